"""A coin that rolls on its edge."""

from __future__ import annotations

from math import cos, sin

import numpy as np

import fricmb as fm
from fricmb.values import SI

from ._arguments import checked


@checked
def rolling_coin(
    *,
    mass: float = 0.1,
    radius: float = 0.25,
    mu: float = 2.0,
    angle: float = 1.2,
    rates: tuple[float, float, float] = (9.0, 0.5, -0.3),
    gravity: float = 9.81,
    law: fm.FrictionLaw | None = None,
) -> fm.Scene:
    """Disc that rolls on its edge along a curve and nods; with little friction it begins to slip.

    SI units; z upwards.

    Parameters
    ----------
    mass, radius : float
        Of the thin disc.
    mu : float
        Coefficient of friction (static and kinetic), unless ``law`` is given.
    angle : float
        Of the disc's axis from the vertical, at the start: pi/2 stands upright.
    rates : (float, float, float)
        Angular velocity at the start: about the axis, about the way up along the disc, about the level diameter.
    gravity : float
    law : FrictionLaw, optional

    Returns
    -------
    Scene
        Rotor coin, plane floor.  It starts without slip.

    Notes
    -----
    A disc that rolls has the integrals of Appell and Korteweg; it never falls flat unless it starts so that it must.
    """
    axis = np.array([sin(angle), 0.0, cos(angle)])
    up, level = np.array([-cos(angle), 0.0, sin(angle)]), np.array([0.0, 1.0, 0.0])
    omega = rates[0] * axis + rates[1] * up + rates[2] * level
    lowest = -radius * up
    coin = fm.space.Rotor(
        "coin",
        mass=mass,
        inertia_across=mass * radius**2 / 4,
        inertia_axial=mass * radius**2 / 2,
        position=(0.0, 0.0, radius * sin(angle)),
        axis=axis,
        angular_velocity=omega,
        velocity=-np.cross(omega, lowest),
    )
    friction = law or fm.laws.Coulomb(mu_s=mu)
    floor = fm.space.OnPlane("floor", coin, normal=(0, 0, 1), radius=radius, push_only=True, friction=friction)
    return fm.Scene("rolling coin", [coin, floor, fm.Gravity("gravity", acceleration={"z": -gravity})], units=SI)
