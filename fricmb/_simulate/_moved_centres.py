"""Notes on gears with a pressure angle whose wheels did not keep the centres that their teeth were laid out for."""

from __future__ import annotations

import numpy as np

from fricmb.scene import Gear
from fricmb.solution import Solution

#: Way of the centres, beside their distance, that is none: round-off of joints that hold them.
STILL = 1e-6


def centre_notes(sol: Solution) -> tuple[str, ...]:
    """Sentences for ``stats.notes``."""
    found = []
    for part in getattr(sol.scene, "parts", ()):
        if not isinstance(part, Gear) or part.pressure_angle is None or sol.t.size == 0:
            continue
        way = _moved(sol, part)
        if way > STILL:
            found.append(
                f"gear {part.name!r}: the centres of its wheels, one beside the other, moved by up to {way:.2g} of"
                " their distance, and its pressure angle takes them as held in place: the force between the teeth"
                " keeps the lines of the start; hold the wheels by joints, or leave pressure_angle out"
            )
    return tuple(found)


def _moved(sol: Solution, gear: Gear) -> float:
    """How far the centres moved one beside the other, over their distance."""
    ax, ay, bx, by = gear.centres
    square = np.zeros(sol.t.size)
    for letter, apart in (("x", bx - ax), ("y", by - ay)):
        form = gear.a.motion(letter) - gear.b.motion(letter)
        square += (form.constant + apart + sum(c * sol[name] for name, c in form.terms)) ** 2
    return float(np.sqrt(square.max()) / np.hypot(bx - ax, by - ay))
