"""Steps of Radau IIA that are solved with the run's own states as unknowns: their nodes, and maps of derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricmb.integrate.problem import Codes, Floats
from fricmb.sensitivity._collocation import Formula, end_maps, radau, stage_rates, weights
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
        formula, h = radau(len(self.slopes)), np.array([self.h])
        K = stage_rates(formula, h, self.slopes[None], self.n, self.n_y)
        once = weights(formula, np.array([share]))[0]
        found: Floats = end_maps(h, K, once, once @ formula.A, self.n, self.n_y, share)[0]
        return found


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
        return {k: begin[k][:, None] + h * (weights(formula, shares) @ own).T for k, own in self.rates.items()}

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
