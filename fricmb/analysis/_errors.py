"""Errors, warnings and the checks that the spectra share."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fricmb.errors import FricmbError

Floats = NDArray[np.float64]


class AnalysisError(FricmbError, ValueError):
    """Data or options that an analysis cannot take: names the argument, the value and what is accepted."""


class AliasingWarning(UserWarning):
    """Samples are too far apart for what the signal holds: power above pi/dt appears at frequencies where it is not."""


def checked_samples(who: str, x: ArrayLike, dt: float) -> Floats:
    """Finite samples (n,) less their mean, for a positive sampling interval."""
    samples = np.asarray(x, dtype=np.float64)
    if samples.ndim != 1 or len(samples) < 2:
        raise AnalysisError(f"{who}: x must be (n,) with n of at least 2; got shape {samples.shape}")
    if not np.isfinite(samples).all():
        raise AnalysisError(f"{who}: x must be finite")
    checked_interval(who, dt)
    centred: Floats = samples - samples.mean()
    return centred


def checked_interval(who: str, dt: float) -> None:
    """Refuse a sampling interval that is not positive."""
    if not (np.isfinite(dt) and dt > 0):
        raise AnalysisError(f"{who}: dt must be positive; got {dt!r}")


def checked_frequencies(who: str, omega: ArrayLike, dt: float) -> Floats:
    """Angular frequencies (n,) from 0 to pi/dt."""
    grid = np.asarray(omega, dtype=np.float64)
    nyquist = np.pi / dt
    outside = ~((grid >= 0.0) & (grid <= nyquist * (1 + 1e-12)))
    if grid.ndim != 1 or outside.any():
        bad = grid.ravel()[outside.ravel()][:1]
        raise AnalysisError(
            f"{who}: omega must be (n,) within 0 and pi/dt = {nyquist:g}; got "
            + (f"{bad[0]:g}" if len(bad) else f"shape {grid.shape}")
        )
    return grid


def checked_integer(who: str, name: str, value: Any, low: int, high: int) -> int:
    """An integer from low to high."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or not low <= value <= high:
        raise AnalysisError(f"{who}: {name} must lie between {low} and {high}; got {value!r}")
    return int(value)
