"""Where forces bend within a step: a gap that closes, a stop, drag that turns over; steps end there if it matters.

Forces and loads have functions of the motion at whose sign changes they have a kink (``Problem.bends``).  As with
knots of laws (:mod:`fricmb.integrate.step.knots`) no polynomial is right on both sides.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.forces import Scratch, element_forces, evaluate, normal_force, set_instant
from fricmb.integrate.model.problem_structs import Packed, Table
from fricmb.integrate.model.state import State
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, Codes, Floats, Floats2, Ints
from fricmb.integrate.run.breakpoints import EPS
from fricmb.integrate.step.knots import AT_AN_END, IN_HISTORY, NEAR, NOWHERE, SLIGHT, narrowed
from fricmb.integrate.step.law_defect import ROUND_OFF
from fricmb.integrate.step.one_step_room import Accuracy, OneStep, widest
from fricmb.integrate.step.slow_slip import NEARER, TIMES, WITHIN, line_at
from fricmb.integrate.step.tableau import by_line
from fricmb.integrate.step.weigh_forces import CREEP, pushed

#: Roundings of the time by which a step ends short of a bend: its last stage must not see what comes behind.
SHORT_OF = 4096.0
#: Times that the law is asked on either side of a bend.
ASKED = 6


@kernel
def put_signs(bends: Table, start: Ints, s: Scratch, signs: Floats) -> None:
    """Functions at whose sign changes forces bend, at X; function i gives the ``signs`` from ``start[i]`` on."""
    for i in range(bends.address.shape[0]):
        evaluate(bends, i, s)
        for j in range(start[i], start[i + 1]):
            signs[j] = s.out[j - start[i]]


@kernel
def look(packed: Packed, s: Scratch, y: State, one: OneStep, x: float, h: float, line: Floats, state: Floats2) -> None:
    """X on the polynomials of the step h just solved at its part x; ``state`` (2, n) and ``line`` (s+1,): space."""
    line_at(one.tab, x, line)
    for i in range(y.q.shape[0]):
        state[0, i] = by_line(line, y.q[i], one.st.Q, i)
        state[1, i] = by_line(line, y.v[i], one.st.V, i)
    set_instant(packed.signals, s, y.t + x * h, state[0], state[1])


@kernel
def where_turned(
    packed: Packed, s: Scratch, y: State, one: OneStep, h: float, b: int, low: float, high: float, signs: Floats2,
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
        look(packed, s, y, one, x, h, line, state)
        put_signs(packed.bends, packed.bend_start, s, here)
        low, first, high, last, moved = narrowed(low, first, high, last, moved, x, here[b])
    return float(min(max(x, low), high))


@kernel
def forces_at(packed: Packed, s: Scratch, n: int, mode: Codes, f: Floats) -> None:
    """Forces of all elements and of normal-force laws on the n dofs at X, behind them the loads of all contacts.

    Loads are those before max with 0; what is open has none.
    """
    ports = packed.ports
    f[:] = 0.0
    element_forces(packed.elements, packed.spread, s, f[:n])
    for k in range(ports.var.shape[0]):
        if ports.var[k] < 0 or mode[k] == OPEN:
            continue
        f[n + k] = normal_force(ports, packed.normals, k, s)
        if ports.acts[k]:
            for i in range(n):
                f[i] += ports.Wn[i, k] * f[n + k]


@kernel
def largest_part(packed: Packed, y: State, acc: Accuracy, off: Floats) -> float:
    """Largest acceleration, by the scale of its velocity, that forces ``off``, and friction under loads off, bring."""
    ports, top, worst, n = packed.ports, widest(acc.v), 0.0, y.q.shape[0]
    for i in range(n):
        scale = max(acc.v[i], abs(y.v[i]), CREEP * acc.floor_v[i], 1e-10 * top, 1e-290)
        worst = max(worst, packed.structure.mobility[i] * off[i] / scale)
    for k in range(ports.var.shape[0]):
        for a in range(ports.row[k], ports.row[k + 1] if off[n + k] > 0.0 else ports.row[k]):
            coefficient = abs(ports.mu_s[k]) if ports.law[k] != LAW_SMOOTH else 1.0
            worst = max(worst, coefficient * off[n + k] * pushed(packed, y, acc, a))
    return worst


@kernel
def missed_at(
    packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, x: float, low: float, high: float, h: float,
    line: Floats, state: Floats2,
) -> float:  # fmt: skip
    """Sum of what forces and loads are off their polynomials on both sides of x, as an error by its own scale."""
    n, count = y.q.shape[0], one.tab.c.shape[0]
    force, off = np.empty((count + 1, n + y.mode.shape[0])), np.empty(n + y.mode.shape[0])
    set_instant(packed.signals, s, y.t, y.q, y.v)
    forces_at(packed, s, n, y.mode, force[0])
    for j in range(count):
        set_instant(packed.signals, s, one.st.t[j], one.st.Q[j], one.st.V[j])
        forces_at(packed, s, n, y.mode, force[j + 1])
    total = 0.0
    for side in range(2):
        way = low - x if side == 0 else high - x
        for _ in range(ASKED):
            way *= NEARER
            look(packed, s, y, one, x + way, h, line, state)
            forces_at(packed, s, n, y.mode, off)
            for i in range(off.shape[0]):
                expected, largest = 0.0, 0.0
                for j in range(count + 1):
                    expected += line[j] * force[j, i]
                    largest = max(largest, abs(force[j, i]))
                off[i] = max(abs(off[i] - expected) - ROUND_OFF * largest, 0.0)
            total += h * abs(way) * largest_part(packed, y, acc, off)
    return total


@kernel
def before_bend(
    packed: Packed, s: Scratch, y: State, one: OneStep, x: float, low: float, h: float, signs: Floats2, line: Floats,
    state: Floats2,
) -> float:  # fmt: skip
    """A place at x where nothing has changed its sign since ``low``: the last stage of a step that ends there, too."""
    here, back = np.empty(signs.shape[1]), EPS * (1.0 + abs(y.t) / h)
    for _ in range(ASKED):
        look(packed, s, y, one, x, h, line, state)
        put_signs(packed.bends, packed.bend_start, s, here)
        same = True
        for b in range(here.shape[0]):
            same = same and (here[b] < 0.0) == (signs[0, b] < 0.0)
        if same or x - back <= low:
            break
        x -= back
        back *= 4.0
    # the polynomial itself is known to some roundings
    return float(max(x - SHORT_OF * EPS * (1.0 + abs(y.t) / h), low))


@kernel
def go_over_bend(packed: Packed, s: Scratch, y: State) -> bool:
    """Carry y over the bend that it has come to, by a few roundings of the time; False where there is none at once."""
    count, n = packed.bend_start[packed.bend_start.shape[0] - 1], y.q.shape[0]
    before, behind, q, v = np.empty(count), np.empty(count), y.q.copy(), y.v.copy()
    set_instant(packed.signals, s, y.t, y.q, y.v)
    put_signs(packed.bends, packed.bend_start, s, before)
    way = EPS * max(abs(y.t), 1e-290)
    for _ in range(ASKED + 4):
        way *= 4.0
        for i in range(n):
            q[i] = y.q[i] + way * y.v[i]
            v[i] = y.v[i] + way * y.a[i]
        set_instant(packed.signals, s, y.t + way, q, v)
        put_signs(packed.bends, packed.bend_start, s, behind)
        for b in range(count):
            if (before[b] < 0.0) != (behind[b] < 0.0):
                y.q[:], y.v[:] = q, v
                y.t += way
                return True
    return False


@kernel
def begins_at_bend(packed: Packed, s: Scratch, y: State, one: OneStep, h: float) -> bool:
    """Whether a step begins where forces bend, on the near side by round-off: its stages are all on the far one."""
    count = packed.bend_start[packed.bend_start.shape[0] - 1]
    signs, line, state = np.empty((2, count)), np.empty(one.tab.c.shape[0] + 1), np.empty((2, y.q.shape[0]))
    set_instant(packed.signals, s, y.t, y.q, y.v)
    put_signs(packed.bends, packed.bend_start, s, signs[0])
    set_instant(packed.signals, s, one.st.t[0], one.st.Q[0], one.st.V[0])
    put_signs(packed.bends, packed.bend_start, s, signs[1])
    least, found = max(AT_AN_END, NEAR * EPS * abs(y.t) / h), False
    for b in range(count):
        if (signs[0, b] < 0.0) != (signs[1, b] < 0.0):
            found = found or where_turned(packed, s, y, one, h, b, 0.0, one.tab.c[0], signs, line, state) <= least
    return bool(found)


@block
def bend_ahead(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, h: float) -> float:
    """Part of the step h just solved up to the first bend that its polynomials do not know; ``NOWHERE`` without one."""
    c, count = one.tab.c, packed.bend_start[packed.bend_start.shape[0] - 1]
    signs, line, state = np.empty((2, count)), np.empty(c.shape[0] + 1), np.empty((2, y.q.shape[0]))
    set_instant(packed.signals, s, y.t, y.q, y.v)
    put_signs(packed.bends, packed.bend_start, s, signs[0])
    least, low = max(AT_AN_END, NEAR * EPS * abs(y.t) / h), 0.0
    for j in range(c.shape[0]):
        set_instant(packed.signals, s, one.st.t[j], one.st.Q[j], one.st.V[j])
        put_signs(packed.bends, packed.bend_start, s, signs[1])
        found = NOWHERE
        for b in range(count):
            if (signs[0, b] < 0.0) != (signs[1, b] < 0.0):
                x = where_turned(packed, s, y, one, h, b, low, c[j], signs, line, state)
                if least < x < min(found, 1.0 - AT_AN_END):
                    found = x
        if found < 1.0 and missed_at(packed, s, y, one, acc, found, low, c[j], h, line, state) > SLIGHT * acc.rtol:
            return before_bend(packed, s, y, one, found, low, h, signs, line, state)
        signs[0], low = signs[1], c[j]
    return NOWHERE


@block
def bends_in_step(packed: Packed, s: Scratch, y: State, end: State, acc: Accuracy) -> bool:
    """Whether forces bend between y and ``end``, a step of BDF, by enough to matter."""
    n, count = y.q.shape[0], packed.bend_start[packed.bend_start.shape[0] - 1]
    signs, state = np.empty((2, count)), np.empty((2, n))
    f, off = np.empty((3, n + y.mode.shape[0])), np.empty(n + y.mode.shape[0])
    set_instant(packed.signals, s, y.t, y.q, y.v)
    put_signs(packed.bends, packed.bend_start, s, signs[0])
    forces_at(packed, s, n, y.mode, f[0])
    set_instant(packed.signals, s, end.t, end.q, end.v)
    put_signs(packed.bends, packed.bend_start, s, signs[1])
    forces_at(packed, s, n, y.mode, f[1])
    h, allowed = end.t - y.t, IN_HISTORY * acc.rtol
    for b in range(count):
        if (signs[0, b] < 0.0) == (signs[1, b] < 0.0):
            continue
        x = signs[0, b] / (signs[0, b] - signs[1, b])
        for i in range(n):
            state[0, i] = y.q[i] + x * (end.q[i] - y.q[i])
            state[1, i] = y.v[i] + x * (end.v[i] - y.v[i])
        set_instant(packed.signals, s, y.t + x * h, state[0], state[1])
        forces_at(packed, s, n, y.mode, f[2])
        for i in range(off.shape[0]):
            largest = max(abs(f[0, i]), abs(f[1, i]))
            off[i] = max(abs(f[2, i] - f[0, i] - x * (f[1, i] - f[0, i])) - ROUND_OFF * largest, 0.0)
        if h * largest_part(packed, y, acc, off) > allowed:
            return True
    return False
