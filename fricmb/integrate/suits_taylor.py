"""What Taylor steps ask of structure and laws; every scene is asked, so it loads none of their kernels."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.csr import is_diagonal
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import LAW_CONSTANT, LAW_SMOOTH, NORMAL_CONSTANT, Linear, Problem, SparseLinear


def against_taylor(problem: Problem) -> str | None:
    """What stands against Taylor steps in the structure and the laws, or None."""
    return once_per(problem, "against taylor", lambda: _against_taylor(problem))


def _against_taylor(problem: Problem) -> str | None:
    if problem.mechanism is not None:
        return "this scene has bodies that turn, or joints"
    contacts, linear = problem.contacts, problem.linear
    if len(problem.elements.table.address):
        return "this scene has nonlinear elements"
    if (contacts.law == LAW_SMOOTH).any() or (contacts.normal != NORMAL_CONSTANT).any() or problem.n_z:
        return "every contact needs a coefficient of friction and a constant normal force"
    if contacts.lean.any():
        return "the limit of friction at rest must be the same in both senses"
    if (contacts.piecewise & (contacts.law != LAW_CONSTANT)).any():
        return "coefficients of friction that depend on slip speed must be formulas"
    return once_per(linear, "against taylor", lambda: _against_structure(linear, problem.n))


def _against_structure(linear: Linear, n: int) -> str | None:
    if isinstance(linear, SparseLinear):
        diagonal = linear.csr("M").is_diagonal()
        symmetric = linear.csr("Kx").block(slice(0, n), slice(0, n)).is_symmetric()
    else:
        K = linear.Kx[:n, :n]
        diagonal = is_diagonal(linear.M)
        symmetric = not np.count_nonzero(K != K.T)
    if not diagonal:
        return "the mass matrix must be diagonal"
    return None if symmetric else "the stiffness must be symmetric"


def fastest(problem: Problem) -> float:
    """A bound on the frequencies and decay rates of a structure whose masses are uncoupled (Gershgorin)."""
    return once_per(problem.linear, "taylor fastest", lambda: _fastest(problem.linear, problem.n))


def _fastest(linear: Linear, n: int) -> float:
    inside = slice(0, n), slice(0, n)
    M = linear.csr("M").diagonal()
    K, C = linear.csr("Kx").block(*inside), linear.csr("Cx").block(*inside)
    scale = 1.0 / np.sqrt(M)
    sums = [np.bincount(A.rows, np.abs(A.value) * scale[A.rows] * scale[A.index], n).max(initial=0.0) for A in (K, C)]
    return float(0.5 * sums[1] + np.sqrt(0.25 * sums[1] ** 2 + sums[0]))
