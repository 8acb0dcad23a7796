"""A mass on a rough plane, held by two springs: friction in two dimensions at its plainest."""

from __future__ import annotations

import fricmb as fm
from fricmb.values import DIMENSIONLESS

from ._arguments import checked


@checked
def planar_oscillator(
    *,
    mass: float = 1.0,
    stiffness: tuple[float, float] = (1.0, 2.3),
    friction: float = 0.1,
    position: tuple[float, float] = (2.0, 0.0),
    velocity: tuple[float, float] = (0.0, 0.01),
    law: fm.FrictionLaw | None = None,
) -> fm.Scene:
    """Mass on a rough plane between two springs: the path passes close to rest and turns there.

    ``m x'' = -k_x x - friction v_x/|v|``, the same along y; any consistent units, dimensionless by default.

    Parameters
    ----------
    mass : float
    stiffness : (float, float)
        Along x and y.
    friction : float
        Friction force: the normal force of a contact whose Coulomb coefficient is 1.
    position, velocity : (float, float)
        Initial values.
    law : FrictionLaw, optional
        Another law, acted on by the normal force ``friction``.

    Returns
    -------
    Scene
        Dofs mass.x, mass.y; contact "sole".

    Notes
    -----
    A test problem of this project: nearly straight motion passes v = 0 at a distance that depends on the small initial
    velocity across, so any threshold on the velocity catches it where it should turn and slip on.
    """
    body = fm.Body(
        "mass",
        mass=mass,
        axes="xy",
        position=dict(zip("xy", position, strict=True)),
        velocity=dict(zip("xy", velocity, strict=True)),
    )
    return fm.Scene(
        "planar oscillator",
        [
            body,
            fm.Spring("kx", body, axis="x", stiffness=stiffness[0]),
            fm.Spring("ky", body, axis="y", stiffness=stiffness[1]),
            fm.Contact("sole", body, law=law or fm.laws.Coulomb(mu_s=1.0), normal_force=friction),
        ],
        units=DIMENSIONLESS,
    )
