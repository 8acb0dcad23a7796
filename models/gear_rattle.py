"""A loose gear that rattles in its play."""

from __future__ import annotations

import sympy

import fricmb as fm
from fricmb.values import SI

from ._arguments import check_positive, checked


@checked
def gear_rattle(
    *,
    inertia: float = 1e-3,
    radius: float = 0.05,
    amplitude: float = 2e-3,
    frequency: float = 200.0,
    gap: float = 2e-3,
    restitution: float = 0.5,
    torque: float = 0.01,
) -> fm.Scene:
    """Gear rattle: a wheel that oscillates throws a loose gear on a dry shaft from flank to flank of its teeth.

    SI units.  The mean rotation of a gear box is left out: both wheels turn about it.

    Parameters
    ----------
    inertia : float
        Of the loose gear about its shaft.
    radius : float
        Of both wheels.
    amplitude, frequency : float
        Of the angle of the driving wheel, ``amplitude sin(frequency t)``.
    gap : float
        Angle through which the gear turns from one flank to the other.
    restitution : float
        Of the flanks, from 0 to 1.
    torque : float
        Dry friction of the shaft.

    Returns
    -------
    Scene
        Bodies drive and gear, stop mesh, dry friction shaft.

    Notes
    -----
    F. Pfeiffer, C. Glocker, Multibody Dynamics with Unilateral Contacts, Wiley 1996.  At rest in the middle at first,
    the gear is struck at ``sin(frequency t) = gap/(2 amplitude)`` and leaves with ``1 + restitution`` times the speed
    of the drive.  While ``torque < inertia amplitude frequency^2`` it leaves a flank that has driven it before the
    drive turns round.
    """
    check_positive("gear_rattle", radius=radius, inertia=inertia)
    drive = fm.RigidBody("drive", mass=1.0, inertia=inertia, angular_velocity=amplitude * frequency)
    gear = fm.RigidBody("gear", mass=1.0, inertia=inertia, position=(2.0 * radius, 0.0))
    return fm.Scene(
        "gear rattle",
        [
            drive,
            gear,
            fm.Revolute("hub", drive),
            fm.Revolute("bearing", gear, fm.ground_point(2.0 * radius, 0.0)),
            fm.DrivenAngle("motor", drive, angle=amplitude * sympy.sin(frequency * fm.t)),
            fm.Backlash("mesh", drive, gear, ratio=1.0, gap=gap, restitution=restitution),
            fm.DryFriction("shaft", gear, axis="angle", static=torque),
        ],
        units=SI,
    )
