"""A pendulum on a dry pin."""

from __future__ import annotations

from math import cos, pi, sin

import fricmb as fm
from fricmb.values import SI

from ._arguments import checked


@checked
def dry_pendulum(
    *,
    mass: float = 1.3,
    inertia: float = 0.2,
    length: float = 0.7,
    radius: float = 0.05,
    mu: float = 0.6,
    angle: float = 1.2,
    gravity: float = 9.81,
    law: fm.FrictionLaw | None = None,
) -> fm.Scene:
    """Pendulum on a dry pin: friction from the pin's own reaction, swings that lose and end in a tilted rest.

    SI units.

    Parameters
    ----------
    mass, inertia : float
        Inertia about the centre of mass.
    length : float
        From the pin to the centre of mass.
    radius : float
        Of the pin.
    mu : float
        Coefficient of friction (static and kinetic), unless ``law`` is given.
    angle : float
        From the vertical, at the start.
    gravity : float
    law : FrictionLaw, optional

    Returns
    -------
    Scene
        Body arm (its axis x points away from the pin), joint and contact pin.

    Notes
    -----
    With the reaction lam on the pendulum at the pin and s the direction of the swing:
    ``(inertia + mass length^2) a = -mass gravity length sin(angle) - mu radius |lam(angle, w, a)| s``.
    """
    arm = fm.RigidBody(
        "arm",
        mass=mass,
        inertia=inertia,
        position=(length * sin(angle), -length * cos(angle)),
        angle=angle - pi / 2,
        points={"pin": (-length, 0.0)},
    )
    friction = law or fm.laws.Coulomb(mu_s=mu)
    return fm.Scene(
        "dry pendulum",
        [
            arm,
            fm.Revolute("pin", arm.point("pin"), radius=radius, friction=friction),
            fm.Gravity("gravity", acceleration={"y": -gravity}),
        ],
        units=SI,
    )
