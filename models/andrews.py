"""Andrews' squeezing mechanism."""

from __future__ import annotations

from math import cos, sin

import fricmb as fm
from fricmb.values import SI

from ._arguments import checked

#: Joint coordinates (beta, Theta, gamma, Phi, delta, Omega, epsilon) at the start, as published.
START = (
    -0.0617138900142764496358948458001,
    0.0,
    0.455279819163070380255912382449,
    0.222668390165885884674473185609,
    0.487364979543842550225598953530,
    -0.222668390165885884674473185609,
    1.23054744454982119249735015568,
)
_A, _B, _C = (-0.06934, -0.00227), (-0.03635, 0.03273), (0.014, 0.072)
_MASS = (0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498)
_INERTIA = (2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5)
_D, _DA, _E, _EA, _RR, _RA, _SS = 28e-3, 115e-4, 2e-2, 1421e-5, 7e-3, 92e-5, 35e-3
_SA, _SB, _SC, _SD, _TA, _TB, _U, _UA, _UB = 1874e-5, 1043e-5, 18e-3, 2e-2, 2308e-5, 916e-5, 4e-2, 1228e-5, 449e-5
_ZF, _ZT, _FA = 2e-2, 4e-2, 1421e-5

_Pair = tuple[float, float]


def _turned(angle: float, offset: _Pair) -> _Pair:
    c, s = cos(angle), sin(angle)
    return c * offset[0] - s * offset[1], s * offset[0] + c * offset[1]


def _body(name: str, number: int, angle: float, hinge: _Pair, at: _Pair, points: dict[str, _Pair]) -> fm.RigidBody:
    """A body whose point ``at`` (from its centre of mass) is at ``hinge``."""
    x, y = _turned(angle, at)
    return fm.RigidBody(
        name,
        mass=_MASS[number - 1],
        inertia=_INERTIA[number - 1],
        position=(hinge[0] - x, hinge[1] - y),
        angle=angle,
        points=points,
    )


@checked
def andrews(*, torque: float = 0.033, stiffness: float = 4530.0, friction: fm.FrictionLaw | None = None) -> fm.Scene:
    """Andrews' squeezing mechanism: seven bodies, ten pins, one spring, driven by a constant torque.

    SI units.

    Parameters
    ----------
    torque : float
        Drives the crank K1.
    stiffness : float
        Of the spring.
    friction : FrictionLaw, optional
        In the pin of the crank, of radius 1 mm.

    Returns
    -------
    Scene
        Bodies K1 to K7.  The published angles are beta = K1.angle, Theta = K2.angle - K1.angle, gamma = K3.angle,
        Phi = K4.angle - K5.angle, delta = K5.angle, Omega = K6.angle - K7.angle, epsilon = K7.angle.

    Notes
    -----
    E. Hairer, G. Wanner, Solving Ordinary Differential Equations II (1996), VII.7; problem "andrews" of the Test
    Set for IVP Solvers (Mazzia, Magherini 2008), which gives the solution at t = 0.03 s to 16 digits.
    """
    beta, theta, gamma, phi, delta, omega, epsilon = START
    tip = _turned(beta, (_RR, 0.0))
    x, y = _turned(beta + theta, (-_D, 0.0))
    F = tip[0] + x, tip[1] + y
    bodies = [
        _body("K1", 1, beta, (0.0, 0.0), (-_RA, 0.0), {"pin": (-_RA, 0.0), "tip": (_RR - _RA, 0.0)}),
        _body("K2", 2, beta + theta, tip, (_DA, 0.0), {"pin": (_DA, 0.0), "F": (_DA - _D, 0.0)}),
        _pivoted("K3", 3, gamma, _B, (_SA, _SB), {"F": (0.0, -_SS), "spring": (_SD, -_SC)}),
        _body("K4", 4, phi + delta, F, (0.0, -_EA), {"F": (0.0, -_EA), "pin": (0.0, _E - _EA)}),
        _pivoted("K5", 5, delta, _A, (_TA, _TB), {"tip": (_ZT, 0.0)}),
        _body("K6", 6, omega + epsilon, F, (_FA, 0.0), {"F": (_FA, 0.0), "pin": (_FA - _ZF, 0.0)}),
        _pivoted("K7", 7, epsilon, _A, (_UA, _UB), {"tip": (0.0, -_U)}),
    ]
    return fm.Scene("andrews", [*bodies, *_joints(bodies, friction), *_forces(bodies, torque, stiffness)], units=SI)


def _pivoted(name: str, number: int, angle: float, at: _Pair, centre: _Pair, points: dict[str, _Pair]) -> fm.RigidBody:
    """A body that turns about ``at``; centre of mass and points counted from there in its axes."""
    back = (-centre[0], -centre[1])
    shifted = {point: (x - centre[0], y - centre[1]) for point, (x, y) in points.items()}
    return _body(name, number, angle, at, back, {"pin": back, **shifted})


def _joints(bodies: list[fm.RigidBody], friction: fm.FrictionLaw | None) -> list[fm.Revolute]:
    k1, k2, k3, k4, k5, k6, k7 = bodies
    A, B = fm.ground_point(*_A), fm.ground_point(*_B)
    radius = 1e-3 if friction is not None else 0.0
    return [
        fm.Revolute("O", k1.point("pin"), fm.ground_point(0.0, 0.0), radius=radius, friction=friction),
        fm.Revolute("crank", k2.point("pin"), k1.point("tip")),
        fm.Revolute("B", k3.point("pin"), B),
        fm.Revolute("A5", k5.point("pin"), A),
        fm.Revolute("A7", k7.point("pin"), A),
        fm.Revolute("F3", k3.point("F"), k2.point("F")),
        fm.Revolute("F4", k4.point("F"), k2.point("F")),
        fm.Revolute("F6", k6.point("F"), k2.point("F")),
        fm.Revolute("E", k4.point("pin"), k5.point("tip")),
        fm.Revolute("G", k6.point("pin"), k7.point("tip")),
    ]


def _forces(bodies: list[fm.RigidBody], torque: float, stiffness: float) -> list[fm.Element]:
    return [
        fm.PointSpring("spring", bodies[2].point("spring"), stiffness=stiffness, length=7785e-5, anchor=_C),
        fm.Torque("motor", bodies[0], value=torque),
    ]
