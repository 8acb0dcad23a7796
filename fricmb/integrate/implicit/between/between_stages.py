"""What laws of friction do between the stages of a step: all that ``attempt_step`` and ``attempt_bdf_step`` ask.

Forces count by what they do without (other) joints: bodies are heavier with them.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.between.knots import bends_between, beside_knots, knot_ahead
from fricmb.integrate.implicit.between.law_defect import law_defect
from fricmb.integrate.implicit.between.slip_growth import growth
from fricmb.integrate.implicit.between.slow_slip import slow_slip_defect
from fricmb.integrate.implicit.equations.forces import directions, move
from fricmb.integrate.implicit.equations.slip_rows import lightness
from fricmb.integrate.implicit.scene.control import Control, asked
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import State
from fricmb.integrate.implicit.stages.stages import Stages, bring_up_to_date
from fricmb.integrate.problem import LAW_CONSTANT


@kernel
def some_follow(mech: Mech, y: State) -> bool:
    """Whether friction of some port follows slip or states."""
    found = False
    for p in range(y.mode.shape[0]):
        found = found or mech.port.law[p] != LAW_CONSTANT
    return found


@kernel
def put_rates(y: State, st: Stages, h: float) -> None:
    """Rates of the states of laws at the stages of the step from y, into ``st.zd``."""
    for a in range(y.z.shape[0]):
        for i in range(st.z.shape[0]):
            value = 0.0
            for j in range(st.z.shape[0]):
                value += st.Ainv[i, j] * (st.z[j, a] - y.z[a])
            st.zd[i, a] = value / h


@kernel
def look_at_step(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float) -> None:
    """Make ready for :func:`push_by_force` in the step h just solved."""
    bring_up_to_date(mech, k, y, st, h)
    for i in range(y.v.shape[0]):
        c.inertia[i] = (c.mass[i] * st.scale[i]) ** 2
    move(mech, k, y.t, y.q, y.v)


@kernel
def push_by_force(mech: Mech, k: Moving, y: State, c: Control, p: int) -> float:
    """Largest acceleration, by its scale, that a unit force of port p brings without joints: an upper bound."""
    most = 0.0
    for a in range(directions(mech, p)):
        most = max(most, np.sqrt(lightness(mech, k, p, a, y.lam, c.inertia)))
    return most


@block
def weigh_ports(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float) -> None:
    """Fill ``st.felt`` for the step h just solved, of all ports whose friction follows slip or states."""
    if not some_follow(mech, y):
        return
    port, felt = mech.port, st.felt
    look_at_step(mech, k, y, st, c, h)
    put_rates(y, st, h)
    for p in range(y.mode.shape[0]):
        if port.law[p] == LAW_CONSTANT:
            continue
        felt.least[p] = -np.inf if port.joint[p] >= 0 else 0.0
        for a in range(directions(mech, p)):
            felt.free[port.row[p] + a] = lightness(mech, k, p, a, y.lam, mech.mass)
            felt.push[port.row[p] + a] = np.sqrt(lightness(mech, k, p, a, y.lam, c.inertia))
    for a in range(y.z.shape[0]):
        felt.size[a] = max(c.z[a], abs(y.z[a]), c.noise_z[a], 1e-290)


@block
def laws_between(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float) -> float:
    """Largest error of a velocity or a state, by its own scale, that laws leave between the stages."""
    if not some_follow(mech, y):
        return 0.0
    port, felt = mech.port, st.felt
    slow = slow_slip_defect(port, port.laws, k.s, st.tab, y, st, felt, asked(c), h)
    return float(max(law_defect(port, port.laws, k.s, st.tab, y, st, felt, h), slow))


@kernel
def growth_of_slip(mech: Mech, k: Moving, y: State, st: Stages, h: float) -> float:
    """Length of the step whose stages ``st`` are, in units of the longest that sees slip grow."""
    return float(growth(mech.port, mech.port.laws, k.s, y, st, st.felt, h))


@block
def knot_within(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float) -> float:
    """Part of the step h just solved up to the first knot that its polynomials do not know."""
    return float(knot_ahead(mech.port, mech.port.laws, k.s, st.tab, y, st, st.felt, asked(c), h))


@block
def off_near_ends(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float) -> float:
    """Error of the step h just solved, by its own scale, of laws with knots near its start and its end."""
    return float(beside_knots(mech.port, mech.port.laws, k.s, st.tab, y, st, st.felt, asked(c), h))


@block
def passes_bend(mech: Mech, k: Moving, y: State, end: State, st: Stages, c: Control) -> bool:
    """Whether slip passes a knot in a step of BDF from y to ``end``, where the law bends enough to matter."""
    return bool(bends_between(mech.port, mech.port.laws, k.s, y, end, st.felt, asked(c)))
