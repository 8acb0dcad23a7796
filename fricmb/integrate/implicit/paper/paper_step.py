"""Steps of the published scheme: BDF2 inside a mode, backward Euler where it changes, stick tried first.

Kinkaid, O'Reilly and Papadopoulos (2005), Eqs. (12) to (14); see :mod:`~fricmb.integrate.methods.bdf2_paper`.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel, run_entry
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.compile.room import room
from fricmb.integrate.implicit.attempt_step import grow
from fricmb.integrate.implicit.equations.accelerations import react
from fricmb.integrate.implicit.equations.slip_rows import aim, keep_held
from fricmb.integrate.implicit.output.recorder import Record, copy_state, crowded, record_step
from fricmb.integrate.implicit.scene.control import Control
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State, state_of
from fricmb.integrate.implicit.scene.watch import Watch
from fricmb.integrate.implicit.stages.near_rest import choose_forms, prepare_steep, prepare_turns
from fricmb.integrate.implicit.stages.one_step import (
    last_stage,
    measure,
    measure_states,
)
from fricmb.integrate.implicit.stages.stage_newton import iterate_stages
from fricmb.integrate.implicit.stages.stages import Stages, bring_up_to_date, factor_stages, linearise
from fricmb.integrate.model.friction_cone import cone_margin
from fricmb.integrate.model.law_values import point_along
from fricmb.integrate.problem import LAW_SMOOTH, NORMAL_LAW, OPEN, SLIP, STICK, Codes, Floats, Problem
from fricmb.integrate.run.mode_changes import record_changes
from fricmb.integrate.run.outcomes import DONE, FAIL_MODES, FAIL_STEP, FULL, SLICE_OVER
from fricmb.integrate.run.slices import slice_over, ticks

#: Matrices for a step at most, each from where the iterations with the one before have got to.
TRIES = 5
#: Part of what counts as 1 to which equations are solved: their error is not to be seen beside that of the formula.
ACCURACY = 1e-11


class Last(Layout):
    """The step before: positions, velocities and states at its start, ``h`` its length (0: none) and its modes.

    ``base``: what the formula makes of the past; ``trial`` modes that are tried.
    """

    q: Floats
    v: Floats
    z: Floats
    h: float
    mode: Codes
    trial: Codes
    base: State


def last_of(problem: Problem) -> Last:
    """Before the first step."""
    n, nc = problem.n, problem.n_c
    modes = np.zeros(nc, np.int8), np.zeros(nc, np.int8)
    return room(Last(np.zeros(n), np.zeros(n), np.zeros(problem.n_z), 0.0, *modes, room(state_of(problem))))


@kernel
def formula(y: State, last: Last, h: float, two: bool) -> float:
    """Put the history of the step into ``last.base``; returns b h, of BDF2 (``two``) or backward Euler."""
    h0, base = last.h, last.base
    a1, a2, b = 0.0, 1.0, 1.0
    if two:
        a1 = -h * h / (h0 * (h0 + 2.0 * h))
        a2 = (h0 + h) ** 2 / (h0 * (h0 + 2.0 * h))
        b = (h0 + h) / (h0 + 2.0 * h)
    copy_state(y, base)
    for before, here, past in ((last.q, y.q, base.q), (last.v, y.v, base.v), (last.z, y.z, base.z)):
        for i in range(past.shape[0]):
            past[i] = a1 * before[i] + a2 * here[i]
    for c in range(y.mode.shape[0]):
        base.mode[c] = last.trial[c]
    return b * h


@block
def solve_with(mech: Mech, k: Moving, y: State, end: State, st: Stages, c: Control, last: Last, h: float) -> float:
    """Solve the step for the trial modes; b h of its formula, 0 where it is not solved.  ``end``: the Jacobian's."""
    two = last.h > 0.0
    for p in range(y.mode.shape[0]):
        two = two and last.trial[p] == last.mode[p]
    beta_h = formula(y, last, h, two)
    base = last.base
    base.t = y.t + h - beta_h
    measure(mech, c, y, h, st.scale)
    measure_states(c, y, h, st)
    copy_state(y, end)
    end.t = y.t + h
    for p in range(y.mode.shape[0]):
        end.mode[p] = last.trial[p]
    c.counts[2] += 1
    for part, target in ((y.v, st.V), (y.lam, st.lam), (y.F, st.F), (y.z, st.z)):
        for i in range(part.shape[0]):
            target[0, i] = part[i]
    keep_held(mech, base.mode, y.F, st.F[0])
    for attempt in range(TRIES):
        # of a law that is steep the slopes are those of the stage
        st.steep.on = 1 if attempt == TRIES - 1 and st.steep.row.shape[0] > 0 else 0
        choose_forms(mech, k, end, st, beta_h)
        linearise(mech, k, end, st)
        if not factor_stages(mech, st, beta_h):
            return 0.0
        prepare_turns(mech, st)
        prepare_steep(mech, st)
        if iterate_stages(mech, k, base, st, beta_h, beta_h, ACCURACY) > 0:
            bring_up_to_date(mech, k, base, st, beta_h)
            return beta_h
        # a fixed step may be long beside what turns the direction of slip: on with slopes from where this has got to
        for part, target in ((end.q, st.Q), (end.v, st.V), (end.F, st.F), (end.z, st.z), (end.N, st.N), (end.g, st.g)):
            for i in range(part.shape[0]):
                part[i] = target[0, i]
        aim(mech, end.mode, end.F, end.n)
    return 0.0


