"""A drive train that sticks and slips."""

from __future__ import annotations

import fricmb as fm
from fricmb.values import SI

from ._arguments import checked


@checked
def drive_train(
    *,
    speed: float = 3.0,
    ratio: float = 2.0,
    inertia: float = 0.4,
    mass: float = 60.0,
    radius: float = 0.03,
    stiffness: float = 25.0,
    damping: float = 0.05,
    mu_s: float = 0.35,
    mu_k: float = 0.2,
    gravity: float = 9.81,
    law: fm.FrictionLaw | None = None,
) -> fm.Scene:
    """Drive train: a motor, a gear, a soft shaft and a heavy disc in a dry bearing, which sticks and slips.

    SI units.

    Parameters
    ----------
    speed : float
        Of the motor.
    ratio : float
        The motor turns that much faster than the shaft, the other way round.
    inertia, mass : float
        Of the disc.
    radius : float
        Of its journal.
    stiffness, damping : float
        Of the shaft, in torsion.
    mu_s, mu_k : float
        In the journal, unless ``law`` is given.
    gravity : float
    law : FrictionLaw, optional

    Returns
    -------
    Scene
        Bodies motor, wheel (behind the gear), disc; joint and contact bearing.

    Notes
    -----
    The bearing carries the weight of the disc: the twist of the shaft is the friction oscillator with normal force
    ``mass gravity`` on a belt that moves at ``radius speed/ratio``.
    """
    if ratio == 0.0:
        raise fm.SceneError("drive_train: ratio must be a finite number other than 0; got 0")
    motor = fm.RigidBody("motor", mass=1.0, inertia=0.01, angular_velocity=-speed)
    wheel = fm.RigidBody("wheel", mass=1.0, inertia=0.02, angular_velocity=speed / ratio)
    disc = fm.RigidBody("disc", mass=mass, inertia=inertia)
    friction = law or fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k)
    return fm.Scene(
        "drive train",
        [
            motor,
            wheel,
            disc,
            fm.Revolute("motor bearing", motor),
            fm.Revolute("wheel bearing", wheel),
            fm.Revolute("bearing", disc, radius=radius, friction=friction),
            fm.DrivenAngle("drive", motor, speed=-speed),
            fm.Gear("gear", wheel, motor, ratio=1.0 / ratio),
            fm.TorsionSpring("shaft", disc, wheel, stiffness=stiffness),
            fm.TorsionDamper("loss", disc, wheel, damping=damping),
            fm.Gravity("gravity", acceleration={"y": -gravity}),
        ],
        units=SI,
    )
