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
    values = legendre.legvander(x, s - 1)
    integrals = np.array([legendre.legval(x, legendre.legint(row, lbnd=-1.0)) for row in np.eye(s)]).T
    A = 0.5 * np.linalg.solve(values.T, integrals.T).T
    error = factorial(s) * factorial(s - 1) / (2.0 * factorial(2 * s - 1) * factorial(2 * s))
    return Formula(c=0.5 * (1.0 + x), A=A, order=2 * s - 1, error=error)


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
    Gq, Gv, Gz = G[..., :n], G[..., n : 2 * n], G[..., 2 * n : n_y]
    left = np.zeros((count, s, m, s, m))
    square, once = h[:, None, None, None, None] ** 2, h[:, None, None, None, None]
    left[..., :n] = -square * A2[None, :, None, :, None] * Gq[:, :, :, None, :]
    left[..., :n] -= once * formula.A[None, :, None, :, None] * Gv[:, :, :, None, :]
    left[..., n:] = -once * formula.A[None, :, None, :, None] * Gz[:, :, :, None, :]
    system: Floats = left.reshape(count, s * m, s * m)
    system[:, np.arange(s * m), np.arange(s * m)] += 1.0
    right = G.copy()
    right[..., n : 2 * n] += h[:, None, None, None] * formula.c[None, :, None, None] * Gq
    K = np.linalg.solve(system, right.reshape(count, s * m, width)).reshape(count, s, m, width)
    found = np.zeros((count, n_y, width))
    found[:, np.arange(n_y), np.arange(n_y)] = 1.0
    found[:, np.arange(n), n + np.arange(n)] += h[:, None]
    found[:, :n] += h[:, None, None] ** 2 * np.einsum("j,tjab->tab", A2[-1], K[:, :, :n])
    found[:, n : 2 * n] += h[:, None, None] * np.einsum("j,tjab->tab", formula.A[-1], K[:, :, :n])
    found[:, 2 * n :] += h[:, None, None] * np.einsum("j,tjab->tab", formula.A[-1], K[:, :, n:])
    return found
