"""Where forces of a mechanism bend within a step: see ``step.element_bends``, of which this is the twin."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.constrained.between_stages import look_at_step, push_by_force
from fricmb.integrate.constrained.forces import load_at, move, scatter
from fricmb.integrate.constrained.moving import Moving
from fricmb.integrate.constrained.problem_structs import Mech
from fricmb.integrate.constrained.radau_step import Control, asked
from fricmb.integrate.constrained.stages import Stages
from fricmb.integrate.constrained.state import State
from fricmb.integrate.model.forces import element_forces
from fricmb.integrate.problem import LAW_SMOOTH, NORMAL_LAW, OPEN, Codes, Floats, Floats2
from fricmb.integrate.run.breakpoints import EPS
from fricmb.integrate.step.element_bends import ASKED, put_signs
from fricmb.integrate.step.knots import AT_AN_END, NEAR, NOWHERE, narrowed
from fricmb.integrate.step.law_defect import ROUND_OFF
from fricmb.integrate.step.slow_slip import NEARER, TIMES, WITHIN, line_at
from fricmb.integrate.step.tableau import by_line


@kernel
def look(mech: Mech, k: Moving, y: State, st: Stages, x: float, h: float, line: Floats, state: Floats2) -> None:
    """X on the polynomials of the step h just solved at its part x; ``state`` (2, n) and ``line`` (s+1,): space."""
    line_at(st.tab, x, line)
    for i in range(y.q.shape[0]):
        state[0, i] = by_line(line, y.q[i], st.Q, i)
        state[1, i] = by_line(line, y.v[i], st.V, i)
    move(mech, k, y.t + x * h, state[0], state[1])


@kernel
def where_turned(
    mech: Mech, k: Moving, y: State, st: Stages, h: float, b: int, low: float, high: float, signs: Floats2,
    line: Floats, state: Floats2,
) -> float:  # fmt: skip
    """Where function b changes its sign between two places with ``signs`` (2, n_b)."""
    first, last = signs[0, b], signs[1, b]
    here, moved, x = np.empty(signs.shape[1]), 0, low
    for _ in range(TIMES):
        before = x
        x = (low * last - high * first) / (last - first)
        if not low < x < high or abs(x - before) <= WITHIN * x:
            break
        look(mech, k, y, st, x, h, line, state)
        put_signs(mech.bends, mech.bend_start, k.s, here)
        low, first, high, last, moved = narrowed(low, first, high, last, moved, x, here[b])
    return float(min(max(x, low), high))


@kernel
def forces_at(mech: Mech, k: Moving, n: int, mode: Codes, f: Floats) -> None:
    """Forces of elements and of normal-force laws on the n degrees of freedom at X; behind them loads.

    What acts on places is brought to the degrees of freedom.  Loads are those of contacts, before max with 0; of
    joints, whose reactions these are, and of what is open, 0.
    """
    place, port = mech.place, mech.port
    k.fy[:] = 0.0
    element_forces(mech.elements, mech.spread, k.s, k.fy)
    for p in range(port.joint.shape[0]):
        f[n + p] = load_at(mech, k, p) if port.joint[p] < 0 and mode[p] != OPEN else 0.0
        if port.joint[p] < 0 and port.normal[p] == NORMAL_LAW:
            scatter(k, port.normals, port.normals.x_start[p], f[n + p])
    for i in range(n):
        f[i] = k.fy[i]
    for c in range(place.address.shape[0]):
        d0 = place.dof_start[c]
        count = place.dof_start[c + 1] - d0
        for r in range(place.first[c + 1] - place.first[c]):
            for i in range(count):
                f[place.dof[d0 + i]] += k.grad[place.grad_start[c] + r * count + i] * k.fy[n + place.first[c] + r]


@kernel
def missed_at(
    mech: Mech, k: Moving, y: State, st: Stages, c: Control, x: float, low: float, high: float, h: float,
    line: Floats, state: Floats2,
) -> float:  # fmt: skip
    """Sum of what forces and loads are off their polynomials on both sides of x, by the scale of velocities.

    A force counts by what it does without joints, which is an upper bound.
    """
    n, count = y.q.shape[0], st.tab.c.shape[0]
    n_c = y.mode.shape[0]
    force, here, free = np.empty((count + 1, n + n_c)), np.empty(n + n_c), np.empty(n + n_c)
    look_at_step(mech, k, y, st, c, h)
    for i in range(n):
        free[i] = 1.0 / (c.mass[i] * st.scale[i])
    for p in range(n_c):
        coefficient = abs(mech.port.mu_s[p]) if mech.port.law[p] != LAW_SMOOTH else 1.0
        free[n + p] = coefficient * push_by_force(mech, k, y, c, p) if mech.port.joint[p] < 0 else 0.0
    move(mech, k, y.t, y.q, y.v)
    forces_at(mech, k, n, y.mode, force[0])
    for j in range(count):
        move(mech, k, y.t + st.tab.c[j] * h, st.Q[j], st.V[j])
        forces_at(mech, k, n, y.mode, force[j + 1])
    total = 0.0
    for side in range(2):
        way = low - x if side == 0 else high - x
        for _ in range(ASKED):
            way *= NEARER
            look(mech, k, y, st, x + way, h, line, state)
            forces_at(mech, k, n, y.mode, here)
            worst = 0.0
            for i in range(n + n_c):
                expected, largest = 0.0, 0.0
                for j in range(count + 1):
                    expected += line[j] * force[j, i]
                    largest = max(largest, abs(force[j, i]))
                off = max(abs(here[i] - expected) - ROUND_OFF * largest, 0.0)
                worst = max(worst, off * free[i])
            total += h * abs(way) * worst
    return total


@block
def bend_within(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float, slight: float) -> float:
    """Part of the step h just solved up to the first bend that its polynomials do not know; ``NOWHERE`` without one.

    ``slight``: part of the tolerance that a bend may bring.
    """
    nodes, count = st.tab.c, mech.bend_start[mech.bend_start.shape[0] - 1]
    signs, line, state = np.empty((2, count)), np.empty(nodes.shape[0] + 1), np.empty((2, y.q.shape[0]))
    move(mech, k, y.t, y.q, y.v)
    put_signs(mech.bends, mech.bend_start, k.s, signs[0])
    least, low = max(AT_AN_END, NEAR * EPS * abs(y.t) / h), 0.0
    for j in range(nodes.shape[0]):
        move(mech, k, y.t + nodes[j] * h, st.Q[j], st.V[j])
        put_signs(mech.bends, mech.bend_start, k.s, signs[1])
        found = NOWHERE
        for b in range(count):
            if (signs[0, b] < 0.0) != (signs[1, b] < 0.0):
                x = where_turned(mech, k, y, st, h, b, low, nodes[j], signs, line, state)
                if least < x < min(found, 1.0 - AT_AN_END):
                    found = x
        if found < 1.0 and missed_at(mech, k, y, st, c, found, low, nodes[j], h, line, state) > slight * asked(c):
            return float(found)
        signs[0], low = signs[1], nodes[j]
    return NOWHERE
