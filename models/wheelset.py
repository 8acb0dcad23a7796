"""A railway wheelset on its suspension, which hunts."""

from __future__ import annotations

import fricmb as fm
from fricmb.values import SI

from ._arguments import check_positive, checked


@checked
def wheelset(
    *,
    mass: float = 1250.0,
    inertia: float = 700.0,
    inertia_axial: float = 110.0,
    half_gauge: float = 0.75,
    radius: float = 0.45,
    conicity: float = 0.05,
    f11: float = 8e6,
    f22: float = 7e6,
    mu: float = 0.3,
    stiffness: float = 3e5,
    yaw_stiffness: float = 1.5e6,
    load: float = 120e3,
    speed: float = 120.0,
    kick: float = 0.01,
    law: fm.FrictionLaw | None = None,
) -> fm.Scene:
    """Wheelset: conical wheels on rails steer it, and beyond 89 m/s let it hunt until creepage saturates.

    SI units; x along the rails, y to the left, z upwards.  The rails pass below; ``speed`` and ``conicity`` are
    parameters of the scene.

    Parameters
    ----------
    mass : float
    inertia, inertia_axial : float
        About the vertical and about the axle.
    half_gauge : float
        From the middle of the axle to a wheel.
    radius : float
        Of rolling.
    conicity : float
        Of the wheels.
    f11, f22 : float
        Creep force per creepage of a wheel along the rail and across.
    mu : float
        Coefficient of friction at which creep saturates.
    stiffness : float
        Of the suspension, across.
    yaw_stiffness : float
        Of the suspension against yaw.
    load : float
        On both wheels together.
    speed : float
        Of the vehicle.
    kick : float
        Displacement to the left at the start.
    law : FrictionLaw, optional
        Of creep, instead of Shen, Hedrick and Elkins'.

    Returns
    -------
    Scene
        Rotor axle, joints and contacts left and right.

    Notes
    -----
    K. Knothe, S. Stichel, Rail Vehicle Dynamics, Springer 2017, chapter 9.  With y, yaw psi and creep linear:
    ``m y'' + ky y + 2 f22 (y'/V - psi) = 0`` and ``Iz psi'' + kpsi psi + 2 f11 a (a psi'/V + conicity y/r0) = 0``.
    """
    check_positive("wheelset", radius=radius)
    V, cone = fm.parameter("speed", speed), fm.parameter("conicity", conicity)
    axle = fm.space.Rotor(
        "axle",
        mass=mass,
        inertia_across=inertia,
        inertia_axial=inertia_axial,
        position=(0.0, kick, radius),
        axis=(0, 1, 0),
        spin=speed / radius,
        stations={"left": half_gauge, "right": -half_gauge, "front": 1.0, "back": -1.0},
    )
    creep = law or fm.space.ShenHedrickElkins(mu=mu, f11=f11, f22=f22, speed=V)
    wheels = [
        fm.space.WheelRail(
            name,
            axle.station(name),
            through=(0.0, y, 0.0),
            rolling_radius=radius,
            conicity=cone,
            speed=V,
            friction=creep,
        )
        for name, y in (("left", half_gauge), ("right", -half_gauge))
    ]
    suspension = [
        fm.Spring("across", axle, axis="y", stiffness=stiffness),
        *(fm.Spring(f"{end}_spring", axle.station(end), axis="x", stiffness=yaw_stiffness / 2)
          for end in ("front", "back")),
    ]  # fmt: skip
    return fm.Scene("wheelset", [axle, *wheels, *suspension, fm.Force("load", axle, axis="z", value=-load)], units=SI)
