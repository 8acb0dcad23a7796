"""Steps of linear equations by Radau IIA collocation, many at once: the map of each step from its begin to its end."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import factorial

import numpy as np
from numpy.polynomial import legendre

from fricmb.integrate.problem import Floats
from fricmb.sensitivity._eliminate import SMALL, small_maps


@dataclass(frozen=True, kw_only=True)
class Formula:
    """Radau IIA (Hairer, Wanner, Solving Ordinary Differential Equations II, section IV.5).

    ``c`` (s,) nodes, ``A`` (s, s) coefficients; ``order`` 2s - 1; ``error``: of one step of y' = y over h**(order + 1).
    """

    c: Floats
    A: Floats
    order: int
    error: float


@cache
def radau(s: int) -> Formula:
    """The formula of s stages."""
    difference = np.zeros(s + 1)
    difference[s], difference[s - 1] = 1.0, -1.0
    x = np.sort(legendre.legroots(difference).real)
    x[-1] = 1.0
    error = factorial(s) * factorial(s - 1) / (2.0 * factorial(2 * s - 1) * factorial(2 * s))
    return Formula(c=0.5 * (1.0 + x), A=_integrals(x, x), order=2 * s - 1, error=error)


def _integrals(x: Floats, ends: Floats) -> Floats:
    """Half the integrals (n, s) from -1 to ends (n,) of polynomials that are 1 at one of x (s,), 0 at the others."""
    s = x.size
    integrals = [legendre.legval(ends, legendre.legint(row, lbnd=-1.0)) for row in np.eye(s)]
    found: Floats = 0.5 * np.linalg.solve(legendre.legvander(x, s - 1).T, np.array(integrals)).T
    return found


def weights(formula: Formula, shares: Floats) -> Floats:
    """Integrals (n, s) up to shares (n,) of a step of the polynomials that are 1 at one node and 0 at the others."""
    return _integrals(2.0 * formula.c - 1.0, 2.0 * shares - 1.0)


def step_maps(formula: Formula, h: Floats, slopes: Floats, rates: Floats, n: int, n_y: int) -> Floats:
    """Maps (n_t, n_y, n_y + n_p) of steps of length h (n_t,): the state and the parameters to the state at the end.

    Parameters
    ----------
    slopes : (n_t, s, n, n_y + n_p)
        Of accelerations at the stages with respect to q, v, z and parameters.
    rates : (n_t, s, n_z, n_y + n_p)
        Of the states of laws.

    Notes
    -----
    Positions follow from accelerations: q_i = q + h c_i v + h^2 sum (A^2)_ij a_j, so only accelerations and rates are
    unknowns of the stages.
    """
    count, s = h.size, formula.c.size
    G = np.concatenate([slopes, rates], axis=2) if rates.size else slopes
    m, width = G.shape[2], G.shape[3]
    A2 = formula.A @ formula.A
    if s * m <= SMALL:
        found = np.zeros((count, n_y, width))
        small_maps(formula.A, A2, formula.c, h, G.reshape(count, s * m, width), n, found)
        return found
    K = stage_rates(formula, h, G, n, n_y)
    return end_maps(h, K, formula.A[-1], A2[-1], n, n_y)


def stage_system(formula: Formula, h: Floats, G: Floats, n: int, n_y: int) -> Floats:
    """Matrices of the stages (n_t, s m, s m): of accelerations and rates less what they make of themselves.

    ``G`` (n_t, s, m, n_y + ...): slopes of accelerations and rates at the stages of steps of length h (n_t,).
    """
    count, s, m = G.shape[:3]
    A, A2 = formula.A[None, :, None, :, None], (formula.A @ formula.A)[None, :, None, :, None]
    square, once = h[:, None, None, None, None] ** 2, h[:, None, None, None, None]
    left = np.zeros((count, s, m, s, m))
    left[..., :n] = -square * A2 * G[:, :, :, None, :n]
    left[..., :n] -= once * A * G[:, :, :, None, n : 2 * n]
    left[..., n:] = -once * A * G[:, :, :, None, 2 * n : n_y]
    system: Floats = left.reshape(count, s * m, s * m)
    system[:, np.arange(s * m), np.arange(s * m)] += 1.0
    return system


def stage_rates(formula: Formula, h: Floats, G: Floats, n: int, n_y: int) -> Floats:
    """Derivatives (n_t, s, m, n_y + n_p) of accelerations and rates at the stages by first state and parameters.

    ``G`` (n_t, s, m, n_y + n_p): their slopes there.
    """
    count, s, m, width = G.shape
    right = G.copy()
    right[..., n : 2 * n] += h[:, None, None, None] * formula.c[None, :, None, None] * G[..., :n]
    K = np.linalg.solve(stage_system(formula, h, G, n, n_y), right.reshape(count, s * m, width))
    return np.asarray(K.reshape(count, s, m, width), dtype=float)


def end_maps(h: Floats, K: Floats, once: Floats, twice: Floats, n: int, n_y: int, share: float = 1.0) -> Floats:
    """Maps (n_t, n_y, n_y + n_p) from the begin of steps to a share of them.

    ``K``: see :func:`stage_rates`; ``once``, ``twice`` (s,): what they are weighted with to be integrated up to there.
    """
    found = np.zeros((h.size, n_y, K.shape[-1]))
    found[:, np.arange(n_y), np.arange(n_y)] = 1.0
    found[:, np.arange(n), n + np.arange(n)] += share * h[:, None]
    found[:, :n] += h[:, None, None] ** 2 * np.einsum("j,tjab->tab", twice, K[:, :, :n])
    found[:, n:] += h[:, None, None] * np.einsum("j,tjab->tab", once, K)
    return found
