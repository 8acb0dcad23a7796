"""A disc with a pair of equal modes, rubbed by pads around its edge."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

import fricmb as fm
from fricmb.errors import shown
from fricmb.values import DIMENSIONLESS

from ._arguments import checked


@checked
def rotor_doublet(
    nodal_diameters: int = 2,
    *,
    frequency: float = 1.0,
    split: float = 0.0,
    damping_ratio: float = 0.0,
    modal_mass: float = 1.0,
    angles: Sequence[float] = (0.0,),
    pad_mass: float = 0.05,
    pad_stiffness: float = 0.2,
    normal_force: float = 0.1,
    mu_s: float = 0.6,
    mu_k: float = 0.4,
    speed: float = 0.2,
) -> fm.Scene:
    """Disc with a cosine and sine pair of modes, and pads on springs that its surface drags.

    Dimensionless.  Each pad moves along the circumference; the disc turns at a constant surface speed below them.  Pads
    that stick to the disc split the pair: one pad loads the mode with its antinode there and leaves the other alone.

    Parameters
    ----------
    nodal_diameters : int
        Circumferential wave number n: the displacement along the circumference is ``cos n phi`` and ``sin n phi``.
    frequency : float
        Angular frequency of the pair.
    split : float
        Relative difference of the two frequencies (an imperfect disc).
    damping_ratio, modal_mass : float
        Of both modes.
    angles : sequence of float
        Angles of the pads (rad).
    pad_mass, pad_stiffness, normal_force : float
        Of each pad.
    mu_s, mu_k : float
    speed : float
        Surface velocity of the disc.

    Returns
    -------
    Scene
        Dofs disc.mode1 (cosine), disc.mode2 (sine), pad1.x, ...; points disc.p1, ...; contacts "pad1 on disc", ...

    Raises
    ------
    SceneError
    """
    if isinstance(nodal_diameters, bool) or not isinstance(nodal_diameters, int) or nodal_diameters < 1:
        raise fm.SceneError(
            f"rotor_doublet: nodal_diameters must be an integer of at least 1; got {shown(nodal_diameters)}"
        )
    if len(angles) == 0 or not all(math.isfinite(phi) for phi in angles):
        raise fm.SceneError(f"rotor_doublet: angles must be one or more finite numbers; got {shown(angles)}")
    n = nodal_diameters
    shapes = {f"p{i + 1}": np.array([[math.cos(n * phi), math.sin(n * phi)]]) for i, phi in enumerate(angles)}
    disc = fm.ModalBody(
        "disc",
        frequencies=[frequency * (1.0 - 0.5 * split), frequency * (1.0 + 0.5 * split)],
        damping_ratios=damping_ratio,
        masses=[modal_mass, modal_mass],
        shapes=shapes,
    )
    law = fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k)
    parts: list[fm.Body | fm.ModalBody | fm.Spring | fm.Contact] = [disc]
    for i in range(len(angles)):
        pad = fm.Body(f"pad{i + 1}", mass=pad_mass)
        parts += [
            pad,
            fm.Spring(f"mount{i + 1}", pad, axis="x", stiffness=pad_stiffness),
            fm.Contact(
                f"pad{i + 1} on disc",
                pad,
                disc.point(f"p{i + 1}"),
                law=law,
                normal_force=normal_force,
                slide=-speed,
            ),
        ]
    return fm.Scene(f"disc with a pair of {n} nodal diameters", parts, units=DIMENSIONLESS)
