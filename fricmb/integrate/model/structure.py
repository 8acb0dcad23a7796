"""The linear structure as kernels take it: its matrices by rows on one pattern."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from fricmb.integrate.csr import Csr, on_one_pattern
from fricmb.integrate.model.band_ordering import band_order
from fricmb.integrate.problem import Floats, Floats2, Ints, Problem


class Structure(NamedTuple):
    """Linear part; ``Kd``, ``Cd``, ``fd`` are the rows of the drivers, ``Ka`` the antisymmetric part of K.

    M, K, C and Ka are kept on one pattern by rows: row i has its entries at ``first[i]:first[i+1]``, in the columns
    ``column[...]``; so is M^-1 on its own.  The pattern also holds what nonlinear elements couple.
    ``own`` (n,): places of the diagonal.  ``tie`` on the pattern, ``alone`` (n,): K q = sum_j K_ij (q_j - tie_ij q_i) +
    alone_i q_i, see :func:`ties`; empty for soft structures.  ``mobility`` (n,): the diagonal of M^-1.
    ``place`` (n,), ``half`` (1,): order for banded factors and its half-bandwidth, -1: dense ones.
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
    half: Ints
    Ku: Floats2
    Cu: Floats2
    f: Floats
    B: Floats2
    Kd: Floats2
    Cd: Floats2
    fd: Floats


def inverse_mass(problem: Problem) -> Csr:
    """M^-1: a diagonal where M is one."""
    M = problem.linear.csr("M")
    if M.is_diagonal():
        places = np.arange(problem.n)
        return Csr.of_entries(places, places, 1.0 / M.diagonal(), M.shape)
    return Csr.of_dense(np.linalg.inv(problem.linear.M))


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


def pack_structure(problem: Problem) -> Structure:
    """The linear part of a problem."""
    n, linear = problem.n, problem.linear
    own, others = slice(0, n), slice(n, n + problem.n_u)
    Kx, Cx, M = linear.csr("Kx"), linear.csr("Cx"), linear.csr("M")
    K, C = Kx.block(own, own), Cx.block(own, own)
    diagonal = np.arange(n)
    first, column, (m, k, c, turned) = on_one_pattern([M, K, C, K.transposed()], (diagonal, diagonal), coupled(problem))
    whole = Csr((n, n), first, column, k)
    Minv = inverse_mass(problem)
    place, half = band_order(first, column)
    solid = np.ascontiguousarray
    tie, alone = ties(whole, np.asarray(problem.omega, float))
    return Structure(
        first=first, column=solid(column), M=m, K=k, C=c, Ka=0.5 * (k - turned),
        own=np.flatnonzero(whole.rows == column), tie=tie, alone=alone,
        Minv_start=Minv.start, Minv_index=solid(Minv.index), Minv=solid(Minv.value),
        mobility=Minv.diagonal(), place=place, half=np.array([half]), Ku=Kx.block(own, others).dense(),
        Cu=Cx.block(own, others).dense(), f=solid(linear.fx[:n]), B=solid(linear.csr("B").dense()),
        Kd=Kx.block(others, slice(0, n + problem.n_u)).dense(), Cd=Cx.block(others, slice(0, n + problem.n_u)).dense(),
        fd=solid(linear.fx[n:]),
    )  # fmt: skip
