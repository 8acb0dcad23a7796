"""Which orders of BDF may be used at a step size: growth of lightly damped oscillations.

BDF of order 3 and more amplifies oscillations on parts of the imaginary axis (Gear 1971, ch. 11; Hairer and Wanner,
Solving ODEs II, V.1).  An error of size 1e-16 in an undamped mode that a step does not resolve then grows until it
matters.  The spectrum of the scene says how fast, at a step size.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from fricmb.integrate.problem import Floats

MAX_ORDER = 5
#: z = h omega of the table's columns.
SPACING, COLUMNS = 0.02, 600


def backward_polynomial(k: int) -> Floats:
    """Coefficients of sum_{j=1..k} (1 - x)^j / j, x the shift back by a step: BDF of order k, lowest power first."""
    total = np.zeros(k + 1)
    power = np.ones(1)
    for j in range(1, k + 1):
        power = np.convolve(power, [1.0, -1.0])
        total[: j + 1] += power / j
    return total


@lru_cache(maxsize=1)
def growth_table() -> Floats:
    """Log of the largest amplification a step (orders 0 to 5 by z = 0, 0.02, ...), 0 where there is none."""
    table = np.zeros((MAX_ORDER + 1, COLUMNS))
    for k in range(3, MAX_ORDER + 1):
        polynomial = backward_polynomial(k)
        for i in range(1, COLUMNS):
            shifted = polynomial.astype(complex)
            shifted[0] -= 1j * SPACING * i
            # roots in x = 1/zeta: the amplification is 1 / min |x|
            table[k, i] = max(0.0, -np.log(np.min(np.abs(np.roots(shifted[::-1])))))
    return table
