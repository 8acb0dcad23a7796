"""What a step, or a loop over steps, ends with."""

from __future__ import annotations

#: A loop that comes back since its slice is over, to be called again; a step that is left to the other of two methods.
SLICE_OVER, HANDOVER = -2, -1
#: A step that was accepted or rejected, one behind which the past is no guide (a transition, a breakpoint, a bend);
#: the run is done, the space for rows is full.
ACCEPTED, REJECTED, CHANGED, DONE, FULL = range(5)
#: Why a run cannot go on.
FAIL_STEP, FAIL_MODES, FAIL_CHATTER, FAIL_INFINITE = range(5, 9)
#: The same; ``implicit/output/failure_text`` puts them into words.
FAIL_SEVERAL, FAIL_MARGIN, FAIL_SINGULAR, FAIL_LOST, FAIL_PROJECT, FAIL_HIT = range(9, 15)
FAILURES = {
    FAIL_STEP: "the step size fell below round-off: the equations of the step could not be solved to tolerance",
    FAIL_MODES: "no consistent set of stick and slip was found for contacts at rest",
    FAIL_INFINITE: "forces or accelerations became infinite",
    FAIL_CHATTER: "transitions pile up at one instant (chattering)",
}
