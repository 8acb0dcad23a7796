"""The history of a BDF run: backward differences at equal steps, and when BDF and the one-step method take turns."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.compile.room import room
from fricmb.integrate.formulas.step_control import BDF_RUNGS, BDF_SAFETY, ladder, step_factor
from fricmb.integrate.implicit.bdf.bdf_stability import MAX_ORDER
from fricmb.integrate.problem import Floats, Floats2, Ints
from fricmb.integrate.run.outcomes import ACCEPTED, CHANGED, HANDOVER, REJECTED


class Differences(Layout):
    """Backward differences ``D`` (8, n_y) of the n_y signals that a step predicts, at step ``h``.

    ``order``; steps since it or the step changed, ``equal``; whether BDF is ``on``; ``rejections`` in a row; steps of
    the one-step method to ``wait`` for before BDF is tried again, the last such wait, ``waited``, and the last one
    because BDF was the slower of the two, ``slower``; steps ``since`` its start. ``good`` last accepted step. ``new``,
    ``guess``, ``d`` (n_y,) values, prediction, and correction of a step. ``gamma`` (7,) sums
    1 + 1/2 + ...;  ``unit`` hundredths of the run per unit of time, see ``allowed``; ``cost`` of a one-step step in BDF
    steps. ``U``, ``E``, ``column`` space for rescaling.
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
    signal = np.zeros(n_y)
    square = np.zeros((MAX_ORDER + 1, MAX_ORDER + 1))
    return room(
        Differences(
            D=np.zeros((8, n_y)),
            h=0.0, order=0, equal=0, on=0, rejections=0, wait=0, waited=0, since=0, slower=0,
            good=0.0,
            new=signal,
            guess=signal.copy(),
            d=signal.copy(),
            gamma=np.concatenate([[0.0], np.cumsum(1.0 / np.arange(1, 7))]),
            # a hundredth of the error is spent on a hundredth of the run
            unit=100.0 / max(span, 1e-300),
            cost=cost,
            U=square,
            E=square.copy(),
            column=np.zeros(8),
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
    """Prediction, and psi (into ``new``)."""
    k = past.order
    for i in range(past.guess.shape[0]):
        guess = past.D[0, i]
        psi = 0.0
        for j in range(1, k + 1):
            guess += past.D[j, i]
            psi += past.gamma[j] * past.D[j, i]
        past.guess[i] = guess
        past.new[i] = guess - psi / past.gamma[k]


@kernel
def bring_forward(past: Differences, i: int) -> None:
    """Bring the differences of signal i to the end of the step corrected by ``d``."""
    k = past.order
    past.D[k + 2, i] = past.d[i] - past.D[k + 1, i]
    past.D[k + 1, i] = past.d[i]
    for j in range(k, -1, -1):
        past.D[j, i] += past.D[j + 1, i]


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
def rescale(past: Differences, factor: float) -> None:
    """Differences for the step ``factor`` h (Byrne and Hindmarsh 1975; as in scipy's BDF, with its R(factor) R(1))."""
    k = past.order
    for pass_ in range(2):
        target = past.U if pass_ == 0 else past.E
        c = factor if pass_ == 0 else 1.0
        for j in range(k + 1):
            target[0, j] = 1.0
        for i in range(1, k + 1):
            target[i, 0] = 0.0
            for j in range(1, k + 1):
                target[i, j] = target[i - 1, j] * (i - 1 - c * j) / i
    width = past.D.shape[1]
    for y in range(width):
        for i in range(k + 1):
            value = 0.0
            for j in range(k + 1):
                value += past.U[j, i] * past.D[j, y]
            past.column[i] = value
        for i in range(k + 1):
            value = 0.0
            for j in range(k + 1):
                value += past.E[j, i] * past.column[j]
            past.D[i, y] = value
    past.h *= factor
    past.equal = 0


@kernel
def reject(past: Differences, counts: Ints, error: float, least: float) -> int:
    """Shorten a step whose error is above 1, to its part ``least`` at least; HANDOVER where nothing is known of it."""
    past.rejections += 1
    counts[1] += 1
    if not error < 1e300:
        return HANDOVER
    rescale(past, ladder(max(least, step_factor(error, past.order, BDF_SAFETY)), BDF_RUNGS))
    return REJECTED


@kernel
def best_order(k: int, lower: float, error: float, higher: float) -> tuple[int, float]:
    """Of orders k - 1, k, k + 1 with these errors (inf: not to be taken) the one that goes fastest, and by what."""
    best_k, best = k, step_factor(error, k, BDF_SAFETY)
    if k > 1 and step_factor(lower, k - 1, BDF_SAFETY) > best:
        best_k, best = k - 1, step_factor(lower, k - 1, BDF_SAFETY)
    if step_factor(higher, k + 1, BDF_SAFETY) > best:
        best_k, best = k + 1, step_factor(higher, k + 1, BDF_SAFETY)
    return best_k, best


@kernel
def change_order(past: Differences, order: int, step: float) -> None:
    """Go on with an order, and the step times ``step`` where that is worth it."""
    if order != past.order or step > 1.3 or step < 1.0:
        past.order = order
        rescale(past, step)
