"""Event functions: what vanishes at a transition, how fast, and by what it is moved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricmb.integrate.problem import STICK, Floats
from fricmb.sensitivity._dual import Dual
from fricmb.sensitivity._equations import Equations, Field
from fricmb.sensitivity._found import at
from fricmb.sensitivity._happenings import Happening
from fricmb.sensitivity._phases import Phases


@dataclass(frozen=True, kw_only=True)
class Trigger:
    """An event function at its zero: residual, slopes (columns,), rate along the motion, and that rate normalised."""

    event: int
    contact: int
    residual: float
    slopes: Floats
    rate: float
    transversality: float


class Triggers:
    """Event functions of happenings.

    Parameters
    ----------
    before : Field
        At the times of all happenings, before them.
    v : (n, n_t)
        Velocities there.
    """

    def __init__(
        self, equations: Equations, phases: Phases, happened: list[Happening], before: Field, v: Floats
    ) -> None:
        self.equations, self.phases, self.happened, self.before = equations, phases, happened, before
        self.speeds = np.abs(v).max(axis=1)

    def of(self, i: int) -> list[Trigger]:
        """Those of one happening."""
        one, along = self.happened[i], self._along(i)
        found = []
        for event, k, kind in zip(one.events.tolist(), one.contacts, one.kinds, strict=True):
            make = {"slip": self._release, "open": self._opening, "close": self._opening}.get(kind, self._rest)
            found.append(make(i, event, k, along))
        return found

    def landing(self, i: int, k: int, g: Floats) -> tuple[Floats, Floats, float]:
        """Slopes (n_t, columns) of the time that slip in two directions still takes, where it has g (d, n_t).

        Also the slopes (n_t, d, columns) of what of it is across g, and the largest speed of what slips.

        With constant a and c = mu_k N it lasts for T = (r + g^T D^-1 a/c)/(c n^T D n - a^T D^-1 a/c), whatever its
        direction, where D is a multiple of the unit matrix, and else once its direction has settled: T' = -1 along
        g' = a - c D n.
        """
        e, along = self.equations, self._along(i)
        slopes = np.array([self._row(dual, i)[1] for dual in self.before.found.g[k]])
        W = slopes[:, e.n : 2 * e.n]
        n = -(slopes @ along) / np.linalg.norm(slopes @ along)
        D = W @ e.free(self.before.found, self.phases.mode[:, self.happened[i].phase - 1], i) @ W.T
        c = e.contacts[k].size_at_rest(self.before.found.N[k], i)
        held_by = np.linalg.solve(D, slopes @ along + c * D @ n) / c
        length = np.linalg.norm(g, axis=0)
        turned = np.where(length > 0.0, g / np.where(length > 0.0, length, 1.0), n[:, None])
        whole_rate = c * float(n @ D @ n) - c * float(held_by @ D @ held_by)
        across = slopes - np.einsum("at,bt,bj->taj", turned, turned, slopes)
        speed = float(np.abs(W).max(axis=0) @ self.speeds)
        return (turned + held_by[:, None]).T @ slopes / whole_rate, across / whole_rate, speed

    def indeterminate(self, i: int) -> bool:
        """Whether forces in stick before a happening are not determined."""
        e, mode = self.equations, self.phases.mode[:, self.happened[i].phase - 1]
        stuck = [k for k, contact in e.contacts.items() if not contact.smooth and mode[k] == STICK]
        D = e.projector(self.before.found, stuck, i)[2]
        return bool(np.linalg.matrix_rank(D, tol=1e-10 * np.abs(D).max(initial=0.0)) < len(D))

    def _along(self, i: int) -> Floats:
        """Rates of all columns along the motion: what slopes are multiplied with."""
        found = np.zeros(self.equations.columns)
        found[: self.equations.n_y] = self.before.y_dot[i]
        found[-1] = 1.0
        return found

    def _row(self, dual: Dual, i: int) -> tuple[float, Floats]:
        slopes = np.zeros(self.equations.columns)
        for j, slope in dual.slopes.items():
            slopes[j] = at(slope, i)
        return at(dual.value, i), slopes

    def _release(self, i: int, event: int, k: int, along: Floats) -> Trigger:
        """Friction that holds reaches its limit: |F| - mu_s N = 0."""
        F, F_slopes = (part[i] for part in self.before.F[k])
        size = max(float(np.linalg.norm(F)), 1e-300)
        limit, limit_slopes = self._row(self.before.found.limit[k], i)
        slopes = F @ F_slopes / size - limit_slopes
        rate = float(slopes @ along)
        unit = max(limit, 1e-300)
        return Trigger(
            event=event, contact=k, residual=abs(size - limit) / unit, slopes=slopes, rate=rate or 1e-300,
            transversality=abs(rate) / unit * self._lasted(i),
        )  # fmt: skip

    def _lasted(self, i: int) -> float:
        """Time since what happened before."""
        begin = self.happened[i - 1].t if i else float(self.phases.t[0])
        return self.happened[i].t - begin

    def _rest(self, i: int, event: int, k: int, along: Floats) -> Trigger:
        """Slip ends or turns round: g = 0."""
        rows = [self._row(dual, i) for dual in self.before.found.g[k]]
        g, slopes = np.array([row[0] for row in rows]), np.array([row[1] for row in rows])
        rates = slopes @ along
        n = np.ones(1) if g.size == 1 else -rates / max(float(np.linalg.norm(rates)), 1e-300)
        limit, _ = self._row(self.before.found.limit[k], i)
        W = (n @ slopes)[self.equations.n : 2 * self.equations.n]
        scale = float(W @ self.equations.inverse @ W) * max(limit, 1e-300)
        speed = float(np.abs(slopes[:, self.equations.n : 2 * self.equations.n]).max(axis=0) @ self.speeds) + 1e-300
        rate = float(n @ rates)
        return Trigger(
            event=event, contact=k, residual=float(np.linalg.norm(g)) / speed, slopes=n @ slopes, rate=rate or 1e-300,
            transversality=abs(rate) / scale,
        )  # fmt: skip

    def _opening(self, i: int, event: int, k: int, along: Floats) -> Trigger:
        """The normal force vanishes."""
        N, slopes = self._row(self.before.found.N[k], i)
        rate = float(slopes @ along)
        largest = float(np.max(np.abs(np.asarray(self.before.found.N[k].value)))) + 1e-300
        parts = float(np.abs(slopes) @ np.abs(along)) + 1e-300
        return Trigger(
            event=event, contact=k, residual=abs(N) / max(largest, 1e-300), slopes=slopes, rate=rate or 1e-300,
            transversality=abs(rate) / parts,
        )  # fmt: skip
