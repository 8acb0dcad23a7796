"""A puck thrown across a moving belt."""

from __future__ import annotations

import fricmb as fm
from fricmb.values import SI

from ._arguments import checked


@checked
def puck_on_belt(
    *,
    mass: float = 0.16,
    gravity: float = 9.81,
    mu: float = 0.25,
    belt: float = 1.0,
    velocity: tuple[float, float] = (0.0, 1.5),
    law: fm.FrictionLaw | None = None,
) -> fm.Scene:
    """Puck thrown across a moving belt: a curved path on the ground, a straight one on the belt.

    SI units (kg, m, s) by default; x along the belt.

    Parameters
    ----------
    mass : float
    gravity : float
    mu : float
        Coefficient of friction (static and kinetic), unless ``law`` is given.
    belt : float
        Velocity of the belt.
    velocity : (float, float)
        Of the puck at the start, in the frame of the ground.
    law : FrictionLaw, optional

    Returns
    -------
    Scene
        Dofs puck.x, puck.y; contact "sole".

    Notes
    -----
    Seen from the belt the puck starts with V = velocity - (belt, 0) and friction opposes it: a straight line, at rest
    at ``t = |V|/(mu g)`` after ``V |V|/(2 mu g)``.
    """
    puck = fm.Body("puck", mass=mass, axes="xy", velocity=dict(zip("xy", velocity, strict=True)))
    moving = fm.Driven("belt", velocity={"x": belt})
    return fm.Scene(
        "puck on belt",
        [
            puck,
            moving,
            fm.Contact("sole", puck, moving, law=law or fm.laws.Coulomb(mu_s=mu), normal_force=mass * gravity),
        ],
        units=SI,
    )
