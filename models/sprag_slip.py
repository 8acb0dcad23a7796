"""Spurr's sprag."""

from __future__ import annotations

from math import cos, sin

import fricmb as fm
from fricmb.values import SI

from ._arguments import checked


@checked
def sprag_slip(
    *,
    mu: float = 0.3,
    angle: float = 0.5,
    belt: float = 1.0,
    load: float = 20.0,
    length: float = 0.1,
    mass: float = 0.2,
    support: float = 50.0,
    stiffness: float = 50.0,
    law: fm.FrictionLaw | None = None,
) -> fm.Scene:
    """Sprag-slip after Spurr: an inclined arm on a belt that drags it upright; it jams where mu nears tan(angle).

    SI units.

    Parameters
    ----------
    mu : float
        Coefficient of friction, unless ``law`` is given.
    angle : float
        Of the arm from the normal of the belt, at the start.
    belt : float
        Velocity of the belt, towards upright where it is > 0.
    load : float
        Presses the belt on the arm.
    length, mass : float
        Of the arm, a slender bar on a pivot.
    support : float
        Mass of what carries the belt.
    stiffness : float
        Of the torsional spring in the pivot, without torque at the start.
    law : FrictionLaw, optional

    Returns
    -------
    Scene
        Bodies arm and belt; joint and contact tip.

    Notes
    -----
    R. T. Spurr, A theory of brake squeal, Proc. IMechE AD (1961): the normal force grows like 1/(1 - mu/tan(angle)).
    With a belt of finite mass the condition is
    ``1 - mu sin cos L/(sin^2 L + 1/support) > 0``, ``L = length^2/inertia``.
    """
    inertia = mass * length**2 / 3
    arm = fm.RigidBody(
        "arm",
        mass=mass,
        inertia=inertia - mass * length**2 / 4,
        position=(-length / 2 * sin(angle), -length / 2 * cos(angle)),
        angle=-angle,
        points={"pivot": (0.0, length / 2), "tip": (0.0, -length / 2)},
    )
    carrier = fm.RigidBody("belt", mass=support, inertia=1.0, position=(0.0, -length * cos(angle)))
    friction = law or fm.laws.Coulomb(mu_s=mu)
    return fm.Scene(
        "sprag",
        [
            arm,
            carrier,
            fm.Revolute("pivot", arm.point("pivot")),
            fm.Prismatic("guide", carrier, angle=1.5707963267948966),
            fm.RollerOnLine("tip", arm.point("tip"), carrier, push_only=True, slide=belt, friction=friction),
            fm.TorsionSpring("spring", arm, stiffness=stiffness, angle=-angle),
            fm.Force("load", carrier, axis="y", value=load),
        ],
        units=SI,
    )
