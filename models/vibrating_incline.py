"""A block that vibration carries up an incline."""

from __future__ import annotations

from math import cos, sin

import sympy

import fricmb as fm
from fricmb.values import SI

from ._arguments import checked


@checked
def vibrating_incline(
    *,
    mass: float = 0.05,
    slope: float = 0.1,
    amplitude: float = 2e-3,
    frequency: float = 100.0,
    direction: float = 0.8,
    mu: float = 0.6,
    restitution: float = 0.3,
    gravity: float = 9.81,
) -> fm.Scene:
    """Vibrating incline: it throws a block forward, which lands, slides and sticks, and so travels uphill.

    SI units.

    Parameters
    ----------
    mass : float
    slope : float
        Angle of the incline, which rises along x; friction holds the block at rest while ``tan(slope) <= mu``.
    amplitude, frequency : float
        Of the incline, ``amplitude sin(frequency t)``.
    direction : float
        Angle from x upward, along which it moves.
    mu : float
        Coefficient of friction, in impacts too.
    restitution : float
        From 0 to 1.
    gravity : float

    Returns
    -------
    Scene
        Body block, which moves with the incline at the start, driven body incline, joint surface with friction.

    Notes
    -----
    As of vibratory conveyors (I. I. Blekhman, Vibrational Mechanics, World Scientific 2000).  With ``a = amplitude
    frequency^2 sin(frequency t)`` and ``b = direction - slope`` the block presses with ``mass (gravity cos(slope) -
    a sin(b))`` and lifts off where that is 0; seen from the incline ``mass (a cos(b) - gravity sin(slope))`` drives it.
    """
    fast = amplitude * frequency
    start = {"x": fast * cos(direction), "y": fast * sin(direction)}
    block = fm.Body("block", mass=mass, axes="xy", velocity=start)
    way = amplitude * sympy.sin(frequency * fm.t)
    incline = fm.Driven("incline", position={"x": cos(direction) * way, "y": sin(direction) * way})
    law = fm.laws.Coulomb(mu_s=mu)
    return fm.Scene(
        "vibrating incline",
        [
            block,
            incline,
            fm.RollerOnLine(
                "surface", block, incline, angle=slope, push_only=True, restitution=restitution, friction=law
            ),
            fm.Gravity("gravity", acceleration={"y": -gravity}),
        ],
        units=SI,
    )
