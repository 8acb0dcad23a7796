"""Where slip passes a knot of a law within a step: a point of a table, a corner or a peak that the law states.

A coefficient is smooth between its knots and bends at them, so no polynomial is right on both sides: a step over a knot
has an error of a low order that the tails of its polynomials need not show.  So the law is asked on both sides of the
place where slip speed passes a knot; where its force is off there by more than may be, the step is done again up to
that place, and the next one begins behind the bend.  A bend too slight to matter is passed over.
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.formulas.crossing import narrowed
from fricmb.integrate.formulas.tableau import Tableau
from fricmb.integrate.implicit.between.felt import Felt
from fricmb.integrate.implicit.between.slow_slip import TIMES, WITHIN, around, missed, most_pushed, put_slip, speed
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.law_values import coefficient, magnitude
from fricmb.integrate.model.problem_structs import Table
from fricmb.integrate.problem import SLIP, Floats2
from fricmb.integrate.run.breakpoints import EPS
from fricmb.integrate.run.room_protocols import AtContacts, AtNodes, LawsWithKnots

#: Part of the tolerance that a bend inside a step may bring: of one-step methods, and of BDF, whose history keeps it.
SLIGHT, IN_HISTORY = 0.2, 0.02
#: Nearer to the ends of a step, as a part of it, no bend matters: without this a step that ends at a knot to a few
#: digits would be cut again and again.  Nearer than so many roundings of the time nothing can end.
AT_AN_END, NEAR = 1e-6, 64.0
#: Nothing is passed in the step.
NOWHERE = 2.0


@kernel
def slips_with_knots(ports: LawsWithKnots, y: AtContacts, k: int) -> bool:
    """Whether contact k slips under a law with knots."""
    return bool(y.mode[k] == SLIP and ports.knot_start[k + 1] > ports.knot_start[k])


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
        here = speed(slip, d, x) - knot
        low, first, high, last, moved = narrowed(
            low, first, high, last, moved, x, here, beyond=(here < 0.0) == (last < 0.0)
        )
    return float(min(max(x, low), high))


@kernel
def contact_knot(
    ports: LawsWithKnots, laws: Table, s: Scratch, tab: Tableau, y: AtContacts, w: AtNodes, felt: Felt,
    tolerance: float, k: int, h: float,
) -> float:  # fmt: skip
    """:func:`knot_ahead` of contact k."""
    c, slip = tab.c, felt.slip
    d = put_slip(ports, tab, y, w, felt, k)
    least = max(AT_AN_END, NEAR * EPS * abs(y.t) / h)
    low, last = 0.0, magnitude(ports.row, k, y.g)
    first, end = ports.knot_start[k], ports.knot_start[k + 1]
    for j in range(c.shape[0]):
        here = magnitude(ports.row, k, w.g[j])
        for i in range(end - first):
            knot = ports.knots[first + i if here > last else end - 1 - i]  # in the order in which they are passed
            if (last < knot) == (here < knot):
                continue
            x = where_passed(slip, d, low, c[j], knot)
            if not least < x < 1.0 - AT_AN_END:
                continue
            if around(ports, laws, s, tab, y, w, felt, tolerance, k, j, x, h) > SLIGHT * tolerance:
                return float(x)
        low, last = c[j], here
    return NOWHERE


@kernel
def knot_ahead(
    ports: LawsWithKnots, laws: Table, s: Scratch, tab: Tableau, y: AtContacts, w: AtNodes, felt: Felt,
    tolerance: float, h: float,
) -> float:  # fmt: skip
    """Part of the step h just solved up to the first knot that its polynomials do not know; ``NOWHERE`` without one."""
    found = NOWHERE
    for k in range(y.mode.shape[0]):
        if slips_with_knots(ports, y, k):
            found = min(found, contact_knot(ports, laws, s, tab, y, w, felt, tolerance, k, h))
    return found


@kernel
def beside_knots(
    ports: LawsWithKnots, laws: Table, s: Scratch, tab: Tableau, y: AtContacts, w: AtNodes, felt: Felt,
    tolerance: float, h: float,
) -> float:  # fmt: skip
    """Error of the step h just solved, by its own scale, of laws with knots near its start and its end.

    Steps end at knots, so what is narrow there lies at their ends: of a peak that a law states by its highest place
    half is before the knot, half behind it.
    """
    c = tab.c
    last = c.shape[0] - 1
    before = c[last - 1] if last > 0 else 0.0
    worst = 0.0
    for k in range(y.mode.shape[0]):
        if not slips_with_knots(ports, y, k):
            continue
        worst = max(worst, missed(ports, laws, s, tab, y, w, felt, tolerance, k, 0, 0.0, c[0], h))
        worst = max(worst, missed(ports, laws, s, tab, y, w, felt, tolerance, k, last, 1.0, before - 1.0, h))
    return worst


@kernel
def off_cubic(
    at0: tuple[float, float], at1: tuple[float, float], r0: float, r1: float, mu: float, knot: float
) -> float:
    """What the cubic with values and slopes ``at0``, ``at1`` at two slip speeds is off from ``mu`` between them."""
    x, way, rise = (knot - r0) / (r1 - r0), r1 - r0, at1[0] - at0[0]
    steep0, steep1 = way * at0[1] - rise, rise - way * at1[1]
    return float(abs(mu - at0[0] - x * rise - x * (1.0 - x) * ((1.0 - x) * steep0 + x * steep1)))


@kernel
def bend(ports: LawsWithKnots, laws: Table, s: Scratch, k: int, N: float, r0: float, r1: float, knot: float) -> float:
    """What the cubic through coefficient k at two slip speeds, with its slopes, is off at a knot between them."""
    mu0, slope0, _ = coefficient(ports, laws, k, s, r0, N)
    mu1, slope1, _ = coefficient(ports, laws, k, s, r1, N)
    mu = coefficient(ports, laws, k, s, knot, N)[0]
    return off_cubic((mu0, slope0), (mu1, slope1), r0, r1, mu, knot)


@kernel
def bends_between(
    ports: LawsWithKnots, laws: Table, s: Scratch, y: AtContacts, end: AtContacts, felt: Felt, tolerance: float
) -> bool:
    """Whether slip passes a knot between y and ``end``, a step of BDF, where the law bends enough to matter."""
    for k in range(y.mode.shape[0]):
        if not slips_with_knots(ports, y, k):
            continue
        r0, r1 = magnitude(ports.row, k, y.g), magnitude(ports.row, k, end.g)
        load = max(y.N[k], end.N[k], felt.least[k])
        allowed = IN_HISTORY * tolerance / max((end.t - y.t) * most_pushed(ports, felt, k) * abs(load), 1e-290)
        for i in range(ports.knot_start[k], ports.knot_start[k + 1]):
            knot = ports.knots[i]
            if min(r0, r1) < knot < max(r0, r1) and bend(ports, laws, s, k, load, r0, r1, knot) > allowed:
                return True
    return False
