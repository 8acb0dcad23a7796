"""The loop of a BDF run of a mechanism: BDF between transitions, the one-step method around them."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import entry
from fricmb.integrate.constrained.attempt_step import arrive, radau_step
from fricmb.integrate.constrained.bdf_history import Formula, start_past
from fricmb.integrate.constrained.bdf_step import multistep
from fricmb.integrate.constrained.moving import Moving
from fricmb.integrate.constrained.problem_structs import Mech
from fricmb.integrate.constrained.radau_step import Control
from fricmb.integrate.constrained.recorder import Record, crowded
from fricmb.integrate.constrained.stages import Stages
from fricmb.integrate.constrained.state import Instant, State
from fricmb.integrate.constrained.watch import Watch
from fricmb.integrate.methods.backward_differences import ON, Differences, hand_over, is_slower, may_begin
from fricmb.integrate.problem import Codes
from fricmb.integrate.run.breakpoints import next_stop, reached, set_window
from fricmb.integrate.run.outcomes import ACCEPTED, DONE, FULL, HANDOVER
from fricmb.integrate.run.stop import stopped


@entry
def drive_bdf(
    mech: Mech, k: Moving, w: Instant, y: State, end: State, before: State, st: Stages, c: Control, out: Watch,
    rec: Record, part: Codes, past: Differences, formula: Formula,
) -> int:  # fmt: skip
    """Step from y until the end of the span, or until the space for steps is used up."""
    stop = set_window(c, k.s.window, y.t[0])
    while True:
        if stopped():
            return FULL
        # a stop is kept until it has been gone through: a step may end on it to the last digit
        if reached(y.t[0], stop):
            code = arrive(mech, k, w, y, before, c, out, rec, part, stop)
            past.status[ON] = 0
            if code == DONE and stop >= c.span[1]:
                return DONE
            stop = next_stop(c, y.t[0])
        elif crowded(rec, y.mode.shape[0]):
            return FULL
        elif past.status[ON] == 1:
            code = multistep(mech, k, w, y, end, st, c, out, rec, past, formula, stop - y.t[0], mech.address)
            if code == ACCEPTED and is_slower(past, formula.usual[0]):
                c.h[0] = formula.usual[0]
            elif code == HANDOVER:
                c.h[0] = max(c.h[0], past.h[0])
                hand_over(past)
        else:
            t = y.t[0]
            code = radau_step(mech, k, w, y, end, before, st, c, out, rec, part, stop, mech.address)
            h = y.t[0] - t
            if may_begin(past, code) and h > 0.0:
                formula.usual[0] = h
                start_past(y, past, formula, min(0.1 * h, past.good[0] if past.good[0] > 0.0 else h))
        if code > FULL:
            return code
