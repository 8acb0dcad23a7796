"""What happens at one time of a run: its events there, breakpoints that parameters move, and slip that passes rest."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.integrate.problem import Floats, Ints
from fricmb.sensitivity._phases import Phases

#: Slip in two directions through rest.
PASS = "pass"


@dataclass(frozen=True, kw_only=True)
class Happening:
    """What happens at one time: numbers of its events, contacts, kinds, and the stretch that begins there.

    What is hit and has no friction has the number -1 among the contacts.
    Of kind ``PASS`` is slip in two directions that comes to rest and sets out at once in another one.  No event of the
    run says so: it has the number behind the last.
    """

    t: float
    events: Ints
    contacts: list[int]
    kinds: list[str]
    phase: int

    @property
    def is_impact(self) -> bool:
        """Whether something is hit; other events are what follows from that."""
        return "impact" in self.kinds

    def kind_of(self, event: int) -> str:
        """Kind of one of its events."""
        return self.kinds[int(np.flatnonzero(self.events == event)[0])]


def happenings(
    events: Any, names: Any, phases: Phases, moving: Floats, passes: Iterable[tuple[int, int]]
) -> list[Happening]:
    """Events of one piece that stand at the same time, together, and breakpoints that parameters move (n_b,).

    ``passes``: contacts, and stretches that begin where their slip passes rest.
    """
    held = list(events)
    t = np.array([event.t for event in held])
    found = []
    inside = np.isin(t, phases.t[1:-1])
    for time in np.unique(t[inside]):
        own = np.flatnonzero(t == time)
        one = Happening(
            t=float(time),
            events=own,
            contacts=[names.contact_index.get(held[i].contact, -1) for i in own],
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
    for k, phase in passes:
        if all(one.phase != phase for one in found):
            own = np.array([t.size])
            found.append(Happening(t=float(phases.t[phase]), events=own, contacts=[k], kinds=[PASS], phase=phase))
    return sorted(found, key=lambda one: one.phase)
