"""A mass on a moving belt, held by a spring: the textbook stick-slip oscillator."""

from __future__ import annotations

import fricmb as fm
from fricmb.values import DIMENSIONLESS

from ._arguments import checked


@checked
def belt_oscillator(
    *,
    mass: float = 1.0,
    stiffness: float = 1.0,
    damping: float = 0.0,
    belt: float = 0.1,
    mu_s: float = 1.5,
    mu_k: float | None = 1.0,
    normal_force: float = 1.0,
    x0: float = 0.0,
    v0: float | None = None,
    law: fm.FrictionLaw | None = None,
) -> fm.Scene:
    """Mass on a moving belt, held by a spring and a damper: stick-slip with mu_s > mu_k.

    Any consistent units; dimensionless by default (m = k = 1).

    Parameters
    ----------
    mass, stiffness, damping : float
        Of the oscillator.
    belt : float
        Velocity of the belt.
    mu_s, mu_k : float
        Coefficients of friction, unless ``law`` is given.
    normal_force : float
    x0, v0 : float
        Initial position (spring relaxed at 0) and velocity; ``v0`` defaults to the belt's: the mass starts stuck.
    law : FrictionLaw, optional

    Returns
    -------
    Scene
        Dof mass.x; contact "sole".

    Notes
    -----
    J. P. Den Hartog, Mechanical Vibrations, 4th ed. (1956), chapter 7 (self-excited vibrations).  Without damping the
    motion has the period ``2 D/belt + 2 (pi - atan(D w/belt))/w``, D = (mu_s - mu_k) N/k, w = sqrt(k/m).
    """
    body = fm.Body("mass", mass=mass, axes="x", position={"x": x0}, velocity={"x": belt if v0 is None else v0})
    moving = fm.Driven("belt", velocity={"x": belt})
    return fm.Scene(
        "belt oscillator",
        [
            body,
            moving,
            fm.Spring("spring", body, axis="x", stiffness=stiffness),
            fm.Damper("damper", body, axis="x", damping=damping),
            fm.Contact(
                "sole", body, moving, law=law or fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k), normal_force=normal_force
            ),
        ],
        units=DIMENSIONLESS,
    )
