"""A block that rocks on its lower corners."""

from __future__ import annotations

from math import cos, sin

import fricmb as fm
from fricmb.values import SI

from ._arguments import check_positive, checked


@checked
def rocking_block(
    *,
    mass: float = 1.0,
    half_width: float = 0.2,
    half_height: float = 0.6,
    angle: float = 0.16,
    restitution: float = 0.0,
    mu: float = 1.0,
    gravity: float = 9.81,
) -> fm.Scene:
    """Rocking block: let go on one corner it rocks from corner to corner, ever faster, until it stands.

    SI units.

    Parameters
    ----------
    mass : float
        Of a homogeneous block.
    half_width, half_height : float
    angle : float
        At the start, positive on its left corner; beyond ``atan(half_width/half_height)`` it falls over.
    restitution : float
        Of the corners, from 0 to 1.
    mu : float
        Coefficient of friction.
    gravity : float

    Returns
    -------
    Scene
        Body block, joints left and right, one for each lower corner.

    Notes
    -----
    G. W. Housner, The behavior of inverted pendulum structures during earthquakes, Bull. Seism. Soc. Am. 53 (1963)
    403-417: where the corners neither slip nor bounce, an impact leaves ``1 - 1.5 sin^2 alpha`` of the rate,
    ``tan alpha = half_width/half_height``.  Between impacts it is an inverted pendulum about the corner that it is on.
    """
    check_positive("rocking_block", half_width=half_width, half_height=half_height)
    across = half_width if angle >= 0.0 else -half_width
    block = fm.RigidBody(
        "block",
        mass=mass,
        inertia=mass * (half_width**2 + half_height**2) / 3.0,
        position=(
            across * cos(angle) - half_height * sin(angle),
            across * sin(angle) + half_height * cos(angle),
        ),
        angle=angle,
        points={
            "left": (-half_width, -half_height),
            "right": (half_width, -half_height),
            "top_right": (half_width, half_height),
            "top_left": (-half_width, half_height),
        },
    )
    law = fm.laws.Coulomb(mu_s=mu)
    corners = [
        fm.RollerOnLine(corner, block.point(corner), push_only=True, restitution=restitution, friction=law)
        for corner in ("left", "right")
    ]
    return fm.Scene(
        "rocking block",
        [block, *corners, fm.Gravity("gravity", acceleration={"y": -gravity})],
        units=SI,
    )
