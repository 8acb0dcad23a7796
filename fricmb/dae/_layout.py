"""What the stepper keeps, and the codes it speaks in.

The stepper is one compiled kernel that never calls the user.  It returns a *request* (evaluate the residual, factor,
...), is served by Python or by the compiled loop, and is called again.  All its memory is in one room.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.compile.room import room
from fricmb.integrate.formulas.backward_differences import history
from fricmb.integrate.problem import Floats, Floats2

# requests of the stepper; below 0: it gave up, and why
RESIDUAL: Final = 1  # evaluate F, solve with the factors at hand
FACTOR: Final = 2  # factor dF/dy + c dF/dyp with the Jacobians at hand, then as RESIDUAL
JACOBIAN: Final = 3  # evaluate the Jacobians anew, then as FACTOR
ACCEPTED: Final = 4  # a step was made
FINISHED: Final = 5  # the end was reached (said by the loop, not by the stepper)
FULL: Final = 6  # no space to record (likewise)
FAILED_ERROR: Final = -1
FAILED_NEWTON: Final = -2
FAILED_NONFINITE: Final = -3
FAILED_SINGULAR: Final = -4

# how a request was served
SERVED: Final = 0
NONFINITE: Final = 1
SINGULAR: Final = 2


class Stepper(Layout):
    """The ``History`` of ``formulas/backward_differences`` for the n components of y, and where a step stands.

    ``y``, ``yp`` (n,) of the attempt, ``now`` (1,) its time; ``delta`` residual, then Newton step; ``weight`` what
    turns a change of y into units of its tolerance; ``rate`` (n,) yp at the last point, whose time is ``t``;
    ``t_end``; ``longest`` step.

    ``c`` yp = ... + c y; ``made`` the c of the factors, 0 where there are none; ``scale`` what a Newton step is
    multiplied by where c is another; ``convergence`` rate of the iteration, ``norm_first`` of its first change.

    ``growth`` of a step at most; ``highest`` order allowed; ``order_used`` by the last step; whether the next call
    begins a step, ``at_start``; ``iteration``; failures of this step by its error and by Newton's method,
    ``error_fails`` and ``newton_fails``; whether the Jacobians are of this step, ``fresh``, and their ``age`` in steps;
    whether no step was made since the (re)start, ``first``; counts of ``steps``, ``rejected``, and, by the compiled
    loop, ``residuals``, ``jacobians``, ``factors``.
    """

    D: Floats2
    h: float
    order: int
    equal: int
    d: Floats
    gamma: Floats
    U: Floats2
    E: Floats2
    column: Floats
    y: Floats
    yp: Floats
    now: Floats
    delta: Floats
    weight: Floats
    rate: Floats
    t: float
    t_end: float
    longest: float
    c: float
    made: float
    scale: float
    convergence: float
    norm_first: float
    growth: float
    highest: int
    order_used: int
    at_start: int
    iteration: int
    error_fails: int
    newton_fails: int
    fresh: int
    age: int
    first: int
    steps: int
    rejected: int
    residuals: int
    jacobians: int
    factors: int


def stepper(n: int, highest: int, longest: float, t_end: float) -> Stepper:
    """Space for a run of n components."""
    vector = np.zeros(n)
    return room(
        Stepper(
            **history(n),
            y=vector.copy(), yp=vector.copy(), now=np.zeros(1), delta=vector.copy(), weight=vector.copy(),
            rate=vector.copy(),
            t=0.0, t_end=t_end, longest=longest,
            c=0.0, made=0.0, scale=1.0, convergence=1.0, norm_first=0.0,
            growth=0.0, highest=highest, order_used=1, at_start=1, iteration=0, error_fails=0, newton_fails=0,
            fresh=0, age=0, first=1, steps=0, rejected=0, residuals=0, jacobians=0, factors=0,
        )
    )  # fmt: skip
