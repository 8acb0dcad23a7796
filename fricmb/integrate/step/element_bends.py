"""Where forces bend within a step: a gap that closes, a stop, drag that turns over; steps end there if it matters.

Forces and loads have functions of the motion at whose sign changes they have a kink (``Problem.bends``).  As with
knots of laws (:mod:`fricmb.integrate.step.knots`) no polynomial is right on both sides.

What is asked here is the same with joints and without.  A driver gives its problem and its space, ``model`` and ``k``,
and three kernels: ``place(model, k, t, q, v)`` puts an instant into X, ``forces_at(model, k, n, mode, f)`` gives the
forces on the n degrees of freedom and, behind them, the loads of contacts before max with 0 (of what is open 0), and
``felt_by(model, k, y, st, scales, h, free)`` what a unit of each does to a velocity, by its own scale.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.forces import Scratch, evaluate
from fricmb.integrate.model.problem_structs import Table
from fricmb.integrate.problem import Floats, Floats2, Ints
from fricmb.integrate.run.breakpoints import EPS
from fricmb.integrate.step.crossing import narrowed
from fricmb.integrate.step.knots import AT_AN_END, NEAR, NOWHERE
from fricmb.integrate.step.law_defect import ROUND_OFF
from fricmb.integrate.step.slow_slip import NEARER, TIMES, WITHIN, line_at
from fricmb.integrate.step.tableau import Tableau, by_line

#: Times that the law is asked on either side of a bend.
ASKED = 6
#: Roundings of the time by which a step ends short of a bend: its last stage must not see what comes behind.
SHORT_OF = 4096.0


@kernel
def put_signs(bends: Table, start: Ints, s: Scratch, signs: Floats) -> None:
    """Functions at whose sign changes forces bend, at X; function i gives the ``signs`` from ``start[i]`` on."""
    for i in range(bends.address.shape[0]):
        evaluate(bends, i, s)
        for j in range(start[i], start[i + 1]):
            signs[j] = s.out[j - start[i]]


@kernel
def look(
    place: Any, model: Any, k: Any, tab: Tableau, y: Any, st: Any, x: float, h: float, line: Floats, state: Floats2
) -> None:
    """X on the polynomials of the step h just solved at its part x; ``state`` (2, n) and ``line`` (s+1,): space."""
    line_at(tab, x, line)
    for i in range(y.q.shape[0]):
        state[0, i] = by_line(line, y.q[i], st.Q, i)
        state[1, i] = by_line(line, y.v[i], st.V, i)
    place(model, k, y.t + x * h, state[0], state[1])


@kernel
def where_turned(
    place: Any, model: Any, k: Any, s: Scratch, tab: Tableau, y: Any, st: Any, h: float, b: int, low: float,
    high: float, signs: Floats2, line: Floats, state: Floats2,
) -> float:  # fmt: skip
    """Where function b changes its sign between two places with ``signs`` (2, n_b)."""
    first, last = signs[0, b], signs[1, b]
    here, moved, x = np.empty(signs.shape[1]), 0, low
    for _ in range(TIMES):
        before = x
        x = (low * last - high * first) / (last - first)
        if not low < x < high or abs(x - before) <= WITHIN * x:
            break
        look(place, model, k, tab, y, st, x, h, line, state)
        put_signs(model.bends, model.bend_start, s, here)
        low, first, high, last, moved = narrowed(
            low, first, high, last, moved, x, here[b], beyond=(here[b] < 0.0) == (last < 0.0)
        )
    return float(min(max(x, low), high))


@kernel
def missed_at(
    place: Any, forces_at: Any, felt_by: Any, model: Any, k: Any, tab: Tableau, y: Any, st: Any, scales: Any, x: float,
    low: float, high: float, h: float, line: Floats, state: Floats2,
) -> float:  # fmt: skip
    """Sum of what forces and loads are off their polynomials on both sides of x, by the scale of velocities."""
    n, count, size = y.q.shape[0], tab.c.shape[0], y.q.shape[0] + y.mode.shape[0]
    force, here, free = np.empty((count + 1, size)), np.empty(size), np.empty(size)
    felt_by(model, k, y, st, scales, h, free)
    place(model, k, y.t, y.q, y.v)
    forces_at(model, k, n, y.mode, force[0])
    for j in range(count):
        place(model, k, y.t + tab.c[j] * h, st.Q[j], st.V[j])
        forces_at(model, k, n, y.mode, force[j + 1])
    total = 0.0
    for side in range(2):
        way = low - x if side == 0 else high - x
        for _ in range(ASKED):
            way *= NEARER
            look(place, model, k, tab, y, st, x + way, h, line, state)
            forces_at(model, k, n, y.mode, here)
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
    place: Any, forces_at: Any, felt_by: Any, model: Any, k: Any, s: Scratch, tab: Tableau, y: Any, st: Any,
    scales: Any, allowed: float, h: float, signs: Floats2, line: Floats, state: Floats2,
) -> tuple[float, float]:  # fmt: skip
    """Part of the step h just solved up to the first bend that its polynomials do not know, and the node before it.

    ``NOWHERE`` without one; ``allowed``: error that a bend may bring.  ``signs`` (2, n_b), those at the node first.
    """
    c = tab.c
    place(model, k, y.t, y.q, y.v)
    put_signs(model.bends, model.bend_start, s, signs[0])
    least, low = max(AT_AN_END, NEAR * EPS * abs(y.t) / h), 0.0
    for j in range(c.shape[0]):
        place(model, k, y.t + c[j] * h, st.Q[j], st.V[j])
        put_signs(model.bends, model.bend_start, s, signs[1])
        found = NOWHERE
        for b in range(signs.shape[1]):
            if (signs[0, b] < 0.0) != (signs[1, b] < 0.0):
                x = where_turned(place, model, k, s, tab, y, st, h, b, low, c[j], signs, line, state)
                if least < x < min(found, 1.0 - AT_AN_END):
                    found = x
        if found < 1.0:
            off = missed_at(
                place, forces_at, felt_by, model, k, tab, y, st, scales, found, low, c[j], h, line, state
            )  # fmt: skip
            if off > allowed:
                return found, low
        signs[0], low = signs[1], c[j]
    return NOWHERE, 1.0


@kernel
def before_bend(
    place: Any, model: Any, k: Any, s: Scratch, tab: Tableau, y: Any, st: Any, x: float, low: float, h: float,
    signs: Floats2, line: Floats, state: Floats2,
) -> float:  # fmt: skip
    """A place at x where nothing has changed its sign since ``low``: the last stage of a step that ends there, too."""
    here, back = np.empty(signs.shape[1]), EPS * (1.0 + abs(y.t) / h)
    for _ in range(ASKED):
        look(place, model, k, tab, y, st, x, h, line, state)
        put_signs(model.bends, model.bend_start, s, here)
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
def carried_over_bend(place: Any, model: Any, k: Any, s: Scratch, y: Any) -> bool:
    """Carry y over the bend that it has come to, by a few roundings of the time; False where there is none at once.

    As far again as to the first function that changes its sign: several may do so there, each by its own round-off.
    """
    count, n = model.bend_start[model.bend_start.shape[0] - 1], y.q.shape[0]
    before, behind, q, v = np.empty(count), np.empty(count), y.q.copy(), y.v.copy()
    place(model, k, y.t, y.q, y.v)
    put_signs(model.bends, model.bend_start, s, before)
    way = EPS * max(abs(y.t), 1e-290)
    for _ in range(ASKED + 4):
        way *= 4.0
        for i in range(n):
            q[i] = y.q[i] + way * y.v[i]
            v[i] = y.v[i] + way * y.a[i]
        place(model, k, y.t + way, q, v)
        put_signs(model.bends, model.bend_start, s, behind)
        for b in range(count):
            if (before[b] < 0.0) != (behind[b] < 0.0):
                way *= 2.0
                for i in range(n):
                    y.q[i] += way * y.v[i]
                    y.v[i] += way * y.a[i]
                y.t += way
                return True
    return False
