"""Lagrange's top in Euler's angles, as one writes it by hand: nutation theta, precession phi, own turn psi.

With ``A1 = A + m l^2`` and ``w = psi' + phi' cos(theta)``, which stays what it is (Whittaker, Analytical Dynamics,
art. 71):

    A1 theta'' = A1 phi'^2 sin(theta) cos(theta) - C w phi' sin(theta) + m g l sin(theta)
    A1 phi'' sin(theta) = C w theta' - 2 A1 theta' phi' cos(theta)
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fricmb.bench._reference import Floats
from fricmb.integrate.compile.kernel import entry

MASS, REACH, ACROSS, AXIAL, GRAVITY = 0.5, 0.04, 2e-4, 2.5e-4, 9.81
START = (0.4, 0.0, 0.0, 0.0, 0.0, 120.0)
#: Nutation and precession after a second, certified to 2e-14: four programs, one of them in elliptic functions.
END = (0.56819256502667, 8.44014126525304)


@entry
def rates(t: float, y: Floats, out: Floats) -> None:
    """Rates of theta, phi, psi, theta', phi', psi'."""
    theta, theta_rate, phi_rate, psi_rate = y[0], y[3], y[4], y[5]
    s, c, whole = math.sin(theta), math.cos(theta), ACROSS + MASS * REACH**2
    spin = AXIAL * (psi_rate + phi_rate * c)
    turn = (spin * theta_rate - 2.0 * whole * theta_rate * phi_rate * c) / (whole * s)
    out[0] = theta_rate
    out[1] = phi_rate
    out[2] = psi_rate
    out[3] = s * (phi_rate**2 * c + (MASS * GRAVITY * REACH - spin * phi_rate) / whole)
    out[4] = turn
    out[5] = phi_rate * theta_rate * s - turn * c


@entry
def residual(t: float, y: Floats, yp: Floats, out: Floats) -> None:
    """What is left of the same."""
    rates(t, y, out)
    for i in range(6):
        out[i] = yp[i] - out[i]


def start() -> tuple[Floats, Floats]:
    """State and rates at the start."""
    y, rate = np.array(START), np.empty(6)
    rates(0.0, y, rate)
    return y, rate


def angles(sol: Any) -> Floats:
    """Nutation and precession at the end of a run of the model; the turns that precession has gone are known."""
    x, y, z = sol["top.axis"][:, -1]
    turned = math.atan2(y, x)
    return np.array([math.acos(z), turned + 2.0 * math.pi * round((END[1] - turned) / (2.0 * math.pi))])
