"""A loose mass in a box that takes a vibration away."""

from __future__ import annotations

import sympy

import fricmb as fm
from fricmb.values import SI

from ._arguments import check_positive, checked


@checked
def impact_damper(
    *,
    mass: float = 1.0,
    stiffness: float = 100.0,
    damping: float = 0.2,
    force: float = 1.0,
    frequency: float = 10.0,
    loose_mass: float = 0.1,
    gap: float = 0.2,
    restitution: float = 0.6,
) -> fm.Scene:
    """Impact damper: a loose mass strikes both walls of its box once a period and takes the resonance away.

    SI units.

    Parameters
    ----------
    mass, stiffness, damping : float
        Of the box on its spring.
    force, frequency : float
        On the box, ``force sin(frequency t)``.
    loose_mass : float
    gap : float
        Free travel of the loose mass in the box.
    restitution : float
        Of the walls, from 0 to 1.

    Returns
    -------
    Scene
        Bodies box and loose, play walls.

    Notes
    -----
    S. F. Masri, T. K. Caughey, On the stability of the impact damper, J. Appl. Mech. 33 (1966) 586-592.  Between
    impacts half a period apart the loose mass keeps its speed; the box moves as a driven oscillator whose velocity
    jumps by ``loose_mass/mass`` times what the loose mass takes up.  Without it the amplitude at resonance is
    ``force/(damping frequency)``.
    """
    check_positive("impact_damper", gap=gap)
    box = fm.Body("box", mass=mass)
    loose = fm.Body("loose", mass=loose_mass)
    return fm.Scene(
        "impact damper",
        [
            box,
            loose,
            fm.Spring("spring", box, axis="x", stiffness=stiffness),
            fm.Damper("damper", box, axis="x", damping=damping),
            fm.Force("drive", box, axis="x", value=force * sympy.sin(frequency * fm.t)),
            fm.Backlash("walls", loose, box, axis="x", gap=gap, restitution=restitution),
        ],
        units=SI,
    )
