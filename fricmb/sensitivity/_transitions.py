"""Transitions: when parameters move them, and by how much that makes derivatives jump.

The state is continuous at a transition.  With dt the derivative of its time, Z = S + f dt is that of the state there,
the same on both sides, so S+ = S- + (f- - f+) dt.  The time follows from the event function h of what happens:
dt = -(h_y S- + h_p)/(h_y f- + h_t).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np

from fricmb.integrate.problem import STICK, Codes, Floats
from fricmb.integrate.run.chunked_run import take
from fricmb.integrate.trajectory import Samples
from fricmb.sensitivity._breakpoints import Breakpoints
from fricmb.sensitivity._directions import signs_at_rest
from fricmb.sensitivity._equations import Equations
from fricmb.sensitivity._found import total
from fricmb.sensitivity._happenings import PASS, Happening
from fricmb.sensitivity._impacts import Impacts
from fricmb.sensitivity._phases import BESIDE, Phases
from fricmb.sensitivity._starts import held
from fricmb.sensitivity._triggers import Trigger, Triggers

#: An event function counts as 0 within this share of its scale, or this many tolerances.
_ZERO, _TOLERANCES = 1e-7, 100.0
#: Below this normalised rate a transition is too close to one that only touches to be trusted.
TOUCHES = 1e-3


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
        rtol: float, rows: Samples, events: Any,
    ) -> None:  # fmt: skip
        self.equations, self.phases, self.happened, self.breakpoints = equations, phases, happened, breakpoints
        self.rtol = rtol
        self.zero = max(_ZERO, _TOLERANCES * rtol)
        self.sample = sample
        self.notes: list[str] = []
        self.unsafe: set[int] = set()
        if not happened:
            return
        times = np.array([one.t for one in happened])
        begin = np.array([one.phase for one in happened])
        self.samples: Samples = sample(times)
        # functions of time may jump here, at an instant that is known to some units of round-off
        beside = BESIDE * np.maximum(1.0, np.abs(times))
        first = _before_impacts(self.samples, happened, rows)
        before, after = replace(first, t=times - beside), replace(self.samples, t=times + beside)
        said = equations.said(after, phases.mode[:, begin], phases.sign[:, begin])
        signs = signs_at_rest(equations, phases, happened, sample, self.samples, said)
        self.before = equations.field(before, phases.mode[:, begin - 1], signs[0])
        self.after = equations.field(after, phases.mode[:, begin], signs[1])
        self.triggers = Triggers(equations, phases, happened, self.before, self.samples, self.zero)
        self._kept: dict[int, list[Trigger]] = {}
        self.impacts = Impacts(equations, happened, equations.meetings(first), self.before.found.held, events)

    def of(self, i: int) -> list[Trigger]:
        """Event functions of a happening."""
        if i not in self._kept:
            self._kept[i] = self.triggers.of(i)
        return self._kept[i]

    def jump(self, i: int, S: Floats, landing: Floats | None = None) -> tuple[Floats, Floats]:
        """Derivatives after happening i from those before (n_y, n_p), and of its time (n_p,).

        ``landing``: those of its time, where slip in two directions ends.
        """
        if self.happened[i].is_impact:
            return self._struck(i, S)
        given = self._given(i)
        if given is not None:
            dt = np.concatenate([np.zeros(S.shape[1] - given.size), given])
            return S + np.outer(self.before.y_dot[i] - self.after.y_dot[i], dt), dt
        triggers = self.of(i)
        chosen = [trigger for trigger in triggers if trigger.residual <= self.zero]
        chosen = chosen or [min(triggers, key=lambda trigger: trigger.residual)]
        dts = [self._time_derivatives(i, trigger, S, landing) for trigger in chosen]
        found, f = S, self.before.y_dot[i]
        for trigger, dt in zip(chosen, dts, strict=True):
            last = trigger is chosen[-1]
            after = self.after.y_dot[i] if last else self._with(i, trigger)
            if self.lands(i, trigger):
                stops = self.after.y_dot[i] if not last else self._with(i, trigger)
                found = self._stopped(i, trigger, found, f - stops) + np.outer(stops - after, dt)
            else:
                found = found + np.outer(f - after, dt)
            f = after
        if len(chosen) > 1:
            self._say_together(i, chosen, dts)
        return found, dts[0]

    def _given(self, i: int) -> Floats | None:
        """Derivatives of a breakpoint at which what changes follows at once; None where it changes by itself."""
        given = self.breakpoints.at(self.happened[i].t)
        return None if any(trigger.residual <= self.zero for trigger in self.of(i)) else given

    def _struck(self, i: int, S: Floats) -> tuple[Floats, Floats]:
        """Derivatives behind an impact, and of its time."""
        f = self.before.y_dot[i]
        dts = self.impacts.times(i, f, S)
        if any(not np.allclose(dt, dts[0], rtol=1e-6, atol=1e-12) for dt in dts):
            names = ", ".join(repr(event.contact) for event, _, _ in self.impacts.hits(i))
            self.unsafe.update(self.happened[i].events.tolist())
            self.notes.append(
                f"at t = {self.happened[i].t:.10g} {names} are hit at the same time, and parameters would move those"
                " times apart: there is no sound derivative of what follows"
            )
        return self.impacts.jump(i, S, dts[0], f, self.after.y_dot[i]), dts[0]

    def landing(self, i: int) -> int | None:
        """Contact whose slip in two directions ends in a happening."""
        if self.happened[i].is_impact:
            return None
        return next((trigger.contact for trigger in self.of(i) if self.lands(i, trigger)), None)

    def landing_times(self, i: int, S: Floats, g: Floats) -> tuple[Floats, Floats]:
        """Derivatives (n_t, n_p) of a landing's time from states before it (n_t, n_y, n_p) with g (m, n_t).

        And by how much they may be off, g being off by a tolerance and directions being what they are.
        """
        k = self.landing(i)
        assert k is not None
        g = g[self.equations.rows(k)]
        slopes, shares, turning, speed = self.triggers.landing(i, k, g)
        turned = np.linalg.norm(total(turning, S, self.equations.n_y), axis=1)
        noise = self.rtol * speed * turned / (np.linalg.norm(g, axis=0) + 1e-300)[:, None]
        dts = np.asarray(total(slopes[:, None], S, self.equations.n_y)[:, 0])
        return dts, noise + shares[:, None] * np.abs(dts)

    def lands(self, i: int, trigger: Trigger) -> bool:
        """Whether slip in two directions ends."""
        kind = self.happened[i].kind_of(trigger.event)
        return kind in ("stick", PASS) and self.equations.contacts[trigger.contact].d > 1

    def transversality(self, i: int) -> list[float]:
        """Of the events of a happening; inf where a function of time makes them."""
        if self.happened[i].is_impact:
            least = min(self.impacts.transversality(i, self.before.y_dot[i], self.phases.speed))
            return [least] * len(self.happened[i].events)
        if self._given(i) is not None:
            return [np.inf] * len(self.of(i))
        return [trigger.transversality for trigger in self.of(i)]

    def say_unsafe(self, i: int) -> None:
        """Events that only touch their condition, or are releases that are not determined; notes tell of them."""
        if self.happened[i].is_impact:
            self._say_grazing(i)
            return
        if self._given(i) is not None:
            return
        one, names = self.happened[i], self.equations.names.contacts
        for trigger, kind in zip(self.of(i), one.kinds, strict=True):
            where = f"at t = {one.t:.10g} contact {names[trigger.contact]!r}"
            if trigger.transversality < TOUCHES:
                self.unsafe.add(trigger.event)
                self.notes.append(
                    f"{where}: a transition ({kind}) that only touches its condition (transversality"
                    f" {trigger.transversality:.1e}); there is no sound derivative of what follows"
                )
            elif not trigger.sure:
                self.unsafe.add(trigger.event)
                self.notes.append(
                    f"{where}: lets go while stuck contacts hold the same motion, which leaves their forces open;"
                    " derivatives of what follows are not sound"
                )

    def _say_grazing(self, i: int) -> None:
        """An impact with next to no speed: derivatives behind it go with one over that speed."""
        one, least = self.happened[i], self.transversality(i)[0]
        if least < max(TOUCHES, 10.0 * self.rtol):
            self.unsafe.update(one.events.tolist())
            names = ", ".join(repr(event.contact) for event, _, _ in self.impacts.hits(i))
            self.notes.append(
                f"at t = {one.t:.10g} {names} is hit at {least:.1e} of the largest speed: derivatives of what follows"
                " grow as one over that, and are not sound"
            )

    def say_unsure(self, i: int, dt: Floats, off: Floats, columns: Sequence[str]) -> None:
        """A note where derivatives of a landing's time are not known to a thousand tolerances of their own size."""
        sizes = np.maximum(np.abs(dt), 1e-300)
        open_to = np.flatnonzero(off > 1e3 * self.rtol * np.where(dt != 0.0, sizes, np.inf))
        if open_to.size:
            by = ", ".join(f"{columns[j]!r} to {off[j] / sizes[j]:.0e}" for j in open_to.tolist())
            moves_on = PASS in self.happened[i].kinds
            self.notes.append(
                f"at t = {self.happened[i].t:.10g} slip in two directions ends before its direction has settled:"
                f" derivatives of that time are known only roughly: by {by} of their size"
                + (" (and no more of what follows)" if moves_on else " (what follows is not affected)")
            )

    def _stopped(self, i: int, trigger: Trigger, S: Floats, off: Floats) -> Floats:
        """Derivatives where a contact sticks with those that stick already, and rates fall by ``off``.

        Its direction has settled: what its slip would last longer is n . dg/kappa, and all that is left of it goes.
        """
        slopes, rates = self.triggers.slipping(i, trigger.contact)
        lasts = -rates @ total(slopes, S, self.equations.n_y) / float(rates @ rates)
        return held(self.equations, self.after.found, i, self._modes(i, trigger)[0], S + np.outer(off, lasts))

    def _time_derivatives(self, i: int, trigger: Trigger, S: Floats, landing: Floats | None) -> Floats:
        """Derivatives (n_p,) of the time at which an event function vanishes."""
        if landing is not None and self.lands(i, trigger):
            return landing
        found: Floats = -total(trigger.slopes, S, self.equations.n_y) / trigger.rate
        return found

    def _say_together(self, i: int, chosen: list[Trigger], dts: list[Floats]) -> None:
        if all(np.allclose(dt, dts[0], rtol=1e-6, atol=1e-12) for dt in dts):
            return
        names = [self.equations.names.contacts[trigger.contact] for trigger in chosen]
        note = (
            f"at t = {self.happened[i].t:.10g} the contacts {', '.join(names)} change on their own at the same time:"
            " derivatives from there on are one-sided"
        )
        self.unsafe.update(trigger.event for trigger in chosen)
        if note not in self.notes:
            self.notes.append(note)

    def _with(self, i: int, trigger: Trigger) -> Floats:
        """Rates when, of several that change at once, those up to a trigger have changed."""
        one = self.happened[i]
        if (one.events <= trigger.event).all() and PASS not in one.kinds:
            return np.asarray(self.after.y_dot[i])
        mode, sign = self._modes(i, trigger)
        found: Floats = self.equations.field(take(self.samples, [i]), mode[:, None], sign[:, None]).y_dot[0]
        return found

    def _modes(self, i: int, trigger: Trigger) -> tuple[Codes, Floats]:
        one = self.happened[i]
        mode, sign = self.phases.mode[:, one.phase - 1].copy(), self.phases.sign[:, one.phase - 1].copy()
        for j, k in enumerate(one.contacts):
            if one.events[j] <= trigger.event:
                own = self.equations.rows(k)
                mode[k], sign[own] = self.phases.mode[k, one.phase], self.phases.sign[own, one.phase]
                if one.kinds[j] == PASS:  # it rests for a moment
                    mode[k] = STICK
        return mode, sign


def _before_impacts(samples: Samples, happened: list[Happening], rows: Samples) -> Samples:
    """Samples with velocities before impacts; the run keeps them in the first of two rows at one time."""
    struck = [i for i, one in enumerate(happened) if one.is_impact]
    if not struck:
        return samples
    twice = np.flatnonzero(np.diff(rows.t) == 0.0)
    found = {f.name: np.array(getattr(samples, f.name)) for f in fields(samples)}
    for i in struck:
        row = twice[np.argmin(np.abs(rows.t[twice] - happened[i].t))]
        for name, values in found.items():
            if name != "t":
                values[..., i] = getattr(rows, name)[..., row]
    return replace(samples, **found)
