"""Who lets go of many ports at rest, under loads that no friction changes: one after the other, by convex problems.

With a limit for each port, whether it sticks or slips, friction forces at rest are the solution of one convex problem:
those within their limits leave no acceleration, the others are at them, against it (Lotstedt 1982).  Here the limit is
``mu_s N`` while a port sticks and ``mu_k N`` once it has let go.  All stick at first, without a limit; the one furthest
beyond ``mu_s N`` is given ``mu_k N``, until there is none.  What has let go and is within ``mu_k N`` in the end sticks
again.  So there is always a combination that holds, and of several it is one in which ports let go where they have to.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.equations.accelerations import react
from fricmb.integrate.implicit.equations.forces import directions
from fricmb.integrate.implicit.equations.slip_rows import friction_coefficient, guided
from fricmb.integrate.implicit.modes.loop_mobility import mobility, rank
from fricmb.integrate.implicit.modes.mode_trial import IN_LOOP, at_rest
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.model.friction_cone import stick_limit
from fricmb.integrate.problem import OPEN, SLIP, STICK, Codes, Floats, Floats2, Ints

#: Where the force of a port is: at its lower or upper limit, within, or without a limit so far.
LOW, WITHIN, HIGH, FREE = -1, 0, 1, 2
#: Changes of one port's state, by the number of ports; relative round-off of forces and accelerations.
CHANGES, SLACK = 60, 1e-11


@kernel
def list_resting(mech: Mech, y: State, part: Codes, rows: Ints) -> int:
    """Ports at rest; 0 of them where loads follow from friction, or a port has no limit of its own."""
    count, plain = 0, y.lam.shape[0] == 0
    for c in range(part.shape[0]):
        if at_rest(mech, y, c, part):
            plain = plain and directions(mech, c) == 1 and not guided(mech, c, 0)
            plain = plain and mech.port.lean[c] == 0.0
            rows[count] = c
            count += 1
    return count if plain else 0


@kernel
def solve_within(D: Floats2, b: Floats, state: Codes, x: Floats) -> bool:
    """Forces x of what is not at a limit, so that it does not accelerate; ``b`` accelerations without forces."""
    n = b.shape[0]
    inside, L, r = np.zeros(n, np.int64), np.zeros((n, n)), np.zeros(n)
    m = 0
    for i in range(n):
        if state[i] == WITHIN or state[i] == FREE:
            inside[m] = i
            m += 1
    for p in range(m):
        i = inside[p]
        r[p] = -b[i]
        for j in range(n):
            if state[j] == LOW or state[j] == HIGH:
                r[p] -= D[i, j] * x[j]
        for s in range(p + 1):
            value = D[i, inside[s]]
            for e in range(s):
                value -= L[p, e] * L[s, e]
            if s < p:
                L[p, s] = value / L[s, s]
            elif value > 0.0:
                L[p, p] = np.sqrt(value)
            else:
                return False
        for s in range(p):
            r[p] -= L[p, s] * r[s]
        r[p] /= L[p, p]
    for p in range(m - 1, -1, -1):
        for s in range(p + 1, m):
            r[p] -= L[s, p] * r[s]
        r[p] /= L[p, p]
        x[inside[p]] = r[p]
    return True


@kernel
def solve_limited(D: Floats2, b: Floats, limit: Floats, state: Codes, x: Floats) -> bool:
    """States and forces x of the convex problem: the first port that contradicts its state changes it (Murty 1974)."""
    n = b.shape[0]
    for _ in range(CHANGES * n):
        if not solve_within(D, b, state, x):
            return False
        changed = False
        for i in range(n):
            if state[i] == WITHIN and abs(x[i]) > limit[i] * (1.0 + SLACK):
                state[i] = HIGH if x[i] > 0.0 else LOW
                x[i] = state[i] * limit[i]
                changed = True
            elif state[i] == LOW or state[i] == HIGH:
                rate, size = b[i], abs(b[i])
                for j in range(n):
                    rate += D[i, j] * x[j]
                    size += abs(D[i, j] * x[j])
                if state[i] * rate > SLACK * size:
                    state[i] = WITHIN
                    changed = True
            if changed:
                break
        if not changed:
            return True
    return False


@kernel
def find_forces(
    mech: Mech, k: Moving, w: Instant, y: State, part: Codes, forced: int, rows: Ints, state: Codes
) -> bool:  # fmt: skip
    """Where the forces of the ports in ``rows`` are, one after the other having let go; they are open meanwhile."""
    count = state.shape[0]
    held = np.full(part.shape[0], SLIP, np.int8)
    for i in range(count):
        held[rows[i]] = STICK
        y.mode[rows[i]] = OPEN
    if not react(mech, k, w, y, False):
        return False
    whole = mobility(mech, k, w, y, held, np.zeros((y.F.shape[0], 0)))
    D, b, x = np.zeros((count, count)), np.zeros(count), np.zeros(count)
    most, least = np.zeros(count), np.zeros(count)
    for i in range(count):
        c = rows[i]
        load = max(y.N[c], 0.0)
        most[i] = stick_limit(mech.port, mech.port.laws, c, k.s, load)
        least[i] = friction_coefficient(mech, k, c, 0.0, load)[0] * load
        state[i] = WITHIN if c == forced or part[c] == IN_LOOP else FREE
        b[i] = y.ga[mech.port.row[c]]
        for j in range(count):
            D[i, j] = whole[mech.port.row[c], mech.port.row[rows[j]]]
    if rank(D) < count:
        return False
    worst = 0
    while worst >= 0:
        if not solve_limited(D, b, least, state, x):
            return False
        worst, over = -1, 1.0 + SLACK
        for i in range(count):
            if state[i] == FREE and abs(x[i]) > over * most[i]:
                worst, over = i, abs(x[i]) / max(most[i], 1e-300)
        if worst >= 0:
            state[worst] = WITHIN
    return True


@block
def release_in_turn(mech: Mech, k: Moving, w: Instant, y: State, part: Codes, forced: int) -> bool:
    """Modes and directions of all ports at rest; False where loads follow from friction, or some are redundant.

    ``forced`` (or -1), and what IN_LOOP in ``part``, has let go already.
    """
    rows = np.zeros(part.shape[0], np.int64)
    state = np.zeros(list_resting(mech, y, part, rows), np.int8)
    before = y.mode.copy()
    found = state.shape[0] > 0 and find_forces(mech, k, w, y, part, forced, rows, state)
    y.mode[:] = before
    for i in range(state.shape[0] if found else 0):
        c = rows[i]
        slips = state[i] == LOW or state[i] == HIGH
        y.mode[c] = SLIP if slips else STICK
        if slips:
            y.n[mech.port.row[c]] = -1.0 * state[i]
    return bool(found)
