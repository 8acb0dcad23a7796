"""Mode coupling: a block on inclined springs that becomes unstable under constant friction."""

from __future__ import annotations

import math

import fricmb as fm
from fricmb.values import DIMENSIONLESS

from ._arguments import checked


@checked
def minimal_flutter(
    mu: float = 0.9,
    *,
    mass: float = 1.0,
    k1: float = 2.0 / 3.0 * (2.0 - math.sqrt(3.0)),
    k2: float = 2.0 / 3.0 * (2.0 + math.sqrt(3.0)),
    k3: float = 4.0 / 3.0,
    damping: float = 0.0,
    preload: float = 1.0,
    belt: float = 2.0,
    kick: float = 1e-3,
) -> fm.Scene:
    """Two-mode mode coupling: friction that follows its own normal force makes two frequencies merge.

    Dimensionless.  Steady sliding is (without damping neutrally) stable for mu below 0.75 by default, and flutters
    above.

    Parameters
    ----------
    mu : float
        Coefficient of friction, the same at break-away and in slip.
    mass : float
    k1, k2 : float
        Springs at 30 and 150 degrees to the belt.
    k3 : float
        Stiffness of the contact, normal to the belt.
    damping : float
        Of both directions to the ground.
    preload : float
        Normal force at equilibrium without friction.
    belt : float
        Velocity of the belt.
    kick : float
        Displacement from steady sliding at the start, normal to the belt.

    Returns
    -------
    Scene
        Dofs block.x (along the belt), block.y (away from it); contact "sole".

    Notes
    -----
    N. Hoffmann, M. Fischer, R. Allgaier, L. Gaul, A minimal model for studying properties of the mode-coupling type
    instability in friction induced oscillations, Mechanics Research Communications 29 (2002) 197-205.  With
    ``k11 = k22 = 2``, ``k12 = -1`` the characteristic frequencies are ``omega^2 = 2 -+ sqrt(1 - mu k3)``, which merge
    at ``mu = 1/k3 = 0.75``.
    """
    block = fm.Body("block", mass=mass, axes="xy", position=_steady(mu, k1, k2, k3, preload, kick, belt))
    up, down = (math.sqrt(3.0) / 2.0, 0.5), (-math.sqrt(3.0) / 2.0, 0.5)
    ground = fm.Driven("belt", velocity={"x": belt})
    return fm.Scene(
        "minimal flutter",
        [
            block,
            ground,
            fm.Spring("k1", block, axis=up, stiffness=k1),
            fm.Spring("k2", block, axis=down, stiffness=k2),
            fm.Damper("cx", block, axis="x", damping=damping),
            fm.Damper("cy", block, axis="y", damping=damping),
            fm.Contact(
                "sole",
                block,
                ground,
                law=fm.laws.Coulomb(mu_s=mu),
                normal_force=fm.normal.Spring(axis="y", stiffness=k3, preload=preload),
            ),
        ],
        units=DIMENSIONLESS,
    )


def _steady(mu: float, k1: float, k2: float, k3: float, preload: float, kick: float, belt: float) -> dict[str, float]:
    """Position of steady sliding, kicked: K q = (mu sign N, 0) with N = preload - k3 y."""
    k11, k12 = 0.75 * (k1 + k2), math.sqrt(3.0) / 4.0 * (k1 - k2)
    k22 = 0.25 * (k1 + k2) + k3
    pull = math.copysign(mu, belt)
    determinant = (k11 * k22) - (k12 + pull * k3) * k12
    x, y = pull * preload * k22 / determinant, -pull * preload * k12 / determinant
    return {"x": x, "y": y + kick}
