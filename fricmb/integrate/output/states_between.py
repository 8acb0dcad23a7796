"""States of laws between rows: on the polynomial of a step of many stages, else on cubics from row to row."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.output.recorder import INSIDE
from fricmb.integrate.problem import Codes, Floats, Floats2, Ints

#: Gaps between the rows of a step up to which cubics are of no lower order than the polynomial through them all.
FEW = 3


@kernel
def cubic(left: Floats, right: Floats, at: int, rate: int, n: int, h: float, x: float, out: Floats) -> None:
    """Cubic Hermite interpolation of n entries from ``at`` with rates from ``rate``, without overshoot.

    Where a rate goes the way of the values, and the other one too or hardly at all, it counts at most three times their
    mean: then the cubic goes that way throughout (Fritsch and Carlson 1980).  Motion that is resolved, turning points
    included, is far from this; a state that meets its limit within a step would be drawn beyond it.
    """
    for i in range(n):
        step = right[at + i] - left[at + i]
        r0, r1 = h * left[rate + i], h * right[rate + i]
        most = 3.0 * abs(step)
        against = r0 * r1 > 0.0 and r0 * step <= 0.0  # two turning points in a step are none
        first = r0 * step >= 0.0 and (r1 * step >= 0.0 or abs(r1) < 0.25 * abs(r0))
        second = r1 * step >= 0.0 and (r0 * step >= 0.0 or abs(r0) < 0.25 * abs(r1))
        if first or against:
            r0 = 0.0 if against else min(max(r0, -most), most)
        if second or against:
            r1 = 0.0 if against else min(max(r1, -most), most)
        out[i] = left[at + i] + x * (r0 + x * (3.0 * step - 2.0 * r0 - r1 + x * (r0 + r1 - 2.0 * step)))


@kernel
def ends_of_step(values: Floats2, kind: Codes, k: int, ends: Ints) -> bool:
    """First and last row of the step in which row k is; whether that has changed."""
    low, high = k, k + 1
    while low > 0 and kind[low] == INSIDE:
        low -= 1
    while high < values.shape[0] - 1 and kind[high] == INSIDE:
        high += 1
    if low == ends[0] and high == ends[1]:
        return False
    ends[0], ends[1] = low, high
    return True


@kernel
def shares(points: Floats, x: float, share: Floats) -> None:
    """What the value at each point counts at x in the polynomial through them all, both (n,).

    By Lagrange's formula: sums of powers lose six digits where there are ten points.
    """
    for j in range(points.shape[0]):
        share[j] = 1.0
        for k in range(points.shape[0]):
            if k != j:
                share[j] *= (x - points[k]) / (points[j] - points[k])


@kernel
def states_between(values: Floats2, kind: Codes, k: int, at: int, n: int, t: float, out: Floats) -> None:
    """N states at t between row k and the next one: ``at`` is where they stand in a row, their rates behind.

    The polynomial of a step is what its error was measured by, between its nodes as well; cubics between its rows are
    of a lower order.
    """
    if n == 0:
        return
    ends = np.full(2, -1)
    ends_of_step(values, kind, k, ends)
    if ends[1] - ends[0] <= FEW:
        h = values[k + 1, 0] - values[k, 0]
        cubic(values[k], values[k + 1], at, at + n, n, h, (t - values[k, 0]) / h, out)
        return
    points = values[ends[0] : ends[1] + 1, 0].copy()
    share = np.empty(points.shape[0])
    shares(points, t, share)
    out[:] = 0.0
    for j in range(share.shape[0]):
        for i in range(n):
            out[i] += share[j] * values[ends[0] + j, at + i]
