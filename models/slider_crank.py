"""A slider crank."""

from __future__ import annotations

from math import asin, cos, sin

import fricmb as fm
from fricmb.values import SI

from ._arguments import checked

#: Friction of the joints, unless another is given.
_RUBS = fm.laws.Coulomb(mu_s=0.1)


@checked
def slider_crank(
    *,
    crank: float = 0.1,
    rod: float = 0.3,
    masses: tuple[float, float, float] = (1.0, 0.6, 0.8),
    angle: float = 0.3,
    speed: float = 30.0,
    torque: float = 0.0,
    gravity: float = 0.0,
    friction: fm.FrictionLaw | None = _RUBS,
    pin: float = 0.01,
) -> fm.Scene:
    """Slider crank: a crank, a connecting rod and a slider in a guide, each joint with friction if wanted.

    SI units.  Crank and rod are slender bars.

    Parameters
    ----------
    crank, rod : float
        Lengths.
    masses : (float, float, float)
        Of crank, rod and slider.
    angle, speed : float
        Of the crank at the start.
    torque : float
        On the crank.
    gravity : float
    friction : FrictionLaw or None
        In the three pins, of radius ``pin``, and in the guide; None: in none of them.
    pin : float

    Returns
    -------
    Scene
        Bodies crank, rod, slider; joints bearing, big end, small end, guide.

    Notes
    -----
    Without friction and load ``J(angle) speed^2 / 2`` is constant, J being the inertia of the whole as seen by the
    crank: the motion is a quadrature.
    """
    if not abs(crank * sin(angle)) < rod:
        raise fm.SceneError(
            f"slider_crank: rod must be longer than crank sin(angle), {crank * sin(angle):g}; got {rod:g}"
        )
    lean = asin(crank * sin(angle) / rod)
    tip = (crank * cos(angle), crank * sin(angle))
    end = tip[0] + rod * cos(lean)
    turn = -speed * crank * cos(angle) / (rod * cos(lean))
    bars = _bars(crank, rod, masses, angle, speed, lean, turn)
    pushed = -speed * crank * sin(angle) + turn * rod * sin(lean)
    turns_by = masses[2] * crank**2 / 8  # it never turns: any inertia serves that scales with masses and lengths
    slider = fm.RigidBody("slider", mass=masses[2], inertia=turns_by, position=(end, 0.0), velocity=(pushed, 0.0))
    checked = fm.parameter("pin", pin).value  # refused by name also where no friction uses it
    radius = checked if friction is not None else 0.0
    first, second = bars
    return fm.Scene(
        "slider crank",
        [
            first,
            second,
            slider,
            fm.Revolute("bearing", first.point("root"), radius=radius, friction=friction),
            fm.Revolute("big end", second.point("root"), first.point("tip"), radius=radius, friction=friction),
            fm.Revolute("small end", slider, second.point("tip"), radius=radius, friction=friction),
            fm.Prismatic("guide", slider, friction=friction),
            fm.Torque("motor", first, value=torque),
            fm.Gravity("gravity", acceleration={"y": -gravity}),
        ],
        units=SI,
    )


def _bars(
    crank: float, rod: float, masses: tuple[float, float, float], angle: float, speed: float, lean: float, turn: float
) -> tuple[fm.RigidBody, fm.RigidBody]:
    """Crank and rod, in motion."""
    half, part = crank / 2, rod / 2
    first = fm.RigidBody(
        "crank",
        mass=masses[0],
        inertia=masses[0] * crank**2 / 12,
        position=(half * cos(angle), half * sin(angle)),
        angle=angle,
        velocity=(-speed * half * sin(angle), speed * half * cos(angle)),
        angular_velocity=speed,
        points={"root": (-half, 0.0), "tip": (half, 0.0)},
    )
    tip = (crank * cos(angle), crank * sin(angle))
    second = fm.RigidBody(
        "rod",
        mass=masses[1],
        inertia=masses[1] * rod**2 / 12,
        position=(tip[0] + part * cos(lean), tip[1] - part * sin(lean)),
        angle=-lean,
        velocity=(-speed * tip[1] + turn * part * sin(lean), speed * tip[0] + turn * part * cos(lean)),
        angular_velocity=turn,
        points={"root": (-part, 0.0), "tip": (part, 0.0)},
    )
    return first, second
