"""Steps of Radau IIA that are solved with the run's own states as unknowns: their nodes, and maps of derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricmb.integrate.problem import Codes, Floats
from fricmb.sensitivity._collocation import Formula, radau
from fricmb.sensitivity._equations import Field


@dataclass(frozen=True, kw_only=True)
class Step:
    """A step that was solved: its begin, length, and slopes at its nodes (s (n + n_z), n_y + n_p)."""

    t: float
    h: float
    slopes: Floats
    n: int
    n_y: int

    def map(self, share: float = 1.0) -> Floats:
        """The map (n_y, n_y + n_p) from its begin to a share of it."""
        n, n_y = self.n, self.n_y
        s, m, width = self.slopes.shape
        formula = radau(s)
        K = _stage_rates(formula, self.h, self.slopes, n, n_y).reshape(s, m, width)
        once = weights(formula, share)
        found = np.zeros((n_y, width))
        found[:, :n_y] = np.eye(n_y)
        found[:n, n : 2 * n] += self.h * share * np.eye(n)
        found[:n] += self.h**2 * np.einsum("j,jab->ab", once @ formula.A, K[:, :n])
        found[n:] += self.h * np.einsum("j,jab->ab", once, K)
        return found


def weights(formula: Formula, share: float) -> Floats:
    """Integrals (s,) up to a share of a step of the polynomials that are 1 at one node and 0 at the others."""
    powers = np.arange(formula.c.size)
    values = formula.c[:, None] ** powers
    return np.asarray(np.linalg.solve(values.T, share ** (powers + 1.0) / (powers + 1.0)))


def system(formula: Formula, h: float, slopes: Floats, n: int, n_y: int) -> Floats:
    """The matrix of the stages (s m, s m): of accelerations and rates less what they make of themselves."""
    s, m = slopes.shape[:2]
    A, A2 = formula.A, formula.A @ formula.A
    left = np.zeros((s, m, s, m))
    left[..., :n] = -(h**2) * A2[:, None, :, None] * slopes[:, :, None, :n]
    left[..., :n] -= h * A[:, None, :, None] * slopes[:, :, None, n : 2 * n]
    left[..., n:] = -h * A[:, None, :, None] * slopes[:, :, None, 2 * n : n_y]
    found: Floats = left.reshape(s * m, s * m)
    return found + np.eye(s * m)


def _stage_rates(formula: Formula, h: float, slopes: Floats, n: int, n_y: int) -> Floats:
    """Derivatives (s m, n_y + n_p) of accelerations and rates at the nodes by the state at the begin and parameters."""
    right = slopes.copy()
    right[..., n : 2 * n] += h * formula.c[:, None, None] * slopes[..., :n]
    s, m, width = slopes.shape
    return np.asarray(np.linalg.solve(system(formula, h, slopes, n, n_y), right.reshape(s * m, width)))


@dataclass(frozen=True, kw_only=True)
class State:
    """Where a stretch has come to: time, state (n_y,), slip of those that set out by contact (d,)."""

    t: float
    y: Floats
    g: dict[int, Floats]


@dataclass(frozen=True, kw_only=True)
class Solved:
    """The nodes of a step.

    ``slopes`` (s, n + n_z, n_y + n_p); where it ends; accelerations and rates ``K`` (s, n + n_z); slip (d, s) of those
    that set out and its rates (s, d), by contact; what parts say there, and modes (n_c,).
    """

    slopes: Floats
    end: State
    K: Floats
    slip: dict[int, Floats]
    rates: dict[int, Floats]
    field: Field
    mode: Codes

    def slip_at(self, shares: Floats, begin: dict[int, Floats], h: float) -> dict[int, Floats]:
        """Slip (d, n) by contact at shares of the step, from what it is at its begin."""
        formula = radau(len(self.K))
        integrals = np.array([weights(formula, share) for share in shares])
        return {k: begin[k][:, None] + h * (integrals @ own).T for k, own in self.rates.items()}

    def rates_at(self, shares: Floats) -> Floats:
        """Accelerations and rates (n, n + n_z) at shares of the step."""
        powers = np.arange(len(self.K))
        nodes, at = radau(len(self.K)).c[:, None] ** powers, shares[:, None] ** powers
        return np.asarray(at @ np.linalg.solve(nodes, self.K))


def at_nodes(formula: Formula, y: Floats, h: float, K: Floats, n: int) -> tuple[Floats, Floats, Floats]:
    """Positions, velocities and laws' states (.., s) at the nodes of a step from y under accelerations and rates K."""
    v = y[n : 2 * n] + h * formula.A @ K[:, :n]
    q = y[:n] + h * formula.c[:, None] * y[n : 2 * n] + h**2 * (formula.A @ formula.A) @ K[:, :n]
    return q.T, v.T, (y[2 * n :] + h * formula.A @ K[:, n:]).T
