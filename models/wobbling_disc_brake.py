"""A disc on an elastic bearing, wobbling between two pads."""

from __future__ import annotations

import fricmb as fm
from fricmb.values import SI

from ._arguments import checked


@checked
def wobbling_disc_brake(
    *,
    mass: float = 18.0,
    inertia: float = 0.16,
    inertia_axial: float = 0.32,
    thickness: float = 0.02,
    radius: float = 0.13,
    preload: float = 3e3,
    stiffness: float = 6e6,
    damping: float = 5.0,
    bearing_stiffness: float = 1.88e7,
    bearing_damping: float = 0.1,
    speed: float = 50.0,
    mu: float = 0.5,
    kick: float = 0.1,
    law: fm.FrictionLaw | None = None,
) -> fm.Scene:
    """Wobbling disc between two pads: friction that follows its faces lets it squeal beyond mu = 0.414.

    SI units; the axis is z.  The disc is driven at a constant angular velocity; ``speed`` and ``mu`` are parameters of
    the scene.  Two degrees of freedom are left: the tilts of the disc.  Growth is slow beside the wobble of 1.7 kHz,
    0.15 1/s at the default mu: runs of milliseconds show the wobble, ``fm.analysis.complex_eigenvalues`` the growth.

    Parameters
    ----------
    mass : float
        Of the disc; its centre rests.
    inertia, inertia_axial : float
        Of the disc, across its axis and about it.
    thickness : float
        Of the disc.
    radius : float
        Of the pads' places.
    preload, stiffness, damping : float
        Of each pad.
    bearing_stiffness, bearing_damping : float
        Of the bearing against tilt, torque by angle and by angular velocity.
    speed : float
        Angular velocity of the disc.
    mu : float
        Coefficient of friction of both pads, unless ``law`` is given.
    kick : float
        Rate of the tilt towards the pads at the start.
    law : FrictionLaw, optional

    Returns
    -------
    Scene
        Rotor disc, contacts upper and lower.

    Notes
    -----
    U. von Wagner, D. Hochlenert, P. Hagedorn, Minimal models for disk brake squeal, Journal of Sound and Vibration 302
    (2007) 527-539, section on the wobbling disc, with pads whose springs stand at right angles on the faces.  With the
    components a, b of the axis across z, Theta = inertia, C = inertia_axial, and N0, k, d those of a pad::

        Theta a'' + (d_t + 2 d r^2 + mu N0 h^2/(2 Omega r)) a' + C Omega b'
                  + (k_t + 2 k r^2 + N0 h) a + mu N0 h^2/(2 r) b = 0
        Theta b'' + d_t b' - (C Omega + mu d h r) a' + (k_t + N0 h) b - mu k h r a = 0
    """
    coefficient, Omega = fm.parameter("mu", mu), fm.parameter("speed", speed)
    arm = 0.1
    disc = fm.space.Rotor(
        "disc",
        mass=mass,
        inertia_across=inertia,
        inertia_axial=inertia_axial,
        angular_velocity=(0.0, kick, speed),
        stations={"front": arm, "back": -arm},
    )
    pads = [
        fm.space.Pad(
            name,
            disc,
            at=(radius, 0.0, side * thickness / 2),
            normal=(0, 0, side),
            preload=preload,
            stiffness=stiffness,
            damping=damping,
            friction=law or fm.laws.Coulomb(mu_s=coefficient),
        )
        for name, side in (("upper", 1.0), ("lower", -1.0))
    ]
    bearing = [
        part
        for letter in "xy"
        for end in ("front", "back")
        for part in (
            fm.Spring(f"{letter}_{end}", disc.station(end), axis=letter, stiffness=bearing_stiffness / (2 * arm**2)),
            fm.Damper(f"{letter}_{end}_loss", disc.station(end), axis=letter, damping=bearing_damping / (2 * arm**2)),
        )
    ]
    centre = fm.space.Spherical("centre", disc)
    drive = fm.space.DrivenSpin("drive", disc, speed=Omega)
    return fm.Scene("wobbling disc brake", [disc, centre, drive, *bearing, *pads], units=SI)
