"""The loop of a run by steps that are condensed to the contacts: steps and breakpoints."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel, run_entry
from fricmb.integrate.contact.rest_problem import Rest
from fricmb.integrate.contact.transition import Before, transition
from fricmb.integrate.methods.attempt_step import Clock, advance, settled
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.output.recorder import Rows
from fricmb.integrate.problem import Floats
from fricmb.integrate.run.breakpoints import reached, set_window
from fricmb.integrate.run.outcomes import CHANGED, DONE, FULL, SLICE_OVER
from fricmb.integrate.run.slices import slice_over, ticks
from fricmb.integrate.signals.longest_steps import kink_from, longest_from
from fricmb.integrate.step.one_step_room import Accuracy, OneStep


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
    packed: Packed, s: Scratch, y: State, end: State, one: OneStep, acc: Accuracy, r: Rest, old: Before, out: Rows,
    clock: Clock, edge: Floats, limit: Floats,
) -> int:  # fmt: skip
    """Step from y until the end of the span, or until a slice is over or the space for rows is used up.

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
        elif crowded(out, one.tab.c.shape[0], y.mode.shape[0]):
            # not on a stop: the loop that begins anew would take it for one behind, and what jumps there for motion
            return FULL
        else:
            code = advance(packed, s, y, end, one, acc, r, old, out, clock, left)
        if code > CHANGED:
            return code
        # not on a stop, which would be taken for one behind
        if slice_over(begun) and not reached(y.t, stop):
            return SLICE_OVER
