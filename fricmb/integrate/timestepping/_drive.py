"""The loop of a run: each step done whole and by halves, whose difference is the error; rows and transitions."""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import entry, kernel
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.problem import EVENT_REVERSAL, EVENT_SLIP, SLIP, STICK
from fricmb.integrate.run.stop import stopped
from fricmb.integrate.timestepping._error import doubtful, step_error
from fricmb.integrate.timestepping._free import set_signals, set_window
from fricmb.integrate.timestepping._layout import (
    DRIVES,
    END,
    ERROR,
    FAULT,
    FIXED,
    HERE,
    LONGEST,
    MIDDLE,
    N_EVENTS,
    N_REJECTED,
    N_ROWS,
    N_STEPS,
    N_STOP,
    N_UNSETTLED,
    NO_NUMBER,
    NOISE,
    SAME,
    SHORTEST,
    SOUND,
    STEP,
    THERE,
    TIME,
    WHOLE,
)  # fmt: skip
from fricmb.integrate.timestepping._review import slide_radius
from fricmb.integrate.timestepping._run import Run
from fricmb.integrate.timestepping._step import forces_at_start, take_step

#: Parts of velocities that are nothing: round-off, and what contacts at rest are solved to.
ROUND_OFF, CREEP = 1e-12, 1e-9
#: Part of a usual step that is none: to ask what holds the contacts at an instant.
PROBE = 1e-3
#: Shortest steps to which steps are shortened until it is clear which transitions they hold.
COARSE = 1e4
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
def copy_state(run: Run, source: int, target: int) -> None:
    """One slot of the state into another."""
    run.q[target] = run.q[source]
    run.v[target] = run.v[source]
    run.u[target] = run.u[source]
    run.du[target] = run.du[source]
    run.g[target] = run.g[source]
    run.w[target] = run.w[source]
    run.F[target] = run.F[source]
    run.ends[target] = run.ends[source]
    run.hold[target] = run.hold[source]
    run.grip[target] = run.grip[source]
    run.when[target] = run.when[source]
    run.known[target] = run.known[source]
    run.jolted[target] = run.jolted[source]
    run.mode[target] = run.mode[source]
    run.push[target] = run.push[source]


@kernel
def keep_row(run: Run, slot: int, normal: int, t: float) -> None:
    """A row of the state, with the normal forces of slot ``normal``."""
    k = run.i[N_ROWS]
    run.row_t[k] = t
    run.row_q[k] = run.q[slot]
    run.row_v[k] = run.v[slot]
    run.row_F[k] = run.ends[slot]
    run.row_g[k] = run.g[slot]
    run.row_N[k] = run.push[normal]
    run.row_mode[k] = run.mode[slot]
    run.row_loss[k] = run.total
    run.row_x[k, 0] = run.spent[HERE, 0]
    run.row_x[k, 1] = run.spent[HERE, 1]
    run.i[N_ROWS] = k + 1


@kernel
def keep_event(run: Run, t: float, c: int, kind: int) -> None:
    """Add a transition."""
    e = run.i[N_EVENTS]
    run.event[e, 0] = t
    run.event[e, 1] = c
    run.event[e, 2] = kind
    run.i[N_EVENTS] = e + 1


@kernel
def accept(run: Run, slot: int, t: float) -> None:
    """Energies, transitions and the row of a step that ended in ``slot`` at t."""
    if run.i[N_STEPS] == 0 and run.i[N_ROWS] == 0:
        if run.x[SAME] == 0.0:
            forces_at_start(run, slot)
        keep_row(run, HERE, slot, run.x[TIME])
    run.i[N_STEPS] += 1
    for c in range(run.total.shape[0]):
        run.total[c] += run.loss[slot, c]
        if run.what[slot, c] >= 0:
            keep_event(run, run.moment[slot, c], c, run.what[slot, c])
    run.spent[HERE, 0] += run.spent[slot, 0]
    run.spent[HERE, 1] += run.spent[slot, 1]
    keep_row(run, slot, slot, t)


@kernel
def on_ladder(h: float) -> float:
    """The next smaller power of the square root of 2: halves of steps are steps, too."""
    return float(2.0 ** (math.floor(2.0 * math.log2(h) + 1e-9) / 2.0))


