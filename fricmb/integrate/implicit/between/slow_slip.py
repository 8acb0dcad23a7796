"""Laws of slip speed where slip is slow or turns within a step: a peak or a corner of the law between two nodes.

Most of what a law of slip speed does it does near r = 0: a regularised law turns its force over, a coefficient that
falls with speed has its peak.  A step that passes there fast, sets out from there or ends there, may have all of that
between two nodes, where no polynomial through the nodes shows it.  And slip speed that turns between two nodes may pass
a corner of the law and come back.  So the law is asked on both sides of where slip is slowest, or turns, at distances
that are quartered until what happens still nearer cannot matter any more.  What the force is off from its polynomial,
times the distance, adds up to the impulse that the step has missed.
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.formulas.crossing import evaluate, narrowed, polynomial
from fricmb.integrate.formulas.tableau import Tableau, by_line
from fricmb.integrate.implicit.between.felt import Felt
from fricmb.integrate.implicit.between.law_defect import ROUND_OFF, load_between, smooth_defect
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.law_values import coefficient, magnitude
from fricmb.integrate.model.problem_structs import Table
from fricmb.integrate.problem import LAW_CONSTANT, LAW_SMOOTH, OPEN, SLIP, Floats, Floats2, Ints
from fricmb.integrate.run.room_protocols import AtContacts, AtNodes, Laws, LawsWithStates

#: Part of the slip speed at the one node below which slip is slow at the other.
SLOW = 0.5
#: Part of the tolerance by which slip speed has to change, where it turns, for the law to be asked there.
FLAT = 1e-3
#: Part of the tolerance that what is not looked at may reach; times the forces at the nodes that a law may be there.
UNSEEN, ABOVE = 0.5, 2.0
#: By what distances are shortened; how often at most, as steps of the search for a turn, found to that part of a gap.
NEARER, TIMES, WITHIN = 0.25, 40, 1e-12


@kernel
def line_at(tab: Tableau, x: float, line: Floats) -> None:
    """Weights (s+1,) of the values at 0 and the nodes in that of their polynomial at x, as the lines of a tableau.

    Lagrange's: the product of the distances to all other points, over what it is at the point itself.
    """
    c, n = tab.c, tab.c.shape[0]
    before = 1.0
    for i in range(n + 1):
        line[i] = tab.basis[n, i] * before
        before *= x - (c[i - 1] if i > 0 else 0.0)
    behind = 1.0
    for i in range(n, -1, -1):
        line[i] *= behind
        behind *= x - (c[i - 1] if i > 0 else 0.0)


@kernel
def approach(slip: Floats2, d: int, x: float) -> float:
    """Half the rate of r^2 at x, of the series ``slip`` (3, s+1) of a slip velocity in d directions."""
    value = 0.0
    for a in range(d):
        g, slope, _ = evaluate(slip[a], x)
        value += g * slope
    return float(value)


@kernel
def turn(slip: Floats2, d: int, low: float, high: float) -> float:
    """Where slip speed turns between two neighbouring nodes, at which it goes in opposite senses.

    By straight lines, where an end that stays twice counts half (Illinois).
    """
    first, last = approach(slip, d, low), approach(slip, d, high)
    within, x, moved = WITHIN * (high - low), low, 0
    for _ in range(TIMES):
        before = x
        x = (low * last - high * first) / (last - first)
        if abs(x - before) <= within:
            break
        rate = approach(slip, d, x)
        low, first, high, last, moved = narrowed(
            low, first, high, last, moved, x, rate, beyond=(rate < 0.0) == (last < 0.0)
        )
    return x


@kernel
def speed(slip: Floats2, d: int, x: float) -> float:
    """Slip speed at x."""
    value = 0.0
    for a in range(d):
        value += evaluate(slip[a], x)[0] ** 2
    return float(value**0.5)


@kernel
def force_between(row: Ints, k: int, line: Floats, F0: Floats, F: Floats2) -> tuple[float, float]:
    """Polynomial of the size of force k of a step at the place of ``line``, and the largest at its start and nodes."""
    top = magnitude(row, k, F0)
    size = line[0] * top
    for j in range(F.shape[0]):
        here = magnitude(row, k, F[j])
        size += line[j + 1] * here
        top = max(top, here)
    return size, top


@kernel
def least_way(tolerance: float, row: Ints, k: int, F0: Floats, F: Floats2, most: float, h: float) -> float:
    """Part of a step h nearer than which nothing that force k may do is above what may stay unseen.

    ``most``: acceleration, by its own scale, that a unit of force brings.
    """
    top = magnitude(row, k, F0)
    for j in range(F.shape[0]):
        top = max(top, magnitude(row, k, F[j]))
    return float(UNSEEN * tolerance / max(ABOVE * top * most * h, 1e-290))


@kernel
def coefficient_off(
    ports: LawsWithStates, laws: Table, s: Scratch, y: AtContacts, w: AtNodes, felt: Felt, k: int, line: Floats
) -> float:
    """What friction of contact k, whose law is a coefficient, is off from the polynomial of its size."""
    r = 0.0
    for a in range(ports.row[k], ports.row[k + 1]):
        r += by_line(line, y.g[a], w.g, a) ** 2
    N = load_between(y, w, felt, k, line)
    size, top = force_between(ports.row, k, line, y.F, w.F)
    mu = coefficient(ports, laws, k, s, r**0.5, N)[0]
    return float(max(abs(mu * N - size) - ROUND_OFF * top, 0.0))


@kernel
def most_pushed(ports: Laws, felt: Felt, k: int) -> float:
    """Largest acceleration, by its own scale, that a unit of force of contact k brings."""
    most = 0.0
    for a in range(ports.row[k], ports.row[k + 1]):
        most = max(most, felt.push[a])
    return most


@kernel
def missed(
    ports: LawsWithStates, laws: Table, s: Scratch, tab: Tableau, y: AtContacts, w: AtNodes, felt: Felt,
    tolerance: float, k: int, j: int, x: float, way: float, h: float,
) -> float:  # fmt: skip
    """Sum of what law k misses at x + way/4, x + way/16, ... of the step h, before node j, by its own scale."""
    most, line = most_pushed(ports, felt, k), felt.line
    least = least_way(tolerance, ports.row, k, y.F, w.F, most, h)
    total = 0.0
    for _ in range(TIMES):
        way *= NEARER
        if abs(way) < least:
            break
        line_at(tab, x + way, line)
        gap = h * abs(way)
        if ports.law[k] == LAW_SMOOTH:
            total += smooth_defect(ports, laws, s, y, w, felt, k, j, line, gap, h)
        else:
            total += gap * coefficient_off(ports, laws, s, y, w, felt, k, line) * most
    return total


@kernel
def around(
    ports: LawsWithStates, laws: Table, s: Scratch, tab: Tableau, y: AtContacts, w: AtNodes, felt: Felt,
    tolerance: float, k: int, j: int, x: float, h: float,
) -> float:  # fmt: skip
    """Sum of what law k misses on both sides of x between node j and the one before it."""
    low, high = tab.c[j - 1] if j > 0 else 0.0, tab.c[j]
    off = 0.0
    if x > low:
        off += missed(ports, laws, s, tab, y, w, felt, tolerance, k, j, x, low - x, h)
    if x < high:
        off += missed(ports, laws, s, tab, y, w, felt, tolerance, k, j, x, high - x, h)
    return off


@kernel
def put_slip(ports: Laws, tab: Tableau, y: AtContacts, w: AtNodes, felt: Felt, k: int) -> int:
    """Series of the slip velocity of contact k into ``felt.slip``, and in how many directions it slips."""
    first = ports.row[k]
    for a in range(first, ports.row[k + 1]):
        for j in range(tab.c.shape[0]):
            felt.values[j] = w.g[j, a]
        polynomial(tab, y.g[a], felt.values, felt.slip[a - first])
    return int(ports.row[k + 1] - first)


@kernel
def contact_missed(
    ports: LawsWithStates, laws: Table, s: Scratch, tab: Tableau, y: AtContacts, w: AtNodes, felt: Felt,
    tolerance: float, k: int, h: float,
) -> float:  # fmt: skip
    """Largest error between two neighbouring nodes where slip of contact k is slow or turns."""
    c, slip = tab.c, felt.slip
    d = put_slip(ports, tab, y, w, felt, k)
    worst = 0.0
    low, last, rate = 0.0, magnitude(ports.row, k, y.g), approach(slip, d, 0.0)
    for j in range(c.shape[0]):
        here, next_rate = magnitude(ports.row, k, w.g[j]), approach(slip, d, c[j])
        x = -1.0
        if rate < 0.0 < next_rate or (rate > 0.0 > next_rate and ports.law[k] == LAW_SMOOTH):
            x = turn(slip, d, low, c[j])
            if abs(speed(slip, d, x) - (min(last, here) if rate < 0.0 else max(last, here))) < FLAT * tolerance * here:
                x = -1.0
        elif min(last, here) < SLOW * max(last, here):
            x = low if last < here else c[j]
        if x >= 0.0:
            worst = max(worst, around(ports, laws, s, tab, y, w, felt, tolerance, k, j, x, h))
        low, last, rate = c[j], here, next_rate
    return worst


@kernel
def follows_slip(ports: Laws, y: AtContacts, k: int) -> bool:
    """Whether friction of contact k follows its slip speed."""
    law = ports.law[k]
    return bool(y.mode[k] != OPEN if law == LAW_SMOOTH else law != LAW_CONSTANT and y.mode[k] == SLIP)


@kernel
def slow_slip_defect(
    ports: LawsWithStates, laws: Table, s: Scratch, tab: Tableau, y: AtContacts, w: AtNodes, felt: Felt,
    tolerance: float, h: float,
) -> float:  # fmt: skip
    """Largest error, by its own scale, of what laws of slip speed do between nodes where slip is slow or turns."""
    worst = 0.0
    for k in range(y.mode.shape[0]):
        if follows_slip(ports, y, k):
            worst = max(worst, contact_missed(ports, laws, s, tab, y, w, felt, tolerance, k, h))
    return worst
