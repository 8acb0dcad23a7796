"""The loop of a run: BDF between transitions, where it is asked for, the one-step method, and breakpoints."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel, run_entry
from fricmb.integrate.contact.rest_problem import Rest
from fricmb.integrate.contact.transition import Before, transition
from fricmb.integrate.methods.attempt_step import Clock, advance, settled
from fricmb.integrate.methods.backward_differences import Differences, hand_over, is_slower, may_begin
from fricmb.integrate.methods.bdf_stability import BdfGuard
from fricmb.integrate.methods.bdf_step import bdf_step, start_history
from fricmb.integrate.methods.bdf_transitions import calm, note_loads
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.output.recorder import Rows
from fricmb.integrate.problem import Floats
from fricmb.integrate.run.breakpoints import reached, set_window
from fricmb.integrate.run.outcomes import ACCEPTED, CHANGED, DONE, FULL, HANDOVER, SLICE_OVER
from fricmb.integrate.run.slices import slice_over, ticks
from fricmb.integrate.signals.longest_steps import OF_BDF, kink_from, longest_from
from fricmb.integrate.step.one_step_room import Accuracy, OneStep
from fricmb.integrate.step.step_matrix import forget


@kernel
def arrive(packed: Packed, s: Scratch, y: State, r: Rest, old: Before, out: Rows, clock: Clock, stop: float) -> int:
    """Go through a stop that has been reached: DONE at the end of the run, else as a transition."""
    y.t = stop
    if out.used[0] > 0:
        # the last row is this instant up to round-off
        out.values[out.used[0] - 1, 0] = stop
    if stop >= clock.span[1]:
        return DONE
    stop = set_window(clock, s.window, stop)
    code = settled(transition(packed, s, y, -1, False, r, old, out))
    clock.h = min(clock.usual, 0.1 * (stop - y.t))
    clock.growth = np.inf
    return code


@kernel
def crowded(out: Rows, n_s: int, nc: int) -> bool:
    """Whether the rows of one more step, its transitions and those of a breakpoint at its end might not find space."""
    return bool(out.used[0] + 2 * n_s + 4 > out.kind.shape[0] or out.used[1] + 2 * nc + 2 > out.event.shape[0])


@run_entry
def drive(
    packed: Packed, s: Scratch, y: State, end: State, one: OneStep, multi: OneStep, acc: Accuracy,
    past: Differences, guard: BdfGuard, r: Rest, old: Before, out: Rows, clock: Clock, edge: Floats, limit: Floats,
) -> int:  # fmt: skip
    """Step from y until the end of the span, or until a slice is over or the space for rows is used up.

    Steps are those of the one-step method ``one``, and where the history ``past`` lets BDF begin those of ``multi``.
    ``edge``, ``limit``: how long inputs let steps be (see ``LongestSteps``).
    """
    stop = set_window(clock, s.window, y.t)
    begun = ticks()
    while True:
        seen = longest_from(edge, limit, y.t)
        left = min(stop - y.t, kink_from(edge, limit, y.t, seen))
        clock.longest = min(clock.bound, seen)
        if reached(y.t, stop):
            code = arrive(packed, s, y, r, old, out, clock, stop)
            stop = set_window(clock, s.window, y.t)
            one.last_h = 0.0
            past.on = 0
        elif crowded(out, one.tab.c.shape[0], y.mode.shape[0]):
            # not on a stop: the loop that begins anew would take it for one behind, and what jumps there for motion
            return FULL
        elif past.on == 1:
            code = bdf_step(packed, s, y, end, multi, acc, past, guard, out, min(left, OF_BDF * seen))
            if code == ACCEPTED and is_slower(past, max(clock.usual, clock.wanted)):
                clock.h = clock.usual
            if code == HANDOVER:
                clock.h = max(clock.h, past.h)
                hand_over(past)
        else:
            code = advance(packed, s, y, end, one, acc, r, old, out, clock, left)
            h = y.t - end.t
            if may_begin(past, code) and calm(packed, y, h):
                usual = past.good if past.good > 0.0 else h
                start_history(packed, s, end, y, one, past, min(usual, 0.25 * h))
                note_loads(packed, s, end, y, guard)
                if packed.elements.address.shape[0] > 0:
                    forget(multi.fac)
        if code > CHANGED:
            return code
        # not on a stop, which would be taken for one behind
        if slice_over(begun) and not reached(y.t, stop):
            return SLICE_OVER
