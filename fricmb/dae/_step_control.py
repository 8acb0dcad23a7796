"""Error estimates of a step, and the order and step size of the next."""

from __future__ import annotations

import math
from typing import Any

from fricmb.dae import _layout as L
from fricmb.dae._compile import kernel

_LEAST_GROWTH = 1.35  # a smaller gain is not worth new factors


@kernel
def test_factor(k: int, h: float, real: Any) -> float:
    """What the error test multiplies the change by: the formula's error, or the interpolation's if larger."""
    leading, past = 0.0, 0.0
    for i in range(k):
        leading += 1.0 / (i + 1)
        past += h / (h + real[L.AGO + i])
    last = h / (h + real[L.AGO + k])
    factor: float = max(abs(last - leading + past), last)
    return factor


@kernel
def norm_of_sum(rows: Any, real: Any, low: int, high: int) -> float:
    """Norm of the change plus the starred history rows low..high: the miss of a lower order."""
    n = rows.shape[1]
    total = 0.0
    for i in range(n):
        value = rows[L.CHANGE, i]
        for j in range(low, high + 1):
            value += real[L.STAR + j] * rows[L.HISTORY + j, i]
        value *= rows[L.WEIGHT, i]
        total += value * value
    return math.sqrt(total / n)


@kernel
def _norm_of_difference(rows: Any, real: Any, j: int) -> float:
    n = rows.shape[1]
    total = 0.0
    for i in range(n):
        value = (rows[L.CHANGE, i] - real[L.STAR + j] * rows[L.HISTORY + j, i]) * rows[L.WEIGHT, i]
        total += value * value
    return math.sqrt(total / n)


@kernel
def allowed(error: float, k: int) -> float:
    """Factor of the step size with which an error estimate of order k stays below one half."""
    factor: float = (2.0 * error + 1e-4) ** (-1.0 / (k + 1))
    return factor


@kernel
def choose(whole: Any, real: Any, rows: Any, best: int, here: float, down: float) -> None:
    """Order and step size of the next step.

    Both change only after a run of equal steps, else the estimates mix errors of two formulas.  The order rises only if
    the estimated derivatives fall with it (otherwise the higher formula is at the edge of its stability), and changes
    where that allows the larger step.
    """
    k = whole[L.ORDER]
    h = real[L.H_STEP]
    whole[L.ORDER_USED] = k
    if best < k or k == whole[L.ORDER_LIMIT]:
        whole[L.RISING] = 0
    if whole[L.RISING]:
        whole[L.ORDER] = k + 1
        real[L.H] = 2.0 * h
        whole[L.SAME] = 0
        return
    factor = allowed(here, k)
    steady = whole[L.SAME] > k
    if steady:
        below = allowed(down, k - 1) if k > 1 else 0.0
        above = 0.0
        if k < whole[L.ORDER_LIMIT] and whole[L.POINTS] > k + 1:
            up = real[L.SIGMA + k + 1] * _norm_of_difference(rows, real, k + 1)
            if (k + 2) * up < (k + 1) * here * (0.5 if k == 1 else 1.0):
                above = allowed(up, k + 1)
        if k > 1 and below >= above and (best < k or k * down <= (k + 1) * here or below > factor):
            best, factor = k - 1, below
        elif above > factor:
            best, factor = k + 1, above
        else:
            best = k
    else:
        best = k
    if factor <= 1.0:
        factor = max(0.5, min(0.9, factor))
    elif steady and factor >= _LEAST_GROWTH and whole[L.ERROR_FAILS] + whole[L.NEWTON_FAILS] == 0:
        factor = min(factor, 2.0)
    else:
        factor = 1.0  # and what was just refused is not tried again at once
    real[L.H] = h * factor
    whole[L.SAME] = whole[L.SAME] + 1 if best == k and factor == 1.0 else 0
    whole[L.ORDER] = best
