"""Where forces bend within a step: a gap that closes, a stop, drag that turns over; steps end there if it matters.

Forces and loads have functions of the motion at whose sign changes they have a kink, or jump (``Problem.bends``).  As
with knots of laws (``knots``) no polynomial is right on both sides.  Where forces jump, steps end a few roundings short
of it, and the next one begins as far behind.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.formulas.crossing import narrowed
from fricmb.integrate.formulas.tableau import by_line
from fricmb.integrate.implicit.between.between_stages import look_at_step, push_by_force
from fricmb.integrate.implicit.between.knots import AT_AN_END, NEAR, NOWHERE
from fricmb.integrate.implicit.between.law_defect import ROUND_OFF
from fricmb.integrate.implicit.between.slow_slip import NEARER, TIMES, WITHIN, line_at
from fricmb.integrate.implicit.equations.forces import load_at, move, scatter
from fricmb.integrate.implicit.scene.control import Control, asked
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import State
from fricmb.integrate.implicit.stages.stages import Stages
from fricmb.integrate.model.forces import element_forces, evaluate
from fricmb.integrate.problem import LAW_SMOOTH, NORMAL_LAW, OPEN, Codes, Floats, Floats2
from fricmb.integrate.run.breakpoints import EPS

#: Times that the law is asked on either side of a bend.
ASKED = 6
#: Roundings of the time by which a step ends short of a bend: its last stage must not see what comes behind.
SHORT_OF = 4096.0


@kernel
def put_signs(mech: Mech, k: Moving, signs: Floats) -> None:
    """Functions at whose sign changes forces bend, at X; function i gives the ``signs`` from ``bend_start[i]`` on."""
    bends, start = mech.bends, mech.bend_start
    for i in range(bends.address.shape[0]):
        evaluate(bends, i, k.s)
        for j in range(start[i], start[i + 1]):
            signs[j] = k.s.out[j - start[i]]


@kernel
def look(
    mech: Mech, k: Moving, y: State, st: Stages, x: float, h: float, line: Floats, state: Floats2
) -> None:
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
        put_signs(mech, k, here)
        low, first, high, last, moved = narrowed(
            low, first, high, last, moved, x, here[b], beyond=(here[b] < 0.0) == (last < 0.0)
        )
    return float(min(max(x, low), high))


@kernel
def bring_to_dofs(mech: Mech, k: Moving, n: int, f: Floats) -> None:
    """Forces on extended coordinates (``k.fy``), brought to the n degrees of freedom."""
    place = mech.place
    for i in range(n):
        f[i] = k.fy[i]
    for c in range(place.address.shape[0]):
        d0 = place.dof_start[c]
        count = place.dof_start[c + 1] - d0
        for r in range(place.first[c + 1] - place.first[c]):
            for i in range(count):
                f[place.dof[d0 + i]] += k.grad[place.grad_start[c] + r * count + i] * k.fy[n + place.first[c] + r]


@kernel
def forces_at(mech: Mech, k: Moving, n: int, mode: Codes, f: Floats) -> None:
    """Forces of elements and of normal-force laws on the n degrees of freedom at X; behind them loads.

    What acts on places is brought to the degrees of freedom.  Loads are those of contacts, before max with 0; of
    joints, whose reactions these are, and of what is open, 0.
    """
    port = mech.port
    k.fy[:] = 0.0
    element_forces(mech.elements, mech.spread, k.s, k.fy)
    for p in range(port.joint.shape[0]):
        f[n + p] = load_at(mech, k, p) if port.joint[p] < 0 and mode[p] != OPEN else 0.0
        if port.joint[p] < 0 and port.normal[p] == NORMAL_LAW:
            scatter(k, port.normals, port.normals.x_start[p], f[n + p])
    bring_to_dofs(mech, k, n, f)


@kernel
def felt_by(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float, free: Floats) -> None:
    """Accelerations, by the scale of their velocities, by units of forces (n) and of loads (n_c) into ``free``.

    A force counts by what it does without joints, which is an upper bound; loads of joints are their reactions.
    """
    n = y.q.shape[0]
    look_at_step(mech, k, y, st, c, h)
    for i in range(n):
        free[i] = 1.0 / (c.mass[i] * st.scale[i])
    for p in range(y.mode.shape[0]):
        coefficient = abs(mech.port.mu_s[p]) if mech.port.law[p] != LAW_SMOOTH else 1.0
        free[n + p] = coefficient * push_by_force(mech, k, y, c, p) if mech.port.joint[p] < 0 else 0.0


@kernel
def missed_at(
    mech: Mech, k: Moving, y: State, st: Stages, c: Control, x: float, low: float, high: float, h: float,
    line: Floats, state: Floats2,
) -> float:  # fmt: skip
    """Sum of what forces and loads are off their polynomials on both sides of x, by the scale of velocities."""
    tab, n, count, size = st.tab, y.q.shape[0], st.tab.c.shape[0], y.q.shape[0] + y.mode.shape[0]
    force, here, free = np.empty((count + 1, size)), np.empty(size), np.empty(size)
    felt_by(mech, k, y, st, c, h, free)
    move(mech, k, y.t, y.q, y.v)
    forces_at(mech, k, n, y.mode, force[0])
    for j in range(count):
        move(mech, k, y.t + tab.c[j] * h, st.Q[j], st.V[j])
        forces_at(mech, k, n, y.mode, force[j + 1])
    total = 0.0
    for side in range(2):
        way = low - x if side == 0 else high - x
        for _ in range(ASKED):
            way *= NEARER
            look(mech, k, y, st, x + way, h, line, state)
            forces_at(mech, k, n, y.mode, here)
            worst = 0.0
            for i in range(size):
                expected, largest = 0.0, 0.0
                for j in range(count + 1):
                    expected += line[j] * force[j, i]
                    largest = max(largest, abs(force[j, i]))
                worst = max(worst, max(abs(here[i] - expected) - ROUND_OFF * largest, 0.0) * free[i])
            total += h * abs(way) * worst
    return total


@kernel
def first_bend(
    mech: Mech, k: Moving, y: State, st: Stages, c: Control, allowed: float, h: float, signs: Floats2, line: Floats,
    state: Floats2,
) -> tuple[float, float]:  # fmt: skip
    """Part of the step h just solved up to the first bend that its polynomials do not know, and the node before it.

    ``NOWHERE`` without one; ``allowed``: error that a bend may bring.  ``signs`` (2, n_b), those at the node first.
    """
    node = st.tab.c
    move(mech, k, y.t, y.q, y.v)
    put_signs(mech, k, signs[0])
    least, low = max(AT_AN_END, NEAR * EPS * abs(y.t) / h), 0.0
    for j in range(node.shape[0]):
        move(mech, k, y.t + node[j] * h, st.Q[j], st.V[j])
        put_signs(mech, k, signs[1])
        found = NOWHERE
        for b in range(signs.shape[1]):
            if (signs[0, b] < 0.0) != (signs[1, b] < 0.0):
                x = where_turned(mech, k, y, st, h, b, low, node[j], signs, line, state)
                if least < x < min(found, 1.0 - AT_AN_END):
                    found = x
        if found < 1.0:
            off = missed_at(mech, k, y, st, c, found, low, node[j], h, line, state)
            if off > allowed:
                return found, low
        signs[0], low = signs[1], node[j]
    return NOWHERE, 1.0


@kernel
def before_bend(
    mech: Mech, k: Moving, y: State, st: Stages, x: float, low: float, h: float, signs: Floats2, line: Floats,
    state: Floats2,
) -> float:  # fmt: skip
    """A place at x where nothing has changed its sign since ``low``: the last stage of a step that ends there, too."""
    here, back = np.empty(signs.shape[1]), EPS * (1.0 + abs(y.t) / h)
    for _ in range(ASKED):
        look(mech, k, y, st, x, h, line, state)
        put_signs(mech, k, here)
        same = True
        for b in range(here.shape[0]):
            same = same and (here[b] < 0.0) == (signs[0, b] < 0.0)
        if same or x - back <= low:
            break
        x -= back
        back *= 4.0
    # the polynomial itself is known to some roundings
    return float(max(x - SHORT_OF * EPS * (1.0 + abs(y.t) / h), low))


@block
def bend_within(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float, slight: float) -> float:
    """Part of the step h just solved up to the first bend that its polynomials do not know; ``NOWHERE`` without one.

    ``slight``: part of the tolerance that a bend may bring.
    """
    count = mech.bend_start[mech.bend_start.shape[0] - 1]
    signs, line, state = np.empty((2, count)), np.empty(st.tab.c.shape[0] + 1), np.empty((2, y.q.shape[0]))
    x, low = first_bend(mech, k, y, st, c, slight * asked(c), h, signs, line, state)
    return before_bend(mech, k, y, st, x, low, h, signs, line, state) if x < 1.0 else NOWHERE


@block
def go_over_bend(mech: Mech, k: Moving, y: State) -> bool:
    """Carry y over the bend that it has come to, by a few roundings of the time; False where there is none at once.

    As far again as to the first function that changes its sign: several may do so there, each by its own round-off.
    """
    count, n = mech.bend_start[mech.bend_start.shape[0] - 1], y.q.shape[0]
    before, behind, q, v = np.empty(count), np.empty(count), y.q.copy(), y.v.copy()
    move(mech, k, y.t, y.q, y.v)
    put_signs(mech, k, before)
    way = EPS * max(abs(y.t), 1e-290)
    for _ in range(ASKED + 4):
        way *= 4.0
        for i in range(n):
            q[i] = y.q[i] + way * y.v[i]
            v[i] = y.v[i] + way * y.a[i]
        move(mech, k, y.t + way, q, v)
        put_signs(mech, k, behind)
        for b in range(count):
            if (before[b] < 0.0) != (behind[b] < 0.0):
                way *= 2.0
                for i in range(n):
                    y.q[i] += way * y.v[i]
                    y.v[i] += way * y.a[i]
                y.t += way
                return True
    return False
