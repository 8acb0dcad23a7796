"""Transitions: when parameters move them, and by how much that makes derivatives jump.

The state is continuous at a transition.  With dt the derivative of its time, Z = S + f dt is that of the state there,
the same on both sides, so S+ = S- + (f- - f+) dt.  The time follows from the event function h of what happens:
dt = -(h_y S- + h_p)/(h_y f- + h_t).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fricmb.integrate.problem import Codes, Floats, Ints
from fricmb.integrate.trajectory import Samples
from fricmb.sensitivity._dual import Dual
from fricmb.sensitivity._equations import Equations, Field
from fricmb.sensitivity._found import whole
from fricmb.sensitivity._phases import Phases

#: An event function counts as 0 within this share of its scale, or this many tolerances.
_ZERO, _TOLERANCES = 1e-7, 100.0
#: Below this normalised rate a transition is too close to one that only touches to be trusted.
TOUCHES = 1e-3


@dataclass(frozen=True, kw_only=True)
class Happening:
    """What happens at one time: numbers of its events, contacts, kinds, and the stretch that begins there."""

    t: float
    events: Ints
    contacts: list[int]
    kinds: list[str]
    phase: int


@dataclass(frozen=True, kw_only=True)
class Trigger:
    """An event function at its zero: residual, slopes (columns,), rate along the motion, and that rate normalised."""

    event: int
    contact: int
    residual: float
    slopes: Floats
    rate: float
    transversality: float


def happenings(events: Any, names: Any, phases: Phases) -> list[Happening]:
    """Events of one piece that stand at the same time, together."""
    held = list(events)
    t = np.array([event.t for event in held])
    found = []
    inside = np.isin(t, phases.t[1:-1])
    for time in np.unique(t[inside]):
        own = np.flatnonzero(t == time)
        one = Happening(
            t=float(time),
            events=own,
            contacts=[names.contact(held[i].contact) for i in own],
            kinds=[held[i].kind for i in own],
            phase=int(np.searchsorted(phases.t, time)),
        )
        found.append(one)
    return found


class Transitions:
    """Jumps of derivatives.

    Parameters
    ----------
    happened : list of Happening
    breakpoints : (n_b,)
        Times at which functions of time have kinks.
    """

    def __init__(
        self, equations: Equations, phases: Phases, sample: Any, happened: list[Happening], breakpoints: Floats,
        rtol: float,
    ) -> None:  # fmt: skip
        self.equations, self.phases, self.happened, self.breakpoints = equations, phases, happened, breakpoints
        self.zero = max(_ZERO, _TOLERANCES * rtol)
        self.notes: list[str] = []
        self._samples: Samples | None = None
        if happened:
            times = np.array([one.t for one in happened])
            begin = np.array([one.phase for one in happened])
            self._samples = sample(times)
            before = replace(self._samples, t=np.nextafter(times, -np.inf))
            self.before = equations.field(before, phases.mode[:, begin - 1], phases.sign[:, begin - 1])
            self.after = equations.field(self._samples, phases.mode[:, begin], phases.sign[:, begin])
            self.speeds = np.abs(self._samples.v).max(axis=1)

    def jump(self, i: int, S: Floats) -> tuple[Floats, Floats, list[float]]:
        """Derivatives after happening i from those before (n_y, n_p); of its time, and transversalities by event."""
        one = self.happened[i]
        triggers = [self._trigger(i, j) for j in range(len(one.contacts))]
        rates = [trigger.transversality for trigger in triggers]
        least = min(triggers, key=lambda trigger: trigger.residual)
        chosen = [trigger for trigger in triggers if trigger.residual <= self.zero]
        if not chosen and np.any(np.abs(self.breakpoints - one.t) <= 1e-12 * max(1.0, abs(one.t))):
            return S + 0.0, np.zeros(S.shape[1]), [np.inf] * len(rates)
        chosen = chosen or [least]
        dts = [self._moved(trigger, S) for trigger in chosen]
        if len(chosen) > 1:
            self._say_together(one, chosen, dts)
        found, f = S, self.before.y_dot[i]
        for trigger, dt in zip(chosen[:-1], dts[:-1], strict=True):
            after = self._with(i, trigger, f)
            found, f = found + np.outer(f - after, dt), after
        found = found + np.outer(f - self.after.y_dot[i], dts[-1])
        return found, dts[0], rates

    def _moved(self, trigger: Trigger, S: Floats) -> Floats:
        """Derivatives (n_p,) of the time at which an event function vanishes."""
        found: Floats = -total(trigger.slopes, S, self.equations.n_y) / trigger.rate
        return found

    def _say_together(self, one: Happening, chosen: list[Trigger], dts: list[Floats]) -> None:
        if all(np.allclose(dt, dts[0], rtol=1e-6, atol=1e-12) for dt in dts):
            return
        names = [self.equations.names.contacts[trigger.contact] for trigger in chosen]
        self.notes.append(
            f"at t = {one.t:.10g} the contacts {', '.join(names)} change on their own at the same time: derivatives"
            " from there on are one-sided"
        )

    def _with(self, i: int, trigger: Trigger, f: Floats) -> Floats:
        """Rates when, of several that change at once, those up to a trigger have changed."""
        one = self.happened[i]
        mode, sign = self.phases.mode[:, one.phase - 1].copy(), self.phases.sign[:, one.phase - 1].copy()
        for j, k in enumerate(one.contacts):
            if one.events[j] <= trigger.event:
                own = slice(int(self.equations.names.row[k]), int(self.equations.names.row[k + 1]))
                mode[k], sign[own] = self.phases.mode[k, one.phase], self.phases.sign[own, one.phase]
        samples = _one(self._samples, i)
        found: Floats = self.equations.field(samples, mode[:, None], sign[:, None]).y_dot[0]
        return found

    # ---- event functions

    def _trigger(self, i: int, j: int) -> Trigger:
        one = self.happened[i]
        k, kind = one.contacts[j], one.kinds[j]
        along = self._along(self.before, i)
        if kind == "slip":
            return self._release(i, int(one.events[j]), k, along)
        if kind in ("open", "close"):
            return self._opening(i, int(one.events[j]), k, along)
        return self._rest(i, int(one.events[j]), k, along)

    def _along(self, field: Field, i: int) -> Floats:
        """Rates of all columns along the motion: what slopes are multiplied with."""
        found = np.zeros(self.equations.columns)
        found[: self.equations.n_y] = field.y_dot[i]
        found[-1] = 1.0
        return found

    def _row(self, dual: Dual, i: int) -> tuple[float, Floats]:
        slopes = np.zeros(self.equations.columns)
        for j, slope in dual.slopes.items():
            slopes[j] = _at(slope, i)
        return _at(dual.value, i), slopes

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
        g, slopes = rows[0]
        rate = float(slopes @ along)
        limit, _ = self._row(self.before.found.limit[k], i)
        W = slopes[self.equations.n : 2 * self.equations.n]
        scale = float(W @ self.equations.inverse @ W) * max(limit, 1e-300)
        speed = float(np.abs(W) @ self.speeds) + 1e-300
        return Trigger(
            event=event, contact=k, residual=abs(g) / speed, slopes=slopes, rate=rate or 1e-300,
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


def held(equations: Equations, samples: Samples, mode: Codes, sign: Floats, S: Floats) -> Floats:
    """Derivatives at a start in stick: what sticks keeps sticking, as if it had just come to rest."""
    field = equations.field(samples, mode[:, None], sign[:, None])
    stuck = [k for k, contact in equations.contacts.items() if not contact.smooth and mode[k] == 0]
    if not stuck:
        return S
    _, slopes = whole([g for k in stuck for g in field.found.g[k]], 1, equations.columns)
    _, B, _ = equations.projector(field.found, stuck)
    found = S.copy()
    found[equations.n : 2 * equations.n] -= B @ total(slopes[0], S, equations.n_y)
    return found


def total(slopes: Floats, S: Floats, n_y: int) -> Floats:
    """Total derivatives from partial ones: parameters have the last columns of S, initial values those before."""
    found = slopes[..., :n_y] @ S
    given = slopes[..., n_y:-1]
    found[..., found.shape[-1] - given.shape[-1] :] += given
    return np.asarray(found, dtype=float)


def _at(value: Any, i: int) -> float:
    return float(value) if np.ndim(value) == 0 else float(value[i])


def _one(samples: Samples | None, i: int) -> Samples:
    from fricmb.integrate.run.chunked_run import take

    assert samples is not None
    return take(samples, [i])
