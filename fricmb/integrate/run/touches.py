"""Touches: slip that only comes down to rest and goes on, where errors below the tolerance see a stick.

Without damping and with mu_s = mu_k a block on a belt reaches the belt's speed once a period at the very place where
friction holds it no longer.  A run that is a little off finds a stick there that lasts as long as the root of its
error.  Friction is continuous through it, so that motion and forces are right to the tolerance either way; what is
wrong is to tell of a stick and a slip.  Where friction falls when stick ends a touch decides what follows, and is kept.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from fricmb.integrate.event_kinds import EVENT_REVERSAL, EVENT_SLIP, EVENT_STICK, IS_TRANSITION
from fricmb.integrate.problem import SLIP, STICK, Contacts, Floats, Ints, Problem
from fricmb.integrate.run.told_once import told_once
from fricmb.integrate.trajectory import MotionSamples, Samples, Trajectory, Transitions

_Samples = TypeVar("_Samples", bound=MotionSamples)

#: A touch misses rest by at most this part of the tolerance, of the largest slip speed.
DEEP = 0.1
#: Part of the slip before it at which its direction is looked up.
WELL = 0.1
#: Its stick lasts no longer than this many roots of the tolerance, of the slip before it.
LONG = 0.5


class WithoutTouches(Trajectory):
    """A run in which contacts slip on where they only touched rest: ``contact``, ``begin``, ``end`` (k,) of each.

    ``told``: its transitions, of which those of the touches go.
    """

    def __init__(self, held: Trajectory, told: Transitions, contact: Ints, begin: Floats, end: Floats) -> None:
        self.held = held
        self.contact, self.begin, self.end_of_touch = contact, begin, end
        others = ~IS_TRANSITION[told.kind]
        kept = np.ones(told.t.size, dtype=bool)
        for c, first, last in zip(contact, begin, end, strict=True):
            kept &= others | (told.contact != c) | (told.t < first) | (told.t > last)
        t, which, kind = (getattr(told, name)[kept] for name in ("t", "contact", "kind"))
        self.transitions = replace(told, t=t, contact=which, kind=kind)
        self.counters, self.end, self.failure = held.counters, held.end, held.failure
        self.moving, self.instead, self.of_scene = held.moving, held.instead, held.of_scene

    @property
    def problem(self) -> Problem:  # type: ignore[override]
        """That of the run."""
        return self.held.problem

    def attach(self, problem: Problem) -> None:
        """See :meth:`Trajectory.attach`."""
        self.held.attach(problem)

    @property
    def t(self) -> Floats:
        """Times of the rows."""
        return self.held.t

    @property
    def ends(self) -> tuple[float, float]:
        """Ends of the run."""
        return self.held.ends

    def rows(self) -> Samples:
        """Values at the rows."""
        return self._slipping(self.held.rows())

    def row_motion(self) -> MotionSamples:
        """As :meth:`rows`, without energies."""
        return self._slipping(self.held.row_motion())

    def sample(self, t: Floats) -> Samples:
        """Values at times within the run."""
        return self._slipping(self.held.sample(t))

    def motion(self, t: Floats) -> MotionSamples:
        """As :meth:`sample`, without energies."""
        return self._slipping(self.held.motion(t))

    def _slipping(self, samples: _Samples) -> _Samples:
        mode = samples.mode.copy()
        for c, first, last in zip(self.contact, self.begin, self.end_of_touch, strict=True):
            here = (samples.t >= first) & (samples.t <= last) & (mode[c] == STICK)
            mode[c, here] = SLIP
        return replace(samples, mode=mode)

    def __getstate__(self) -> dict[str, Any]:
        return dict(vars(self))


def own_run(trajectory: Trajectory) -> Trajectory:
    """The run as it was computed."""
    return trajectory.held if isinstance(trajectory, WithoutTouches) else trajectory


def is_continuous(contacts: Contacts) -> NDArray[np.bool_]:
    """Contacts (n_c,) whose friction does not fall where stick ends."""
    found: NDArray[np.bool_] = (contacts.mu_s < 0.0) | (contacts.mu_s <= contacts.mu_0 * (1.0 + 1e-12))
    return found


def without_touches(trajectory: Trajectory, row: Ints, continuous: NDArray[np.bool_], rtol: float) -> Trajectory:
    """The run, or the same without its touches where it has some, and with what happens at one instant told once.

    ``row``: of its contacts among rows of slip.
    """
    told = told_once(trajectory.transitions, trajectory.ends)
    found = [
        touch
        for c in np.unique(told.contact).tolist()
        if c < continuous.size and continuous[c]
        for touch in _candidates(told, trajectory.ends, c, rtol)
    ]
    contact = np.array([touch.contact for touch in found], dtype=np.int64)
    begin, end = np.array([touch.begin for touch in found]), np.array([touch.end for touch in found])
    touches = _are_touches(trajectory, found, row, rtol) if found else np.zeros(0, dtype=bool)
    if told is trajectory.transitions and not touches.any():
        return trajectory
    return WithoutTouches(trajectory, told, contact[touches], begin[touches], end[touches])


def _are_touches(trajectory: Trajectory, found: list[Touch], row: Ints, rtol: float) -> NDArray[np.bool_]:
    """Which of some short sticks are touches, (k,)."""
    begin, end = np.array([touch.begin for touch in found]), np.array([touch.end for touch in found])
    half = 0.5 * (end - begin)
    last = trajectory.ends[1]
    deep = [trajectory.motion(t).g for t in (begin - half, begin + half, np.minimum(end + half, last))]
    # so near to rest directions may be round-off
    ways = [trajectory.motion(np.array([getattr(touch, name) for touch in found])).g for name in ("before", "after")]
    fastest = _fastest(trajectory, row)
    touches = np.zeros(len(found), dtype=bool)
    for i, c in enumerate(touch.contact for touch in found):
        rows = slice(int(row[c]), int(row[c + 1]))
        size = max(float(np.linalg.norm(g[rows, i])) for g in deep)
        goes_on = float(ways[0][rows, i] @ ways[1][rows, i]) > 0.0
        touches[i] = goes_on and size <= DEEP * rtol * fastest[c]
    return touches


@dataclass(frozen=True, kw_only=True)
class Touch:
    """A stick of a contact between two times (or slip back), and times well before and behind it at which it slips."""

    contact: int
    begin: float
    end: float
    before: float
    after: float


def _candidates(told: Transitions, ends: tuple[float, float], c: int, rtol: float) -> list[Touch]:
    """Short sticks of contact c after a longer slip, and short slip back."""
    mine = (told.contact == c) & IS_TRANSITION[told.kind]
    t, kind = told.t[mine], told.kind[mine]
    first, last = ends
    since, until = np.concatenate([[first], t[:-1]]), np.append(t[2:], [last, last])[: t.size]
    brief = np.diff(t, append=np.inf) < LONG * np.sqrt(rtol) * (t - since)
    then = np.append(kind[1:], -1)
    pairs = ((kind == EVENT_STICK) & (then == EVENT_SLIP)) | ((kind == EVENT_REVERSAL) & (then == EVENT_REVERSAL))
    return [
        Touch(
            contact=c, begin=float(t[i]), end=float(t[i + 1]), before=float(t[i] - WELL * (t[i] - since[i])),
            after=float(t[i + 1] + min(WELL * (t[i] - since[i]), 0.5 * (until[i] - t[i + 1]))),
        )
        for i in np.flatnonzero(pairs & brief).tolist()
    ]  # fmt: skip


def _fastest(trajectory: Trajectory, row: Ints) -> Floats:
    """Largest slip speed of every contact (n_c,) at the rows."""
    g = trajectory.row_motion().g
    found: Floats = np.sqrt(np.add.reduceat(g**2, row[:-1], axis=0)).max(axis=1, initial=0.0)
    return found
