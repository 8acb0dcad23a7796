"""A ball that bounces on a table that oscillates."""

from __future__ import annotations

import sympy

import fricmb as fm
from fricmb.values import SI

from ._arguments import checked


@checked
def oscillating_table(
    *,
    mass: float = 0.1,
    amplitude: float = 1e-3,
    frequency: float = 100.0,
    height: float = 4e-3,
    velocity: float = -0.18,
    restitution: float = 0.8,
    gravity: float = 9.81,
) -> fm.Scene:
    """Ball on an oscillating table: it settles to one bounce a period; shaken harder, it loses step.

    SI units.

    Parameters
    ----------
    mass : float
    amplitude, frequency : float
        Of the table's height, ``amplitude sin(frequency t)``.
    height, velocity : float
        Of the ball at the start, upward; the table is at height 0.
    restitution : float
        From 0 to 1.
    gravity : float

    Returns
    -------
    Scene
        Body ball, driven body table, stop surface.

    Notes
    -----
    P. J. Holmes, The dynamics of repeated impacts with a sinusoidally vibrating table, J. Sound Vib. 84 (1982) 173-189;
    here without his assumption that bounces are high.  Bounces of one period T leave with ``gravity T/2`` at phases
    ``cos(phase) = gravity T (1 - restitution)/(2 (1 + restitution) amplitude frequency)``; small deviations have
    multipliers of product ``restitution^2`` and sum ``1 + restitution^2 - (1 + restitution)^2 amplitude
    frequency^2 sin(phase)/gravity``.  A ball that comes too low or late is lost: its bounces die out on the table.
    """
    ball = fm.Body("ball", mass=mass, axes="y", position={"y": height}, velocity={"y": velocity})
    table = fm.Driven("table", position={"y": amplitude * sympy.sin(frequency * fm.t)}, axes="y")
    return fm.Scene(
        "ball on an oscillating table",
        [
            ball,
            table,
            fm.Stop("surface", ball, table, axis="y", lower=0.0, restitution=restitution),
            fm.Gravity("gravity", acceleration={"y": -gravity}),
        ],
        units=SI,
    )
