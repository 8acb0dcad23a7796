"""Numeric helpers of laws whose coefficient needs no SymPy."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fricmb.errors import LawError, shown


def numbers_of(law: Any, name: str, values: Any) -> NDArray[np.float64]:
    """Numbers as an array, else a LawError."""
    try:
        return np.asarray(values, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise LawError(f"{law._label()}: {name} must be a number or an array of numbers, got {shown(values)}") from None


def alike(law: Any, name: str, x: Any, N: Any) -> tuple[Any, Any]:
    """Both of one shape, else a LawError."""
    try:
        return tuple(np.broadcast_arrays(x, N))  # type: ignore[return-value]
    except ValueError:
        raise LawError(
            f"{law._label()}: normal_force must be a number or have the shape of {name}, {x.shape}; got shape {N.shape}"
        ) from None


def speeds(law: Any, r: ArrayLike) -> NDArray[np.float64]:
    """Slip speeds as an array; raises LawError below 0."""
    values = numbers_of(law, "r", r)
    if np.any(values < 0.0) or np.any(np.isnan(values)):
        raise LawError(f"{law._label()}: slip speed r must be >= 0, got {float(np.min(values))!r}")
    return values


def constant(law: Any, r: ArrayLike, value: float) -> Any:
    """``value`` in the shape of ``r``."""
    shape = speeds(law, r).shape
    return np.full(shape, value) if shape else value
