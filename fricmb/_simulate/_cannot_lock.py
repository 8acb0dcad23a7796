"""Notes on contacts that slip near the speed below which their law has no strength, and therefore never lock."""

from __future__ import annotations

import numpy as np

from fricmb.laws import RateAndState
from fricmb.solution import Solution
from fricmb.values import value_of

#: How many times as fast as that speed a contact slips on average so that its strength hardly feels it (measured on
#: quakes under a plate: 14 for 13 at 100 times, none at 10); and how far it has to slip for that to matter, in lengths
#: over which its state evolves: one that is held creeps as slowly, and gets nowhere.
FAR, SOME = 1000.0, 10.0


def lock_notes(sol: Solution) -> tuple[str, ...]:
    """Sentences for ``stats.notes``."""
    found = []
    for part in getattr(sol.scene, "contacts", ()):
        if not isinstance(part.law, RateAndState) or part.name not in sol.contact_names or sol.t.size < 2:
            continue
        speed = np.sqrt((sol.relative_velocity(part.name) ** 2).sum(axis=0))
        path, least = float(np.trapezoid(speed, sol.t)), part.law.slowest()
        mean = path / (sol.t_end - sol.t_start)
        if mean < FAR * least and path > SOME * float(value_of(part.law.L)):
            found.append(
                f"contact {part.name!r} slips at {mean:.2g} on average, and its law has no strength below v_rest ="
                f" {least:.2g}: it cannot lock as it should; give a v_rest far below"
            )
    return tuple(found)
