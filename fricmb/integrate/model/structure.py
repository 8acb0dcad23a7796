"""The linear structure as kernels take it: its matrices by rows on one pattern."""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np

from fricmb.integrate.array_cache import cached_by_content
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.csr import Csr, is_diagonal, on_one_pattern
from fricmb.integrate.model.band_ordering import band_order
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import Floats, Floats2, Ints, Problem, SparseLinear


class Structure(Layout):
    """Linear part; ``Kd``, ``Cd``, ``fd`` are the rows of the drivers, ``Ka`` the antisymmetric part of K.

    M, K, C and Ka are kept on one pattern by rows: row i has its entries at ``first[i]:first[i+1]``, in the columns
    ``column[...]``; so is M^-1 on its own.  The pattern also holds what nonlinear elements couple.
    ``own`` (n,): places of the diagonal.  ``tie`` on the pattern, ``alone`` (n,): K q = sum_j K_ij (q_j - tie_ij q_i) +
    alone_i q_i, see :func:`ties`; empty for soft structures.  ``mobility`` (n,): the diagonal of M^-1.
    ``place`` (n,), ``half``: order for banded factors and its half-bandwidth, -1: dense ones.
    """

    first: Ints
    column: Ints
    M: Floats
    K: Floats
    C: Floats
    Ka: Floats
    own: Ints
    tie: Floats
    alone: Floats
    Minv_start: Ints
    Minv_index: Ints
    Minv: Floats
    mobility: Floats
    place: Ints
    half: int
    Ku: Floats2
    Cu: Floats2
    f: Floats
    B: Floats2
    Kd: Floats2
    Cd: Floats2
    fd: Floats


def inverse_mass(problem: Problem) -> Csr:
    """M^-1, made once per problem object: a diagonal where M is one."""
    return once_per(problem, "inverse mass", lambda: _inverse_mass(problem))


def _inverse_mass(problem: Problem) -> Csr:
    if not isinstance(problem.linear, SparseLinear):
        return dense_inverse(np.asarray(problem.linear.M, dtype=float))
    M = problem.linear.csr("M")
    if M.is_diagonal():
        places = np.arange(problem.n)
        return Csr.of_entries(places, places, 1.0 / M.diagonal(), M.shape)
    return Csr.of_dense(np.linalg.inv(problem.linear.M))


@cached_by_content
def dense_inverse(M: Floats) -> Csr:
    """Inverse of a mass matrix, by its content; a diagonal where it is one."""
    places, diagonal = np.arange(len(M)), np.diagonal(M)
    if is_diagonal(M):
        return Csr(M.shape, np.arange(len(M) + 1), places, 1.0 / diagonal)
    return Csr.of_dense(np.linalg.inv(M))


def coupled(problem: Problem) -> tuple[Ints, Ints]:
    """Pairs that nonlinear elements couple: degrees of freedom that feel a force, and those it depends on."""
    elements, n = problem.elements, problem.n
    table = elements.table
    rows, columns = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
    for k in range(len(table.address)):
        first, last = elements.spread_start[elements.f_start[[k, k + 1]]]
        feel = np.unique(elements.spread_dof[first:last])
        first, last = table.form_start[table.x_start[[k, k + 1]]]
        index = table.form_index[first:last] - 1
        on = np.unique(index[(index >= 0) & (index < 2 * n)] % max(n, 1))
        rows.append(np.repeat(feel, len(on)))
        columns.append(np.tile(on, len(feel)))
    return np.concatenate(rows), np.concatenate(columns)


#: Ratio of frequencies from which on forces of stiff springs are taken from differences of positions.
SPREAD = 3e3


def ties(K: Csr, omega: Floats) -> tuple[Floats, Floats]:
    """Which entries of K are springs between two dofs, and what of each row (n,) is none; empty for soft structures.

    The forces of a spring on its two ends are opposite to the last digit only where both come from q_j - q_i; the
    round-off of K q on large positions would push the whole by as much as a soft spring does.
    """
    moving = omega[omega > 0.0]
    # a frequency of 0 is a rigid motion, or one that is lost in round-off beside the largest
    if len(omega) < 2 or (len(moving) == len(omega) and moving.max() < SPREAD * moving.min()):
        return np.zeros(0), np.zeros(0)
    i, j, own = K.rows, K.index, K.diagonal()
    spring = (K.value < 0.0) & (i != j) & (np.minimum(own[i], own[j]) >= -K.value)
    counted = spring | (i == j)
    held = [K.value[a:b][counted[a:b]] for a, b in pairwise(K.start)]
    return counted.astype(float), np.array([math.fsum(line) for line in held])


