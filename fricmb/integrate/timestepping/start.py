"""Where a run starts, and where something prescribed jumps: which contacts rest there, and what holds them."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel, run_entry
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.problem import EVENT_REVERSAL, EVENT_SLIP, SLIP, STICK
from fricmb.integrate.timestepping.free_motion import set_signals, set_window
from fricmb.integrate.timestepping.friction_discs import slide_radius
from fricmb.integrate.timestepping.layout import HERE, MIDDLE, WHOLE
from fricmb.integrate.timestepping.recorder import keep_event, keep_row
from fricmb.integrate.timestepping.room import Run
from fricmb.integrate.timestepping.step import take_step

#: Parts of velocities that are nothing: round-off, and what contacts at rest are solved to.
ROUND_OFF, CREEP = 1e-12, 1e-9
#: Part of a usual step that is none: to ask what holds the contacts at an instant.
PROBE = 1e-3


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
    h = min(PROBE * run.step, 0.5 * (run.s.window[1] - t))
    if not h > 0.0:
        return
    take_step(run, HERE, WHOLE, t, h)
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
    set_signals(run, WHOLE, run.time + run.step)
    for c in range(run.mode.shape[1]):
        row0 = run.row[c]
        d = run.row[c + 1] - row0
        size = run.noise
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


@run_entry
def begin(run: Run, given: bool) -> None:
    """Signals, relative velocities and modes at the start."""
    set_window(run, 0)
    set_signals(run, HERE, run.time)
    relative_velocities(run, ROUND_OFF)
    for c in range(run.mode.shape[1]):
        still = magnitude(run.row, c, run.g[HERE]) == 0.0
        if not given or not still:
            run.mode[HERE, c] = STICK if still else SLIP
    if not given and run.mode.shape[1] > 0:
        # what nothing can hold slips from the start
        take_step(run, HERE, WHOLE, run.time, PROBE * run.step)
        for c in range(run.mode.shape[1]):
            if run.mode[HERE, c] == STICK and run.mode[WHOLE, c] == SLIP:
                run.mode[HERE, c] = SLIP
    if run.goes_on == 0.0:
        probe(run, run.time)
