"""Functions of time that joints prescribe."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.field._functions import Given
from fricmb.integrate.problem import Floats


class Drive:
    """A prescribed function of time of a joint, and its rate."""

    def __init__(self, given: str, value: Any, start: float) -> None:
        self.integrated, self.start = given == "rate", start
        self.value, self.rate = Given(value), Given(value, order=1)

    def at(self, t: Floats, breaks: Floats) -> tuple[Any, Any]:
        """Value and rate (n_t,); ``breaks``: times at which functions of time jump."""
        if not self.integrated:
            return self.value.over(t) + self.start, self.rate.over(t)
        return self.start + _integral(self.value, t, breaks), self.value.over(t)


def _integral(value: Given, t: Floats, breaks: Floats) -> Floats:
    """The integral from 0 to each of t, by Gauss's rule on short stretches that no break lies in."""
    if value.number is not None:
        return value.number * t
    if not t.size:
        return np.zeros(0)
    low, high = min(0.0, float(t.min())), max(0.0, float(t.max()))
    inner = breaks[(breaks > low) & (breaks < high)]
    ends = np.unique(np.concatenate([np.linspace(low, high, 257), inner, t, [0.0]]))
    x, w = np.polynomial.legendre.leggauss(8)
    half = 0.5 * np.diff(ends)
    nodes = ends[:-1, None] + half[:, None] * (1.0 + x)
    sums = np.append(0.0, np.cumsum(half * (value.over(nodes) @ w)))
    found: Floats = sums[np.searchsorted(ends, t)] - sums[np.searchsorted(ends, 0.0)]
    return found
