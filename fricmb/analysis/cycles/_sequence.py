"""The sequence of transitions of a cycle, and the borders that it may be near."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fricmb.analysis.cycles._field import Field
from fricmb.analysis.cycles._frozen import Condition, Phase
from fricmb.integrate import SLIP, STICK
from fricmb.integrate.problem import LAW_SMOOTH, Codes, Floats

if TYPE_CHECKING:
    from fricmb.analysis.cycles._shooting import Orbit

#: Times between two transitions at which a slip speed is looked at for its least values.
_POINTS = 400
#: A border is looked for where a phase, a margin of force or a slip speed is below this part of the cycle's.
NEAR = 0.3


@dataclass(frozen=True, kw_only=True)
class Border:
    """A border that a cycle may be near, with the phases of the orbit on it.

    Attributes
    ----------
    kind : str
        "stick" (a stick that gets short), "reversal" (one at which the force gets able to hold), "touch" (a slip
        whose speed gets small) or "arrival" (a stick that a slip gets to without deceleration: it will not get there).
    near : float
        How far it is, as a part of the cycle's period, force or speed.
    t : float
        Time on the cycle.
    lengths : (n_phases,)
    start : tuple of Condition
        What holds at its first instant on the border; ``before`` and ``after``: directions of slip there.
    """

    kind: str
    contact: int
    near: float
    t: float
    y: Floats
    phases: tuple[Phase, ...]
    lengths: Floats
    start: tuple[Condition, ...]
    before: float
    after: float


def sequence(orbit: Orbit) -> tuple[tuple[str, str], ...]:
    """Transitions of a lap as (contact, kind), from the one on that makes this the first in order."""
    events = tuple((event.contact, event.kind) for event in orbit.arc.solution.events)
    turns = [events[i:] + events[:i] for i in range(len(events))]
    return min(turns, default=())


def in_one_dimension(orbit: Orbit) -> bool:
    """Whether every transition is of a contact in one dimension, and none opens or closes."""
    system, sol = orbit.shooting.system, orbit.arc.solution
    row = system.problem.contacts.row
    return all(
        row[(k := system.contact_names.index(event.contact)) + 1] - row[k] == 1 and event.kind not in ("open", "close")
        for event in sol.events
    )


class Lap:
    """A lap cut at its transitions."""

    def __init__(self, orbit: Orbit) -> None:
        self.orbit, self.sol = orbit, orbit.arc.solution
        self.system = orbit.shooting.system
        self.events = list(self.sol.events)
        self.t = np.array([event.t for event in self.events])
        begin = self.sol.t_start
        bounds = np.append(self.t, (self.t[0] if self.t.size else begin) + orbit.T)
        self.lengths = np.diff(bounds) if self.t.size else np.array([orbit.T])
        first = self.t if self.t.size else np.array([begin])
        middles = begin + np.mod(first + 0.5 * self.lengths - begin, orbit.T)
        samples = self.sol.at(middles).record.samples
        self.mode, self.direction = samples.mode.T.copy(), np.sign(samples.g).T.copy()
        self.force = samples.F.T

    def state(self, t: float) -> Floats:
        """(q, v, z) at a time of the lap."""
        samples = self.sol.at([t]).record.samples
        return np.concatenate([samples.q, samples.v, samples.z])[:, 0]

    def row(self, k: int) -> int:
        """Row of a contact in one dimension."""
        return int(self.system.problem.contacts.row[k])

    def condition(self, i: int) -> Condition:
        """Transition i as an equation."""
        event = self.events[i]
        k = self.system.contact_names.index(event.contact)
        if event.kind == "slip":  # from here on slip is in the direction against the force
            return Condition(kind="release", contact=k, sign=-float(self.direction[i, self.row(k)]))
        return Condition(kind="stop", contact=k)

    def phase(self, i: int, last: bool = False) -> Phase:
        """The phase after transition i, ended by the next one or by the end of the lap."""
        end = None if last else self.condition((i + 1) % len(self.events))
        return Phase(mode=self.mode[i], direction=self.direction[i], end=end)


def borders(orbit: Orbit) -> list[Border]:
    """The borders that a cycle may be near, nearest first."""
    if not in_one_dimension(orbit):
        return []
    lap = Lap(orbit)
    found = [*_short_sticks(lap), *_weak_reversals(lap), *_touches(lap), *_arrivals(lap)]
    return sorted((b for b in found if b.near < NEAR), key=lambda b: b.near)


def _short_sticks(lap: Lap) -> list[Border]:
    """Sticks without a transition of another contact in them; on the border the slips around them meet."""
    found, count = [], len(lap.events)
    for i, event in enumerate(lap.events):
        j = (i + 1) % count
        if event.kind != "stick" or lap.events[j].kind != "slip" or lap.events[j].contact != event.contact:
            continue
        k = lap.system.contact_names.index(event.contact)
        order = [(j + n) % count for n in range(count - 1)]
        phases = tuple(lap.phase(n, last=n == order[-1]) for n in order)
        before, after = float(lap.direction[order[-1], lap.row(k)]), float(lap.direction[j, lap.row(k)])
        start = (Condition(kind="stop", contact=k), Condition(kind="release", contact=k, sign=-after))
        found.append(Border(
            kind="stick", contact=k, near=float(lap.lengths[i] / lap.orbit.T), t=float(lap.t[j]),
            y=lap.state(float(lap.t[j])), phases=phases, lengths=lap.lengths[order], start=start, before=before,
            after=after,
        ))  # fmt: skip
    return found


def _arrivals(lap: Lap) -> list[Border]:
    """Sticks that begin with little deceleration, beside the largest change of speed in the slip before."""
    found, count = [], len(lap.events)
    for i, event in enumerate(lap.events):
        k = lap.system.contact_names.index(event.contact)
        if event.kind != "stick" or lap.mode[i - 1, k] != SLIP:
            continue
        order = [(i + n) % count for n in range(count)]
        phases = tuple(lap.phase(n, last=n == order[-1]) for n in order)
        row, at, y = lap.row(k), float(lap.t[i]), lap.state(float(lap.t[i]))
        field = Field(system=lap.system, mode=phases[-1].mode, direction=phases[-1].direction)
        rate = abs(float(field.turning(np.array([at]), y[:, None])[row, 0]))
        t = lap.sol.t_start + np.mod(
            float(lap.t[i - 1]) + lap.lengths[i - 1] * np.linspace(0.0, 1.0, _POINTS + 1) - lap.sol.t_start, lap.orbit.T
        )
        g = lap.sol.at(np.minimum(t, lap.sol.t_end)).record.samples.g[row]
        fastest = float(np.abs(np.diff(g)).max()) * _POINTS / float(lap.lengths[i - 1])
        sign = float(lap.direction[i - 1, row])
        start = (Condition(kind="stop", contact=k), Condition(kind="arrival", contact=k))
        found.append(Border(
            kind="arrival", contact=k, near=rate / max(fastest, 1e-300), t=at, y=y, phases=phases,
            lengths=lap.lengths[order], start=start, before=sign, after=sign,
        ))  # fmt: skip
    return found


def _weak_reversals(lap: Lap) -> list[Border]:
    """Reversals at which the force that would hold the contact is hardly more than it can be."""
    found, count = [], len(lap.events)
    for i, event in enumerate(lap.events):
        if event.kind != "reversal":
            continue
        k = lap.system.contact_names.index(event.contact)
        order = [(i + n) % count for n in range(count)]
        phases = tuple(lap.phase(n, last=n == order[-1]) for n in order)
        before, after = float(lap.direction[i - 1, lap.row(k)]), float(lap.direction[i, lap.row(k)])
        y = lap.state(float(lap.t[i]))
        margin = _margin(lap, k, lap.mode[i], float(lap.t[i]), y, -after)
        start = (Condition(kind="stop", contact=k), Condition(kind="release", contact=k, sign=-after))
        found.append(Border(
            kind="reversal", contact=k, near=abs(margin), t=float(lap.t[i]), y=y, phases=phases,
            lengths=lap.lengths[order], start=start, before=before, after=after,
        ))  # fmt: skip
    return found


def _margin(lap: Lap, k: int, mode: Codes, t: float, y: Floats, sign: float) -> float:
    """By how much the force that would hold a contact is more than it can be, as a part of that."""
    stuck = mode.copy()
    stuck[k] = STICK
    field = Field(system=lap.system, mode=stuck, direction=lap.direction[0])
    when, state = np.array([t]), y[:, None]
    most = float(field.break_away(when, state, k)[0])
    return (sign * float(field.rate_and_force(when, state)[1][lap.row(k), 0]) - most) / most


def _touches(lap: Lap) -> list[Border]:
    """Least slip speeds within a slip."""
    contacts = lap.system.problem.contacts
    found = []
    for i, length in enumerate(lap.lengths.tolist()):
        begin = float(lap.t[i]) if lap.t.size else lap.sol.t_start
        t = begin + length * np.linspace(0.0, 1.0, _POINTS + 1)
        wrapped = lap.sol.t_start + np.mod(t - lap.sol.t_start, lap.orbit.T)
        g = lap.sol.at(np.minimum(wrapped, lap.sol.t_end)).record.samples.g
        for k in range(lap.system.problem.n_c):
            if lap.mode[i, k] != SLIP or contacts.law[k] == LAW_SMOOTH or contacts.row[k + 1] - contacts.row[k] != 1:
                continue
            speed = np.abs(g[lap.row(k)])
            inner = speed[1:-1]
            least = 1 + np.flatnonzero((inner < speed[:-2]) & (inner <= speed[2:]))
            found += [_touch(lap, i, k, float(t[n]), float(speed[n] / speed.max())) for n in least]
    return found


def _touch(lap: Lap, i: int, k: int, t: float, near: float) -> Border:
    """The lap from a least slip speed in phase i on."""
    count = len(lap.events)
    sign = float(lap.direction[i, lap.row(k)])
    at = lap.sol.t_start + float(np.mod(t - lap.sol.t_start, lap.orbit.T))
    whole = Phase(mode=lap.mode[i], direction=lap.direction[i], end=None)
    phases: tuple[Phase, ...] = (whole,)
    lengths = np.array([lap.orbit.T])
    if count:
        order = [(i + n) % count for n in range(count)]
        phases = (*(lap.phase(n) for n in order), whole)
        gone = t - float(lap.t[i])
        lengths = np.concatenate([[lap.lengths[i] - gone], lap.lengths[order[1:]], [gone]])
    start = (Condition(kind="stop", contact=k), Condition(kind="turn", contact=k))
    return Border(
        kind="touch", contact=k, near=near, t=at, y=lap.state(at), phases=phases, lengths=lengths, start=start,
        before=sign, after=sign,
    )  # fmt: skip
