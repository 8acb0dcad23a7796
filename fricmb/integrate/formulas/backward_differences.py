"""Backward differences: the formula of BDF, its step and its order, for scenes and for ``solve_dae``.

Row j of ``D`` holds the j-th backward difference of each signal at equal steps h.  With gamma_k = 1 + 1/2 + ... + 1/k,
BDF of order k reads gamma_k d + psi = h y', where d = y - (D_0 + ... + D_k) is what the prediction has missed, and
psi = gamma_1 D_1 + ... + gamma_k D_k is h times the slope of the prediction.  The error of a step is d/(k + 1); of
orders k - 1 and k + 1 it would be D_k/k and D_(k+2)/(k + 2), in the rows behind the step.

Source: L. F. Shampine, M. W. Reichelt, The MATLAB ODE Suite, SIAM J. Sci. Comput. 18 (1997) 1, section 2.
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.formulas.step_control import BDF_RUNGS, BDF_SAFETY, ladder, step_factor
from fricmb.integrate.problem import Floats, Floats2

MAX_ORDER = 5


class History(Protocol):
    """What the kernels here need of a run's layout.

    ``D`` (8, n) differences at step ``h``, which may be negative; ``order``; steps since it or the step changed,
    ``equal``; ``d`` (n,) the correction of a step; ``gamma`` (7,) 0, 1, 1 + 1/2, ...; ``U``, ``E``, ``column`` space
    for ``rescale``.
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


def history(n: int) -> dict[str, Any]:
    """What a ``History`` of n signals holds, by name: rows for what a formula uses, and two for the order's choice."""
    square = np.zeros((MAX_ORDER + 1, MAX_ORDER + 1))
    gamma = np.concatenate([[0.0], np.cumsum(1.0 / np.arange(1, MAX_ORDER + 2))])
    return {
        "D": np.zeros((MAX_ORDER + 3, n)), "h": 0.0, "order": 0, "equal": 0, "d": np.zeros(n), "gamma": gamma,
        "U": square, "E": square.copy(), "column": np.zeros(MAX_ORDER + 1),
    }  # fmt: skip


@kernel
def predicted(past: History, i: int) -> tuple[float, float]:
    """Value of signal i where its differences lead, and h times its slope there, psi."""
    guess, psi = past.D[0, i], 0.0
    for j in range(1, past.order + 1):
        guess += past.D[j, i]
        psi += past.gamma[j] * past.D[j, i]
    return guess, psi


@kernel
def bring_forward(past: History, i: int) -> None:
    """Bring the differences of signal i to the end of the step corrected by ``d``."""
    k = past.order
    past.D[k + 2, i] = past.d[i] - past.D[k + 1, i]
    past.D[k + 1, i] = past.d[i]
    for j in range(k, -1, -1):
        past.D[j, i] += past.D[j + 1, i]


@kernel
def rescale(past: History, factor: float) -> None:
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
def shortened(error: float, power: int, least: float) -> float:
    """Factor for a step whose error, which goes with h^``power``, is above 1: a rung, ``least`` at least."""
    return ladder(max(least, step_factor(error, power, BDF_SAFETY)), BDF_RUNGS)


@kernel
def best_order(k: int, lower: float, error: float, higher: float, more: int) -> tuple[int, float]:
    """Of orders k - 1, k, k + 1 with these errors (inf: not to be taken) the one that goes fastest, and by what.

    Errors go with h^(order + ``more``): 1 where they are those of a step, 0 where they are asked per unit of time.
    """
    best_k, best = k, step_factor(error, k + more, BDF_SAFETY)
    below = step_factor(lower, k - 1 + more, BDF_SAFETY) if k > 1 else 0.0
    above = step_factor(higher, k + 1 + more, BDF_SAFETY)
    if below > best:
        best_k, best = k - 1, below
    if above > best:
        best_k, best = k + 1, above
    return best_k, best


@kernel
def change_order(past: History, order: int, step: float) -> None:
    """Go on with an order, and the step times ``step`` where that is worth it."""
    if order != past.order or step > 1.3 or step < 1.0:
        past.order = order
        rescale(past, step)