@lru_cache(maxsize=64)
def _places(n: int, filled: bytes) -> tuple[Ints, Ints, Ints]:
    """Rows by compressed places and columns (see :class:`Structure`) of what is filled (n, n), and row of each entry.

    Scenes that differ in numbers alone share them.
    """
    rows, column = np.nonzero(np.frombuffer(filled, dtype=np.bool_).reshape(n, n))
    first = np.concatenate([[0], np.cumsum(np.bincount(rows, minlength=n))]).astype(np.int64)
    return first, column, rows


@lru_cache(maxsize=64)
def _order(n: int, filled: bytes) -> tuple[Ints, int]:
    """:func:`band_order` of what is filled (n, n)."""
    first, column, _ = _places(n, filled)
    return band_order(first, column)


def _on_dense(problem: Problem) -> tuple[Any, ...]:
    """What :func:`_on_sparse` gives, of dense matrices: without a search for entries of one place."""
    n, linear = problem.n, problem.linear
    M, K, C = linear.M, linear.Kx[:n, :n], linear.Cx[:n, :n]
    filled = (M != 0.0) | (K != 0.0) | (C != 0.0) | (K.T != 0.0)
    np.fill_diagonal(filled, True)
    filled[coupled(problem)] = True
    key = filled.tobytes()
    first, column, rows = _places(n, key)
    values = [matrix[rows, column] + 0.0 for matrix in (M, K, C, K.T)]  # + 0.0: of an entry that is not there, +0
    return first, column, rows, values, _order(n, key)


def _on_sparse(problem: Problem) -> tuple[Any, ...]:
    """Joint pattern of M, K, C and the transpose of K, row of each entry, their values, :func:`band_order` of it."""
    n, linear = problem.n, problem.linear
    own, diagonal = slice(0, n), np.arange(n)
    K, C = linear.csr("Kx").block(own, own), linear.csr("Cx").block(own, own)
    matrices = [linear.csr("M"), K, C, K.transposed()]
    first, column, values = on_one_pattern(matrices, (diagonal, diagonal), coupled(problem))
    return first, column, np.repeat(diagonal, np.diff(first)), values, band_order(first, column)


def pack_structure(problem: Problem) -> Structure:
    """The linear part of a problem."""
    n, linear = problem.n, problem.linear
    sparse = isinstance(linear, SparseLinear)
    first, column, rows, (m, k, c, turned), (place, half) = _on_sparse(problem) if sparse else _on_dense(problem)
    Minv = inverse_mass(problem)
    solid = np.ascontiguousarray
    tie, alone = ties(Csr((n, n), first, column, k), np.asarray(problem.omega, float))

    def part(name: str, at: slice, to: slice) -> Floats:
        if sparse:
            return linear.csr(name).block(at, to).dense()
        held: Floats = solid(getattr(linear, name)[at, to] + 0.0)
        return held

    own, others, both = slice(0, n), slice(n, n + problem.n_u), slice(0, n + problem.n_u)
    return Structure(
        first=first, column=solid(column), M=m, K=k, C=c, Ka=0.5 * (k - turned),
        own=np.flatnonzero(rows == column), tie=tie, alone=alone,
        Minv_start=Minv.start, Minv_index=solid(Minv.index), Minv=solid(Minv.value),
        mobility=Minv.diagonal(), place=place, half=int(half), Ku=part("Kx", own, others),
        Cu=part("Cx", own, others), f=solid(linear.fx[:n]), B=part("B", own, slice(0, problem.n_u)),
        Kd=part("Kx", others, both), Cd=part("Cx", others, both), fd=solid(linear.fx[n:]),
    )  # fmt: skip
