"""The run of one contact under constant friction on a linear structure with at most linear loads."""

from __future__ import annotations

import math

from fricmb.integrate.collocation.block_motion import fundamental, two_sum
from fricmb.integrate.collocation.layout import (
    AT_BLOCKS,
    AT_LENGTH,
    AT_LOSS,
    AT_LOW,
    AT_TIME,
    D_INV,
    DAMP,
    DIRECTION,
    E1,
    FIRST,
    FREE,
    LINES,
    LOAD_1,
    LOSS,
    MODE,
    MW,
    N_EVENTS,
    N_PHASES,
    N_REJECTED,
    N_ROWS,
    N_STEPS,
    NEXT,
    OUT,
    POS,
    RHS,
    ROWS,
    S1,
    STIFF,
    STUCK_BLOCKS,
    STUCK_V,
    TIME,
    TIME_LOW,
    U_LOW,
    VEL,
    W2,
    A,
    G,
    K,
    N,
    U,
    V,
)  # fmt: skip
from fricmb.integrate.collocation.nodes import RUNGS
from fricmb.integrate.collocation.one_contact.landing import arrive, first_stop, land, nearly_stopped
from fricmb.integrate.collocation.one_contact.phase import (
    accelerations,
    begin_phase,
    contact_acceleration,
    settle,
    to_dofs,
)
from fricmb.integrate.collocation.one_contact.room import Run
from fricmb.integrate.collocation.one_contact.slip_directions import start_direction
from fricmb.integrate.collocation.one_contact.step import (
    commit,
    end_state,
    keep_slip,
    on_ladder,
    rates,
    solve_slip,
    step_error,
    transfer_weights,
    weigh,
)  # fmt: skip
from fricmb.integrate.collocation.one_contact.stick import release_time
from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import entry, kernel
from fricmb.integrate.problem import EVENT_SLIP, SLIP, STICK, Ints
from fricmb.integrate.run.stop import stopped

#: Why a run came back: at its end; no space for rows; for a progress report; or what went wrong.
DONE, FULL, PAUSE, UNDERFLOW, ENDLESS, NOT_FINITE = range(6)
#: Steps after which the reference point moves along.
REBASE = 16
#: Mode of a contact at g = 0 whose accelerations have not been asked yet.
UNSETTLED = -1
#: Kernels that are compiled one by one.
BLOCKS = ("transfer_weights", "solve_slip", "land", "arrive", "begin_phase", "stick_phase", "slip_phase")


@kernel
def length_factor(error: float, s: int) -> float:
    """By what a step may grow or has to shrink."""
    return float(min(3.0, max(0.05, 0.85 * (error + 1e-30) ** (-1.0 / s))))


@kernel
def rung_of(run: Run, h: float) -> int:
    """The longest rung not above h."""
    ratio = run.ladder[0] / h
    if ratio <= 1.0:
        return 0
    return int(min(RUNGS, math.ceil(4.0 * math.log2(ratio) - 1e-9)))


@block
def slip_phase(run: Run, t_end: float, tol: float, stiff: float, address: Ints) -> int:
    """Slip until it ends, the run ends, or the reference point should move along; DONE, or what went wrong."""
    n = run.sd.shape[1]
    m = run.flags[ROWS]
    s = run.basis.shape[0]
    begin_phase(run, 0, n, run.places)
    rates(run)
    since = 0.0
    taken = 0
    fresh = True
    for a in range(m):
        fresh = fresh and run.sm[G, a] == 0.0
    while taken < REBASE and not stopped():
        left = (t_end - run.sx[TIME]) - run.sx[TIME_LOW]
        if left <= 0.0:
            break
        rung = rung_of(run, run.sx[NEXT])
        if rung >= RUNGS:
            return UNDERFLOW
        h = run.ladder[rung]
        accelerations(run, 0, n, since)
        if h >= left:
            h = left
            slot = 0
            transfer_weights(run, h, 0, stiff, run.places)
        else:
            slot = on_ladder(run, rung, stiff)
        weigh(run, h)
        for a in range(m):
            for i in range(s):
                run.nx[DIRECTION, a, i] = run.sm[N, a]
        if not solve_slip(run, slot, h, tol, run.places):
            run.sx[NEXT] = 0.5 * h
            run.si[N_REJECTED] += 1
            continue
        r0 = 0.0
        for a in range(m):
            r0 += run.sm[G, a] * run.sm[G, a]
        r0 = math.sqrt(r0)
        stop = first_stop(run, r0, h, tol)
        if stop < 1.5:
            gone = land(run, h, stop, since, tol, stiff, run.places)
            if gone > 0.0:
                arrive(run, since + gone, run.places)
                return DONE
            run.si[N_REJECTED] += 1
            run.sx[NEXT] = max(stop * h * length_factor(-gone, s), 0.01 * h)
            continue
        error = step_error(run, h, tol)
        error = max(error, stop - 2.0)
        if error > 1.0:
            run.si[N_REJECTED] += 1
            run.sx[NEXT] = h * length_factor(error, s)
            continue
        loss = keep_slip(run, h)
        end_state(run, slot, h)
        commit(run, h, loss)
        since += h
        taken += 1
        if fresh:
            run.sx[FIRST] = h
            fresh = False
        run.sx[NEXT] = h * length_factor(error, s) * 1.0000001
        if nearly_stopped(run, since, tol, run.wk[LINES, RHS, s - 1], h):
            arrive(run, since, run.places)
            return DONE
    to_dofs(run, 0, n, since)
    return DONE


