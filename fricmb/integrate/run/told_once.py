"""What happens at one instant is told once: slip that sets out to the wrong side, or turns round as it comes to rest.

A contact that a jump of force releases may be let go by the force before the jump and turn round behind it, and
round-off of slip may change its sign just before it ends.  Between two such transitions nothing has moved.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fricmb.integrate.event_kinds import EVENT_REVERSAL, EVENT_SLIP, EVENT_STICK, IS_TRANSITION
from fricmb.integrate.problem import Floats, Ints
from fricmb.integrate.trajectory import Transitions

#: One instant, as a part of the run, and of the time until the contact's next transition.
AT_ONCE, BRIEF = 1e-12, 1e-6
#: The same where slip turns round and ends: what is left of it in a loop of contacts is known to no more.
AT_REST = 1e-10
#: What two transitions of a contact at one instant are together, none where slip goes on as before; and that instant.
#: Slip that sticks at once is not even put down (``run/mode_changes``: ``record_event``).
_TOGETHER = {
    (EVENT_SLIP, EVENT_REVERSAL): (EVENT_SLIP, AT_ONCE),
    (EVENT_REVERSAL, EVENT_STICK): (EVENT_STICK, AT_REST),
    (EVENT_REVERSAL, EVENT_REVERSAL): (None, AT_ONCE),
}


def told_once(transitions: Transitions, ends: tuple[float, float]) -> Transitions:
    """The same transitions where none are at one instant; ``ends`` of the run."""
    if transitions.t.size < 2 or not (np.diff(np.sort(transitions.t)) <= AT_REST * (ends[1] - ends[0])).any():
        return transitions
    kept, kind = np.ones(transitions.t.size, dtype=bool), transitions.kind.copy()
    change = IS_TRANSITION[kind]
    for c in np.unique(transitions.contact):
        _join(np.flatnonzero(change & (transitions.contact == c)), transitions.t, ends, kept, kind)
    if kept.all():
        return transitions
    return replace(transitions, t=transitions.t[kept], contact=transitions.contact[kept], kind=kind[kept])


def _join(mine: Ints, t: Floats, ends: tuple[float, float], kept: NDArray[np.bool_], kind: Ints) -> None:
    """Join those of one contact, at the places ``mine``: the first of two stays, as what both are, or neither."""
    told: list[int] = []
    for i, following in zip(mine.tolist(), [*t[mine[1:]].tolist(), ends[1]], strict=True):
        told.append(i)
        if len(told) < 2:
            continue
        first, apart = told[-2], t[i] - t[told[-2]]
        pair = int(kind[first]), int(kind[i])
        if pair not in _TOGETHER:
            continue
        both, instant = _TOGETHER[pair]
        if not apart <= min(instant * (ends[1] - ends[0]), BRIEF * (following - t[i])):
            continue
        kept[told.pop()] = False
        if both is None:
            kept[told.pop()] = False
        else:
            kind[first] = both
