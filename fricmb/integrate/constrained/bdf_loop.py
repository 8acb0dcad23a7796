"""The loop of a BDF run of a mechanism: BDF between transitions, the one-step method around them."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import entry, kernel
from fricmb.integrate.constrained.accelerations import Instant, State
from fricmb.integrate.constrained.attempt_step import arrive, is_there, radau_step
from fricmb.integrate.constrained.bdf_history import Past, start_past
from fricmb.integrate.constrained.bdf_step import multistep
from fricmb.integrate.constrained.outcomes import ACCEPTED, CHANGED, DONE, FULL, HANDOVER
from fricmb.integrate.constrained.problem_structs import Mech, Moving
from fricmb.integrate.constrained.radau_step import Control
from fricmb.integrate.constrained.recorder import Record, crowded
from fricmb.integrate.constrained.stages import Stages
from fricmb.integrate.constrained.transition import next_stop, set_window
from fricmb.integrate.constrained.watch import Watch
from fricmb.integrate.problem import Codes
from fricmb.integrate.run.stop import stopped

#: BDF steps after which the two methods are compared.
PATIENCE = 16


@kernel
def begin_or_wait(y: State, past: Past, H: float, code: int) -> None:
    """After a step of the one-step method: start BDF, unless it has to wait."""
    if code == CHANGED and past.status[7] == 0:
        past.status[4] = 0
    elif code == ACCEPTED and past.status[4] > 0:
        past.status[4] -= 1
    elif code == ACCEPTED and H > 0.0:
        past.usual[0] = H
        start_past(y, past, min(0.1 * H, past.good[0] if past.good[0] > 0.0 else H))


@kernel
def hand_over(c: Control, past: Past) -> None:
    """Leave the next steps to the one-step method; where BDF came to nothing it is not tried again at once."""
    past.status[2] = 0
    c.h[0] = max(c.h[0], past.h[0])
    past.status[5] = min(50, 2 * past.status[5] + 1) if past.status[6] < 8 else 0
    past.status[4] = past.status[5]
    if past.status[6] > 4 * PATIENCE:
        past.status[7] = 0


@kernel
def give_up_if_slower(c: Control, past: Past) -> None:
    """Leave the run to the one-step method where it gets on faster, for longer each time."""
    if past.status[6] > PATIENCE and past.h[0] * past.cost[0] < past.usual[0]:
        past.status[2] = 0
        past.status[7] = min(2000, max(50, 4 * past.status[7]))
        past.status[4] = past.status[7]
        c.h[0] = past.usual[0]


@entry
def drive_bdf(
    mech: Mech, k: Moving, w: Instant, y: State, end: State, before: State, st: Stages, c: Control, out: Watch,
    rec: Record, part: Codes, past: Past,
) -> int:  # fmt: skip
    """Step from y until the end of the span, or until the room for steps is used up."""
    set_window(k, c, y.t[0])
    while True:
        if stopped() or crowded(rec, y.mode.shape[0]):
            return FULL
        stop = next_stop(c, y.t[0])
        if is_there(y, stop):
            code = arrive(mech, k, w, y, before, c, out, rec, part, stop)
            past.status[2] = 0
            if code == DONE and stop >= c.span[1]:
                return DONE
        elif past.status[2] == 1:
            code = multistep(mech, k, w, y, end, st, c, out, rec, past, stop - y.t[0], mech.address)
            if code == ACCEPTED:
                give_up_if_slower(c, past)
            elif code == HANDOVER:
                hand_over(c, past)
        else:
            before_ = y.t[0]
            code = radau_step(mech, k, w, y, end, before, st, c, out, rec, part, stop, mech.address)
            begin_or_wait(y, past, y.t[0] - before_, code)
        if code > FULL:
            return code
