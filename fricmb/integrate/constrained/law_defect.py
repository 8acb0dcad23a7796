"""Smooth laws of a mechanism between the stages of a step: a kink, or a turn of the law that all stages have missed.

As in ``step.law_defect``: the polynomials of a step are right at its stages, and half-way between these the law is
asked again.  What its force and its rates are off, times the width of the gap, is an error of velocities and states
that the Legendre series of velocities need not show.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.template import call
from fricmb.integrate.constrained.forces import forces, move
from fricmb.integrate.constrained.moving import Moving
from fricmb.integrate.constrained.problem_structs import Mech
from fricmb.integrate.constrained.radau_step import Control
from fricmb.integrate.constrained.slip_rows import lightness
from fricmb.integrate.constrained.stages import Stages
from fricmb.integrate.constrained.state import State
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, Floats, Floats2, Ints
from fricmb.integrate.step.law_defect import between, counted_force, counted_rate


@kernel
def ask(mech: Mech, k: Moving, y: State, st: Stages, p: int, line: Floats) -> None:
    """Ask the law of port p at a point of the step's polynomials: arguments in ``s.x``, answers in ``s.out``.

    ``line``: weights of the values at the start and the stages.
    """
    port, s = mech.port, k.s
    row0, z0 = port.row[p], port.z_start[p]
    d, nz = port.row[p + 1] - row0, port.z_start[p + 1] - z0
    for a in range(d):
        s.x[a] = between(line, y.g[row0 + a], st.g, row0 + a)
    load = between(line, y.N[p], st.N, p)
    s.x[d] = load if port.joint[p] >= 0 else max(load, 0.0)
    for a in range(nz):
        s.x[d + 1 + a] = between(line, y.z[z0 + a], st.Z, z0 + a)
    call(port.laws.address[p], s.x, 0, port.laws.p, port.laws.p_start[p], s.out, 0)


@kernel
def largest_in_step(start: float, values: Floats2, column: int) -> float:
    """The largest magnitude of a quantity within a step."""
    size = abs(start)
    for i in range(values.shape[0]):
        size = max(size, abs(values[i, column]))
    return float(size)


@kernel
def put_rates(mech: Mech, k: Moving, y: State, st: Stages, p: int, rates: Floats2, h: float) -> None:
    """Rates of the states of port p at the start of the step and at its stages, into ``rates`` (s+1, n_z)."""
    port, s = mech.port, k.s
    row0, z0 = port.row[p], port.z_start[p]
    d, nz = port.row[p + 1] - row0, port.z_start[p + 1] - z0
    for a in range(d):
        s.x[a] = y.g[row0 + a]
    s.x[d] = y.N[p] if port.joint[p] >= 0 else max(y.N[p], 0.0)
    for a in range(nz):
        s.x[d + 1 + a] = y.z[z0 + a]
    call(port.laws.address[p], s.x, 0, port.laws.p, port.laws.p_start[p], s.out, 0)
    for a in range(nz):
        rates[0, z0 + a] = s.out[d + a]
        for i in range(st.Z.shape[0]):
            value = 0.0
            for j in range(st.Z.shape[0]):
                value += st.Ainv[i, j] * (st.Z[j, z0 + a] - y.z[z0 + a])
            rates[i + 1, z0 + a] = value / h


@kernel
def bring_up_to_date(mech: Mech, k: Moving, y: State, st: Stages, h: float) -> bool:
    """Slip velocities and loads at the stages after the last of Newton's changes; False where no law is smooth."""
    smooth = False
    for p in range(y.mode.shape[0]):
        smooth = smooth or mech.port.law[p] == LAW_SMOOTH
    for i in range(st.tab.c.shape[0] if smooth else 0):
        move(mech, k, y.t[0] + st.tab.c[i] * h, st.Q[i], st.V[i], mech.address)
        forces(mech, k, st.lam[i], st.F[i], 0, 0, st.N[i], st.g[i], mech.address)
    return smooth


@block
def law_defect(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float, address: Ints) -> float:
    """Largest error of a velocity or a state, by its own scale, that smooth laws leave between the stages."""
    port, tab = mech.port, st.tab
    worst = 0.0
    if not bring_up_to_date(mech, k, y, st, h):
        return worst
    for i in range(y.v.shape[0]):
        c.inertia[i] = (c.mass[i] * st.scale[i]) ** 2
    for p in range(y.mode.shape[0]):
        if port.law[p] != LAW_SMOOTH:
            continue
        row0, z0 = port.row[p], port.z_start[p]
        d, nz = port.row[p + 1] - row0, port.z_start[p + 1] - z0
        for a in range(d):
            # what a unit of force does to the slip velocity, and to the velocities over their scales
            st.x[2 * a] = lightness(mech, k, p, a, y.lam, mech.mass, mech.address)
            st.x[2 * a + 1] = np.sqrt(lightness(mech, k, p, a, y.lam, c.inertia, mech.address))
        if nz > 0:
            put_rates(mech, k, y, st, p, c.rates, h)
        for j in range(tab.c.shape[0]):
            gap = h * (tab.c[j] - (tab.c[j - 1] if j > 0 else 0.0))
            ask(mech, k, y, st, p, tab.mid[j])
            for a in range(d if y.mode[p] != OPEN else 0):
                worst = max(worst, gap * force_off(k, y, st, row0, d, nz, j, a, gap, h) * st.x[2 * a + 1])
            for a in range(nz):
                size = max(c.z[z0 + a], largest_in_step(y.z[z0 + a], st.Z, z0 + a), c.noise_z[z0 + a], 1e-290)
                worst = max(worst, rate_off(k, st, c, z0, d, nz, j, a, gap) / size)
    return worst


@kernel
def force_off(
    k: Moving, y: State, st: Stages, row0: int, d: int, nz: int, j: int, a: int, gap: float, h: float
) -> float:
    """What the force of row a is off half-way to stage j."""
    out = k.s.out
    off = abs(out[a] - between(st.tab.mid[j], y.F[row0 + a], st.F, row0 + a))
    stiff = 0.0
    for b in range(d):
        stiff += abs(out[d + nz + a * (d + 1 + nz) + b])
    stiff *= st.x[2 * a]
    return float(counted_force(off, largest_in_step(y.F[row0 + a], st.F, row0 + a), stiff, gap, h))


@kernel
def rate_off(k: Moving, st: Stages, c: Control, z0: int, d: int, nz: int, j: int, a: int, gap: float) -> float:
    """What state a of a law is off by over the gap before stage j, as a stiff rate lets it."""
    out, x = k.s.out, k.s.x
    at = d + nz + (d + a) * (d + 1 + nz)
    size = abs(c.rates[0, z0 + a])
    for i in range(st.Z.shape[0]):
        size = max(size, abs(c.rates[i + 1, z0 + a]))
    for b in range(d + 1 + nz):
        size = max(size, abs(out[at + b] * x[b]))
    value = 0.0
    for i in range(c.rates.shape[0]):
        value += st.tab.mid[j, i] * c.rates[i, z0 + a]
    off = abs(out[d + a] - value)
    return float(counted_rate(off, size, out[at + d + 1 + a], gap))
