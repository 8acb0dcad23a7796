"""What a scene predicts for measurements, with its derivatives by the parameters that are sought."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fricmb._fit._data import Measured
from fricmb._fit._offsets import without_offset
from fricmb._simulate import simulate
from fricmb.analysis.cycles import Cycle, limit_cycle
from fricmb.errors import FricmbError, SceneError, unknown_name
from fricmb.integrate.problem import Floats
from fricmb.scene import Scene
from fricmb.solution import Solution

#: Residuals where there is no run.
_FAR = 1e8
#: Transitions that a run has not had yet are waited for this much longer than the last one measured.
_LONGER = 1.25
#: Parameters move by this share for differences: runs agree to far more digits.
_STEP = 1e-4
#: Differences are at least of this part of the distance of the bounds.
_LEAST = 1e-6


@dataclass(kw_only=True)
class Costs:
    """Seconds that a run takes, without derivatives and with them: inf until it is known."""

    plain: float = np.inf
    exact: float = np.inf

    def differences_are_cheaper(self, n_p: int) -> bool:
        """Whether a run for each parameter takes less time than one with derivatives."""
        return bool(np.isfinite(self.exact) and n_p * self.plain < 0.7 * self.exact)


@dataclass(frozen=True, kw_only=True)
class Beside:
    """Two runs whose values of one parameter are ``width`` apart."""

    width: float
    first: Solution
    last: Solution

    def slope(self, name: str) -> Floats:
        """Derivative (n_t,) of a signal; 0 where a transition lies between both: the signal may jump there."""
        same = (self.first.record.samples.mode == self.last.record.samples.mode).all(axis=0)
        difference = (self.last.scalar(name) - self.first.scalar(name)) / self.width
        found: Floats = np.where(same, difference, 0.0)
        return found


@dataclass(kw_only=True)
class Model:
    """Predictions of a scene; the last ones are kept, as an optimiser asks for values and Jacobian in turn."""

    scene: Scene
    names: tuple[str, ...]
    measured: tuple[Measured, ...]
    options: Mapping[str, Any]
    offset: frozenset[str] = frozenset()
    runs: int = 0
    cycle: Cycle | None = None
    #: Those found last.
    offsets: dict[str, float] = field(default_factory=dict)
    costs: Costs = field(default_factory=Costs)
    #: Distances of the bounds (n_p,); 0 where they are not known.
    ranges: Floats = field(default_factory=lambda: np.zeros(0))
    #: Whether derivatives are exact whatever they cost.
    exact: bool = False
    _values: dict[bytes, list[Floats]] = field(default_factory=dict)
    _kept: dict[bytes, tuple[Floats, Floats]] = field(default_factory=dict)

    def until(self, t: float) -> Model:
        """The same for what was measured until then."""
        early = tuple(m.until(t) for m in self.measured)
        return Model(
            scene=self.scene, names=self.names, measured=tuple(m for m in early if m.x.size), options=self.options,
            offset=self.offset, cycle=self.cycle, costs=self.costs, ranges=self.ranges,
        )  # fmt: skip

    def residuals(self, p: Floats) -> Floats:
        """(Prediction - measurement)/error of everything measured (n,).

        Far off where a scene cannot have such values (mu_k above mu_s) or cannot be run with them: steps there are
        taken back.
        """
        try:
            if p.tobytes() in self._kept or not self._plain:
                return self._at(p)[0]
            return np.concatenate([without_offset(m, x)[0] if m.name in self.offset else x
                                   for m, x in zip(self.measured, self._predicted(p), strict=True)])
        except FricmbError:
            if self.runs <= 1:
                raise
            return np.full(sum(m.x.size for m in self.measured), _FAR)

    @property
    def differs(self) -> bool:
        """Whether derivatives are differences, since that is quicker."""
        return self._plain and not self.exact and self.costs.differences_are_cheaper(len(self.names))

    @property
    def _plain(self) -> bool:
        """Whether residuals come from runs without derivatives: signals do, and times of transitions."""
        return all(m.kind != "period" for m in self.measured)

    def noise(self, p: Floats) -> float:
        """Standard deviation of the residuals by their degrees of freedom."""
        residuals = self.residuals(p)
        return float(np.sqrt(residuals @ residuals / self.freedom(p)))

    def freedom(self, p: Floats) -> int:
        """Degrees of freedom of the residuals: each parameter and each offset takes one."""
        return max(sum(m.x.size for m in self.measured) - p.size - len(self.offset), 1)

    def jacobian(self, p: Floats) -> Floats:
        """Derivative (n, n_p) of the residuals."""
        return self._at(p)[1]

    def exact_jacobian(self, p: Floats) -> Floats:
        """The same by exact derivatives whatever they cost: standard errors follow from it."""
        self.exact, before = True, self.exact
        self._kept.clear()
        try:
            return self.jacobian(p)
        finally:
            self.exact = before

    def _at(self, p: Floats) -> tuple[Floats, Floats]:
        key = p.tobytes()
        if key not in self._kept:
            self._kept.clear()
            self._kept[key] = self._computed(p)
        return self._kept[key]

    def with_values(self, p: Floats) -> Scene:
        """The scene with these values."""
        return self.scene.with_parameters(dict(zip(self.names, p.tolist(), strict=True)))

    def run(self, p: Floats, **more: Any) -> Solution | None:
        """The run at the times of the measured signals; None where only periods were measured."""
        times = [m.t for m in self.measured if m.kind == "signal"]
        ends = [m.t.max() * (_LONGER if m.kind == "event" else 1.0) for m in self.measured if m.kind != "period"]
        if not ends:
            return None
        t = np.unique(np.concatenate([*times, np.zeros(0)]))
        t_eval = t if t.size else None
        return simulate(self.with_values(p), t_end=float(max(ends)), t_eval=t_eval, **{**self.options, **more})

    def _predicted(self, p: Floats) -> list[Floats]:
        """Residuals of each measurement by a run without derivatives, offsets still in them."""
        key = p.tobytes()
        if key not in self._values:
            self._values.clear()
            self.runs += 1
            self._values[key] = self._of_run(self._timed(p, "plain"))
        return self._values[key]

    def _timed(self, p: Floats, kind: str, **more: Any) -> Solution | None:
        """A run; how long one takes is kept, that of compiling taken off."""
        begin = time.perf_counter()
        sol = self.run(p, **more)
        if sol is not None:
            if more:
                sol.derivatives.known(sol.names)
            took = time.perf_counter() - begin - float(sol.stats.compile_s)
            setattr(self.costs, kind, min(getattr(self.costs, kind), max(took, 1e-6)))
        return sol

    def _of_run(self, sol: Solution | None) -> list[Floats]:
        assert sol is not None
        found = []
        for m in self.measured:
            if m.kind == "event":
                found.append((_times(m, sol)[0] - m.x) / m.sigma)
            else:
                places = np.searchsorted(sol.t, m.t)
                found.append((sol.scalar(m.name, "data")[places] - m.x) / m.sigma)
        return found

    def _computed(self, p: Floats) -> tuple[Floats, Floats]:
        if self.differs:
            parts = self._differences(p)
        else:
            self.runs += 1
            sol = self._timed(p, "exact", sensitivities=self.names)
            beside = self._beside(sol, p)
            parts = [self._one(m, sol, p, beside) for m in self.measured]
        for i, m in enumerate(self.measured):
            if m.name in self.offset:
                x, J, self.offsets[m.name] = without_offset(m, *parts[i])
                parts[i] = x, J
        return np.concatenate([x for x, _ in parts]), np.concatenate([J for _, J in parts])

    def _moved(self, p: Floats, i: int, sign: float) -> Floats:
        """The values with one of them a little larger or smaller."""
        moved = p.copy()
        least = _LEAST * float(self.ranges[i]) if self.ranges.size else _STEP**2
        moved[i] += sign * max(_STEP * abs(float(p[i])), least)
        return moved

    def _differences(self, p: Floats) -> list[tuple[Floats, Floats]]:
        """Residuals and their derivatives from a further run for each parameter."""
        middle = self._predicted(p)
        columns = [self._column(p, i, middle) for i in range(p.size)]
        return [(x, np.array([column[k] for column in columns]).T) for k, x in enumerate(middle)]

    def _column(self, p: Floats, i: int, middle: list[Floats]) -> list[Floats]:
        """Derivatives of all residuals by one parameter; towards smaller values where the scene has no larger one."""
        for sign in (1.0, -1.0):
            moved = self._moved(p, i, sign)
            self.runs += 1
            try:
                ends = self._of_run(self.run(moved))
            except FricmbError:
                continue
            return [(b - a) / (moved[i] - p[i]) for a, b in zip(middle, ends, strict=True)]
        raise SceneError(f"parameters: the scene accepts no values next to {p[i]:g} of {self.names[i]}")

    def _beside(self, sol: Solution | None, p: Floats) -> tuple[Beside, ...]:
        """Runs with a value a little lower and higher, for signals that have no exact derivatives."""
        exact = set() if sol is None else set(sol.derivatives.known(sol.names))
        if sol is None or all(m.name in exact for m in self.measured if m.kind == "signal"):
            return ()
        return tuple(self._pair(p, i, sol) for i in range(p.size))

    def _pair(self, p: Floats, i: int, sol: Solution) -> Beside:
        """Where the scene cannot have one of both values, this run stands for it."""
        found = []
        for sign in (-1.0, 1.0):
            moved = self._moved(p, i, sign)
            try:
                found.append((moved[i], self.run(moved)))
            except FricmbError:
                found.append((p[i], sol))
        (low, first), (high, last) = found
        if first is None or last is None or low == high:
            raise SceneError(f"parameters: the scene accepts no values next to {p[i]:g} of {self.names[i]}")
        return Beside(width=float(high - low), first=first, last=last)

    def _one(self, m: Measured, sol: Solution | None, p: Floats, beside: tuple[Beside, ...]) -> tuple[Floats, Floats]:
        if m.kind == "period":
            return self._period(m, p)
        assert sol is not None
        if m.kind == "event":
            return _events(m, sol, self.names)
        places = np.searchsorted(sol.t, m.t)
        if m.name in sol.derivatives.known(sol.names):
            J = np.array([sol.sensitivity(m.name, name)[places] for name in self.names]).T
        else:
            J = np.array([pair.slope(m.name)[places] for pair in beside]).T
        return (sol.scalar(m.name, "data")[places] - m.x) / m.sigma, J / m.sigma[:, None]

    def _period(self, m: Measured, p: Floats) -> tuple[Floats, Floats]:
        self.cycle = limit_cycle(self.with_values(p), start=self.cycle)
        slopes = np.array([self.cycle.sensitivity("period", name) for name in self.names])
        return (self.cycle.period - m.x) / m.sigma, slopes / m.sigma[:, None]


def _times(m: Measured, sol: Solution) -> tuple[Floats, Any]:
    """Times of the first transitions of a kind, and these; those that have not come count with the end of the run."""
    contact, _, kind = m.name.rpartition(".")
    if contact not in sol.contact_names:
        raise unknown_name("contact in data", contact, sol.contact_names)
    found = sol.events.of(kind=kind, contact=contact)[: m.x.size]
    return np.concatenate([found.t, np.full(m.x.size - len(found), sol.t_end)]), found


def _events(m: Measured, sol: Solution, names: tuple[str, ...]) -> tuple[Floats, Floats]:
    """Residuals of times of transitions and their derivatives."""
    t, found = _times(m, sol)
    J = np.zeros((m.x.size, len(names)))
    for i, event in enumerate(found):
        J[i] = [event.sensitivity(name) for name in names]
    return (t - m.x) / m.sigma, J / m.sigma[:, None]
