"""Who sticks and who slips at an instant, together with the reactions that hold there."""

from __future__ import annotations

from fricmb.integrate._kernel import kernel
from fricmb.integrate._problem import LAW_SMOOTH, NORMAL_LAW, OPEN, SLIP, STICK, Codes, Ints
from fricmb.integrate._room import block
from fricmb.integrate.constrained._pack import Mech, Moving
from fricmb.integrate.constrained._state import Instant, State, react

#: Outcomes of a decision.
FOUND, NO_SOLUTION, SEVERAL = 0, 1, 2
#: Up to this many ports at rest every combination is tried where the search by release fails.
ENUMERATED = 6
#: Round-off of forces beside the limit of sticking, and of slip accelerations beside their size.
SLACK = 1e-10


@kernel
def wrong(mech: Mech, y: State, c: int, a_scale: float) -> float:
    """By how much port c contradicts its mode (0: not at all); y is complete."""
    port = mech.port
    if y.mode[c] == STICK:
        limit = port.mu_s[c] * max(y.N[c], 0.0)
        over = abs(y.F[c]) - limit
        return over / max(limit, 1e-300) if over > SLACK * max(limit, abs(y.F[c])) else 0.0
    against = -y.n[c] * y.ga[c]
    return against / a_scale if against > 1e-9 * a_scale else 0.0


@kernel
def largest_acceleration(y: State) -> float:
    """Scale of slip accelerations."""
    value = 1e-290
    for i in range(y.a.shape[0]):
        value = max(value, abs(y.a[i]))
    for c in range(y.ga.shape[0]):
        value = max(value, abs(y.ga[c]))
    return value


@kernel
def at_rest(mech: Mech, y: State, c: int, part: Codes) -> bool:
    """Whether port c takes part in the decision."""
    return bool(part[c] != 0 and mech.port.law[c] != LAW_SMOOTH and y.mode[c] != OPEN)


@block
def decide(mech: Mech, k: Moving, w: Instant, y: State, part: Codes, forced: int, address: Ints) -> int:
    """Modes of the ports in ``part`` (their slip is 0); the others keep theirs.  ``forced`` (or -1) does not stick.

    Sticking first; the port that is furthest beyond its limit is released against its force, one that would slip the
    wrong way sticks again.  Where that does not settle, every combination is tried.
    """
    n_c = y.F.shape[0]
    count = 0
    for c in range(n_c):
        if at_rest(mech, y, c, part):
            count += 1
            if c == forced:
                y.n[c] = -1.0 if y.F[c] > 0.0 else 1.0
                y.mode[c] = SLIP
            else:
                y.mode[c] = STICK
    for _ in range(4 * count + 4):
        if not react(mech, k, w, y, False, mech.address):
            break
        scale = largest_acceleration(y)
        worst, most = -1, 0.0
        for c in range(n_c):
            if at_rest(mech, y, c, part):
                beyond = wrong(mech, y, c, scale)
                if c == forced and y.mode[c] == SLIP and beyond < 1e-6:
                    beyond = 0.0
                if beyond > most:
                    worst, most = c, beyond
        if worst < 0:
            return FOUND
        if y.mode[worst] == STICK:
            y.mode[worst] = SLIP
            y.n[worst] = -1.0 if y.F[worst] > 0.0 else 1.0
        else:
            y.mode[worst] = STICK
    return enumerate_modes(mech, k, w, y, part, count, mech.address)


@block
def enumerate_modes(mech: Mech, k: Moving, w: Instant, y: State, part: Codes, count: int, address: Ints) -> int:
    """Try every combination of stick and the two directions of slip; the state is left at the last that holds."""
    if count > ENUMERATED:
        return NO_SOLUTION
    n_c = y.F.shape[0]
    found, kept = 0, -1
    for number in range(3**count + 1):
        # the last round returns to what was found
        code = number
        if number == 3**count:
            if found != 1:
                break
            code = kept
        for c in range(n_c):
            if at_rest(mech, y, c, part):
                digit = code % 3
                code //= 3
                y.mode[c] = STICK if digit == 0 else SLIP
                y.n[c] = 1.0 if digit == 1 else -1.0
        if not react(mech, k, w, y, False, mech.address):
            continue
        scale = largest_acceleration(y)
        holds = True
        for c in range(n_c):
            if at_rest(mech, y, c, part) and wrong(mech, y, c, scale) > 0.0:
                holds = False
        if holds and number < 3**count:
            found += 1
            kept = number
    if found == 0:
        return NO_SOLUTION
    return FOUND if found == 1 else SEVERAL


@kernel
def mark_rest(mech: Mech, y: State, small: float, part: Codes) -> None:
    """Ports whose slip is no more than round-off; directions of the others; contacts without load are open."""
    port = mech.port
    for c in range(y.F.shape[0]):
        part[c] = 0
        j = port.joint[c]
        if j >= 0 and mech.joint.dropped[mech.joint.row[j]] == 2:
            y.mode[c] = OPEN
            y.F[c] = 0.0
            continue
        if j >= 0 and y.mode[c] == OPEN:
            y.mode[c] = SLIP
        if port.normal[c] == NORMAL_LAW:
            if y.N[c] <= 0.0:
                y.mode[c] = OPEN
                continue
            if y.mode[c] == OPEN:
                y.mode[c] = SLIP
        if port.law[c] == LAW_SMOOTH:
            y.mode[c] = SLIP
            continue
        if abs(y.g[c]) <= small or y.mode[c] == STICK:
            part[c] = 1
        else:
            y.mode[c] = SLIP
            y.n[c] = 1.0 if y.g[c] > 0.0 else -1.0
