"""Signals whose zero is not known: a constant in each is found with the parameters, and taken out of the problem.

A residual ``r = (y + b - x)/sigma`` is linear in the offset b: for given parameters the best b follows in closed form,
and what is left of r and of its derivatives is what has no part along 1/sigma (variable projection).
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from fricmb._fit._data import Measured
from fricmb.errors import SceneError, shown, unknown_name
from fricmb.integrate.problem import Floats


def checked_offsets(given: Any, measured: tuple[Measured, ...]) -> frozenset[str]:
    """Names of the signals that may be off: those given, or all for True.

    Raises
    ------
    SceneError
        For what is no signal that was measured.
    """
    signals = [m.name for m in measured if m.kind == "signal"]
    if isinstance(given, bool):
        return frozenset(signals if given else ())
    if not isinstance(given, str | Iterable):
        raise SceneError(f"offset: got {shown(given)}; expected True, False, or names of measured signals")
    names = (given,) if isinstance(given, str) else tuple(given)
    for name in names:
        if name not in signals:
            raise unknown_name("signal in offset", name, signals)
    return frozenset(names)


def without_offset(m: Measured, residual: Floats, J: Floats | None = None) -> tuple[Floats, Floats, float]:
    """Residual (n,) and derivatives (n, n_p) at the best offset, and that offset of the measurement."""
    along = 1.0 / m.sigma
    size = along @ along
    b = float(along @ residual / size)
    slopes = np.zeros((residual.size, 0)) if J is None else J
    return residual - b * along, slopes - np.outer(along, along @ slopes / size), -b
