"""A ball that rolls in an upright tube."""

from __future__ import annotations

import fricmb as fm
from fricmb.values import SI

from ._arguments import check_positive, checked


@checked
def ball_in_cylinder(
    *,
    mass: float = 0.05,
    radius: float = 0.02,
    cylinder_radius: float = 0.15,
    mu: float = 2.0,
    spin: float = 9.0,
    rise: float = 0.1,
    gravity: float = 9.81,
    law: fm.FrictionLaw | None = None,
) -> fm.Scene:
    """Ball in an upright tube: rolling round the wall it goes up and down, and does not fall out.

    SI units; z upwards, along the tube.

    Parameters
    ----------
    mass : float
    radius : float
        Of the ball.
    cylinder_radius : float
        Of the tube, more than that of the ball.
    mu : float
        Coefficient of friction (static and kinetic), unless ``law`` is given.
    spin : float
        Angular velocity at which the ball goes round the tube, at the start.
    rise : float
        Velocity upwards at the start.
    gravity : float
    law : FrictionLaw, optional

    Returns
    -------
    Scene
        Body ball, contact tube; the ball starts rolling, without spin about its contact.

    Notes
    -----
    Height goes as ``z'' = -2/7 spin^2 z + const`` beside the turn about the contact: z swings at ``sqrt(2/7)`` of the
    rate of going round (M. Gualtieri, T. Tokieda, L. Advis-Gaete, B. Carry, E. Reffet, C. Guthmann, Golfer's dilemma,
    American Journal of Physics 74 (2006) 497-501).
    """
    check_positive("ball_in_cylinder", radius=radius)
    off = cylinder_radius - radius
    ball = fm.space.Ball(
        "ball",
        mass=mass,
        radius=radius,
        position=(off, 0.0, 0.0),
        velocity=(0.0, off * spin, rise),
        angular_velocity=(0.0, rise / radius, -off * spin / radius),
    )
    tube = fm.space.InCylinder(
        "tube", ball, axis=(0, 0, 1), radius=cylinder_radius, push_only=True, friction=law or fm.laws.Coulomb(mu_s=mu)
    )
    return fm.Scene("ball in a tube", [ball, tube, fm.Gravity("gravity", acceleration={"z": -gravity})], units=SI)
