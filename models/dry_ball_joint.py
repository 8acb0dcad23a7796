"""A pendulum that swings in all directions on a dry ball joint."""

from __future__ import annotations

import fricmb as fm
from fricmb.values import SI

from ._arguments import checked


@checked
def dry_ball_joint(
    *,
    mass: float = 2.0,
    inertia: tuple[float, float, float] = (0.03, 0.05, 0.02),
    arm: tuple[float, float, float] = (0.1, 0.05, -0.3),
    radius: float = 0.02,
    mu: float = 0.6,
    angular_velocity: tuple[float, float, float] = (1.0, 2.0, 3.0),
    gravity: float = 9.81,
    law: fm.FrictionLaw | None = None,
) -> fm.Scene:
    """Pendulum on a dry ball joint: one cone in three directions of slip, and a rest out of plumb.

    SI units; z upwards.

    Parameters
    ----------
    mass : float
    inertia : (float, float, float)
        Principal moments about the centre of mass.
    arm : (float, float, float)
        From the joint to the centre of mass, at the start and along the body's axes.
    radius : float
        Of the ball.
    mu : float
        Coefficient of friction (static and kinetic), unless ``law`` is given.
    angular_velocity : (float, float, float)
        At the start.
    gravity : float
    law : FrictionLaw, optional

    Returns
    -------
    Scene
        Body bob, joint and contact hook.

    Notes
    -----
    With the reaction F and the angular velocity w the joint brakes by the torque ``-mu radius |F| w/|w|``; at rest it
    bears any torque up to ``mu radius |F|``, in whatever direction.
    """
    x, y, z = arm
    a, b, c = angular_velocity
    bob = fm.space.RigidBody(
        "bob",
        mass=mass,
        inertia=inertia,
        position=arm,
        velocity=(b * z - c * y, c * x - a * z, a * y - b * x),
        angular_velocity=angular_velocity,
        points={"joint": (-x, -y, -z)},
    )
    hook = fm.space.Spherical("hook", bob.point("joint"), radius=radius, friction=law or fm.laws.Coulomb(mu_s=mu))
    return fm.Scene("dry ball joint", [bob, hook, fm.Gravity("gravity", acceleration={"z": -gravity})], units=SI)
