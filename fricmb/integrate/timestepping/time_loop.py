"""The loop of a run: each step done whole and by halves, whose difference is the error; rows and transitions."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel, run_entry
from fricmb.integrate.compile.kernel_library import long_loops
from fricmb.integrate.run.stopped import stopped
from fricmb.integrate.step.step_control import ladder, step_factor
from fricmb.integrate.timestepping.free_motion import set_window
from fricmb.integrate.timestepping.layout import DRIVES, HERE, MIDDLE, NO_NUMBER, SOUND, THERE, WHOLE
from fricmb.integrate.timestepping.recorder import copy_state, keep_event, keep_row
from fricmb.integrate.timestepping.room import Run
from fricmb.integrate.timestepping.start import jump
from fricmb.integrate.timestepping.step import forces_at_start, take_step
from fricmb.integrate.timestepping.step_error import doubtful, step_error

#: Shortest steps to which steps are shortened until it is clear which transitions they hold.
COARSE = 1e4
#: Rungs of the ladder between a step and its double: halves of steps are steps, too.
RUNGS = 2
#: Why a run came back.
DONE, FULL, NOT_FINITE, NEGATIVE = range(4)


@kernel
def is_finite(run: Run) -> bool:
    """Whether the new state is."""
    total = 0.0
    for i in range(run.load.shape[0]):
        total += 0.0 * (run.q[THERE, i] + run.v[THERE, i])
    return bool(total == 0.0)


@kernel
def accept(run: Run, slot: int, t: float) -> None:
    """Energies, transitions and the row of a step that ended in ``slot`` at t."""
    if run.n_steps == 0 and run.n_rows == 0:
        if run.goes_on == 0.0:
            forces_at_start(run, slot)
        keep_row(run, HERE, slot, run.time)
    run.n_steps += 1
    for c in range(run.total.shape[0]):
        run.total[c] += run.loss[slot, c]
        if run.what[slot, c] >= 0:
            keep_event(run, run.moment[slot, c], c, run.what[slot, c])
    run.spent[HERE, 0] += run.spent[slot, 0]
    run.spent[HERE, 1] += run.spent[slot, 1]
    keep_row(run, slot, slot, t)


@kernel
def next_length(run: Run) -> float:
    """Length of the next step: to the next stop at most."""
    left = run.stops[run.n_stop] - run.time
    fixed = run.fixed_step
    h = fixed if fixed > 0.0 else ladder(min(run.step, run.longest), RUNGS)
    if h >= left * (1.0 - 1e-9):
        return float(left)
    if fixed == 0.0 and h > 0.5 * left:
        return float(0.5 * left)
    return float(h)


@kernel
def adapt(run: Run, h: float, error: float, settled: bool) -> bool:
    """Set the length of the next step; whether this one is accepted."""
    if not settled:
        run.step = 0.25 * h
        fine = h <= run.shortest
    else:
        factor = step_factor(error, 3.0, 0.9)
        if error > 1.0:
            factor = min(step_factor(error, 2.0, 0.9), 0.5)
        run.step = h * min(2.0, max(0.1, factor))
        fine = error <= 1.0 or h <= run.shortest
    run.step = max(run.step, run.shortest)
    if fine and (not settled or error > 1.0):
        run.n_unsettled += 1
    return bool(fine)


@kernel
def arrive(run: Run, t: float) -> None:
    """Go on from the end of a step; behind a stop functions of time are those of the next interval."""
    copy_state(run, THERE, HERE)
    stop = run.stops[run.n_stop]
    if t >= stop - 1e-14 * abs(stop) - 1e-300:
        t = stop
        run.n_stop += 1
        if run.n_stop < run.stops.shape[0]:
            run.time = t
            set_window(run, run.n_stop)
            jump(run, t)
    run.time = t


@run_entry
@long_loops
def drive(run: Run) -> int:
    """Step until the end, or until there is no space for rows or transitions."""
    while True:
        if run.time >= run.end or run.n_stop >= run.stops.shape[0]:
            return DONE
        space = run.n_rows + 3 <= run.row_t.shape[0]
        if stopped() or not space or run.n_events + 3 * run.mode.shape[1] > run.event.shape[0]:
            return FULL
        t = run.time
        h = next_length(run)
        run.fault = SOUND
        if run.fixed_step > 0.0:
            if not take_step(run, HERE, THERE, t, h):
                run.n_unsettled += 1
            if not is_finite(run) or run.fault == NO_NUMBER:
                return NOT_FINITE
            if run.fault == DRIVES:
                return NEGATIVE
            accept(run, THERE, t + h)
            arrive(run, t + h)
            continue
        settled = take_step(run, HERE, WHOLE, t, h)
        settled = take_step(run, HERE, MIDDLE, t, 0.5 * h) and settled
        settled = take_step(run, MIDDLE, THERE, t + 0.5 * h, 0.5 * h) and settled
        if not is_finite(run) or run.fault == NO_NUMBER:
            if h <= run.shortest:
                return NOT_FINITE
            run.step = 0.25 * h
            continue
        error = step_error(run)
        if error <= 1.0 and h > COARSE * run.shortest and doubtful(run, t, h):
            error = 2.0
        run.error = error
        if adapt(run, h, error, settled):
            if run.fault == DRIVES:
                return NEGATIVE
            accept(run, MIDDLE, t + 0.5 * h)
            accept(run, THERE, t + h)
            arrive(run, t + h)
        else:
            run.n_rejected += 1
