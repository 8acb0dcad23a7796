"""Transitions: when parameters move them, and by how much that makes derivatives jump.

The state is continuous at a transition.  With dt the derivative of its time, Z = S + f dt is that of the state there,
the same on both sides, so S+ = S- + (f- - f+) dt.  The time follows from the event function h of what happens:
dt = -(h_y S- + h_p)/(h_y f- + h_t).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fricmb.integrate.problem import SLIP, STICK, Codes, Floats, Ints
from fricmb.integrate.trajectory import Samples
from fricmb.sensitivity._breakpoints import Breakpoints
from fricmb.sensitivity._dual import Dual
from fricmb.sensitivity._equations import Equations, Field
from fricmb.sensitivity._found import whole
from fricmb.sensitivity._phases import BESIDE, Phases

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


def happenings(events: Any, names: Any, phases: Phases, moving: Floats) -> list[Happening]:
    """Events of one piece that stand at the same time, together, and breakpoints that parameters move (n_b,)."""
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
    seen = {one.phase for one in found}
    for time in moving.tolist():
        phase = int(np.argmin(np.abs(phases.t - time)))
        if phase not in seen:
            own = np.zeros(0, dtype=np.int64)
            found.append(Happening(t=float(phases.t[phase]), events=own, contacts=[], kinds=[], phase=phase))
    return sorted(found, key=lambda one: one.phase)


class Transitions:
    """Jumps of derivatives.

    Parameters
    ----------
    happened : list of Happening
    breakpoints : Breakpoints
        Of functions of time.
    """

    def __init__(
        self, equations: Equations, phases: Phases, sample: Any, happened: list[Happening], breakpoints: Breakpoints,
        rtol: float,
    ) -> None:  # fmt: skip
        self.equations, self.phases, self.happened, self.breakpoints = equations, phases, happened, breakpoints
        self.zero = max(_ZERO, _TOLERANCES * rtol)
        self.notes: list[str] = []
        self.sample = sample
        self._samples: Samples | None = None
        if happened:
            times = np.array([one.t for one in happened])
            begin = np.array([one.phase for one in happened])
            self._samples = sample(times)
            # functions of time may jump here, at an instant that is known to some units of round-off
            beside = BESIDE * np.maximum(1.0, np.abs(times))
            before, after = (replace(self._samples, t=times + sign * beside) for sign in (-1.0, 1.0))
            self.before = equations.field(before, phases.mode[:, begin - 1], phases.sign[:, begin - 1])
            self.after = equations.field(after, phases.mode[:, begin], phases.sign[:, begin])
            self.speeds = np.abs(self._samples.v).max(axis=1)
            self._beginnings()

    def _beginnings(self) -> None:
        """Fields where slip in two directions begins or has just ended, along its direction at r = 0."""
        for i, one in enumerate(self.happened):
            for k, kind in zip(one.contacts, one.kinds, strict=True):
                if self.equations.contacts[k].d > 1 and kind in ("stick", "slip"):
                    ends = kind == "stick"
                    if not ends and self._moves_on(i, k):
                        continue
                    phase = one.phase - 1 if ends else one.phase
                    samples, mode = _one(self._samples, i), self.phases.mode[:, [phase]]
                    sign = direction_at_rest(self.equations, samples, mode, self.phases.sign[:, [phase]], k)
                    own = self.equations.field(samples, mode, sign)
                    _put(self.before if ends else self.after, i, own)

    def _moves_on(self, i: int, k: int) -> bool:
        """Whether slip begins with a speed: what a contact touches has jumped."""
        g, W = whole(self.after.found.g[k], len(self.happened), self.equations.columns)
        speed = float(np.abs(W[i, :, self.equations.n : 2 * self.equations.n]).max(axis=0) @ self.speeds) + 1e-300
        return bool(np.linalg.norm(g[i]) > 1e-3 * speed)

    def jump(self, i: int, S: Floats, t: float) -> tuple[Floats, Floats, list[float]]:
        """Derivatives after happening i from those before (n_y, n_p); of its time, and transversalities by event.

        ``t``: when S is meant, not later.
        """
        one = self.happened[i]
        triggers = [self._trigger(i, j, t) for j in range(len(one.contacts))]
        rates = [trigger.transversality for trigger in triggers]
        chosen = [trigger for trigger in triggers if trigger.residual <= self.zero]
        given = self.breakpoints.at(one.t)
        if not chosen and given is not None:
            # a function of time breaks, and what changes follows at once
            dt = np.concatenate([np.zeros(S.shape[1] - given.size), given])
            return S + np.outer(self.before.y_dot[i] - self.after.y_dot[i], dt), dt, [np.inf] * len(rates)
        self._say_unsafe(i, triggers)
        chosen = chosen or [min(triggers, key=lambda trigger: trigger.residual)]
        dts = [self._moved(trigger, S) for trigger in chosen]
        if len(chosen) > 1:
            self._say_together(one, chosen, dts)
        found, f = S, self.before.y_dot[i]
        for trigger, dt in zip(chosen, dts, strict=True):
            last = trigger is chosen[-1]
            after = self.after.y_dot[i] if last else self._with(i, trigger)
            if self._lands(i, trigger):
                # its direction has settled: all that is left of the slip goes
                stops = self.after.y_dot[i] if not last else self._with(i, trigger)
                found = self._stopped(i, trigger, found) + np.outer(stops - after, dt)
            else:
                found = found + np.outer(f - after, dt)
            f = after
        return found, dts[0], rates

    def _say_unsafe(self, i: int, triggers: list[Trigger]) -> None:
        """Notes on transitions that only touch their condition, and on releases that are not determined."""
        one, names = self.happened[i], self.equations.names.contacts
        for trigger, kind in zip(triggers, one.kinds, strict=True):
            where = f"at t = {one.t:.10g} contact {names[trigger.contact]!r}"
            if trigger.transversality < TOUCHES:
                self.notes.append(
                    f"{where}: a transition ({kind}) that only touches its condition (transversality"
                    f" {trigger.transversality:.1e}); there is no sound derivative of what follows"
                )
            elif kind == "slip" and self._indeterminate(i):
                self.notes.append(
                    f"{where}: lets go while stuck contacts hold the same motion, which leaves their forces open;"
                    " derivatives of what follows are not sound"
                )

    def _indeterminate(self, i: int) -> bool:
        """Whether forces in stick before a happening are not determined."""
        e, mode = self.equations, self.phases.mode[:, self.happened[i].phase - 1]
        stuck = [k for k, contact in e.contacts.items() if not contact.smooth and mode[k] == STICK]
        D = e.projector(self.before.found, stuck)[2]
        return bool(np.linalg.matrix_rank(D, tol=1e-10 * np.abs(D).max(initial=0.0)) < len(D))

    def _lands(self, i: int, trigger: Trigger) -> bool:
        """Whether slip in two directions ends."""
        one = self.happened[i]
        kind = one.kinds[int(np.flatnonzero(one.events == trigger.event)[0])]
        return kind == "stick" and self.equations.contacts[trigger.contact].d > 1

    def _stopped(self, i: int, trigger: Trigger, S: Floats) -> Floats:
        """Derivatives where a contact sticks with those that stick already."""
        mode, sign = self._modes(i, trigger)
        return held(self.equations, _one(self._samples, i), mode, sign, S)

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

    def _with(self, i: int, trigger: Trigger) -> Floats:
        """Rates when, of several that change at once, those up to a trigger have changed."""
        mode, sign = self._modes(i, trigger)
        found: Floats = self.equations.field(_one(self._samples, i), mode[:, None], sign[:, None]).y_dot[0]
        return found

    def _modes(self, i: int, trigger: Trigger) -> tuple[Codes, Floats]:
        one = self.happened[i]
        mode, sign = self.phases.mode[:, one.phase - 1].copy(), self.phases.sign[:, one.phase - 1].copy()
        for j, k in enumerate(one.contacts):
            if one.events[j] <= trigger.event:
                own = self.equations.rows(k)
                mode[k], sign[own] = self.phases.mode[k, one.phase], self.phases.sign[own, one.phase]
        return mode, sign

    # ---- event functions

    def _trigger(self, i: int, j: int, t: float) -> Trigger:
        one = self.happened[i]
        k, kind = one.contacts[j], one.kinds[j]
        along = self._along(self.before, i)
        if kind == "slip":
            return self._release(i, int(one.events[j]), k, along)
        if kind in ("open", "close"):
            return self._opening(i, int(one.events[j]), k, along)
        found = self._rest(i, int(one.events[j]), k, along)
        return self._landing(i, found, along, t) if self._lands(i, found) else found

    def _landing(self, i: int, trigger: Trigger, along: Floats, t: float) -> Trigger:
        """Slip in two directions ends: how long it still takes, and what of it g makes.

        With constant a and c = mu_k N it lasts for T = (r + g^T D^-1 a/c)/(c n^T D n - a^T D^-1 a/c), whatever its
        direction, where D is a multiple of the unit matrix, and else once its direction has settled: T' = -1 along
        g' = a - c D n.
        """
        e, k = self.equations, trigger.contact
        slopes = np.array([self._row(dual, i)[1] for dual in self.before.found.g[k]])
        W = slopes[:, e.n : 2 * e.n]
        n = -(slopes @ along) / np.linalg.norm(slopes @ along)
        D = W @ e.free(self.before.found, self.phases.mode[:, self.happened[i].phase - 1]) @ W.T
        N, _ = self._row(self.before.found.N[k], i)
        size = e.contacts[k].beginning(Dual(value=N), np.ones((len(n), 1)))[0].value
        c = -float(np.ravel(size)[0])
        held_by = np.linalg.solve(D, slopes @ along + c * D @ n) / c
        g = self.sample(np.array([t])).g[e.rows(k), 0]
        length = float(np.linalg.norm(g))
        turned = g / length if length > 0.0 else n
        whole_rate = c * float(n @ D @ n) - c * float(held_by @ D @ held_by)
        return replace(trigger, slopes=(turned + held_by) @ slopes / whole_rate, rate=-1.0)

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


def direction_at_rest(e: Equations, samples: Samples, mode: Codes, sign: Floats, k: int) -> Floats:
    """Signs in which those of contact k are the direction in which its slip begins, or has just ended.

    (mu_k N D + rho I) n = a with |n| = 1: a is the relative acceleration without its friction, rho the growth of r,
    below 0 in a landing, where directions settle.
    """
    own, found = e.rows(k), sign.copy()
    found[own] = 0.0
    field = e.field(samples, mode, found)
    slopes = whole(field.found.g[k], 1, e.columns)[1][0]
    a = slopes @ np.concatenate([field.y_dot[0], np.zeros(e.columns - e.n_y - 1), [1.0]])
    W = slopes[:, e.n : 2 * e.n]
    size = -e.contacts[k].beginning(field.found.N[k], np.ones((len(a), 1)))[0].value
    values, vectors = np.linalg.eigh(float(np.ravel(size)[0]) * (W @ e.free(field.found, mode[:, 0]) @ W.T))
    parts = vectors.T @ a
    low, high = -values[0], float(np.linalg.norm(a))
    for _ in range(200):
        rho = 0.5 * (low + high)
        with np.errstate(divide="ignore", invalid="ignore"):
            longer = not np.linalg.norm(parts / (values + rho)) <= 1.0
        low, high = (rho, high) if longer else (low, rho)
    n = vectors @ (parts / (values + high))
    found[own, 0] = n / max(float(np.linalg.norm(n)), 1e-300)
    return found


def _put(field: Field, i: int, own: Field) -> None:
    """The one time of a field into another's time number i."""
    field.a[i], field.a_slopes[i] = own.a[0], own.a_slopes[0]
    field.rate[i], field.rate_slopes[i] = own.rate[0], own.rate_slopes[0]
    for k, (F, slopes) in own.F.items():
        field.F[k][0][i], field.F[k][1][i] = F[0], slopes[0]


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


def one_sided(equations: Equations, samples: Samples, mode: Codes, sign: Floats, S: Floats) -> dict[str, Ints]:
    """Contacts at rest at the start that slip from there on, and the columns of S that give them a speed.

    A speed along the slip that begins and one against it are not two sides of one thing: there is no derivative.
    """
    field = equations.field(samples, mode[:, None], sign[:, None])
    found = {}
    for k, contact in equations.contacts.items():
        g, slopes = whole(field.found.g[k], 1, equations.columns)
        if contact.smooth or mode[k] != SLIP or np.any(np.abs(g) > 1e-14):
            continue
        columns = np.flatnonzero(np.any(np.abs(total(slopes[0], S, equations.n_y)) > 1e-14, axis=0))
        if columns.size:
            found[contact.name] = columns
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
