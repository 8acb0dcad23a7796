"""Coefficients of friction of a mechanism where slip is slow: the peak of a law between two stages of a step.

As in ``step.slow_slip``: a coefficient that falls with slip speed has its peak near rest.  A step that sets out from
there, or ends there, may have all of the peak between two stages, where nothing half-way between them shows it.  So the
law is asked at distances from where slip is slowest that are quartered until what is nearer cannot matter any more.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.constrained.forces import directions, move
from fricmb.integrate.constrained.law_defect import bring_up_to_date
from fricmb.integrate.constrained.moving import Moving
from fricmb.integrate.constrained.problem_structs import Mech
from fricmb.integrate.constrained.radau_step import Control, asked
from fricmb.integrate.constrained.slip_rows import carried, friction_coefficient, lightness
from fricmb.integrate.constrained.stages import Stages
from fricmb.integrate.constrained.state import State
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.problem import LAW_COEFFICIENT, SLIP, Floats
from fricmb.integrate.step.law_defect import ROUND_OFF
from fricmb.integrate.step.slow_slip import NEARER, SLOW, TIMES, force_between, least_way, line_at
from fricmb.integrate.step.tableau import by_line


@kernel
def follows_speed(mech: Mech, y: State, p: int) -> bool:
    """Whether port p slips under a coefficient of friction that follows its slip speed."""
    return bool(y.mode[p] == SLIP and mech.port.law[p] == LAW_COEFFICIENT)


@kernel
def coefficient_off(mech: Mech, k: Moving, y: State, st: Stages, p: int, line: Floats) -> float:
    """What friction of port p is off from the polynomial of its size, at the place of ``line``."""
    row = mech.port.row
    r = 0.0
    for a in range(row[p], row[p + 1]):
        r += by_line(line, y.g[a], st.g, a) ** 2
    size, top = force_between(row, p, line, y.F, st.F)
    load = carried(mech, p, by_line(line, y.N[p], st.N, p))
    mu, _, _ = friction_coefficient(mech, k, p, r**0.5, load)
    return float(max(abs(mu * load - size) - ROUND_OFF * top, 0.0))


@kernel
def missed(
    mech: Mech, k: Moving, y: State, st: Stages, c: Control, p: int, x: float, way: float, h: float, most: float,
    line: Floats,
) -> float:  # fmt: skip
    """Sum of what port p misses at x + way/4, x + way/16, ... of the step h, by the scale of velocities.

    ``most``: largest acceleration, by its scale, that a unit force brings.
    """
    least = least_way(asked(c), mech.port.row, p, y.F, st.F, most, h)
    total = 0.0
    for _ in range(TIMES):
        way *= NEARER
        if abs(way) < least:
            break
        line_at(st.tab, x + way, line)
        total += h * abs(way) * coefficient_off(mech, k, y, st, p, line) * most
    return total


@kernel
def look_at_step(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float) -> None:
    """Make ready for ``missed`` and ``free_by_force`` in the step h just solved."""
    bring_up_to_date(mech, k, y, st, h)
    for i in range(y.v.shape[0]):
        c.inertia[i] = (c.mass[i] * st.scale[i]) ** 2
    move(mech, k, y.t, y.q, y.v)


@kernel
def free_by_force(mech: Mech, k: Moving, y: State, c: Control, p: int) -> float:
    """Largest acceleration, by its scale, that a unit force of port p brings without joints: an upper bound."""
    free = 0.0
    for a in range(directions(mech, p)):
        free = max(free, np.sqrt(lightness(mech, k, p, a, y.lam, c.inertia)))
    return free


@kernel
def port_missed(mech: Mech, k: Moving, y: State, st: Stages, c: Control, p: int, h: float, line: Floats) -> float:
    """Largest error of port p between two neighbouring stages of which one has slow slip."""
    worst, free = 0.0, free_by_force(mech, k, y, c, p)
    low, last = 0.0, magnitude(mech.port.row, p, y.g)
    for j in range(st.tab.c.shape[0]):
        high, here = st.tab.c[j], magnitude(mech.port.row, p, st.g[j])
        if min(last, here) < SLOW * max(last, here):
            x = low if last < here else high
            worst = max(worst, missed(mech, k, y, st, c, p, x, low + high - 2.0 * x, h, free, line))
        low, last = high, here
    return worst


@block
def slow_slip_defect(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float) -> float:
    """Largest error of a velocity, by its own scale, that coefficients of friction leave where slip is slow."""
    worst, some = 0.0, False
    for p in range(y.mode.shape[0]):
        some = some or follows_speed(mech, y, p)
    if not some:
        return worst
    look_at_step(mech, k, y, st, c, h)
    line = np.empty(st.tab.c.shape[0] + 1)
    for p in range(y.mode.shape[0]):
        if follows_speed(mech, y, p):
            worst = max(worst, port_missed(mech, k, y, st, c, p, h, line))
    return worst
