"""A billiard ball on its cloth."""

from __future__ import annotations

import fricmb as fm
from fricmb.values import SI

from ._arguments import checked


@checked
def billiard(
    *,
    mass: float = 0.17,
    radius: float = 0.028575,
    mu: float = 0.2,
    velocity: tuple[float, float] = (1.5, 0.0),
    angular_velocity: tuple[float, float, float] = (20.0, -30.0, 50.0),
    gravity: float = 9.81,
    law: fm.FrictionLaw | None = None,
) -> fm.Scene:
    """Billiard ball with side and back spin: it skids along a parabola, and rolls straight from one moment on.

    SI units; z upwards.

    Parameters
    ----------
    mass, radius : float
        Of the solid ball.
    mu : float
        Coefficient of friction (static and kinetic), unless ``law`` is given.
    velocity : (float, float)
        Of the centre at the start.
    angular_velocity : (float, float, float)
        At the start.
    gravity : float
    law : FrictionLaw, optional

    Returns
    -------
    Scene
        Ball ball, plane cloth.

    Notes
    -----
    Slip ``s = v + omega x c`` keeps its direction while its size falls by ``7/2 mu g`` in a second: the ball rolls
    from ``t = 2 |s|/(7 mu g)`` on (Coriolis, Théorie mathématique des effets du jeu de billard, 1835).
    """
    ball = fm.space.Ball(
        "ball",
        mass=mass,
        radius=radius,
        position=(0, 0, radius),
        velocity=(*velocity, 0.0),
        angular_velocity=angular_velocity,
    )
    friction = law or fm.laws.Coulomb(mu_s=mu)
    cloth = fm.space.OnPlane("cloth", ball, normal=(0, 0, 1), push_only=True, friction=friction)
    return fm.Scene("billiard", [ball, cloth, fm.Gravity("gravity", acceleration={"z": -gravity})], units=SI)
