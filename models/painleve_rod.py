"""The rod of Painleve's paradox."""

from __future__ import annotations

from math import cos, sin

import fricmb as fm
from fricmb.values import SI

from ._arguments import checked


@checked
def painleve_rod(
    *,
    mu: float = 0.5,
    angle: float = 1.0,
    speed: float = -3.0,
    spin: float = 0.0,
    mass: float = 1.0,
    half: float = 0.5,
    gravity: float = 9.81,
    law: fm.FrictionLaw | None = None,
) -> fm.Scene:
    """Rod that slides on its tip: above mu = 4/3 positions where rigid friction has no solution, or two.

    SI units.

    Parameters
    ----------
    mu : float
        Coefficient of friction, unless ``law`` is given.
    angle : float
        From the ground to the rod, at the start; the tip is below the centre of mass.
    speed : float
        Of the tip along the ground.
    spin : float
        Angular velocity.
    mass, half : float
        A uniform rod of length ``2 half``.
    gravity : float
    law : FrictionLaw, optional

    Returns
    -------
    Scene
        Body rod; joint and contact tip, which can push only.

    Notes
    -----
    The normal force is unique while ``1 + 3 cos^2 a + 3 mu s sin a cos a > 0`` with s the direction of slip of the tip
    along x: P. Painleve (1895); F. Genot, B. Brogliato, Eur. J. Mech. A 18 (1999) 653.
    """
    rod = fm.RigidBody(
        "rod",
        mass=mass,
        inertia=mass * half**2 / 3,
        position=(half * cos(angle), half * sin(angle)),
        angle=angle,
        velocity=(speed - spin * half * sin(angle), spin * half * cos(angle)),
        angular_velocity=spin,
        points={"tip": (-half, 0.0)},
    )
    friction = law or fm.laws.Coulomb(mu_s=mu)
    return fm.Scene(
        "Painleve's rod",
        [
            rod,
            fm.RollerOnLine("tip", rod.point("tip"), push_only=True, friction=friction),
            fm.Gravity("gravity", acceleration={"y": -gravity}),
        ],
        units=SI,
    )
