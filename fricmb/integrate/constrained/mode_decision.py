"""Who sticks and who slips at an instant, together with the reactions that hold there."""

from __future__ import annotations

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.constrained.accelerations import react
from fricmb.integrate.constrained.forces import is_open
from fricmb.integrate.constrained.moving import Moving
from fricmb.integrate.constrained.problem_structs import Mech
from fricmb.integrate.constrained.slip_rows import SETTING_OUT, SLIGHT, aim, lack, lightness, plane, slip_speed, spare
from fricmb.integrate.constrained.state import Instant, State
from fricmb.integrate.model.friction_cone import stick_limit
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.problem import LAW_SMOOTH, NORMAL_LAW, OPEN, SLIP, STICK, Codes, Ints

#: Outcomes of a decision.
FOUND, NO_SOLUTION, SEVERAL = 0, 1, 2
#: What a port does at the instant decided on: it slips on (or is open), comes to rest, has rested; LENT to rest while
#: round-off of its slip is taken away (``transition``).
SLIPS_ON, ARRIVES, RESTED, LENT = 0, 1, 2, 3
#: Up to this many ports at rest every combination is tried where the search by release fails.
ENUMERATED = 6
#: Round-off of forces beside the limit of sticking.
SLACK = 1e-10
#: Round-off of slip accelerations beside the largest: in trees, and in loops, whose Jacobians are softened.
CREEP, CREEP_IN_LOOPS = 1e-12, 1e-9
#: Steps from the forces that hold to those of slip, where directions of slip are to be found.
STEPS_OUT = 6


@kernel
def wrong(mech: Mech, k: Moving, y: State, c: int, a_scale: float) -> float:
    """By how much port c contradicts its mode (0: not at all); y is complete."""
    if y.mode[c] == STICK:
        limit = stick_limit(mech.port, mech.port.laws, c, k.s, max(y.N[c], 0.0))
        force = magnitude(mech.port.row, c, y.F)
        over = -spare(mech, k, c, y.F, y.N, k.borne[0])
        return over / max(limit, 1e-300) if over > SLACK * max(limit, force) else 0.0
    against = -slip_speed(mech.port.row, c, y.n, y.F, y.ga) / a_scale - lack(y.N[c], k.borne[0])
    return against if against > (CREEP_IN_LOOPS if mech.port.soft[c] > 0.0 else CREEP) else 0.0


@kernel
def release(mech: Mech, k: Moving, y: State, c: int) -> None:
    """Let port c slip, against the force that has held it."""
    row = mech.port.row
    if not plane(mech, c):
        y.mode[c] = SLIP
        y.n[row[c]] = -1.0 if y.F[row[c]] > 0.0 else 1.0
        return
    y.mode[c] = SETTING_OUT
    force = magnitude(row, c, y.F)
    k.held[c] = force
    k.slight[c] = 0.0
    for a in range(row[c + 1] - row[c]):
        k.slight[c] += SLIGHT * force * lightness(mech, k, c, a, y.lam, mech.mass, mech.address)
    for a in range(row[c], row[c + 1]):
        y.n[a] = -y.F[a] / force if force > 0.0 else (1.0 if a == row[c] else 0.0)


@kernel
def hold(mech: Mech, y: State, c: int, anew: bool) -> None:
    """Let port c stick; ``anew``: by no force yet.

    Of ports that hold more than there is to hold Newton's changes are of least norm, so forces are, too, if they come
    from 0; what they were before says nothing.
    """
    y.mode[c] = STICK
    for a in range(mech.port.row[c], mech.port.row[c + 1] if anew else mech.port.row[c]):
        y.F[a] = 0.0


@kernel
def ease(mech: Mech, k: Moving, w: Instant, y: State) -> bool:
    """As ``react``; where ports set out in a plane, along a path from the forces that held them.

    Along it slip accelerations grow from 0 on the side where friction brakes; a root on the other is not met.
    """
    some = False
    for c in range(y.mode.shape[0]):
        some = some or y.mode[c] == SETTING_OUT
    for part in range(1, STEPS_OUT if some else 1):
        k.part[0] = part / STEPS_OUT
        if not react(mech, k, w, y, False, mech.address):
            k.part[0] = 1.0
            return False
    k.part[0] = 1.0
    return bool(react(mech, k, w, y, False, mech.address))


