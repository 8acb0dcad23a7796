"""A wheel on a slope."""

from __future__ import annotations

from math import atan, cos, sin

import fricmb as fm
from fricmb.values import SI

from ._arguments import check_positive, checked


@checked
def wheel_on_slope(
    *,
    mass: float = 2.0,
    radius: float = 0.1,
    slope: float = 0.3,
    mu: float = 0.2,
    arm: float = 0.002,
    spin: float = 60.0,
    gravity: float = 9.81,
) -> fm.Scene:
    """Wheel on a slope: spun up it slides and rolls uphill, turns round, and rests where the slope is gentle.

    SI units.

    Parameters
    ----------
    mass, radius : float
        Of a disc.
    slope : float
        Rise over run, uphill along x.
    mu : float
        Coefficient of friction.
    arm : float
        Of rolling resistance: it takes a torque of ``arm`` times the load.
    spin : float
        Rate at which the disc turns at the start, clockwise, which drives it uphill.
    gravity : float

    Returns
    -------
    Scene
        Body disc, joint ground with the friction of the rim, resistance with that of rolling.

    Notes
    -----
    It rolls while ``slope <= 3 mu`` (less what the resistance takes), and stays at rest up to ``slope = arm/radius``:
    see :class:`fricmb.Wheel`.
    """
    check_positive("wheel_on_slope", radius=radius)
    rise = atan(slope)
    disc = fm.RigidBody(
        "disc",
        mass=mass,
        inertia=mass * radius**2 / 2.0,
        position=(-radius * sin(rise), radius * cos(rise)),
        angular_velocity=-spin,
    )
    return fm.Scene(
        "wheel on a slope",
        [
            disc,
            fm.Wheel("ground", disc, radius=radius, angle=rise, friction=fm.laws.Coulomb(mu_s=mu)),
            fm.DryFriction("resistance", disc, axis="angle", static=arm * mass * gravity * cos(rise)),
            fm.Gravity("gravity", acceleration={"y": -gravity}),
        ],
        units=SI,
    )
