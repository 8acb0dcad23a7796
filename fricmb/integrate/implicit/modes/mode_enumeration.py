"""All combinations of stick and slip at an instant, one after the other, where a search by release has found none."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.equations.accelerations import weighed
from fricmb.integrate.implicit.equations.friction_share import react_by_shares
from fricmb.integrate.implicit.equations.slip_rows import plane, slip_speed
from fricmb.integrate.implicit.modes.mode_trial import (
    CREEP_IN_LOOPS,
    IN_LOOP,
    at_rest,
    ease,
    hold,
    largest_acceleration,
    most_light,
    release,
    set_out,
    still,
    wrong,
)
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.problem import SLIP, STICK, Codes

#: Outcomes of a decision.
FOUND, NO_SOLUTION, SEVERAL = 0, 1, 2
#: Up to this many ports at rest every combination is tried where the search by release fails.
ENUMERATED = 6


@kernel
def moves_alike(mech: Mech, k: Moving, w: Instant, y: State, scale: float) -> bool:
    """Whether accelerations are those of the combination found before, as ports would feel them."""
    for i in range(y.a.shape[0]):
        w.x[i] = y.a[i] - w.other[i]
    return bool(np.sqrt(most_light(mech, k, y)) * weighed(mech, w.x[: y.a.shape[0]]) <= 1e-7 * scale)


@kernel
def solved_by_shares(mech: Mech, k: Moving, w: Instant, y: State) -> bool:
    """Whether friction that grows from nothing comes to all of it; counted in ``k.unsolved`` where it does not."""
    reached = react_by_shares(mech, k, w, y)
    if reached < 1.0:
        k.furthest = max(k.furthest, reached)
        k.unsolved += 1
    return reached == 1.0


@block
def enumerate_modes(mech: Mech, k: Moving, w: Instant, y: State, part: Codes, count: int, patient: bool) -> int:
    """Try every combination of stick and the two directions of slip; the state is left at the first that holds.

    Combinations that give the same accelerations are one solution: of joints that hold more than there is to hold,
    forces alone are not determined.  Where a group has let go at mu_s and slips at mu_k several may hold: of those in
    which some of it moves the one with the most at rest counts.  ``patient``: where Newton's method does not converge,
    friction is let grow; counts
    of these tries are left in ``k.furthest``, ``k.unsolved``.
    """
    k.furthest, k.unsolved = 0.0, 0
    if count > ENUMERATED:
        return NO_SOLUTION
    n_c = y.mode.shape[0]
    found, kept, most, released = 0, -1, -1, False
    for c in range(n_c):
        released = released or part[c] == IN_LOOP
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
        if twice or not (ease(mech, k, w, y) or (patient and solved_by_shares(mech, k, w, y))):
            continue
        scale = largest_acceleration(mech, k, w, y)
        holds, stuck, moves = True, 0, not released
        for c in range(n_c):
            if not at_rest(mech, y, c, part):
                continue
            stuck += 1 if y.mode[c] == STICK else 0
            if part[c] == IN_LOOP and y.mode[c] != STICK:
                moves = moves or slip_speed(mech.port.row, c, y.n, y.F, y.ga) > CREEP_IN_LOOPS * scale
            if wrong(mech, k, y, c, scale) > 0.0 or (part[c] != IN_LOOP and still(mech, k, y, c, scale)):
                holds = False
        holds = holds and moves
        if holds and number < 3**count and released and stuck != most:
            if stuck < most:
                continue
            found, most = 0, stuck
        if holds and number < 3**count and not (found > 0 and moves_alike(mech, k, w, y, scale)):
            found += 1
            kept = number
            for i in range(y.a.shape[0]):
                w.other[i] = y.a[i]
    set_out(mech, y)
    if found == 0:
        return NO_SOLUTION
    k.furthest, k.unsolved = 0.0, 0
    return FOUND if found == 1 else SEVERAL
