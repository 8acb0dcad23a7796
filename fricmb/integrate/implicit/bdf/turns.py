"""The history of a BDF run of a scene, and when BDF and the one-step method take turns."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.compile.room import room
from fricmb.integrate.formulas.backward_differences import history, predicted, rescale, shortened
from fricmb.integrate.problem import Floats, Floats2, Ints
from fricmb.integrate.run.outcomes import ACCEPTED, CHANGED, HANDOVER, REJECTED


class Differences(Layout):
    """A ``History`` of the n_y signals that a step predicts, and the turns of the two methods.

    Whether BDF is ``on``; ``rejections`` in a row; steps of the one-step method to ``wait`` for before BDF is tried
    again, the last such wait, ``waited``, and the last one because BDF was the slower of the two, ``slower``; steps
    ``since`` its start. ``good`` last accepted step. ``new``, ``guess`` (n_y,) values and prediction of a step.
    ``unit`` hundredths of the run per unit of time, see ``allowed``; ``cost`` of a one-step step in BDF steps.
    """

    D: Floats2
    h: float
    order: int
    equal: int
    on: int
    rejections: int
    wait: int
    waited: int
    since: int
    slower: int
    good: float
    new: Floats
    guess: Floats
    d: Floats
    gamma: Floats
    unit: float
    cost: float
    U: Floats2
    E: Floats2
    column: Floats


def differences(n_y: int, span: float, cost: float) -> Differences:
    """Space for the history of a run over ``span``; ``cost`` of a one-step step, in steps of BDF."""
    return room(
        Differences(
            **history(n_y),
            on=0, rejections=0, wait=0, waited=0, since=0, slower=0,
            good=0.0,
            new=np.zeros(n_y),
            guess=np.zeros(n_y),
            # a hundredth of the error is spent on a hundredth of the run
            unit=100.0 / max(span, 1e-300),
            cost=cost,
        )
    )


@lru_cache(maxsize=1)
def no_differences() -> Differences:
    """A history that waits for ever: BDF never begins, and every step is one of the one-step method."""
    past = differences(0, 1.0, 1.0)
    past.wait, past.slower = 2**62, 1
    return past


#: Largest growth of a step: differences of old values are extrapolated, their round-off with them.
GROWTH = 3.0


#: Part of the tolerance that a hundredth of a run may err by: errors of an undamped run, which add up, sum to some 5
#: rtol.  Least such part, beside the round-off of the history, where the tolerance is not below it.
SHARE, LEAST = 0.05, 1e-12


@kernel
def allowed(rtol: float, past: Differences) -> float:
    """Part of its size that a signal may err by in a step of BDF: in proportion to the length of the step."""
    tolerance = max(SHARE * rtol, min(rtol, LEAST))
    return max(tolerance * min(1.0, past.h * past.unit), 4e-15)


@kernel
def predict(past: Differences) -> None:
    """Prediction of all signals, and into ``new`` what the formula keeps of the past: new + (h/gamma) y' is y."""
    for i in range(past.guess.shape[0]):
        past.guess[i], psi = predicted(past, i)
        past.new[i] = past.guess[i] - psi / past.gamma[past.order]


@kernel
def count_step(past: Differences) -> None:
    """Count a step whose error has passed."""
    past.equal += 1
    past.rejections = 0
    past.since += 1
    past.good = past.h


@kernel
def begin_at(past: Differences, order: int, h: float) -> None:
    """Begin with the differences of an order at step h."""
    past.h = h
    past.order = order
    past.on = 1
    past.equal = past.rejections = past.since = 0


@kernel
def hand_over(past: Differences) -> None:
    """Leave the next steps to the one-step method; where BDF came to nothing it is not tried again at once."""
    past.on = 0
    past.waited = min(50, 2 * past.waited + 1) if past.since < 8 else 0
    past.wait = past.waited
    if past.since > 4 * PATIENCE:
        past.slower = 0


@kernel
def is_slower(past: Differences, usual: float) -> bool:
    """Whether the one-step method with steps ``usual`` gets on faster: the run is left to it, longer each time."""
    if past.since <= PATIENCE or past.h * past.cost >= usual:
        return False
    past.on = 0
    past.slower = min(2000, max(50, 4 * past.slower))
    past.wait = past.slower
    return True


@kernel
def may_begin(past: Differences, code: int) -> bool:
    """Whether BDF may begin after a step of the one-step method that ended with ``code``, or has to wait."""
    if code == CHANGED and past.slower == 0:
        past.wait = 0
    elif code == ACCEPTED and past.wait > 0:
        past.wait -= 1
    else:
        return bool(code == ACCEPTED)
    return False


#: BDF steps after which the two methods are compared.
PATIENCE = 16


@kernel
def reject(past: Differences, counts: Ints, error: float, least: float) -> int:
    """Shorten a step whose error is above 1, to its part ``least`` at least; HANDOVER where nothing is known of it."""
    past.rejections += 1
    counts[1] += 1
    if not error < 1e300:
        return HANDOVER
    rescale(past, shortened(error, past.order, least))
    return REJECTED
