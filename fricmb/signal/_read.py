"""Series from files: columns by name, as :mod:`fricmb.measure` reads them."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from fricmb.errors import FileError, SceneError, shown, unknown_name
from fricmb.integrate.problem import Floats
from fricmb.measure import read


def read_columns(path: Any, time: Any, value: Any, units: Any, step: Any) -> tuple[Floats, Floats, str]:
    """Times, values and the name of a series in a file."""
    of_time, of_value = _factors(units)
    found = read(path, step=step, time=time)
    there = {series.name: series for series in found.signals}
    if value is None:
        if len(there) != 1:
            raise FileError(f"{path}: expected one series, found {', '.join(there) or 'none'}; say value=, one of them")
        value = next(iter(there))
    if not isinstance(value, str) or value not in there:
        raise unknown_name(f"series of {path}", value, there)
    series = there[value]
    t, y = series.t * of_time, series.y * of_value
    _name_gaps(path, value, t)
    return t, y, value


def _factors(units: Any) -> tuple[float, float]:
    given = tuple(units) if isinstance(units, tuple | list) else (1.0, units)
    good = len(given) == 2 and all(
        isinstance(v, int | float | np.number) and not isinstance(v, bool) and np.isfinite(v) and v != 0.0
        for v in given
    )
    if not good:
        raise SceneError(f"Signal.read: units must be a factor, or one of times and one of values, got {shown(units)}")
    return float(given[0]), float(given[1])


def _name_gaps(path: Any, value: str, t: Floats) -> None:
    steps = np.diff(t)
    wide = np.flatnonzero(steps > 3.0 * np.median(steps)) if steps.size else np.zeros(0, dtype=int)
    if wide.size:
        i = int(wide[np.argmax(steps[wide])])
        warnings.warn(
            f"{path}: {value}: {wide.size} gap(s) in the times, the widest from {t[i]:.6g} to {t[i + 1]:.6g} (usual are"
            f" {np.median(steps):.3g}); the line between two values goes over them",
            stacklevel=4,
        )
