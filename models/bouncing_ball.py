"""A ball that bounces with spin."""

from __future__ import annotations

import fricmb as fm
from fricmb.values import SI

from ._arguments import check_positive, checked


@checked
def bouncing_ball(
    *,
    mass: float = 0.2,
    radius: float = 0.1,
    height: float = 1.0,
    velocity: float = 2.0,
    spin: float = 10.0,
    restitution: float = 0.7,
    mu: float = 0.08,
    gravity: float = 9.81,
) -> fm.Scene:
    """Bouncing ball: thrown with backspin it slips in its first two impacts, then rolls, and its bounces die out.

    SI units.

    Parameters
    ----------
    mass, radius : float
        Of a solid ball.
    height : float
        Of its lowest point above the floor at the start.
    velocity : float
        Along x at the start; it falls from rest.
    spin : float
        Rate at which it turns backwards, against rolling along x.
    restitution : float
        Part of the speed of approach with which it leaves, from 0 to 1.
    mu : float
        Coefficient of friction, in impacts too.
    gravity : float

    Returns
    -------
    Scene
        Body ball, joint floor with the friction of its rim.

    Notes
    -----
    With V = sqrt(2 gravity height) and e = restitution it meets the floor first at V/gravity and rests after
    ``(V/gravity) (1 + e)/(1 - e)``.  Friction has at most mu times the impulse of the floor: an impact takes up to
    ``3.5 mu (1 + e)`` times the speed of approach off the speed of slip, until it rolls.
    """
    check_positive("bouncing_ball", radius=radius)
    ball = fm.RigidBody(
        "ball",
        mass=mass,
        inertia=0.4 * mass * radius**2,
        position=(0.0, height + radius),
        velocity=(velocity, 0.0),
        angular_velocity=spin,
    )
    law = fm.laws.Coulomb(mu_s=mu)
    return fm.Scene(
        "bouncing ball",
        [
            ball,
            fm.Wheel("floor", ball, radius=radius, push_only=True, restitution=restitution, friction=law),
            fm.Gravity("gravity", acceleration={"y": -gravity}),
        ],
        units=SI,
    )
