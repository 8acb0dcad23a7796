"""Newton's cradle."""

from __future__ import annotations

from math import cos, sin
from typing import Any

import fricmb as fm
from fricmb.errors import shown
from fricmb.values import SI

from ._arguments import check_positive, checked


@checked
def newtons_cradle(
    n: int = 5,
    *,
    mass: float = 0.05,
    radius: float = 0.01,
    length: float = 0.15,
    gap: float = 1e-5,
    angle: float = 0.5,
    lifted: int = 1,
    restitution: float = 1.0,
    gravity: float = 9.81,
) -> fm.Scene:
    """Newton's cradle: what comes in on one side leaves on the other, as each ball passes its speed on to the next.

    SI units.

    Parameters
    ----------
    n : int
        Balls, at least 2.
    mass, radius : float
        Of each.
    length : float
        Of their threads.
    gap : float
        Between neighbours at rest, > 0.
    angle : float
        From which the first balls are let go.
    lifted : int
        How many of them, from 1 to ``n - 1``.
    restitution : float
        From 0 to 1.
    gravity : float

    Returns
    -------
    Scene
        Bodies ball1, ball2, ..., their threads, and touch1, ... between neighbours.

    Notes
    -----
    F. Herrmann, P. Schmalzle, Simple explanation of a well-known collision experiment, Am. J. Phys. 49 (1981) 761-764.
    Balls with a little air between them are struck in turn, and two equal ones change their speeds; balls that touch
    would share an elastic impact as the law of impact says, and all of them move.  They are points on threads that stay
    taut, and strike along the line of their centres.
    """
    check_positive("newtons_cradle", gap=gap, radius=radius, length=length)
    if n < 2:
        raise fm.SceneError(f"newtons_cradle: n must be an integer of at least 2; got {shown(n)}")
    if not 1 <= lifted < n:
        raise fm.SceneError(f"newtons_cradle: lifted must be an integer from 1 to n - 1; got {shown(lifted)}")
    pitch = 2.0 * radius + gap
    parts: list[Any] = []
    balls = []
    for i in range(n):
        start = -angle if i < lifted else 0.0
        place = (pitch * i + length * sin(start), -length * cos(start))
        balls.append(fm.Body(f"ball{i + 1}", mass=mass, axes="xy", position=dict(zip("xy", place, strict=True))))
        thread = fm.Rod(f"thread{i + 1}", balls[i], fm.ground_point(pitch * i, 0.0), length=length)
        parts += [balls[i], thread]
    for i in range(n - 1):
        parts.append(
            fm.RollerOnCircle(
                f"touch{i + 1}", balls[i + 1], balls[i], radius=2.0 * radius, push_only=True, restitution=restitution
            )
        )
    return fm.Scene("Newton's cradle", [*parts, fm.Gravity("gravity", acceleration={"y": -gravity})], units=SI)
