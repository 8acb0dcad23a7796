"""Smooth laws between the nodes of a step: a kink, or a turn of the law that all nodes have missed.

The polynomials of a step are right at its nodes.  Half-way between these the law is asked again: what its force and
its rates are off from their polynomials, times the width of the gap, is an error of velocities and states that the
tails of their polynomials need not show.
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.template import call
from fricmb.integrate.formulas.tableau import Tableau, by_line, largest_in_step
from fricmb.integrate.implicit.between.felt import Felt
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.problem_structs import Table
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, Floats, Floats2
from fricmb.integrate.run.room_protocols import AtContacts, AtNodes, LawsWithStates

#: Relative round-off of forces and rates beside their polynomials.
ROUND_OFF = 1e-14


@kernel
def load_between(y: AtContacts, w: AtNodes, felt: Felt, k: int, line: Floats) -> float:
    """Load of contact k on its polynomial at the place of ``line``; 0 where it is open."""
    return float(max(by_line(line, y.N[k], w.N, k), felt.least[k]) if y.mode[k] != OPEN else 0.0)


@kernel
def ask_between(
    ports: LawsWithStates, laws: Table, s: Scratch, k: int, line: Floats, y: AtContacts, w: AtNodes, N: float
) -> None:
    """Law k under the load N on the polynomials of slip and states: force, rates, slopes into ``s.out``.

    ``line``: that of the tableau's ``mid`` which says where.
    """
    first, states = ports.row[k], ports.z_start[k]
    d = ports.row[k + 1] - first
    for a in range(d):
        s.x[a] = by_line(line, y.g[first + a], w.g, first + a)
    s.x[d] = N
    for a in range(ports.z_start[k + 1] - states):
        s.x[d + 1 + a] = by_line(line, y.z[states + a], w.z, states + a)
    call(laws.address[k], s.x, 0, laws.p, laws.p_start[k], s.out, 0)


@kernel
def force_off(
    ports: LawsWithStates, s: Scratch, k: int, a: int, line: Floats, F0: Floats, F: Floats2, mobility: float,
    gap: float, h: float,
) -> float:  # fmt: skip
    """What counts of how far force a of law k, just asked, is off its polynomial, over a gap of a step h.

    Velocities hold the round-off of what forces do in the step, and a law whose slope, times the ``mobility`` of the
    row, is ``stiff`` makes forces of it.  What it would take back at once does not count.
    """
    d, nz, row = ports.row[k + 1] - ports.row[k], ports.z_start[k + 1] - ports.z_start[k], ports.row[k] + a
    off = abs(s.out[a] - by_line(line, F0[row], F, row))
    stiff = 0.0
    for b in range(d):
        stiff += abs(s.out[d + nz + a * (d + 1 + nz) + b])
    stiff *= mobility
    grain = ROUND_OFF * largest_in_step(F0[row], F, row) * (1.0 + h * stiff)
    return float(max(off - grain, 0.0) / (1.0 + gap * stiff))


@kernel
def rate_off(
    ports: LawsWithStates, s: Scratch, k: int, a: int, line: Floats, rates0: Floats, rates: Floats2, gap: float
) -> float:
    """What state a of law k, just asked, is off by over a gap, as its rate is; a rate falls with its state."""
    d, nz, state = ports.row[k + 1] - ports.row[k], ports.z_start[k + 1] - ports.z_start[k], ports.z_start[k] + a
    size = largest_in_step(rates0[state], rates, state)
    at = d + nz + (d + a) * (d + 1 + nz)
    for b in range(d + 1 + nz):
        size = max(size, abs(s.out[at + b] * s.x[b]))
    off = abs(s.out[d + a] - by_line(line, rates0[state], rates, state))
    return float(gap * max(off - ROUND_OFF * size, 0.0) / (1.0 + gap * abs(s.out[at + d + 1 + a])))


@kernel
def smooth_defect(
    ports: LawsWithStates, laws: Table, s: Scratch, y: AtContacts, w: AtNodes, felt: Felt, k: int, j: int,
    line: Floats, gap: float, h: float,
) -> float:  # fmt: skip
    """Largest error, by its own scale, that smooth law k, asked by ``line``, leaves in a gap before node j."""
    first, z0 = ports.row[k], ports.z_start[k]
    worst = 0.0
    ask_between(ports, laws, s, k, line, y, w, load_between(y, w, felt, k, line))
    for a in range(ports.row[k + 1] - first if y.mode[k] != OPEN else 0):
        off = force_off(ports, s, k, a, line, y.F, w.F, felt.free[first + a], gap, h)
        worst = max(worst, gap * off * felt.push[first + a])
    for a in range(ports.z_start[k + 1] - z0):
        size = max(felt.size[z0 + a], abs(w.z[j, z0 + a]))
        worst = max(worst, rate_off(ports, s, k, a, line, y.zd, w.zd, gap) / size)
    return worst


@kernel
def law_defect(
    ports: LawsWithStates, laws: Table, s: Scratch, tab: Tableau, y: AtContacts, w: AtNodes, felt: Felt, h: float
) -> float:
    """Largest error of a velocity or a state, by its own scale, that smooth laws leave between the nodes."""
    c = tab.c
    worst = 0.0
    for k in range(y.mode.shape[0]):
        if ports.law[k] != LAW_SMOOTH:
            continue
        for j in range(c.shape[0]):
            gap = h * (c[j] - (c[j - 1] if j > 0 else 0.0))
            worst = max(worst, smooth_defect(ports, laws, s, y, w, felt, k, j, tab.mid[j], gap, h))
    return worst
