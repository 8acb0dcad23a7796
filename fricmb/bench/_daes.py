"""Classical differential-algebraic equations of index 1, with the published digits at their end; one is a mechanism.

Test Set for Initial Value Problem Solvers, release 2.4 (F. Mazzia, C. Magherini, University of Bari, 2008): equations
and reference solutions.  ``residual(t, y, yp, out)`` is compiled.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import fricmb as fm
from fricmb.bench import _andrews, _heavy_top
from fricmb.bench._reference import Floats
from fricmb.integrate.compile.kernel import entry


@dataclass(frozen=True, kw_only=True, eq=False)
class DaeCase:
    """An implicit equation ``residual(t, y, yp) = 0``; ``end`` is the solution at ``t_end``, ``size`` its scales.

    ``quick``: part of the quick suite.  ``algebraic``: components without a derivative.  ``compared``: number of
    components whose end is known (None: all).  ``scene`` builds the mechanism that the equation describes, and ``read``
    takes the compared components from its solution.  ``rates(t, y, out)``: the same as an explicit equation, where it
    is one.
    """

    name: str
    title: str
    residual: Callable[[float, Floats, Floats, Floats], None]
    t_end: float
    y0: Floats
    yp0: Floats
    end: Floats
    size: Floats
    algebraic: tuple[int, ...] = ()
    quick: bool = False
    compared: int | None = None
    scene: Callable[[], fm.Scene] | None = None
    read: Callable[[Any], Floats] | None = None
    rates: Callable[[float, Floats, Floats], None] | None = None
    source: str = "Test Set for IVP Solvers, release 2.4"


@entry
def robertson(t: float, y: Floats, yp: Floats, out: Floats) -> None:
    """Three reactions; the sum of concentrations stands for the third equation."""
    slow, fast = -0.04 * y[0] + 1e4 * y[1] * y[2], 3e7 * y[1] ** 2
    out[0] = yp[0] - slow
    out[1] = yp[1] + slow + fast
    out[2] = y[0] + y[1] + y[2] - 1.0


@entry
def akzo_nobel(t: float, y: Floats, yp: Floats, out: Floats) -> None:
    """Five reactions and an equilibrium."""
    root = math.sqrt(y[1]) if y[1] >= 0.0 else math.nan
    r1, r2, r3 = 18.7 * y[0] ** 4 * root, 0.58 * y[2] * y[3], 0.58 / 34.4 * y[0] * y[4]
    r4, r5 = 0.09 * y[0] * y[3] ** 2, 0.42 * y[5] ** 2 * root
    inflow = 3.3 * (0.9 / 737.0 - y[1])
    out[0] = yp[0] + 2.0 * r1 - r2 + r3 + r4
    out[1] = yp[1] + 0.5 * r1 + r4 + 0.5 * r5 - inflow
    out[2] = yp[2] - r1 + r2 - r3
    out[3] = yp[3] + r2 - r3 + 2.0 * r4
    out[4] = yp[4] - r2 + r3 - r5
    out[5] = 115.83 * y[0] * y[3] - y[5]


@entry
def transistor_amplifier(t: float, y: Floats, yp: Floats, out: Floats) -> None:
    """Eight nodes; the charges between nodes make dF/dyp singular without a zero column."""
    if max(y[1] - y[2], y[4] - y[5]) > 10.0:
        out[:] = math.nan
        return
    i1, i2 = 1e-6 * (math.exp((y[1] - y[2]) / 0.026) - 1.0), 1e-6 * (math.exp((y[4] - y[5]) / 0.026) - 1.0)
    r, ub, u_in = 9000.0, 6.0, 0.1 * math.sin(200.0 * math.pi * t)
    q1, q3, q5 = 1e-6 * (yp[1] - yp[0]), 3e-6 * (yp[4] - yp[3]), 5e-6 * (yp[7] - yp[6])
    out[0] = q1 + (u_in - y[0]) / 1000.0
    out[1] = -q1 + (ub - 2.0 * y[1]) / r - 0.01 * i1
    out[2] = -2e-6 * yp[2] + i1 - y[2] / r
    out[3] = q3 + (ub - y[3]) / r - 0.99 * i1
    out[4] = -q3 + (ub - 2.0 * y[4]) / r - 0.01 * i2
    out[5] = -4e-6 * yp[5] + i2 - y[5] / r
    out[6] = q5 + (ub - y[6]) / r - 0.99 * i2
    out[7] = -q5 - y[7] / r


@entry
def ring_modulator(t: float, y: Floats, yp: Floats, out: Floats) -> None:
    """Fifteen voltages and currents, with capacities of 2e-12: oscillation at several frequencies."""
    u1, u2 = 0.5 * math.sin(2e3 * math.pi * t), 2.0 * math.sin(2e4 * math.pi * t)
    a, b = y[2] - y[4] - y[6] - u2, -y[3] + y[5] - y[6] - u2
    c, d = y[3] + y[4] + y[6] + u2, -y[2] - y[5] + y[6] + u2
    if max(a, b, c, d) > 15.0:
        out[:] = math.nan
        return
    g, e = 40.67286402e-9, 17.7493332
    q1, q2 = g * (math.exp(e * a) - 1.0), g * (math.exp(e * b) - 1.0)
    q3, q4 = g * (math.exp(e * c) - 1.0), g * (math.exp(e * d) - 1.0)
    out[0] = 1.6e-8 * yp[0] - (y[7] - 0.5 * y[9] + 0.5 * y[10] + y[13] - y[0] / 25e3)
    out[1] = 1.6e-8 * yp[1] - (y[8] - 0.5 * y[11] + 0.5 * y[12] + y[14] - y[1] / 25e3)
    out[2] = 2e-12 * yp[2] - (y[9] - q1 + q4)
    out[3] = 2e-12 * yp[3] - (-y[10] + q2 - q3)
    out[4] = 2e-12 * yp[4] - (y[11] + q1 - q3)
    out[5] = 2e-12 * yp[5] - (-y[12] - q2 + q4)
    out[6] = 1e-8 * yp[6] - (-y[6] / 50.0 + q1 + q2 - q3 - q4)
    out[7] = 4.45 * yp[7] + y[0]
    out[8] = 4.45 * yp[8] + y[1]
    out[9] = 5e-4 * yp[9] - (0.5 * y[0] - y[2] - 17.3 * y[9])
    out[10] = 5e-4 * yp[10] - (-0.5 * y[0] + y[3] - 17.3 * y[10])
    out[11] = 5e-4 * yp[11] - (0.5 * y[1] - y[4] - 17.3 * y[11])
    out[12] = 5e-4 * yp[12] - (-0.5 * y[1] + y[5] - 17.3 * y[12])
    out[13] = 0.002 * yp[13] - (-y[0] + u1 - 86.3 * y[13])
    out[14] = 0.002 * yp[14] - (-y[1] - 636.3 * y[14])


def _akzo_start() -> tuple[Floats, Floats]:
    y = np.array([0.444, 0.00123, 0.0, 0.007, 0.0, 115.83 * 0.444 * 0.007])
    rate = np.empty(6)
    akzo_nobel(0.0, y, np.zeros(6), rate)
    rate = -rate
    rate[5] = 115.83 * (rate[0] * y[3] + y[0] * rate[3])
    return y, rate


def _transistor_start() -> tuple[Floats, Floats]:
    """The node equations without charges, differentiated; g is the slope of the diodes at 0 V."""
    g, r = 1e-6 / 0.026, 9000.0
    d3, d6 = -3.0 / r / 2e-6, -3.0 / r / 4e-6
    d1 = (0.1 * 200.0 * math.pi / 1000.0 + 0.01 * g * d3) / (1.0 / 1000.0 + 2.0 / r + 0.01 * g)
    d4 = (-0.99 * g * (d1 - d3) + 0.01 * g * d6) / (3.0 / r + 0.01 * g)
    d7 = -0.99 * g * (d4 - d6) / (2.0 / r)
    return np.array([0.0, 3.0, 3.0, 6.0, 3.0, 3.0, 6.0, 0.0]), np.array([d1, d1, d3, d4, d4, d6, d7, d7])


_AKZO_END = (
    0.1150794920661702, 0.1203831471567715e-2, 0.1611562887407974, 0.3656156421249283e-3, 0.1708010885264404e-1,
    0.4873531310307455e-2,
)  # fmt: skip
_TRANSISTOR_END = (
    -0.5562145012262709e-2, 0.3006522471903042e1, 0.2849958788608128e1, 0.2926422536206241e1, 0.2704617865010554e1,
    0.2761837778393145e1, 0.4770927631616772e1, 0.1236995868091548e1,
)  # fmt: skip
_RING_END = (
    -0.2339057358486745e-1, -0.7367485485540825e-2, 0.2582956709291169, -0.4064465721283450, -0.4039455665149794,
    0.2607966765422943, 0.1106761861269975, 0.2939904342435596e-6, -0.2840029933642329e-7, 0.7267198267264553e-3,
    0.7929487196960840e-3, -0.7255283495698965e-3, -0.7941401968526521e-3, 0.7088495416976114e-4,
    0.2390059075236570e-4,
)  # fmt: skip
_ROBERTSON_END = (0.2083340149701255e-7, 0.8333360770334713e-13, 0.9999999791665050)


def dae_cases() -> tuple[DaeCase, ...]:
    """The cases; a function, because two starts are computed with compiled residuals."""
    akzo, transistor, mechanism = _akzo_start(), _transistor_start(), _andrews.start()
    top = _heavy_top.start()
    ends = [np.array(end) for end in (_ROBERTSON_END, _AKZO_END, _TRANSISTOR_END, _RING_END)]
    return (
        DaeCase(
            name="robertson", title="Robertson to t = 1e11", residual=robertson, t_end=1e11,
            y0=np.array([1.0, 0.0, 0.0]), yp0=np.array([-0.04, 0.04, 0.0]), end=ends[0], size=np.abs(ends[0]),
            algebraic=(2,), quick=True,
        ),
        DaeCase(
            name="akzo_nobel", title="chemical Akzo Nobel", residual=akzo_nobel, t_end=180.0, y0=akzo[0], yp0=akzo[1],
            end=ends[1], size=np.abs(ends[1]), algebraic=(5,), quick=True,
        ),
        DaeCase(
            name="transistor", title="transistor amplifier", residual=transistor_amplifier, t_end=0.2,
            y0=transistor[0], yp0=transistor[1], end=ends[2], size=np.abs(ends[2]),
        ),
        DaeCase(
            name="ring_modulator", title="ring modulator", residual=ring_modulator, t_end=1e-3, y0=np.zeros(15),
            yp0=np.array([0.0] * 15), end=ends[3], size=np.abs(ends[3]),
        ),
        DaeCase(
            name="andrews", title="Andrews' mechanism", residual=_andrews.andrews, t_end=0.03, y0=mechanism[0],
            yp0=mechanism[1], end=np.array(_andrews.END), compared=14, algebraic=tuple(range(14, 27)), quick=True,
            size=np.array([*np.abs(_andrews.END), *np.abs(mechanism[0][14:21]).clip(1e4), *[100.0] * 6]),
            scene=fm.models.andrews, read=_andrews.angles,
        ),
        DaeCase(
            name="heavy_top", title="heavy top in Euler's angles, and as a body in space", t_end=1.0, y0=top[0],
            yp0=top[1], residual=_heavy_top.residual, rates=_heavy_top.rates, end=np.array(_heavy_top.END), compared=2,
            size=np.array([0.5, 8.0, 100.0, 10.0, 20.0, 120.0]), scene=fm.models.heavy_top, read=_heavy_top.angles,
            source="E. T. Whittaker, Analytical Dynamics, art. 71",
        ),
    )  # fmt: skip