@kernel
def set_out(mech: Mech, y: State) -> None:
    """Ports that set out slip from now on, in the direction found; one without load follows its acceleration."""
    row = mech.port.row
    for c in range(y.mode.shape[0]):
        if y.mode[c] == SETTING_OUT:
            y.mode[c] = SLIP
            aim(mech, y.mode, y.F, y.n)
            if magnitude(row, c, y.F) == 0.0:
                size = magnitude(row, c, y.ga)
                for a in range(row[c], row[c + 1]):
                    y.n[a] = y.ga[a] / size if size > 0.0 else y.n[a]


@kernel
def largest_acceleration(mech: Mech, k: Moving, y: State) -> float:
    """Scale of slip accelerations: those there are, and those that friction could bring."""
    value = 1e-290
    for i in range(y.a.shape[0]):
        value = max(value, abs(y.a[i]))
    row = mech.port.row
    for c in range(y.mode.shape[0]):
        for a in range(row[c], row[c + 1]):
            light = lightness(mech, k, c, a - row[c], y.lam, mech.mass, mech.address)
            value = max(value, abs(y.ga[a]), abs(y.F[a]) * light)
    return value


@kernel
def at_rest(mech: Mech, y: State, c: int, part: Codes) -> bool:
    """Whether port c takes part in the decision."""
    return bool(part[c] != SLIPS_ON and mech.port.law[c] != LAW_SMOOTH and y.mode[c] != OPEN)


@block
def decide(mech: Mech, k: Moving, w: Instant, y: State, part: Codes, forced: int, address: Ints) -> int:
    """Modes of the ports in ``part`` (their slip is 0); the others keep theirs.  ``forced`` (or -1) does not stick.

    Sticking first (what is at its limit already stays there where another breaks away); the port that is furthest
    beyond its limit is released against its force, one that would slip the wrong way sticks again.  One that comes to
    rest is released before those that have rested: more friction at rest than in slip lets several combinations hold,
    and what has stuck lets go only where it has to.  Where that does not settle, every combination is tried.
    """
    n_c = y.mode.shape[0]
    count, anew = 0, True
    for c in range(n_c):
        # what has rested goes on from the forces that held it, as what is elastic does
        anew = anew and not (at_rest(mech, y, c, part) and y.mode[c] == STICK)
    for c in range(n_c):
        if at_rest(mech, y, c, part):
            count += 1
            part[c] = RESTED if y.mode[c] == STICK else ARRIVES
            if c == forced:
                release(mech, k, y, c)
            elif forced < 0 or y.mode[c] == STICK or plane(mech, c):
                hold(mech, y, c, anew)
    for _ in range(4 * count + 4):
        if not ease(mech, k, w, y):
            break
        worst = find_wrong(mech, k, y, part, forced)
        if worst < 0:
            # what breaks away takes along whom it will; what arrives may have been released for another's sake
            if forced < 0 and not hold_again(mech, k, w, y, part):
                break
            set_out(mech, y)
            return FOUND
        if y.mode[worst] == STICK:
            release(mech, k, y, worst)
        else:
            y.mode[worst] = STICK
    return enumerate_modes(mech, k, w, y, part, count, mech.address)


@kernel
def find_wrong(mech: Mech, k: Moving, y: State, part: Codes, forced: int) -> int:
    """The port whose mode is to be changed next; -1 where all hold.  What comes to rest goes before what has rested."""
    scale = largest_acceleration(mech, k, y)
    worst, most = -1, 0.0
    for c in range(y.mode.shape[0]):
        if at_rest(mech, y, c, part):
            beyond = wrong(mech, k, y, c, scale)
            if c == forced and y.mode[c] != STICK and beyond < 1e-6:
                beyond = 0.0
            first = worst < 0 or part[c] < part[worst]
            if beyond > 0.0 and (first or (part[c] == part[worst] and beyond > most)):
                worst, most = c, beyond
    return worst


