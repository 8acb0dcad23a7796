"""When a Newton iteration whose factors are not those of the last iterate may end, in scenes and in ``solve_dae``."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel


@kernel
def left_over(change: float, rate: float) -> float:
    """What further changes of an iteration add up to, of which each is ``rate`` times the one before.

    Infinite where it does not converge (Hairer, Wanner, Solving ODEs II, IV.8).
    """
    return float(change * rate / (1.0 - rate) if rate < 1.0 else np.inf)
