"""Numeric helpers of laws whose coefficient needs no SymPy."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fricmb.errors import LawError


def speeds(law: Any, r: ArrayLike) -> NDArray[np.float64]:
    """Slip speeds as an array; raises LawError below 0."""
    values = np.asarray(r, dtype=float)
    if np.any(values < 0.0) or np.any(np.isnan(values)):
        raise LawError(f"{law._label()}: slip speed r must be >= 0, got {np.nanmin(values)!r}")
    return values


def constant(law: Any, r: ArrayLike, value: float) -> Any:
    """``value`` in the shape of ``r``."""
    shape = speeds(law, r).shape
    return np.full(shape, value) if shape else value
