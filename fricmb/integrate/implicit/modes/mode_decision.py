"""Who sticks and who slips at an instant, together with the reactions that hold there."""

from __future__ import annotations

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.equations.accelerations import react
from fricmb.integrate.implicit.equations.forces import is_unloaded
from fricmb.integrate.implicit.equations.slip_rows import may_open, plane
from fricmb.integrate.implicit.modes.group_release import start_group
from fricmb.integrate.implicit.modes.load_share import mark_loops
from fricmb.integrate.implicit.modes.mode_enumeration import ENUMERATED, FOUND, NO_SOLUTION, enumerate_modes
from fricmb.integrate.implicit.modes.mode_trial import (
    ARRIVES,
    IN_LOOP,
    RESTED,
    SLIPS_ON,
    at_rest,
    ease,
    hold,
    largest_acceleration,
    release,
    set_out,
    still,
    wrong,
)
from fricmb.integrate.implicit.modes.release_in_plane import release_in_plane
from fricmb.integrate.implicit.modes.release_in_turn import release_in_turn
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.model.law_values import magnitude, point_along
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, SLIP, STICK, Codes


@block
def decide(mech: Mech, k: Moving, w: Instant, y: State, part: Codes, forced: int) -> int:
    """Modes of the ports in ``part`` (their slip is 0); the others keep theirs.  ``forced`` (or -1) does not stick.

    Sticking first (a joint that is at its limit already stays there where another breaks away; contacts in loops share
    what they hold); the port that is furthest beyond its limit is released against its force, one that would slip the
    wrong way, or is held by others, sticks again.  What IN_LOOP in ``part`` does not stick.  One that comes to rest is
    released before those that have rested: more friction at rest than in slip lets several combinations hold,
    and what has stuck lets go only where it has to.  Where that does not settle, every combination is tried; many ports
    let go one after the other (``release_in_turn``, ``release_in_plane``).
    """
    n_c = y.mode.shape[0]
    count, anew = 0, True
    k.answer[:] = -1.0
    mark_loops(mech, k, w, y, part)
    freely = forced < 0
    for c in range(n_c):
        freely = freely and part[c] != IN_LOOP
        # what has rested goes on from the forces that held it, as what is elastic does
        anew = anew and not (at_rest(mech, y, c, part) and y.mode[c] == STICK)
    for c in range(n_c):
        if at_rest(mech, y, c, part):
            count += 1
            if part[c] != IN_LOOP:
                part[c] = RESTED if y.mode[c] == STICK else ARRIVES
            if c == forced or part[c] == IN_LOOP:
                release(mech, k, y, c)
            elif freely or y.mode[c] == STICK or plane(mech, c):
                hold(mech, y, c, anew)
    if shares_in_plane(mech, y, part) and settles_in_plane(mech, k, w, y, part, forced):
        return FOUND
    if not freely:
        start_group(mech, k, w, y)
    for _ in range(4 * count + 4):
        if not ease(mech, k, w, y):
            break
        worst = find_wrong(mech, k, w, y, part, forced)
        if worst < 0:
            # what breaks away takes along whom it will; what arrives may have been released for another's sake
            if freely and not hold_again(mech, k, w, y, part):
                break
            set_out(mech, y)
            return FOUND
        if y.mode[worst] == STICK:
            release(mech, k, y, worst)
        else:
            y.mode[worst] = STICK
    many = count > ENUMERATED and release_in_turn(mech, k, w, y, part, forced) and ease(mech, k, w, y)
    if many and find_wrong(mech, k, w, y, part, forced) < 0:
        return FOUND
    code = enumerate_modes(mech, k, w, y, part, count, False)
    if code != FOUND and settles_in_plane(mech, k, w, y, part, forced):
        return FOUND
    return enumerate_modes(mech, k, w, y, part, count, True) if code == NO_SOLUTION else code


@kernel
def settles_in_plane(mech: Mech, k: Moving, w: Instant, y: State, part: Codes, forced: int) -> bool:
    """Whether letting go over discs has found modes that contradict nothing; y sets out in them then."""
    found = release_in_plane(mech, k, w, y, part, forced) and react(mech, k, w, y, False)
    if not found or find_wrong(mech, k, w, y, part, forced) >= 0:
        return False
    set_out(mech, y)
    return True


@kernel
def shares_in_plane(mech: Mech, y: State, part: Codes) -> bool:
    """Whether redundant contacts at rest in the plane share what they hold."""
    found = False
    for c in range(part.shape[0]):
        found = found or (at_rest(mech, y, c, part) and plane(mech, c) and mech.port.soft[c] > 0.0)
    return found


@kernel
def find_wrong(mech: Mech, k: Moving, w: Instant, y: State, part: Codes, forced: int) -> int:
    """The port whose mode is to be changed next; -1 where all hold.  What comes to rest goes before what has rested."""
    scale = largest_acceleration(mech, k, w, y)
    worst, most = -1, 0.0
    for c in range(y.mode.shape[0]):
        if at_rest(mech, y, c, part):
            beyond = wrong(mech, k, y, c, scale)
            if (c == forced or part[c] == IN_LOOP) and y.mode[c] != STICK and beyond < 1e-6:
                beyond = 0.0
            first = worst < 0 or part[c] < part[worst]
            if beyond > 0.0 and (first or (part[c] == part[worst] and beyond > most)):
                worst, most = c, beyond
    for c in range(y.mode.shape[0] if worst < 0 else 0):
        if at_rest(mech, y, c, part) and c != forced and part[c] != IN_LOOP and still(mech, k, y, c, scale):
            return c
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
        changed = not ease(mech, k, w, y) or find_wrong(mech, k, w, y, part, -1) >= 0
        if changed:
            y.mode[c] = mode
            y.F[:], y.lam[:], y.n[:] = forces, reactions, directions
        else:
            count -= 1
    # back at a solution there is: on the way that has led there once, another may be met
    return not changed or react(mech, k, w, y, False)


@kernel
def mark_rest(mech: Mech, y: State, small: float, part: Codes) -> None:
    """Ports whose slip is no more than round-off; directions of the others; contacts without load are open."""
    port = mech.port
    for c in range(y.mode.shape[0]):
        part[c] = SLIPS_ON
        row = port.row[c]
        j = port.joint[c]
        if is_unloaded(mech, j):
            y.mode[c] = OPEN
            for a in range(row, port.row[c + 1]):
                y.F[a] = 0.0
            continue
        if j >= 0 and y.mode[c] == OPEN:
            y.mode[c] = SLIP
        if may_open(mech, c):
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
            point_along(port.row, c, y.g, 1.0, y.n)