@kernel
def hold_again(mech: Mech, k: Moving, w: Instant, y: State, part: Codes) -> bool:
    """Where several were released, hold those that come to rest and need not slip; False without convergence.

    A port that was released first may be able to stick once another has let go.
    """
    count = 0
    for c in range(y.mode.shape[0]):
        if at_rest(mech, y, c, part) and y.mode[c] != STICK:
            count += 1
    changed = False
    for c in range(y.mode.shape[0]):
        if count < 2 or part[c] != ARRIVES or y.mode[c] == STICK or not at_rest(mech, y, c, part):
            continue
        forces, reactions, directions, mode = y.F.copy(), y.lam.copy(), y.n.copy(), y.mode[c]
        hold(mech, y, c, False)
        changed = not ease(mech, k, w, y) or find_wrong(mech, k, y, part, -1) >= 0
        if changed:
            y.mode[c] = mode
            y.F[:], y.lam[:], y.n[:] = forces, reactions, directions
        else:
            count -= 1
    return not changed or ease(mech, k, w, y)


@kernel
def moves_alike(w: Instant, y: State, scale: float) -> bool:
    """Whether accelerations are those of the combination found before."""
    apart = 0.0
    for i in range(y.a.shape[0]):
        apart = max(apart, abs(y.a[i] - w.other[i]))
    return bool(apart <= 1e-7 * scale)


@block
def enumerate_modes(mech: Mech, k: Moving, w: Instant, y: State, part: Codes, count: int, address: Ints) -> int:
    """Try every combination of stick and the two directions of slip; the state is left at the first that holds.

    Combinations that give the same accelerations are one solution: of joints that hold more than there is to hold,
    forces alone are not determined.
    """
    if count > ENUMERATED:
        return NO_SOLUTION
    n_c = y.mode.shape[0]
    found, kept = 0, -1
    for number in range(3**count + 1):
        # the last round returns to what was found
        code, twice = number, False
        if number == 3**count:
            if found != 1:
                break
            code = kept
        for c in range(n_c):
            if at_rest(mech, y, c, part):
                digit = code % 3
                code //= 3
                twice = twice or (digit == 2 and plane(mech, c))
                if digit == 0:
                    hold(mech, y, c, True)
                elif plane(mech, c):
                    release(mech, k, y, c)
                else:
                    y.mode[c] = SLIP
                    y.n[mech.port.row[c]] = 1.0 if digit == 1 else -1.0
        if twice or not ease(mech, k, w, y):
            continue
        scale = largest_acceleration(mech, k, y)
        holds = True
        for c in range(n_c):
            if at_rest(mech, y, c, part) and wrong(mech, k, y, c, scale) > 0.0:
                holds = False
        if holds and number < 3**count and not (found > 0 and moves_alike(w, y, scale)):
            found += 1
            kept = number
            for i in range(y.a.shape[0]):
                w.other[i] = y.a[i]
    set_out(mech, y)
    if found == 0:
        return NO_SOLUTION
    return FOUND if found == 1 else SEVERAL


@kernel
def mark_rest(mech: Mech, y: State, small: float, part: Codes) -> None:
    """Ports whose slip is no more than round-off; directions of the others; contacts without load are open."""
    port = mech.port
    for c in range(y.mode.shape[0]):
        part[c] = SLIPS_ON
        row = port.row[c]
        j = port.joint[c]
        if is_open(mech, j):
            y.mode[c] = OPEN
            for a in range(row, port.row[c + 1]):
                y.F[a] = 0.0
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
        speed = magnitude(port.row, c, y.g)
        if speed <= small or y.mode[c] == STICK:
            part[c] = ARRIVES
        else:
            y.mode[c] = SLIP
            for a in range(row, port.row[c + 1]):
                y.n[a] = y.g[a] / speed
