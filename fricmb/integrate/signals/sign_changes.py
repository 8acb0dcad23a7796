"""Times between which a function of time changes its sign at most once, by bounds of it and of its rate."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricmb.integrate.problem import Floats
from fricmb.integrate.signals.jets import Entry, bounds

#: Stretches that are looked at first; most that are halved at once; halvings of one.
FIRST, MOST, DEEPEST = 64, 2**16, 46


def stretches(tape: Sequence[Entry], parameters: Sequence[float], low: float, high: float) -> Floats:
    """Ends of stretches from ``low`` to ``high``, rising: in each the function has one sign, or rises, or falls.

    So its values there show every change of sign, however short it is beside the run.  Not where it stays 0, nor of
    more changes than ``MOST``: such stretches are left as they are.
    """
    edge = np.linspace(low, high, FIRST + 1)
    found, start, end = [edge], edge[:-1], edge[1:]
    for _ in range(DEEPEST):
        jet = bounds(tape, parameters, start, end, 1)
        may = (jet.low <= 0.0) & (jet.high >= 0.0) | np.isnan(jet.low) | np.isnan(jet.high)
        hidden = may[0] & may[1]
        if not hidden.any() or hidden.sum() > MOST:
            break
        start, end = start[hidden], end[hidden]
        middle = 0.5 * (start + end)
        found.append(middle)
        start, end = np.concatenate([start, middle]), np.concatenate([middle, end])
    return np.unique(np.concatenate(found))
