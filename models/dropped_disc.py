"""A disc that is dropped on a slope."""

from __future__ import annotations

from math import atan, cos, sin

import fricmb as fm
from fricmb.values import SI

from ._arguments import check_positive, checked


@checked
def dropped_disc(
    *,
    mass: float = 0.5,
    radius: float = 0.1,
    slope: float = 0.3,
    height: float = 0.5,
    spin: float = 0.0,
    mu: float = 0.25,
    restitution: float = 0.6,
    gravity: float = 9.81,
) -> fm.Scene:
    """Dropped disc: it bounces down a slope, each impact gives it spin, and ends rolling.

    SI units.

    Parameters
    ----------
    mass, radius : float
        Of a disc.
    slope : float
        Fall over run, downhill along x.
    height : float
        Of the rim above the slope at the start, across it; it falls from rest.
    spin : float
        Rate at which it turns at the start, counter-clockwise.
    mu : float
        Coefficient of friction, in impacts too.
    restitution : float
        From 0 to 1.
    gravity : float

    Returns
    -------
    Scene
        Body disc, joint slope with the friction of its rim.

    Notes
    -----
    Across the slope, which has the angle a, it is a ball that bounces under ``gravity cos a``; along it the disc falls
    with ``gravity sin a`` all the time, and an impact takes up to ``3 mu (1 + restitution)`` times the speed of
    approach off the speed of its rim.  It rolls on with ``2/3 gravity sin a`` where ``tan a <= 3 mu``.
    """
    check_positive("dropped_disc", radius=radius)
    angle = atan(slope)
    disc = fm.RigidBody(
        "disc",
        mass=mass,
        inertia=mass * radius**2 / 2.0,
        position=((radius + height) * sin(angle), (radius + height) * cos(angle)),
        angular_velocity=spin,
    )
    law = fm.laws.Coulomb(mu_s=mu)
    return fm.Scene(
        "dropped disc",
        [
            disc,
            fm.Wheel(
                "slope", disc, radius=radius, angle=-angle, push_only=True, restitution=restitution, friction=law
            ),
            fm.Gravity("gravity", acceleration={"y": -gravity}),
        ],
        units=SI,
    )
