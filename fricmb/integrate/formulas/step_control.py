"""How long the next step may be: the formula, and the ladder of step sizes.

Who takes or rejects a step sets bounds: ``implicit/attempt_step`` (``radau``, ``bdf`` around transitions: ``GROWTH``,
``CUT`` and the like), ``implicit/bdf/turns`` (``bdf``: ``GROWTH``), ``dae/_stepper`` (``solve_dae``). After a failure
``next_step`` holds growth back in the former; steps of BDF grow only after k + 1 equal ones anyhow.

The other methods ask the same formula: ``collocation/one_contact/run.length_factor`` (growth up to 3),
``taylor/step_start`` (1.5).
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import Floats

#: Part of a run that a step takes at most under loads that are not linear in time: where nothing moves, no error says
#: how fast they change, so they are looked at a hundred times at least.
SAMPLED = 0.01
#: Part that a step takes of a run without such loads, which the error of steps knows.
FREE = 0.1
#: Parts of the step that would just do: of one-step methods, and of BDF.
ONE_STEP_SAFETY, BDF_SAFETY = 0.85, 0.9
#: Rungs of their ladders between a step and its double.
ONE_STEP_RUNGS, BDF_RUNGS = 8, 4


def first_step(v: Floats, a: Floats, span: float, part: float, omega: float = 0.0) -> float:
    """A careful first step: a small part of the run, and of the time in which velocities change, or of 1/omega."""
    speed, rate = np.max(np.abs(v), initial=0.0), np.max(np.abs(a), initial=0.0)
    h = SAMPLED * span
    if rate > 0.0 and speed > 0.0:
        h = min(h, part * speed / rate)
    if omega > 0.0:
        h = min(h, part / omega)
    return float(max(h, 1e-12 * span))


#: Part of the velocity reached within a step below which what was known before it is no measure.
LEFT_BEHIND = 1e-3


@kernel
def or_reached(size: float, velocity: float) -> float:
    """What a velocity is measured by: the ``size`` known before a step, or, where that is nothing, what it reaches."""
    reached = abs(velocity)
    return float(reached if size < LEFT_BEHIND * reached else size)


@kernel
def step_factor(error: float, order: float, safety: float) -> float:
    """By what a step may grow, or has to shrink, where its error over the tolerance is ``error`` and goes with h^order.

    ``safety error^(-1/order)`` (Hairer, Noersett, Wanner, Solving ODEs I, II.4); bounds are the caller's.
    """
    return float(safety * max(error, 1e-16) ** (-1.0 / order))


class Pace(Protocol):
    """``growth``: by what a step may grow behind an accepted one; infinite where nothing has failed."""

    growth: float


@kernel
def next_step(c: Pace, h: float, wanted: float) -> float:
    """The step after an accepted one of length ``h`` whose error alone would let it be ``wanted``.

    What a step has failed at lies ahead of the next ones, too: a failure sets ``growth`` to 1, every accepted step
    makes it half as large again, and a transition sets it to infinity.  Without this each accurate step was followed
    by one that is far too long, which costs several times as much where its equations do not converge.
    """
    allowed = h * c.growth
    c.growth *= 1.5
    return float(min(wanted, allowed))


@kernel
def ladder(x: float, rungs: int) -> float:
    """A step, or a factor of one, rounded down to a power of 2^(1/rungs): steps come again, and factors with them."""
    return float(2.0 ** (np.floor(rungs * np.log2(x) + 1e-9) / rungs))
