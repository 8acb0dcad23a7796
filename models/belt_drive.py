"""Two pulleys and a belt."""

from __future__ import annotations

from math import pi
from typing import Any

import fricmb as fm
from fricmb.values import SI

from ._arguments import check_positive, checked


@checked
def belt_drive(
    *,
    inertia: float = 0.02,
    radius: float = 0.1,
    speed: float = 20.0,
    mu: float = 0.35,
    pretension: float = 200.0,
    stiffness: float = 2e4,
    damping: float = 20.0,
    mass: float = 0.1,
    load: Any = None,
) -> fm.Scene:
    """Belt drive: a pulley drives another through elastic strands, until its load makes the belt slip.

    SI units.

    Parameters
    ----------
    inertia, radius : float
        Of both pulleys.
    speed : float
        Of the pulley that drives.
    mu : float
        Coefficient of friction of the belt, which is wound by half a turn.
    pretension : float
        Tension of both strands at rest.
    stiffness, damping, mass : float
        Of each strand; the mass stands in halves at its ends.
    load : float or expression, optional
        Torque on the driven pulley, < 0 against its motion; default: ``-12 fm.t``.

    Returns
    -------
    Scene
        Pulleys drive and driven, ends of the strands, joints on_drive and on_driven with the friction of the belt.

    Notes
    -----
    Strands of the same stiffness keep the sum of their tensions, so that in steady motion the belt slips at the torque
    ``2 pretension radius tanh(mu pi/2)``: see :class:`fricmb.Rope`.
    """
    check_positive("belt_drive", radius=radius, stiffness=stiffness)
    turning: dict[str, Any] = {"mass": 2.0 * inertia / radius**2, "inertia": inertia, "angular_velocity": speed}
    drive, driven = fm.RigidBody("drive", **turning), fm.RigidBody("driven", position=(0.5, 0.0), **turning)
    # strands run off the drive along x; turning forward, the drive winds the upper one and pays out the lower one
    along = {"upper": -radius * speed, "lower": radius * speed}
    ends = {
        f"{strand}_{i}": fm.Body(f"{strand}_{i}", mass=mass / 2, position={"x": at}, velocity={"x": v})
        for strand, v in along.items() for i, at in ((1, 0.15), (2, 0.35))
    }  # fmt: skip
    parts: list[Any] = [drive, driven, *ends.values()]
    for strand in along:
        first, second = ends[f"{strand}_1"], ends[f"{strand}_2"]
        length = 0.2 - pretension / stiffness
        parts.append(fm.Spring(f"{strand}_k", second, first, axis="x", stiffness=stiffness, length=length))
        parts.append(fm.Damper(f"{strand}_c", second, first, axis="x", damping=damping))
    wound: dict[str, Any] = {"angle": pi, "friction": mu}
    parts += [
        fm.Rope("on_drive", (ends["upper_1"], ends["lower_1"]), axes=((1,), (1,)), drum=drive, radius=radius, **wound),
        fm.Rope(
            "on_driven", (ends["upper_2"], ends["lower_2"]), axes=((-1,), (-1,)), drum=driven, radius=-radius, **wound
        ),
        fm.Revolute("hub", drive),
        fm.Revolute("axle", driven, fm.ground_point(0.5, 0.0)),
        fm.DrivenAngle("motor", drive, speed=speed),
        fm.Torque("load", driven, value=-12.0 * fm.t if load is None else load),
    ]
    return fm.Scene("belt drive", parts, units=SI)
