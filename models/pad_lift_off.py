"""A pad that lifts off a rotor whose surface is wavy."""

from __future__ import annotations

import sympy

import fricmb as fm
from fricmb.values import SI

from ._arguments import checked


@checked
def pad_lift_off(
    *,
    mass: float = 0.5,
    stiffness: float = 2e4,
    damping: float = 10.0,
    guide_stiffness: float = 2e5,
    guide_damping: float = 50.0,
    preload: float = 30.0,
    waviness: float = 2e-4,
    frequency: float = 600.0,
    speed: float = 5.0,
    mu: float = 0.4,
    restitution: float = 0.3,
) -> fm.Scene:
    """Pad that lifts off: a wavy rotor throws it up, its spring brings it back by impacts.

    SI units.

    Parameters
    ----------
    mass : float
    stiffness, damping, preload : float
        Of the spring that presses the pad on the rotor, across it.
    guide_stiffness, guide_damping : float
        Of the guide that keeps the pad from going with the rotor.
    waviness, frequency : float
        Of the rotor's surface under the pad, ``waviness sin(frequency t)``.
    speed : float
        Of the rotor's surface.
    mu : float
        Coefficient of friction, in impacts too.
    restitution : float
        From 0 to 1.

    Returns
    -------
    Scene
        Body pad, driven body rotor, joint lining with friction.

    Notes
    -----
    A test problem of this project.  In touch the pad presses with ``preload`` plus ``(stiffness - mass frequency^2)
    waviness sin(frequency t)`` plus ``damping waviness frequency cos(frequency t)``, and lifts off where that is 0.
    """
    pad = fm.Body("pad", mass=mass, axes="xy", velocity={"y": waviness * frequency})
    rotor = fm.Driven("rotor", velocity={"x": speed}, position={"y": waviness * sympy.sin(frequency * fm.t)})
    return fm.Scene(
        "pad that lifts off",
        [
            pad,
            rotor,
            fm.Spring("spring", pad, axis="y", stiffness=stiffness),
            fm.Damper("damper", pad, axis="y", damping=damping),
            fm.Spring("guide", pad, axis="x", stiffness=guide_stiffness),
            fm.Damper("guide damper", pad, axis="x", damping=guide_damping),
            fm.Force("preload", pad, axis="y", value=-preload),
            fm.RollerOnLine(
                "lining", pad, rotor, push_only=True, restitution=restitution, friction=fm.laws.Coulomb(mu_s=mu)
            ),
        ],
        units=SI,
    )
