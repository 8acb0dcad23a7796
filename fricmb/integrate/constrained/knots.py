"""Where slip of a mechanism passes a knot of a law within a step: see ``step.knots``, of which this is the twin."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.constrained.moving import Moving
from fricmb.integrate.constrained.problem_structs import Mech
from fricmb.integrate.constrained.radau_step import Control, asked
from fricmb.integrate.constrained.slip_rows import carried, friction_coefficient
from fricmb.integrate.constrained.slow_slip import follows_speed, free_by_force, look_at_step, missed
from fricmb.integrate.constrained.stages import Stages
from fricmb.integrate.constrained.state import State
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.problem import Floats2
from fricmb.integrate.run.breakpoints import EPS
from fricmb.integrate.step.crossing import polynomial
from fricmb.integrate.step.knots import AT_AN_END, IN_HISTORY, NEAR, NOWHERE, SLIGHT, off_cubic, where_passed


@kernel
def has_knots(mech: Mech, y: State, p: int) -> bool:
    """Whether port p slips under a law with knots."""
    return bool(follows_speed(mech, y, p) and mech.port.knot_start[p + 1] > mech.port.knot_start[p])


@kernel
def some_with_knots(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float) -> bool:
    """Whether some port slips under a law with knots; if so all is ready for ``missed`` in the step h just solved."""
    for p in range(y.mode.shape[0]):
        if has_knots(mech, y, p):
            look_at_step(mech, k, y, st, c, h)
            return True
    return False


@kernel
def port_knot(
    mech: Mech, k: Moving, y: State, st: Stages, c: Control, p: int, h: float, free: float, space: Floats2
) -> float:
    """:func:`knot_within` of port p; ``free``: see ``slow_slip.missed``; ``space`` (5, s+1)."""
    nodes, row0 = st.tab.c, mech.port.row[p]
    d, count = mech.port.row[p + 1] - row0, nodes.shape[0]
    line, values, slip = space[0], space[1, :count], space[2:]
    for a in range(d):
        for j in range(count):
            values[j] = st.g[j, row0 + a]
        polynomial(st.tab, y.g[row0 + a], values, slip[a])
    least = max(AT_AN_END, NEAR * EPS * abs(y.t) / h)
    low, last = 0.0, magnitude(mech.port.row, p, y.g)
    first, end = mech.port.knot_start[p], mech.port.knot_start[p + 1]
    for j in range(count):
        high, here = nodes[j], magnitude(mech.port.row, p, st.g[j])
        for i in range(end - first):
            knot = mech.port.knots[first + i if here > last else end - 1 - i]  # in the order in which they are passed
            if (last < knot) == (here < knot):
                continue
            x = where_passed(slip, d, low, high, knot)
            if not least < x < 1.0 - AT_AN_END:
                continue
            off = missed(mech, k, y, st, c, p, x, low - x, h, free, line)
            off += missed(mech, k, y, st, c, p, x, high - x, h, free, line)
            if off > SLIGHT * asked(c):
                return float(x)
        low, last = high, here
    return NOWHERE


@block
def knot_within(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float) -> float:
    """Part of the step h just solved up to the first knot that its polynomials do not know; ``NOWHERE`` without one."""
    found = NOWHERE
    if not some_with_knots(mech, k, y, st, c, h):
        return found
    space = np.empty((5, st.tab.c.shape[0] + 1))
    for p in range(y.mode.shape[0]):
        if has_knots(mech, y, p):
            found = min(found, port_knot(mech, k, y, st, c, p, h, free_by_force(mech, k, y, c, p), space))
    return found


@block
def off_near_ends(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float) -> float:
    """Error of the step h just solved, of laws with knots near its start and its end; by the scale of velocities."""
    nodes = st.tab.c
    count, worst = nodes.shape[0], 0.0
    if not some_with_knots(mech, k, y, st, c, h):
        return worst
    before = nodes[count - 2] if count > 1 else 0.0
    line = np.empty(count + 1)
    for p in range(y.mode.shape[0]):
        if not has_knots(mech, y, p):
            continue
        free = free_by_force(mech, k, y, c, p)
        worst = max(worst, missed(mech, k, y, st, c, p, 0.0, nodes[0], h, free, line))
        worst = max(worst, missed(mech, k, y, st, c, p, 1.0, before - 1.0, h, free, line))
    return worst


@block
def passes_bend(mech: Mech, k: Moving, y: State, end: State, st: Stages, c: Control, h: float) -> bool:
    """Whether slip passes a knot in a step h of BDF from y to ``end``, where the law bends enough to matter."""
    if not some_with_knots(mech, k, y, st, c, h):
        return False
    for p in range(y.mode.shape[0]):
        if not has_knots(mech, y, p):
            continue
        r0, r1 = magnitude(mech.port.row, p, y.g), magnitude(mech.port.row, p, end.g)
        load = carried(mech, p, max(y.N[p], end.N[p]))
        allowed = IN_HISTORY * asked(c) / max(h * free_by_force(mech, k, y, c, p) * load, 1e-290)
        for i in range(mech.port.knot_start[p], mech.port.knot_start[p + 1]):
            knot = mech.port.knots[i]
            if not min(r0, r1) < knot < max(r0, r1):
                continue
            mu = at_speed(mech, k, p, knot, load)[0]
            first, last = at_speed(mech, k, p, r0, load), at_speed(mech, k, p, r1, load)
            if off_cubic(first, last, r0, r1, mu, knot) > allowed:
                return True
    return False


@kernel
def at_speed(mech: Mech, k: Moving, p: int, r: float, load: float) -> tuple[float, float]:
    """Coefficient of port p at a slip speed, and its slope."""
    mu, slope, _ = friction_coefficient(mech, k, p, r, load)
    return mu, slope
