"""Smooth laws of a mechanism between the stages of a step: a kink, or a turn of the law that all stages have missed.

As in ``step.law_defect``: the polynomials of a step are right at its stages, and half-way between these the law is
asked again.  What its force and its rates are off, times the width of the gap, is an error of velocities and states
that the Legendre series of velocities need not show.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.constrained.forces import forces, move
from fricmb.integrate.constrained.moving import Moving
from fricmb.integrate.constrained.problem_structs import Mech
from fricmb.integrate.constrained.radau_step import Control
from fricmb.integrate.constrained.slip_rows import carried, lightness
from fricmb.integrate.constrained.stages import Stages
from fricmb.integrate.constrained.state import State
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, Floats2
from fricmb.integrate.step.law_defect import ask_between, force_off, rate_off
from fricmb.integrate.step.tableau import by_line, largest_in_step


@kernel
def put_rates(y: State, st: Stages, rates: Floats2, h: float) -> None:
    """Rates of the states of laws at the stages of the step from y, into ``rates`` (s, n_z)."""
    for a in range(y.z.shape[0]):
        for i in range(st.Z.shape[0]):
            value = 0.0
            for j in range(st.Z.shape[0]):
                value += st.Ainv[i, j] * (st.Z[j, a] - y.z[a])
            rates[i, a] = value / h


@kernel
def bring_up_to_date(mech: Mech, k: Moving, y: State, st: Stages, h: float) -> None:
    """Slip velocities and loads at the stages after the last of Newton's changes."""
    for i in range(st.tab.c.shape[0]):
        move(mech, k, y.t + st.tab.c[i] * h, st.Q[i], st.V[i])
        forces(mech, k, st.lam[i], st.F[i], st.N[i], st.g[i])


@block
def law_defect(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float) -> float:
    """Largest error of a velocity or a state, by its own scale, that smooth laws leave between the stages."""
    port, tab = mech.port, st.tab
    worst = 0.0
    smooth = False
    for p in range(y.mode.shape[0]):
        smooth = smooth or port.law[p] == LAW_SMOOTH
    if not smooth:
        return worst
    bring_up_to_date(mech, k, y, st, h)
    put_rates(y, st, c.rates, h)
    for i in range(y.v.shape[0]):
        c.inertia[i] = (c.mass[i] * st.scale[i]) ** 2
    for p in range(y.mode.shape[0]):
        if port.law[p] != LAW_SMOOTH:
            continue
        z0 = port.z_start[p]
        d, nz = port.row[p + 1] - port.row[p], port.z_start[p + 1] - z0
        for a in range(d):
            # what a unit of force does to the slip velocity, and to the velocities over their scales
            st.x[2 * a] = lightness(mech, k, p, a, y.lam, mech.mass)
            st.x[2 * a + 1] = np.sqrt(lightness(mech, k, p, a, y.lam, c.inertia))
        for j in range(tab.c.shape[0]):
            gap = h * (tab.c[j] - (tab.c[j - 1] if j > 0 else 0.0))
            line = tab.mid[j]
            load = carried(mech, p, by_line(line, y.N[p], st.N, p))
            ask_between(port, port.laws, k.s, p, line, y.g, st.g, load, y.z, st.Z)
            for a in range(d if y.mode[p] != OPEN else 0):
                off = force_off(port, k.s, p, a, line, y.F, st.F, st.x[2 * a], gap, h)
                worst = max(worst, gap * off * st.x[2 * a + 1])
            for a in range(nz):
                size = max(c.z[z0 + a], largest_in_step(y.z[z0 + a], st.Z, z0 + a), c.noise_z[z0 + a], 1e-290)
                worst = max(worst, rate_off(port, k.s, p, a, line, y.zd, c.rates, gap) / size)
    return worst
