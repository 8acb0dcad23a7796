"""The polynomial side of a step: coefficients, predictor, and the history after a step."""

from __future__ import annotations

import math
from typing import Any

from fricmb.dae import _layout as L
from fricmb.dae._compile import kernel


@kernel
def weighted_norm(rows: Any, row: int) -> float:
    """Root mean square of a row in units of the tolerances."""
    n = rows.shape[1]
    total = 0.0
    for i in range(n):
        value = rows[row, i] * rows[L.WEIGHT, i]
        total += value * value
    return math.sqrt(total / n)


@kernel
def coefficients(k: int, h: float, real: Any) -> None:
    """What a step h of order k multiplies the history by."""
    leading = 0.0
    for i in range(k):
        leading += 1.0 / (i + 1)
    real[L.C] = leading / h
    star, gamma, sigma = 1.0, 0.0, 1.0
    real[L.STAR], real[L.GAMMA], real[L.SIGMA] = 1.0, 0.0, 1.0
    for j in range(1, L.MAX_ORDER + 1):
        reach = h + real[L.AGO + j - 1]
        star *= reach / real[L.AGO + j] if real[L.AGO + j] != 0.0 else 0.0
        gamma += 1.0 / reach
        sigma *= j * h / (h + real[L.AGO + j])
        real[L.STAR + j] = star
        real[L.GAMMA + j] = gamma
        real[L.SIGMA + j] = sigma


@kernel
def predict(k: int, real: Any, rows: Any) -> None:
    """Y and yp where the polynomial of degree k through the past points says."""
    n = rows.shape[1]
    for i in range(n):
        value, slope = rows[L.HISTORY, i], 0.0
        for j in range(1, k + 1):
            term = real[L.STAR + j] * rows[L.HISTORY + j, i]
            value += term
            slope += real[L.GAMMA + j] * term
        rows[L.Y, i] = value
        rows[L.YP, i] = slope
        rows[L.CHANGE, i] = 0.0


@kernel
def remember(whole: Any, real: Any, rows: Any) -> None:
    """Make the new point the last one: history rows, distances, counters."""
    n = rows.shape[1]
    k = whole[L.ORDER_USED]
    h = real[L.H_STEP]
    points = whole[L.POINTS]
    top = min(points, L.MAX_ORDER)
    for i in range(n):
        miss = rows[L.CHANGE, i]
        for j in range(k + 1, top + 1):  # what higher orders missed: each needs the old row below it
            old = real[L.STAR + j] * rows[L.HISTORY + j, i]
            rows[L.HISTORY + j, i] = miss
            miss -= old
        miss = rows[L.CHANGE, i]
        for j in range(k, -1, -1):
            miss += real[L.STAR + j] * rows[L.HISTORY + j, i]
            rows[L.HISTORY + j, i] = miss
        rows[L.HISTORY, i] = rows[L.Y, i]
        rows[L.YP_LAST, i] = rows[L.YP, i]
    if whole[L.FIRST]:
        for i in range(n):  # move the made-up point onto the parabola through y0, yp0 and the new y
            rows[L.HISTORY + 2, i] = 2.0 * rows[L.CHANGE, i]
        whole[L.FIRST] = 0
    for j in range(L.MAX_ORDER + 1, 0, -1):
        real[L.AGO + j] = real[L.AGO + j - 1] + h if j <= points else 0.0
    whole[L.POINTS] = min(points + 1, L.MAX_ORDER + 1)
    real[L.T] = real[L.T_NEW]
    whole[L.AT_START] = 1
    whole[L.STEPS] += 1
    whole[L.JACOBIAN_AGE] += 1
    whole[L.ERROR_FAILS] = 0
    whole[L.NEWTON_FAILS] = 0
    whole[L.FRESH] = 0
