"""The run of one contact under constant friction on a linear structure with at most linear loads."""

from __future__ import annotations

import math

from fricmb.integrate.collocation.block_motion import fundamental, two_sum
from fricmb.integrate.collocation.nodes import RUNGS
from fricmb.integrate.collocation.one_contact.landing import arrive, first_stop, land, nearly_stopped
from fricmb.integrate.collocation.one_contact.phase import (
    accelerations,
    begin_phase,
    contact_acceleration,
    keep_row,
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
from fricmb.integrate.collocation.one_contact.stick import AGAIN, NO_END, release_time
from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel, run_entry
from fricmb.integrate.event_kinds import EVENT_SLIP
from fricmb.integrate.formulas.step_control import ONE_STEP_SAFETY, step_factor
from fricmb.integrate.problem import SLIP, STICK
from fricmb.integrate.run.outcomes import SLICE_OVER
from fricmb.integrate.run.slices import slice_over, ticks

#: Why a run came back: at its end; no space for rows; for a progress report; or what went wrong.
DONE, FULL, UNDERFLOW, ENDLESS, NOT_FINITE = range(5)
#: Steps after which the reference point moves along.
REBASE = 16
#: Mode of a contact at g = 0 whose accelerations have not been asked yet.
UNSETTLED = -1
#: Kernels that are compiled one by one.
BLOCKS = ("transfer_weights", "solve_slip", "land", "arrive", "begin_phase", "stick_phase", "slip_phase")


@kernel
def length_factor(error: float, s: int) -> float:
    """By what a step may grow or has to shrink."""
    return float(min(3.0, max(0.05, step_factor(error, s, ONE_STEP_SAFETY))))


@kernel
def rung_of(run: Run, h: float) -> int:
    """The longest rung not above h."""
    ratio = run.ladder[0] / h
    if ratio <= 1.0:
        return 0
    return int(min(RUNGS, math.ceil(4.0 * math.log2(ratio) - 1e-9)))


@block
def slip_phase(run: Run, t_end: float, tol: float, stiff: float) -> int:
    """Slip until it ends, the run ends, or the reference point should move along; DONE, or what went wrong."""
    n = run.pos.shape[0]
    m = run.belt.shape[0]
    s = run.basis.shape[0]
    begin_phase(run, 0, n)
    rates(run)
    since = 0.0
    taken = 0
    fresh = True
    for a in range(m):
        fresh = fresh and run.g[a] == 0.0
    while taken < REBASE:
        left = (t_end - run.time) - run.time_low
        if left <= 0.0:
            break
        rung = rung_of(run, run.next_step)
        if rung >= RUNGS:
            return UNDERFLOW
        h = run.ladder[rung]
        accelerations(run, 0, n, since)
        if h >= left:
            h = left
            slot = 0
            transfer_weights(run, h, 0, stiff)
        else:
            slot = on_ladder(run, rung, stiff)
        weigh(run, h)
        for a in range(m):
            for i in range(s):
                run.direction[a, i] = run.n[a]
        if not solve_slip(run, slot, h, tol):
            run.next_step = 0.5 * h
            run.counts[1] += 1
            continue
        r0 = 0.0
        for a in range(m):
            r0 += run.g[a] * run.g[a]
        r0 = math.sqrt(r0)
        stop = first_stop(run, r0, h, tol)
        if stop < 1.5:
            gone = land(run, h, stop, since, tol, stiff)
            if gone > 0.0:
                arrive(run, since + gone)
                return DONE
            run.counts[1] += 1
            run.next_step = max(stop * h * length_factor(-gone, s), 0.01 * h)
            continue
        error = step_error(run, h, tol)
        error = max(error, stop - 2.0)
        if error > 1.0:
            run.counts[1] += 1
            run.next_step = h * length_factor(error, s)
            continue
        loss = keep_slip(run, h)
        end_state(run, slot, h)
        commit(run, h, loss)
        since += h
        taken += 1
        if fresh:
            run.first_step = h
            fresh = False
        run.next_step = h * length_factor(error, s) * 1.0000001
        if nearly_stopped(run, since, tol, run.rhs[s - 1], h):
            arrive(run, since)
            return DONE
    to_dofs(run, 0, n, since)
    return DONE


@block
def stick_phase(run: Run, t_end: float, begun: int) -> int:
    """Stick until the force reaches its cone or the run ends; ``begun``: the slice."""
    n = run.pos.shape[0]
    m = run.belt.shape[0]
    b = run.stuck_blocks
    contact_acceleration(run)
    for a in range(m):
        run.free[a, 0] = run.out[1, a]
    begin_phase(run, 1, b)
    accelerations(run, 1, b, 0.0)
    for a in range(m):
        # ``free`` holds the force at the start and its rate beside the blocks' part
        value = 0.0
        for i in range(n):
            load = run.load_1[i]
            for j in range(n):
                load -= run.stiff[i, j] * run.stuck_v[j]
            value += run.mw[a, i] * load
        run.out[0, a] = value
    for a in range(m):
        value = 0.0
        for c in range(m):
            value -= run.D_inv[a, c] * run.out[0, c]
        for j in range(b):
            value -= run.hold_v[a, j] * run.e1[j]
        run.free[a, 1] = value
    left = (t_end - run.time) - run.time_low
    found = release_time(run, left, begun)
    if found == AGAIN:
        return SLICE_OVER
    run.looks = 0.0
    if found == NO_END:
        return ENDLESS
    h = left if found < 0.0 else found
    keep_row(run, STICK, b, h)
    for j in range(b):
        x0, x1, x2 = fundamental(run.w2[1, j], run.damp[1, j], h)
        run.u[j], run.u_low[j] = two_sum(run.u[j], run.u_low[j], run.v[j] * h + run.a[j] * x1 + run.k[j] * x2)
        run.v[j] += run.a[j] * x0 + run.k[j] * x1
    to_dofs(run, 1, b, h)
    for a in range(m):
        run.g[a] = 0.0
    if found < 0.0:
        run.time = t_end
        run.time_low = 0.0
        return DONE
    run.time, run.time_low = two_sum(run.time, run.time_low, h)
    contact_acceleration(run)
    start_direction(run)
    run.mode = SLIP
    run.next_step = run.first_step
    run.events[run.used[2], 0] = run.time + run.time_low
    run.events[run.used[2], 1] = EVENT_SLIP
    run.used[2] += 1
    return DONE


@run_entry
def run_single(run: Run, t_end: float, tol: float, stiff: float) -> int:
    """Run from the state until the end, a slice is over, or there is no space for the rows of another phase."""
    stalled = 0
    begun = ticks()
    if run.mode == UNSETTLED:
        settle(run)
    while run.time + run.time_low < t_end:
        if run.used[0] + REBASE + 2 > run.steps.shape[0] or run.used[1] + 2 > run.phases.shape[0]:
            return FULL
        if run.used[2] + 2 > run.events.shape[0]:
            return FULL
        t = run.time
        low = run.time_low
        if run.mode == STICK:
            code = stick_phase(run, min(t_end, run.time + run.bound), begun)
        else:
            code = slip_phase(run, t_end, tol, stiff)
        if code != DONE:
            return code
        for i in range(run.pos.shape[0]):
            if not abs(run.pos[i]) + abs(run.vel[i]) < 1e300:
                return NOT_FINITE
        stalled = stalled + 1 if (run.time - t) + (run.time_low - low) <= 1e-15 * abs(t) else 0
        if stalled > 50:
            return ENDLESS
        if slice_over(begun) and run.time + run.time_low < t_end:
            return SLICE_OVER
    return DONE