@kernel
def next_length(run: Run) -> float:
    """Length of the next step: to the next stop at most."""
    left = run.stops[run.i[N_STOP]] - run.x[TIME]
    fixed = run.x[FIXED]
    h = fixed if fixed > 0.0 else on_ladder(min(run.x[STEP], run.x[LONGEST]))
    if h >= left * (1.0 - 1e-9):
        return float(left)
    if fixed == 0.0 and h > 0.5 * left:
        return float(0.5 * left)
    return float(h)


@kernel
def adapt(run: Run, h: float, error: float, settled: bool) -> bool:
    """Set the length of the next step; whether this one is accepted."""
    if not settled:
        run.x[STEP] = 0.25 * h
        fine = h <= run.x[SHORTEST]
    else:
        factor = 0.9 * (error + 1e-12) ** (-1.0 / 3.0)
        if error > 1.0:
            factor = min(0.9 * error ** (-0.5), 0.5)
        run.x[STEP] = h * min(2.0, max(0.1, factor))
        fine = error <= 1.0 or h <= run.x[SHORTEST]
    run.x[STEP] = max(run.x[STEP], run.x[SHORTEST])
    if fine and (not settled or error > 1.0):
        run.i[N_UNSETTLED] += 1
    return bool(fine)


@kernel
def arrive(run: Run, t: float) -> None:
    """Go on from the end of a step; behind a stop functions of time are those of the next interval."""
    copy_state(run, THERE, HERE)
    stop = run.stops[run.i[N_STOP]]
    if t >= stop - 1e-14 * abs(stop) - 1e-300:
        t = stop
        run.i[N_STOP] += 1
        if run.i[N_STOP] < run.stops.shape[0]:
            run.x[TIME] = t
            set_window(run, run.i[N_STOP])
            jump(run, t)
    run.x[TIME] = t


@kernel
def jump(run: Run, t: float) -> None:
    """Signals behind a breakpoint; a belt whose velocity jumps ends what sticks, forces that hold may jump."""
    run.w[MIDDLE] = run.w[HERE]
    set_signals(run, HERE, t)
    for i in range(run.load.shape[0]):
        run.top_v[i] = max(run.top_v[i], abs(run.v[HERE, i]))
    run.g[MIDDLE] = run.g[HERE]
    relative_velocities(run, CREEP)
    for c in range(run.mode.shape[1]):
        run.known[HERE, c] = 0
        row0 = run.row[c]
        if run.mode[HERE, c] == SLIP and run.row[c + 1] - row0 == 1 and run.g[MIDDLE, row0] * run.g[HERE, row0] < 0.0:
            keep_event(run, t, c, EVENT_REVERSAL)
        if run.mode[HERE, c] == STICK:
            for a in range(run.row[c], run.row[c + 1]):
                if run.g[HERE, a] != 0.0 and run.mode[HERE, c] == STICK:
                    run.mode[HERE, c] = SLIP
                    keep_event(run, t, c, EVENT_SLIP)
    probe(run, t)
    keep_behind(run, t)


@kernel
def keep_behind(run: Run, t: float) -> None:
    """A second row where the velocity of a belt jumps: as things are behind it."""
    jumps = False
    for c in range(run.mode.shape[1]):
        row0 = run.row[c]
        d = run.row[c + 1] - row0
        for a in range(row0, row0 + d):
            size = max(abs(run.w[HERE, a]), abs(run.w[MIDDLE, a]))
            jumps = jumps or abs(run.w[HERE, a] - run.w[MIDDLE, a]) > ROUND_OFF * size
        speed = magnitude(run.row, c, run.g[HERE])
        if run.mode[HERE, c] == SLIP and speed > 0.0:
            radius = slide_radius(run, c, speed, run.push[HERE, c])
            for a in range(row0, row0 + d):
                run.ends[HERE, a] = -radius * run.g[HERE, a] / speed
    if jumps:
        keep_row(run, HERE, HERE, t)


@kernel
def probe(run: Run, t: float) -> None:
    """What holds the contacts at rest from t on: by a step that is nothing beside those of the run."""
    some = False
    for c in range(run.mode.shape[1]):
        some = some or run.mode[HERE, c] == STICK
    if not some:
        return
    h = min(PROBE * run.x[STEP], 0.5 * (run.s.window[1] - t))
    if not h > 0.0:
        return
    take_step(run, HERE, WHOLE, t, h, run.places)
    for c in range(run.mode.shape[1]):
        if run.mode[HERE, c] == STICK and run.mode[WHOLE, c] == STICK and run.known[WHOLE, c] == 1:
            run.known[HERE, c] = 1
            run.when[HERE, c] = run.when[WHOLE, c]
            run.grip[HERE, c] = run.grip[WHOLE, c]
            for a in range(run.row[c], run.row[c + 1]):
                run.hold[HERE, a] = run.hold[WHOLE, a]


