"""A ball that rolls on a turntable."""

from __future__ import annotations

import numpy as np

import fricmb as fm
from fricmb.values import SI

from ._arguments import check_positive, checked


@checked
def turntable(
    *,
    mass: float = 1.0,
    radius: float = 0.05,
    mu: float = 5.0,
    turning: float = 4.0,
    position: tuple[float, float] = (0.1, -0.2),
    velocity: tuple[float, float] = (0.3, 0.0),
    gravity: float = 9.81,
    law: fm.FrictionLaw | None = None,
) -> fm.Scene:
    """Ball that rolls on a turntable: it goes round in circles, at two sevenths of the table's rate.

    SI units; z upwards, the table turns about the origin.

    Parameters
    ----------
    mass, radius : float
        Of the solid ball.
    mu : float
        Coefficient of friction (static and kinetic), unless ``law`` is given.
    turning : float
        Angular velocity of the table.
    position, velocity : (float, float)
        Of the centre at the start.
    gravity : float
    law : FrictionLaw, optional

    Returns
    -------
    Scene
        Ball ball, plane table.  It starts without slip.

    Notes
    -----
    ``v' = 2/7 turning e x v`` for a solid ball: circles about a point that the start gives (Earnshaw, 1844).
    """
    check_positive("turntable", radius=radius)
    start, v = np.array([*position, radius]), np.array([*velocity, 0.0])
    carried = np.cross((0.0, 0.0, turning), start) - v  # what the turns have to bring at the lowest point
    ball = fm.space.Ball(
        "ball",
        mass=mass,
        radius=radius,
        position=start,
        velocity=v,
        angular_velocity=(carried[1] / radius, -carried[0] / radius, 0.0),
    )
    friction = law or fm.laws.Coulomb(mu_s=mu)
    table = fm.space.OnPlane("table", ball, normal=(0, 0, 1), turning=turning, push_only=True, friction=friction)
    return fm.Scene("turntable", [ball, table, fm.Gravity("gravity", acceleration={"z": -gravity})], units=SI)
