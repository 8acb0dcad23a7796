"""Andrews' mechanism as an implicit equation in its seven joint angles, for solvers that know no bodies.

Unknowns [p (7), v (7), w (7), lam (6)]: angles, rates, accelerations and multipliers, with the constraints on the level
of accelerations (index 1).  Equations: Hairer and Wanner, Solving ODEs II (1996), VII.7, and problem "andrews" of the
Test Set for IVP Solvers, release 2.4 (Mazzia, Magherini 2008), which gives the solution at t = 0.03 to 16 digits.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fricmb.bench._reference import Floats
from fricmb.integrate.compile.kernel import entry

# geometry, masses and forces under their published names
_XA, _YA, _XB, _YB, _XC, _YC = -0.06934, -0.00227, -0.03635, 0.03273, 0.014, 0.072
_D, _DA, _E, _EA, _RR, _RA, _SS, _SA, _SB = 28e-3, 115e-4, 2e-2, 1421e-5, 7e-3, 92e-5, 35e-3, 1874e-5, 1043e-5
_SC, _SD, _TA, _TB, _U, _UA, _UB = 18e-3, 2e-2, 2308e-5, 916e-5, 4e-2, 1228e-5, 449e-5
_ZF, _ZT, _FA = 2e-2, 4e-2, 1421e-5
_M1, _M2, _M3, _M4, _M5, _M6, _M7 = 0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498
_I1, _I2, _I3, _I4, _I5, _I6, _I7 = 2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5
_MOM, _C0, _L0 = 0.033, 4530.0, 0.07785

#: Angles (beta, Theta, gamma, Phi, delta, Omega, epsilon) at t = 0, angles and rates at t = 0.03.
START = (
    -0.0617138900142764496358948458001, 0.0, 0.455279819163070380255912382449, 0.222668390165885884674473185609,
    0.487364979543842550225598953530, -0.222668390165885884674473185609, 1.23054744454982119249735015568,
)  # fmt: skip
END = (
    0.1581077119629904e2, -0.1575637105984298e2, 0.4082224013073101e-1, -0.5347301163226948, 0.5244099658805304,
    0.5347301163226948, 0.1048080741042263e1, 0.1139920302151208e4, -0.1424379294994111e4, 0.1103291221937134e2,
    0.1929337464421385e2, 0.5735699284790808, -0.1929337464421385e2, 0.3231791658026955,
)  # fmt: skip


@entry
def andrews(t: float, y: Floats, yp: Floats, out: Floats) -> None:
    """The 27 equations."""
    be, th, ga, ph, de, om, ep = y[0], y[1], y[2], y[3], y[4], y[5], y[6]
    bep, thp, gap, php, dep, omp, epp = y[7], y[8], y[9], y[10], y[11], y[12], y[13]
    w1, w2, w3, w4, w5, w6, w7 = y[14], y[15], y[16], y[17], y[18], y[19], y[20]
    l1, l2, l3, l4, l5, l6 = y[21], y[22], y[23], y[24], y[25], y[26]
    for i in range(7):
        out[i] = yp[i] - y[7 + i]
        out[7 + i] = yp[7 + i] - y[14 + i]
    sibe, cobe, sibeth, cobeth = math.sin(be), math.cos(be), math.sin(be + th), math.cos(be + th)
    siga, coga, siphde, cophde = math.sin(ga), math.cos(ga), math.sin(ph + de), math.cos(ph + de)
    side, code, siomep, coomep = math.sin(de), math.cos(de), math.sin(om + ep), math.cos(om + ep)
    siep, coep = math.sin(ep), math.cos(ep)
    sith, coth, siph, coph = math.sin(th), math.cos(th), math.sin(ph), math.cos(ph)
    siom, coom = math.sin(om), math.cos(om)
    xd, yd = _SD * coga + _SC * siga + _XB, _SD * siga - _SC * coga + _YB
    long = math.sqrt((xd - _XC) ** 2 + (yd - _YC) ** 2)
    pull = -_C0 * (long - _L0) / long
    fx, fy = pull * (xd - _XC), pull * (yd - _YC)
    # mass matrix times accelerations
    m21 = _M2 * (_DA**2 - _DA * _RR * coth) + _I2
    m54 = _M4 * ((_E - _EA) ** 2 + _ZT * (_E - _EA) * siph) + _I4
    m76 = _M6 * ((_ZF - _FA) ** 2 - _U * (_ZF - _FA) * siom) + _I6
    a1 = (_M1 * _RA**2 + _M2 * (_RR**2 - 2 * _DA * _RR * coth + _DA**2) + _I1 + _I2) * w1 + m21 * w2
    a2 = m21 * w1 + (_M2 * _DA**2 + _I2) * w2
    a3 = (_M3 * (_SA**2 + _SB**2) + _I3) * w3
    a4 = (_M4 * (_E - _EA) ** 2 + _I4) * w4 + m54 * w5
    m55 = _M4 * (_ZT**2 + 2 * _ZT * (_E - _EA) * siph + (_E - _EA) ** 2) + _M5 * (_TA**2 + _TB**2) + _I4 + _I5
    a5 = m54 * w4 + m55 * w5
    a6 = (_M6 * (_ZF - _FA) ** 2 + _I6) * w6 + m76 * w7
    m77 = _M6 * ((_ZF - _FA) ** 2 - 2 * _U * (_ZF - _FA) * siom + _U**2) + _M7 * (_UA**2 + _UB**2) + _I6 + _I7
    a7 = m76 * w6 + m77 * w7
    # forces
    f1 = _MOM - _M2 * _DA * _RR * thp * (thp + 2 * bep) * sith
    f2 = _M2 * _DA * _RR * bep**2 * sith
    f3 = fx * (_SC * coga - _SD * siga) + fy * (_SD * coga + _SC * siga)
    f4 = _M4 * _ZT * (_E - _EA) * dep**2 * coph
    f5 = -_M4 * _ZT * (_E - _EA) * php * (php + 2 * dep) * coph
    f6 = -_M6 * _U * (_ZF - _FA) * epp**2 * coom
    f7 = _M6 * _U * (_ZF - _FA) * omp * (omp + 2 * epp) * coom
    # gradients of the constraints
    x1, x2 = -_RR * sibe + _D * sibeth, _D * sibeth
    y1, y2 = _RR * cobe - _D * cobeth, -_D * cobeth
    gx3, gy3 = -_SS * coga, -_SS * siga
    gx4, gy4 = -_E * cophde, -_E * siphde
    gx5, gy5 = -_E * cophde + _ZT * side, -_E * siphde - _ZT * code
    gx6, gy6 = _ZF * siomep, -_ZF * coomep
    gx7, gy7 = _ZF * siomep - _U * coep, -_ZF * coomep - _U * siep
    out[14] = a1 - f1 + x1 * (l1 + l3 + l5) + y1 * (l2 + l4 + l6)
    out[15] = a2 - f2 + x2 * (l1 + l3 + l5) + y2 * (l2 + l4 + l6)
    out[16] = a3 - f3 + gx3 * l1 + gy3 * l2
    out[17] = a4 - f4 + gx4 * l3 + gy4 * l4
    out[18] = a5 - f5 + gx5 * l3 + gy5 * l4
    out[19] = a6 - f6 + gx6 * l5 + gy6 * l6
    out[20] = a7 - f7 + gx7 * l5 + gy7 * l6
    # second derivatives of the constraints
    cx = -_RR * cobe * bep**2 + _D * cobeth * (bep + thp) ** 2 + x1 * w1 + x2 * w2
    cy = -_RR * sibe * bep**2 + _D * sibeth * (bep + thp) ** 2 + y1 * w1 + y2 * w2
    out[21] = cx + _SS * siga * gap**2 + gx3 * w3
    out[22] = cy - _SS * coga * gap**2 + gy3 * w3
    out[23] = cx + _E * siphde * (php + dep) ** 2 + _ZT * code * dep**2 + gx4 * w4 + gx5 * w5
    out[24] = cy - _E * cophde * (php + dep) ** 2 + _ZT * side * dep**2 + gy4 * w4 + gy5 * w5
    out[25] = cx + _ZF * coomep * (omp + epp) ** 2 + _U * siep * epp**2 + gx6 * w6 + gx7 * w7
    out[26] = cy + _ZF * siomep * (omp + epp) ** 2 - _U * coep * epp**2 + gy6 * w6 + gy7 * w7


def start() -> tuple[Floats, Floats]:
    """Values and rates at the start, at rest; accelerations and multipliers solve the last 13 equations."""
    y = np.zeros(27)
    y[:7] = START
    rest, out = np.zeros(27), np.zeros(27)
    andrews(0.0, y, rest, rest)
    A = np.zeros((13, 13))
    for j in range(13):
        unit = y.copy()
        unit[14 + j] = 1.0
        andrews(0.0, unit, np.zeros(27), out)
        A[:, j] = out[14:] - rest[14:]
    y[14:] = np.linalg.solve(A, -rest[14:])
    rate = np.zeros(27)
    rate[7:14] = y[14:21]
    return y, rate


def angles(sol: Any) -> Floats:
    """The published angles and their rates at the end of a run of ``fm.models.andrews()``."""
    found: list[float] = []
    for of in (sol.__getitem__, sol.velocity):
        k = [0.0, *(float(of(f"K{i}.angle")[-1]) for i in range(1, 8))]
        found += [k[1], k[2] - k[1], k[3], k[4] - k[5], k[5], k[6] - k[7], k[7]]
    return np.array(found)