@block
def stick_phase(run: Run, t_end: float, address: Ints) -> int:
    """Stick until the force reaches its cone or the run ends."""
    n = run.sd.shape[1]
    m = run.flags[ROWS]
    b = run.flags[STUCK_BLOCKS]
    contact_acceleration(run)
    for a in range(m):
        run.nx[FREE, a, 0] = run.wk[LINES, OUT + 1, a]
    begin_phase(run, 1, b, run.places)
    accelerations(run, 1, b, 0.0)
    for a in range(m):
        # FREE: the force at the start and its rate beside the blocks' part
        value = 0.0
        for i in range(n):
            load = run.vec[LOAD_1, i]
            for j in range(n):
                load -= run.dof[STIFF, i, j] * run.vec[STUCK_V, j]
            value += run.row[MW, a, i] * load
        run.wk[LINES, OUT, a] = value
    for a in range(m):
        value = 0.0
        for c in range(m):
            value -= run.con[D_INV, a, c] * run.wk[LINES, OUT, c]
        for j in range(b):
            value -= run.row[S1, a, j] * run.bx[E1, j]
        run.nx[FREE, a, 1] = value
    left = (t_end - run.sx[TIME]) - run.sx[TIME_LOW]
    found = release_time(run, left)
    if found == -2.0:
        return ENDLESS
    h = left if found < 0.0 else found
    at_row = run.si[N_ROWS]
    run.kinds[at_row, 0] = STICK
    run.kinds[at_row, 1] = run.si[N_PHASES] - 1
    run.steps[at_row, AT_TIME] = run.sx[TIME]
    run.steps[at_row, AT_LOW] = run.sx[TIME_LOW]
    run.steps[at_row, AT_LENGTH] = h
    run.steps[at_row, AT_LOSS] = run.sx[LOSS]
    for j in range(b):
        run.steps[at_row, AT_BLOCKS + j] = run.bx[U, j]
        run.steps[at_row, AT_BLOCKS + n + j] = run.bx[V, j]
        run.steps[at_row, AT_BLOCKS + 2 * n + j] = run.bx[A, j]
    run.si[N_ROWS] += 1
    run.si[N_STEPS] += 1
    for j in range(b):
        x0, x1, x2 = fundamental(run.blk[1, W2, j], run.blk[1, DAMP, j], h)
        run.bx[U, j], run.bx[U_LOW, j] = two_sum(
            run.bx[U, j], run.bx[U_LOW, j], run.bx[V, j] * h + run.bx[A, j] * x1 + run.bx[K, j] * x2,
        )  # fmt: skip
        run.bx[V, j] += run.bx[A, j] * x0 + run.bx[K, j] * x1
    to_dofs(run, 1, b, h)
    for a in range(m):
        run.sm[G, a] = 0.0
    if found < 0.0:
        run.sx[TIME] = t_end
        run.sx[TIME_LOW] = 0.0
        return DONE
    run.sx[TIME], run.sx[TIME_LOW] = two_sum(run.sx[TIME], run.sx[TIME_LOW], h)
    contact_acceleration(run)
    start_direction(run)
    run.si[MODE] = SLIP
    run.sx[NEXT] = run.sx[FIRST]
    run.events[run.si[N_EVENTS], 0] = run.sx[TIME] + run.sx[TIME_LOW]
    run.events[run.si[N_EVENTS], 1] = EVENT_SLIP
    run.si[N_EVENTS] += 1
    return DONE


@entry
def run_single(run: Run, t_end: float, tol: float, stiff: float, t_pause: float) -> int:
    """Run from the state until the end, or until there is no space for the rows of another phase."""
    stalled = 0
    if run.si[MODE] == UNSETTLED:
        settle(run)
    while run.sx[TIME] + run.sx[TIME_LOW] < t_end:
        if run.si[N_ROWS] + REBASE + 2 > run.steps.shape[0] or run.si[N_PHASES] + 2 > run.phases.shape[0]:
            return FULL
        if run.si[N_EVENTS] + 2 > run.events.shape[0]:
            return FULL
        if run.sx[TIME] > t_pause:
            return PAUSE
        if stopped():
            return FULL
        t = run.sx[TIME]
        low = run.sx[TIME_LOW]
        if run.si[MODE] == STICK:
            code = stick_phase(run, t_end, run.places)
        else:
            code = slip_phase(run, t_end, tol, stiff, run.places)
        if code != DONE:
            return code
        for i in range(run.sd.shape[1]):
            if not abs(run.sd[POS, i]) + abs(run.sd[VEL, i]) < 1e300:
                return NOT_FINITE
        stalled = stalled + 1 if (run.sx[TIME] - t) + (run.sx[TIME_LOW] - low) <= 1e-15 * abs(t) else 0
        if stalled > 50:
            return ENDLESS
    return DONE
