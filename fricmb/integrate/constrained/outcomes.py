"""Outcomes of steps and runs."""

#: Of a run: DONE, room for steps used up, and why it cannot go on.
DONE, FULL, FAIL_STEP, FAIL_NONE, FAIL_SEVERAL, FAIL_MARGIN, FAIL_SINGULAR, FAIL_LOST = range(8)
FAIL_PROJECT, FAIL_HIT = 8, 9
#: Of a step: taken, to be tried again shorter, taken up to a transition, left to the one-step method.
ACCEPTED, REJECTED, CHANGED, HANDOVER = -1, -2, -3, -4
