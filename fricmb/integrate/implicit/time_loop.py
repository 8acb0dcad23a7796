"""The loop of a run: BDF between transitions, where it is asked for, the one-step method, and what stops it."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import run_entry
from fricmb.integrate.implicit.attempt_step import arrive, attempt_step, grow
from fricmb.integrate.implicit.bdf.bdf_history import Formula, start_past
from fricmb.integrate.implicit.bdf.bdf_step import attempt_bdf_step
from fricmb.integrate.implicit.bdf.turns import Differences, hand_over, is_slower, may_begin
from fricmb.integrate.implicit.between.between_stages import growth_of_slip
from fricmb.integrate.implicit.equations.accelerations import react
from fricmb.integrate.implicit.equations.projection import project_velocities
from fricmb.integrate.implicit.equations.singular_position import start_watch, starts_dependent
from fricmb.integrate.implicit.events.load_kinks import mark_bends
from fricmb.integrate.implicit.modes.mode_decision import decide, mark_rest
from fricmb.integrate.implicit.modes.mode_enumeration import FOUND, SEVERAL
from fricmb.integrate.implicit.modes.mode_trial import most_light
from fricmb.integrate.implicit.modes.transition import bring_to_rest, least_held, open_joint, take_given
from fricmb.integrate.implicit.modes.uniqueness import margins
from fricmb.integrate.implicit.output.recorder import Record, crowded
from fricmb.integrate.implicit.scene.control import Control
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.implicit.scene.watch import Watch
from fricmb.integrate.implicit.stages.one_step import (
    has_joints,
)
from fricmb.integrate.implicit.stages.stages import Stages
from fricmb.integrate.problem import Codes, Floats
from fricmb.integrate.run.breakpoints import next_stop, reached, set_window
from fricmb.integrate.run.outcomes import (
    ACCEPTED,
    DONE,
    FAIL_LOST,
    FAIL_MARGIN,
    FAIL_MODES,
    FAIL_SEVERAL,
    FAIL_SINGULAR,
    FULL,
    HANDOVER,
    SLICE_OVER,
)
from fricmb.integrate.run.slices import slice_over, ticks
from fricmb.integrate.signals.longest_steps import OF_BDF, kink_from, longest_from

#: Steps of the one-step method, in times by which slip grows e-fold, from which on BDF does not begin: what the short
#: steps of its start err by would grow with the slip.
GROWING = 0.1
#: Times its step that the one-step method may want for the next one where BDF begins without joints: one that was cut
#: short says nothing of what BDF has to get by.
NATURAL = 2.0


@run_entry
def begin(
    mech: Mech,
    k: Moving,
    w: Instant,
    y: State,
    c: Control,
    out: Watch,
    part: Codes,
    given: bool,
    small: float,
    reach: float,
) -> int:
    """Modes, forces and accelerations at the start.

    ``small``: slip that is round-off there; ``reach``: root of the energy beside which round-off of slip is seen later.
    """
    set_window(c, k.s.window, y.t + 4e-16 * abs(y.t) + 1e-300)
    if not project_velocities(mech, k, w, y, False, False):
        return FAIL_SINGULAR
    start_watch(mech, w, out, 0.0)
    if starts_dependent(mech, w):
        return FAIL_SINGULAR
    mark_rest(mech, y, small, part)
    if given:
        take_given(mech, k, w, y, c.span[1] - c.span[0], part)
    code = decide(mech, k, w, y, part, -1)
    if code != FOUND:
        if margins(mech, k, w, y, out, True) <= 0.0:
            return FAIL_MARGIN
        return FAIL_SEVERAL if code == SEVERAL else FAIL_MODES
    # what sticks, or sets out from rest, moves by nothing: not by the round-off of velocities given or projected, nor
    # by what a run that ended on the way into rest has left
    if not (bring_to_rest(mech, k, w, y, part) and react(mech, k, w, y, False)):
        return FAIL_MODES
    grow(mech, c, out, k, y)
    out.top_slip = max(out.top_slip, reach * np.sqrt(most_light(mech, k, y)))
    if margins(mech, k, w, y, out, True) <= 0.0:
        return FAIL_MARGIN
    mark_bends(mech, k, out)
    for _ in range(mech.joint.port.shape[0]):
        worst = least_held(mech, y, False)
        if worst < 0:
            break
        code = open_joint(mech, k, w, y, out, worst)
        if code != DONE:
            return FAIL_SINGULAR if code == FAIL_SINGULAR else FAIL_LOST
        mark_rest(mech, y, small, part)
        code = decide(mech, k, w, y, part, -1)
        if code != FOUND:
            return FAIL_SEVERAL if code == SEVERAL else FAIL_MODES
    return DONE


@run_entry
def drive(
    mech: Mech, k: Moving, w: Instant, y: State, end: State, before: State, st: Stages, c: Control, out: Watch,
    rec: Record, part: Codes, past: Differences, formula: Formula, edge: Floats, limit: Floats,
) -> int:  # fmt: skip
    """Step from y until the end of the span, or until a slice is over or the space for steps is used up.

    Steps are those of the one-step method, and where the history ``past`` lets BDF begin those of ``formula``.
    ``edge``, ``limit``: how long inputs let steps be (see ``LongestSteps``).
    """
    stop = set_window(c, k.s.window, y.t)
    begun = ticks()
    while True:
        seen = longest_from(edge, limit, y.t)
        goal = min(stop, y.t + kink_from(edge, limit, y.t, seen))
        c.longest = min(c.bound, seen)
        # a stop is kept until it has been gone through: a step may end on it to the last digit
        if reached(y.t, stop):
            code = arrive(mech, k, w, y, before, c, out, rec, part, stop)
            past.on = 0
            if code == DONE and stop >= c.span[1]:
                return DONE
            stop = next_stop(c, y.t)
        elif crowded(rec, y.mode.shape[0]):
            return FULL
        elif past.on == 1:
            code = attempt_bdf_step(mech, k, w, y, end, st, c, out, rec, past, formula, min(goal - y.t, OF_BDF * seen))
            if code == ACCEPTED and is_slower(past, formula.usual):
                c.h = formula.usual
            elif code == HANDOVER:
                c.h = max(c.h, past.h)
                hand_over(past)
        else:
            t = y.t
            code = attempt_step(mech, k, w, y, end, before, st, c, out, rec, part, goal)
            h = y.t - t
            found = may_begin(past, code) and h > 0.0 and (has_joints(y) or c.wanted <= NATURAL * h)
            if found and growth_of_slip(mech, k, y, st, h) <= GROWING:
                formula.usual = max(h, c.wanted)
                start_past(y, past, formula, min(0.1 * h, past.good if past.good > 0.0 else h))
        if code > FULL:
            return code
        if slice_over(begun) and not reached(y.t, stop):
            return SLICE_OVER
