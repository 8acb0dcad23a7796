"""Powers fitted to measurements."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def exponent(x: Sequence[float], y: Sequence[float]) -> float | None:
    """The p of y ~ x^p by least squares of the logarithms; None for fewer than two different points."""
    pairs = [(a, b) for a, b in zip(x, y, strict=True) if a > 0.0 and b > 0.0 and np.isfinite(a) and np.isfinite(b)]
    if len({a for a, _ in pairs}) < 2:
        return None
    logs = np.log(np.array(pairs))
    return float(np.polyfit(logs[:, 0], logs[:, 1], 1)[0])


def order(steps: Sequence[float], errors: Sequence[float]) -> float | None:
    """Order of convergence: minus the exponent of error against number of steps, outside round-off and nonsense."""
    kept = [(n, e) for n, e in zip(steps, errors, strict=True) if 1e-12 < e < 0.1]
    p = exponent([n for n, _ in kept], [e for _, e in kept])
    return None if p is None else -p
