"""What is known of a linear structure beside its matrices: the inverse of its mass, stiff springs, its band."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from fricmb.integrate.array_cache import cached_by_content
from fricmb.integrate.csr import Csr, is_diagonal, on_one_pattern
from fricmb.integrate.model.band_ordering import band_order
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import Floats, Problem, SparseLinear


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


def half_bandwidth(problem: Problem) -> int:
    """Half the width of the band in which the structure is solved; -1 where a dense matrix is cheaper."""
    return once_per(problem.linear, "half bandwidth", lambda: _half_bandwidth(problem))


def _half_bandwidth(problem: Problem) -> int:
    n, linear = problem.n, problem.linear
    own, diagonal = slice(0, n), np.arange(n)
    K, C = linear.csr("Kx").block(own, own), linear.csr("Cx").block(own, own)
    first, column, _ = on_one_pattern([linear.csr("M"), K, C, K.transposed()], (diagonal, diagonal))
    return band_order(first, column)[1]
