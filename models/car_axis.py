"""The car axis of the Test Set for IVP Solvers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import fricmb as fm
from fricmb.values import DIMENSIONLESS

from ._arguments import checked


@dataclass(frozen=True, eq=False)
class Perpendicular(fm.Joint):
    """The point a stays on the line through the origin across the direction to b."""

    def local_coordinates(self) -> tuple[Any, ...]:
        """Coordinates of both ends."""
        return (*(self.a.motion(c) for c in "xy"), *(self.b.motion(c) for c in "xy"))

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Their scalar product."""
        return (x[0] * x[2] + x[1] * x[3],)


@checked
def car_axis(*, eps: float = 1e-2, mass: float = 10.0, gravity: float = 1.0, bump: float = 0.1) -> fm.Scene:
    """A car axis over a bumpy road: two point masses on stiff springs, held at a distance, one wheel driven.

    Dimensionless.

    Parameters
    ----------
    eps, mass : float
        The masses are ``mass eps^2 / 2``: the smaller, the stiffer.
    gravity : float
    bump : float
        Amplitude of the road under the right wheel, at an angular frequency of 10.

    Returns
    -------
    Scene
        Bodies left and right, driven wheel.

    Notes
    -----
    S. Schneider (1994); problem "caraxis" of the Test Set for IVP Solvers (Mazzia, Magherini 2008), which gives the
    solution at t = 3 to 16 digits.
    """
    m, length, natural = mass * eps**2 / 2, 1.0, 0.5
    left = fm.Body("left", mass=m, axes="xy", position={"x": 0.0, "y": natural}, velocity={"x": -natural / length})
    right = fm.Body("right", mass=m, axes="xy", position={"x": length, "y": natural}, velocity={"x": -natural / length})
    import sympy  # takes half a second, which no other model should wait for

    road = bump * sympy.sin(10 * fm.t)
    wheel = fm.Driven("wheel", position={"x": sympy.sqrt(length**2 - road**2), "y": road}, axes="xy")
    return fm.Scene(
        "car axis",
        [
            left,
            right,
            wheel,
            fm.PointSpring("left spring", left, stiffness=1.0, length=natural),
            fm.PointSpring("right spring", right, wheel, stiffness=1.0, length=natural),
            Perpendicular("guide", left, wheel),
            fm.Rod("axis", left, right, length=length),
            fm.Gravity("gravity", acceleration={"y": -gravity}),
        ],
        units=DIMENSIONLESS,
    )
