"""A top that stands on a fixed point."""

from __future__ import annotations

from math import cos, sin

import fricmb as fm
from fricmb.values import SI

from ._arguments import checked


@checked
def heavy_top(
    *,
    mass: float = 0.5,
    inertia_across: float = 2e-4,
    inertia_axial: float = 2.5e-4,
    reach: float = 0.04,
    angle: float = 0.4,
    spin: float = 120.0,
    gravity: float = 9.81,
) -> fm.Scene:
    """Lagrange's top: let go at rest while it spins, its axis goes round in cusps.

    SI units; no friction, z upwards.

    Parameters
    ----------
    mass : float
    inertia_across, inertia_axial : float
        About the centre of mass, across the axis and about it.
    reach : float
        From the tip to the centre of mass.
    angle : float
        Of the axis from the vertical, at the start.
    spin : float
        Angular velocity about the axis, which is itself at rest at the start.
    gravity : float

    Returns
    -------
    Scene
        Rotor top with the station tip, held in the origin by the joint pivot.

    Notes
    -----
    With u the cosine of the angle of the axis ``u'^2 = (1 - u^2)(E - U u) - (b - a u)^2``, with constants from energy
    and angular momentum: u is an elliptic function of time (Whittaker, Analytical Dynamics, art. 71).
    """
    n = (sin(angle), 0.0, cos(angle))
    top = fm.space.Rotor(
        "top",
        mass=mass,
        inertia_across=inertia_across,
        inertia_axial=inertia_axial,
        position=tuple(reach * c for c in n),
        axis=n,
        spin=spin,
        stations={"tip": -reach},
    )
    pivot = fm.space.Spherical("pivot", top.station("tip"))
    return fm.Scene("heavy top", [top, pivot, fm.Gravity("gravity", acceleration={"z": -gravity})], units=SI)
