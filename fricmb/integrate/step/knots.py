"""Where slip passes a knot of a law within a step: a point of a table, a corner or a peak that the law states.

A coefficient is smooth between its knots and bends at them, so no polynomial is right on both sides: a step over a knot
has an error of a low order that the tails of its polynomials need not show.  So the law is asked on both sides of the
place where slip speed passes a knot; where its force is off there by more than may be, the step is done again up to
that place, and the next one begins behind the bend.  A bend too slight to matter is passed over.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.law_values import coefficient, magnitude
from fricmb.integrate.model.problem_structs import Packed, Ports
from fricmb.integrate.model.state import State
from fricmb.integrate.problem import SLIP, Floats2
from fricmb.integrate.run.breakpoints import EPS
from fricmb.integrate.step.crossing import polynomial
from fricmb.integrate.step.law_defect import felt, put_felt
from fricmb.integrate.step.one_step_room import Accuracy, OneStep
from fricmb.integrate.step.slow_slip import TIMES, WITHIN, around, missed, speed

#: Part of the tolerance that a bend inside a step may bring: of one-step methods, and of BDF, whose history keeps it.
SLIGHT, IN_HISTORY = 0.2, 0.02
#: Nearer to the ends of a step, as a part of it, no bend matters: without this a step that ends at a knot to a few
#: digits would be cut again and again.  Nearer than so many roundings of the time nothing can end.
AT_AN_END, NEAR = 1e-6, 64.0
#: Nothing is passed in the step.
NOWHERE = 2.0


@kernel
def has_knots(ports: Ports, y: State, k: int) -> bool:
    """Whether contact k slips under a law with knots."""
    return bool(y.mode[k] == SLIP and ports.knot_start[k + 1] > ports.knot_start[k])


@kernel
def narrowed(
    low: float, first: float, high: float, last: float, moved: int, x: float, here: float
) -> tuple[float, float, float, float, int]:
    """Two places between which a function changes its sign, its values there, and which moved, after one more look.

    An end that stays twice counts half (Illinois); the next look is where the straight line between the values is 0.
    """
    if (here < 0.0) == (last < 0.0):
        return low, first * (0.5 if moved > 0 else 1.0), x, here, 1
    return x, here, high, last * (0.5 if moved < 0 else 1.0), -1


@kernel
def where_passed(slip: Floats2, d: int, low: float, high: float, knot: float) -> float:
    """Where slip speed passes ``knot`` between two places at which it is on either side; ``slip``: see ``speed``."""
    first, last = speed(slip, d, low) - knot, speed(slip, d, high) - knot
    x, moved = low, 0
    for _ in range(TIMES):
        before = x
        x = (low * last - high * first) / (last - first)
        if not low < x < high or abs(x - before) <= WITHIN * x:
            break
        low, first, high, last, moved = narrowed(low, first, high, last, moved, x, speed(slip, d, x) - knot)
    return float(min(max(x, low), high))


@kernel
def contact_knot(
    packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, k: int, h: float, space: Floats2
) -> float:
    """:func:`knot_ahead` of contact k; ``space`` (5, s+1)."""
    ports, c = packed.ports, one.tab.c
    row0, d = ports.row[k], ports.row[k + 1] - ports.row[k]
    weight, line, slip = space[0], space[1], space[2:]
    for a in range(d):
        for j in range(c.shape[0]):
            one.margin[j] = one.w.g[j, row0 + a]
        polynomial(one.tab, y.g[row0 + a], one.margin, slip[a])
    weight[:3] = 0.0
    put_felt(packed, y, acc, k, weight)
    least = max(AT_AN_END, NEAR * EPS * abs(y.t) / h)
    low, last = 0.0, magnitude(ports.row, k, y.g)
    first, end = ports.knot_start[k], ports.knot_start[k + 1]
    for j in range(c.shape[0]):
        here = magnitude(ports.row, k, one.w.g[j])
        for i in range(end - first):
            knot = ports.knots[first + i if here > last else end - 1 - i]  # in the order in which they are passed
            if (last < knot) == (here < knot):
                continue
            x = where_passed(slip, d, low, c[j], knot)
            if not least < x < 1.0 - AT_AN_END:
                continue
            if around(packed, s, y, one, acc, k, j, x, h, line, weight) > SLIGHT * acc.rtol:
                return float(x)
        low, last = c[j], here
    return NOWHERE


@block
def knot_ahead(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, h: float) -> float:
    """Part of the step h just solved up to the first knot that its polynomials do not know; ``NOWHERE`` without one."""
    found = NOWHERE
    space = np.empty((5, one.tab.c.shape[0] + 1))
    for k in range(y.mode.shape[0]):
        if has_knots(packed.ports, y, k):
            found = min(found, contact_knot(packed, s, y, one, acc, k, h, space))
    return found


@block
def beside_knots(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, h: float) -> float:
    """Error of the step h just solved, in units of the tolerance, of laws with knots near its start and its end.

    Steps end at knots, so what is narrow there lies at their ends: of a peak that a law states by its highest place
    half is before the knot, half behind it.
    """
    ports, c = packed.ports, one.tab.c
    last = c.shape[0] - 1
    before = c[last - 1] if last > 0 else 0.0
    line, weight = np.empty(last + 2), np.empty(3)
    worst = 0.0
    for k in range(y.mode.shape[0]):
        if not has_knots(ports, y, k):
            continue
        weight[:] = 0.0
        put_felt(packed, y, acc, k, weight)
        worst = max(worst, missed(packed, s, y, one, acc, k, 0, 0.0, c[0], h, line, weight))
        worst = max(worst, missed(packed, s, y, one, acc, k, last, 1.0, before - 1.0, h, line, weight))
    return float(worst / acc.rtol)


@kernel
def off_cubic(
    at0: tuple[float, float], at1: tuple[float, float], r0: float, r1: float, mu: float, knot: float
) -> float:
    """What the cubic with values and slopes ``at0``, ``at1`` at two slip speeds is off from ``mu`` between them."""
    x, way, rise = (knot - r0) / (r1 - r0), r1 - r0, at1[0] - at0[0]
    steep0, steep1 = way * at0[1] - rise, rise - way * at1[1]
    return float(abs(mu - at0[0] - x * rise - x * (1.0 - x) * ((1.0 - x) * steep0 + x * steep1)))


@kernel
def bend(packed: Packed, s: Scratch, k: int, N: float, r0: float, r1: float, knot: float) -> float:
    """What the cubic through coefficient k at two slip speeds, with its slopes, is off at a knot between them."""
    mu0, slope0, _ = coefficient(packed.ports, packed.laws, k, s, r0, N)
    mu1, slope1, _ = coefficient(packed.ports, packed.laws, k, s, r1, N)
    mu = coefficient(packed.ports, packed.laws, k, s, knot, N)[0]
    return off_cubic((mu0, slope0), (mu1, slope1), r0, r1, mu, knot)


@kernel
def bends_between(packed: Packed, s: Scratch, y: State, end: State, acc: Accuracy) -> bool:
    """Whether slip passes a knot between y and ``end``, a step of BDF, where the law bends enough to matter."""
    ports = packed.ports
    for k in range(y.mode.shape[0]):
        if not has_knots(ports, y, k):
            continue
        r0, r1 = magnitude(ports.row, k, y.g), magnitude(ports.row, k, end.g)
        most = 0.0
        for a in range(ports.row[k], ports.row[k + 1]):
            most = max(most, felt(packed, y, acc, a))
        allowed = IN_HISTORY * acc.rtol / max((end.t - y.t) * most * max(y.N[k], end.N[k]), 1e-290)
        for i in range(ports.knot_start[k], ports.knot_start[k + 1]):
            knot = ports.knots[i]
            if min(r0, r1) < knot < max(r0, r1) and bend(packed, s, k, y.N[k], r0, r1, knot) > allowed:
                return True
    return False
