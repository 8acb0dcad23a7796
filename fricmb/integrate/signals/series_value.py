"""Reading tables of polynomial pieces inside compiled kernels: see :mod:`fricmb.integrate.signals.pieces`."""

from __future__ import annotations

from typing import Any

from fricmb.integrate.compile.template import template


@template
def lookup(x: Any, p: Any, out: Any) -> None:
    """Table p at the time x[0], its derivative of order x[1]: out[0]."""
    t, m = x[0], int(x[1]) + 2
    n, width = int(p[1]), int(p[2])
    # the number of edges at or before t: where it would be if they were evenly spaced, else by halves
    low, high = 0, n
    if t == t:
        guess = (t - p[4]) * p[3] + 1.0
        i = n if guess >= n else (int(guess) if guess > 0.0 else 0)
        if (i == 0 or p[3 + i] <= t) and (i == n or t < p[4 + i]):
            low = high = i
        while low < high:
            middle = (low + high) // 2
            if p[4 + middle] <= t:
                low = middle + 1
            else:
                high = middle
    s = t - p[4 + max(low - 1, 0)]
    at = 4 + n + low * width
    value = 0.0
    for j in range(width - 1, m - 1, -1):
        factor = 1.0
        for k in range(m):
            factor *= j - k
        value = value * s + factor * p[at + j]
    out[0] = value
