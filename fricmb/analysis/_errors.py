"""Errors, warnings and the checks that analyses share."""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite
from typing import Any, NoReturn, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fricmb.errors import FricmbError, shown
from fricmb.laws import FrictionLaw
from fricmb.scene import Scene
from fricmb.solution import Solution
from fricmb.values import as_float

Floats = NDArray[np.float64]
_Kind = TypeVar("_Kind")


class AnalysisError(FricmbError, ValueError):
    """Data or options that an analysis cannot take: names the argument, the value and what is accepted."""


class AliasingWarning(UserWarning):
    """Samples are too far apart for the signal: power above pi/dt appears at lower frequencies."""


def refuse(who: str, name: str, value: object, accepted: str) -> NoReturn:
    """Raise the error of an argument that is not accepted."""
    raise AnalysisError(f"{who}: {name} must be {accepted}; got {shown(value)}")


def checked_kind(who: str, name: str, value: Any, kind: type[_Kind], accepted: str) -> _Kind:
    """An argument that must be of a type."""
    if not isinstance(value, kind):
        refuse(who, name, value, accepted)
    return value


def checked_scene(who: str, scene: Any) -> Scene:
    """A scene."""
    return checked_kind(who, "scene", scene, Scene, "a Scene")


def checked_solution(who: str, sol: Any) -> Solution:
    """What a run found."""
    return checked_kind(who, "sol", sol, Solution, "a Solution")


def checked_law(who: str, law: Any) -> FrictionLaw:
    """A friction law."""
    return checked_kind(who, "law", law, FrictionLaw, "a friction law")


def checked_number(who: str, name: str, value: Any, accepted: str, fits: Callable[[float], bool]) -> float:
    """A finite number that fits."""
    found = as_float(value)
    if not (isfinite(found) and fits(found)):
        refuse(who, name, value, accepted)
    return found


def positive(who: str, name: str, value: Any) -> float:
    """A finite number above 0."""
    return checked_number(who, name, value, "positive", lambda x: x > 0.0)


def checked_numbers(who: str, name: str, values: Any, accepted: str) -> Floats:
    """Numbers as an array; what is accepted besides is not looked at."""
    if np.iscomplexobj(values):  # numpy would leave the imaginary part out
        refuse(who, name, values, accepted)
    try:
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        refuse(who, name, values, accepted)


def checked_growth(who: str, name: str, values: Any) -> Floats:
    """At least two finite numbers (n,), each above the one before."""
    accepted = "(n,) rising numbers, n of at least 2"
    found = checked_numbers(who, name, values, accepted)
    if found.ndim != 1 or found.size < 2 or not np.isfinite(found).all() or not (np.diff(found) > 0.0).all():
        refuse(who, name, values, accepted)
    return found


def checked_samples(who: str, x: ArrayLike, dt: float) -> Floats:
    """Finite samples (n,) less their mean, for a positive sampling interval."""
    samples = checked_numbers(who, "x", x, "(n,) numbers with n of at least 2")
    if samples.ndim != 1 or len(samples) < 2:
        raise AnalysisError(f"{who}: x must be (n,) with n of at least 2; got shape {samples.shape}")
    if not np.isfinite(samples).all():
        raise AnalysisError(f"{who}: x must be finite")
    checked_interval(who, dt)
    centred: Floats = samples - samples.mean()
    return centred


def checked_interval(who: str, dt: Any) -> float:
    """A positive sampling interval."""
    return positive(who, "dt", dt)


def checked_frequencies(who: str, omega: ArrayLike, dt: float) -> Floats:
    """Angular frequencies (n,) from 0 to pi/dt."""
    grid = checked_numbers(who, "omega", omega, "(n,) numbers within 0 and pi/dt")
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
        raise AnalysisError(f"{who}: {name} must lie between {low} and {high}; got {shown(value)}")
    return int(value)
