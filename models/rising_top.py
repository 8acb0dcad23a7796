"""A top whose rounded tip slides on a table."""

from __future__ import annotations

from math import cos, sin

import fricmb as fm
from fricmb.values import SI

from ._arguments import checked


@checked
def rising_top(
    *,
    mass: float = 0.05,
    inertia_across: float = 2e-5,
    inertia_axial: float = 1.5e-5,
    reach: float = 0.02,
    tip_radius: float = 0.004,
    mu: float = 0.02,
    angle: float = 0.3,
    spin: float = 250.0,
    gravity: float = 9.81,
    law: fm.FrictionLaw | None = None,
) -> fm.Scene:
    """Top on a slippery table: friction where its rounded tip slides raises it until the tip rolls.

    SI units; z upwards.

    Parameters
    ----------
    mass : float
    inertia_across, inertia_axial : float
        About the centre of mass, across the axis and about it.
    reach : float
        From the middle of the tip's rounding to the centre of mass.
    tip_radius : float
        Of the rounding.  A sharp tip hardly rises.
    mu : float
        Coefficient of friction (static and kinetic), unless ``law`` is given.
    angle : float
        Of the axis from the vertical, at the start.
    spin : float
        Angular velocity about the axis, at the start.
    gravity : float
    law : FrictionLaw, optional

    Returns
    -------
    Scene
        Rotor top with the station tip, on the plane table.

    Notes
    -----
    The tip touches beside the axis, so friction against the spin has a moment that turns the angular momentum towards
    the vertical while the spin pays for it.  It rises as long as the tip slides: on a rough table it soon rolls round
    in a circle, and rises no more.  (Gallop, Trans. Cambridge Phil. Soc. 19, 1904; Jellett's constant
    ``L . (tip_radius e - reach n)`` stays what it is.)
    """
    n = (sin(angle), 0.0, cos(angle))
    top = fm.space.Rotor(
        "top",
        mass=mass,
        inertia_across=inertia_across,
        inertia_axial=inertia_axial,
        position=(reach * n[0], 0.0, reach * n[2] + tip_radius),
        axis=n,
        spin=spin,
        stations={"tip": -reach},
    )
    table = fm.space.OnPlane(
        "table",
        top.station("tip"),
        normal=(0, 0, 1),
        radius=tip_radius,
        push_only=True,
        friction=law or fm.laws.Coulomb(mu_s=mu),
    )
    return fm.Scene("rising top", [top, table, fm.Gravity("gravity", acceleration={"z": -gravity})], units=SI)