@kernel
def relative_velocities(run: Run, fine: float) -> None:
    """G of the present state, 0 where it is below ``fine`` of what moves, has moved or will; that of slip as it is."""
    set_signals(run, WHOLE, run.x[TIME] + run.x[STEP])
    for c in range(run.mode.shape[1]):
        row0 = run.row[c]
        d = run.row[c + 1] - row0
        size = run.x[NOISE]
        part_of = fine if run.mode[HERE, c] == STICK else ROUND_OFF
        for a in range(row0, row0 + d):
            value = -run.w[HERE, a]
            size = max(size, part_of * abs(value), part_of * abs(run.w[WHOLE, a]))
            for e in range(run.w_start[a], run.w_start[a + 1]):
                part = run.w_coef[e] * run.v[HERE, run.w_dof[e]]
                value += part
                j = run.w_dof[e]
                size = max(size, part_of * abs(part), part_of * abs(run.w_coef[e]) * (run.top_v[j] + run.floor_v[j]))
            run.g[HERE, a] = value
        if magnitude(run.row, c, run.g[HERE]) <= size or (run.mode[HERE, c] == STICK and size == 0.0):
            for a in range(row0, row0 + d):
                run.g[HERE, a] = 0.0


@entry
def begin(run: Run, given: bool) -> None:
    """Signals, relative velocities and modes at the start."""
    set_window(run, 0)
    set_signals(run, HERE, run.x[TIME])
    relative_velocities(run, ROUND_OFF)
    for c in range(run.mode.shape[1]):
        still = magnitude(run.row, c, run.g[HERE]) == 0.0
        if not given or not still:
            run.mode[HERE, c] = STICK if still else SLIP
    if not given and run.mode.shape[1] > 0:
        # what nothing can hold slips from the start
        take_step(run, HERE, WHOLE, run.x[TIME], PROBE * run.x[STEP], run.places)
        for c in range(run.mode.shape[1]):
            if run.mode[HERE, c] == STICK and run.mode[WHOLE, c] == SLIP:
                run.mode[HERE, c] = SLIP
    if run.x[SAME] == 0.0:
        probe(run, run.x[TIME])


@entry
def drive(run: Run) -> int:
    """Step until the end, or until there is no room for rows or transitions."""
    while True:
        if run.x[TIME] >= run.x[END] or run.i[N_STOP] >= run.stops.shape[0]:
            return DONE
        room = run.i[N_ROWS] + 3 <= run.row_t.shape[0]
        if stopped() or not room or run.i[N_EVENTS] + 3 * run.mode.shape[1] > run.event.shape[0]:
            return FULL
        t = run.x[TIME]
        h = next_length(run)
        run.x[FAULT] = SOUND
        if run.x[FIXED] > 0.0:
            if not take_step(run, HERE, THERE, t, h, run.places):
                run.i[N_UNSETTLED] += 1
            if not is_finite(run) or run.x[FAULT] == NO_NUMBER:
                return NOT_FINITE
            if run.x[FAULT] == DRIVES:
                return NEGATIVE
            accept(run, THERE, t + h)
            arrive(run, t + h)
            continue
        settled = take_step(run, HERE, WHOLE, t, h, run.places)
        settled = take_step(run, HERE, MIDDLE, t, 0.5 * h, run.places) and settled
        settled = take_step(run, MIDDLE, THERE, t + 0.5 * h, 0.5 * h, run.places) and settled
        if not is_finite(run) or run.x[FAULT] == NO_NUMBER:
            if h <= run.x[SHORTEST]:
                return NOT_FINITE
            run.x[STEP] = 0.25 * h
            continue
        error = step_error(run)
        if error <= 1.0 and h > COARSE * run.x[SHORTEST] and doubtful(run, t, h):
            error = 2.0
        run.x[ERROR] = error
        if adapt(run, h, error, settled):
            if run.x[FAULT] == DRIVES:
                return NEGATIVE
            accept(run, MIDDLE, t + 0.5 * h)
            accept(run, THERE, t + h)
            arrive(run, t + h)
        else:
            run.i[N_REJECTED] += 1
