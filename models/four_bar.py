"""A four-bar linkage."""

from __future__ import annotations

from math import atan2, cos, hypot, sin, sqrt

import fricmb as fm
from fricmb.values import SI

from ._arguments import checked

_Pair = tuple[float, float]


@checked
def four_bar(
    *,
    crank: float = 0.1,
    coupler: float = 0.3,
    rocker: float = 0.25,
    ground: float = 0.32,
    density: float = 5.0,
    angle: float = 0.8,
    speed: float = 0.0,
    torque: float = 0.0,
    gravity: float = 9.81,
    friction: fm.FrictionLaw | None = None,
    pin: float = 0.005,
) -> fm.Scene:
    """Four-bar linkage: crank, coupler and rocker on four pins, under gravity, with dry pins if wanted.

    SI units.  Bars are slender.

    Parameters
    ----------
    crank, coupler, rocker, ground : float
        Lengths.
    density : float
        Mass per length.
    angle, speed : float
        Of the crank at the start.
    torque : float
        On the crank.
    gravity : float
    friction : FrictionLaw, optional
        In all four pins, of radius ``pin``.
    pin : float

    Returns
    -------
    Scene
        Bodies crank, coupler, rocker; joints A, B, C, D in the order of the chain.
    """
    A, D = (0.0, 0.0), (ground, 0.0)
    B = (crank * cos(angle), crank * sin(angle))
    C = _meeting(B, coupler, D, rocker)
    bars = [_bar("crank", A, B, density, speed), _bar("coupler", B, C, density), _bar("rocker", D, C, density)]
    first, second, third = bars
    checked = fm.parameter("pin", pin).value  # refused by name also where no friction uses it
    radius = checked if friction is not None else 0.0
    return fm.Scene(
        "four-bar linkage",
        [
            *bars,
            fm.Revolute("A", first.point("root"), radius=radius, friction=friction),
            fm.Revolute("B", second.point("root"), first.point("tip"), radius=radius, friction=friction),
            fm.Revolute("C", third.point("tip"), second.point("tip"), radius=radius, friction=friction),
            fm.Revolute("D", third.point("root"), fm.ground_point(*D), radius=radius, friction=friction),
            fm.Torque("motor", first, value=torque),
            fm.Gravity("gravity", acceleration={"y": -gravity}),
        ],
        units=SI,
    )


def _meeting(first: _Pair, one: float, second: _Pair, other: float) -> _Pair:
    """The upper point at the two distances from the two points."""
    dx, dy = second[0] - first[0], second[1] - first[1]
    apart = hypot(dx, dy)
    along = (apart**2 + one**2 - other**2) / (2 * apart)
    if along**2 > one**2:
        raise fm.SceneError(f"four_bar: bars of {one:g} and {other:g} cannot meet over {apart:g}")
    across = sqrt(one**2 - along**2)
    return first[0] + (along * dx - across * dy) / apart, first[1] + (along * dy + across * dx) / apart


def _bar(name: str, root: _Pair, tip: _Pair, density: float, speed: float = 0.0) -> fm.RigidBody:
    """A slender bar between two points, turning about its root."""
    dx, dy = tip[0] - root[0], tip[1] - root[1]
    length = hypot(dx, dy)
    return fm.RigidBody(
        name,
        mass=density * length,
        inertia=density * length**3 / 12,
        position=((root[0] + tip[0]) / 2, (root[1] + tip[1]) / 2),
        angle=atan2(dy, dx),
        velocity=(-speed * dy / 2, speed * dx / 2),
        angular_velocity=speed,
        points={"root": (-length / 2, 0.0), "tip": (length / 2, 0.0)},
    )