@kernel
def revise(mech: Mech, k: Moving, y: State, st: Stages, mode: Codes) -> bool:
    """Change the modes that the solution just found contradicts; True where there are any."""
    port, changed = mech.port, False
    for c in range(mode.shape[0]):
        N = st.N[0, c]
        if port.normal[c] == NORMAL_LAW and (N <= 0.0) != (mode[c] == OPEN):
            mode[c] = OPEN if N <= 0.0 else SLIP
            changed = True
            continue
        if port.law[c] == LAW_SMOOTH or mode[c] != STICK:
            continue
        if cone_margin(port, port.laws, c, k.s, st.F[0], max(N, 0.0)) < 0.0:
            mode[c] = SLIP
            changed = True
            point_along(port.row, c, st.F[0], -1.0, y.n)
    return changed


@block
def find_modes(mech: Mech, k: Moving, y: State, end: State, st: Stages, c: Control, last: Last, h: float) -> bool:
    """Solve a step h from y, stick tried first; False where no modes are right."""
    for p in range(y.mode.shape[0]):
        free = SLIP if mech.port.law[p] == LAW_SMOOTH else STICK
        last.trial[p] = OPEN if y.mode[p] == OPEN else free
    for _ in range(3 * y.mode.shape[0] + 3):
        if solve_with(mech, k, y, end, st, c, last, h) == 0.0:
            return False
        if not revise(mech, k, y, st, last.trial):
            return True
    return False


@run_entry
def drive_paper(
    mech: Mech, k: Moving, w: Instant, y: State, end: State, before: State, st: Stages, c: Control, out: Watch,
    rec: Record, last: Last, h: float,
) -> int:  # fmt: skip
    """Step from y to the end of the span, or until the space for rows is used up or a slice is over."""
    begun, t_end = ticks(), c.span[1]
    while True:
        if crowded(rec, y.mode.shape[0]):
            return FULL
        left = t_end - y.t
        if left <= 1e-12 * max(abs(t_end), abs(y.t)):
            return DONE
        step = h if left > h * (1.0 + 1e-9) else left
        copy_state(y, before)
        if not find_modes(mech, k, y, end, st, c, last, step):
            return FAIL_STEP
        last_stage(mech, last.base, end, st)
        end.t = y.t + step if step < left else t_end
        if not react(mech, k, w, end, False):
            return FAIL_MODES
        for i in range(y.rate.shape[0]):
            c.power[0, i] = 0.5 * (y.rate[i] + end.rate[i])
            end.work[i] = y.work[i] + step * c.power[0, i]
        # the published scheme takes the force from the step's own equations
        for a in range(y.F.shape[0]):
            end.F[a] = st.F[0, a]
        keep_step(mech, rec, y, end, before, st, c, last, step)
        c.counts[0] += 1
        copy_state(end, y)
        grow(mech, c, out, k, y)
        if slice_over(begun):
            return SLICE_OVER


@kernel
def keep_step(
    mech: Mech, rec: Record, y: State, end: State, before: State, st: Stages, c: Control, last: Last, h: float
) -> None:
    """A row of the step, with its modes and forces, transitions at its end, and the history of the next one."""
    for p in range(y.mode.shape[0]):
        y.mode[p] = end.mode[p]
    record_step(mech, rec, y, end, st, c, h)
    for a in range(y.F.shape[0]):
        rec.force[rec.used[0] - 1, a] = end.F[a]
        rec.force[rec.used[0] - 1, y.F.shape[0] + a] = end.n[a]
    record_changes(mech.port, end.t, end, before, rec)
    for here, past in ((y.q, last.q), (y.v, last.v), (y.z, last.z)):
        for i in range(past.shape[0]):
            past[i] = here[i]
    for p in range(y.mode.shape[0]):
        last.mode[p] = end.mode[p]
    last.h = h
