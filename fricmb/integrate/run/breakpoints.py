"""How runs stop exactly at the times where functions of time, or their derivatives, jump."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import Floats
from fricmb.integrate.run.room_protocols import Times

EPS = 2.220446049250313e-16


@kernel
def next_stop(times: Times, t: float) -> float:
    """The next time that has to be stepped to exactly."""
    stop = times.span[1]
    for i in range(times.stops.shape[0]):
        if times.stops[i] > t + 4.0 * EPS * abs(t) and times.stops[i] < stop:
            stop = times.stops[i]
    return float(stop)


@kernel
def set_window(times: Times, window: Floats, t: float) -> float:
    """Let functions of time be evaluated inside the present interval between breakpoints; returns its end.

    ``window`` (2,): that of :class:`~fricmb.integrate.model.forces.Scratch`.
    """
    stop = next_stop(times, t)
    low, high = times.span[0] + 2.0 * EPS * abs(times.span[0]) + 1e-300, np.inf
    for i in range(times.stops.shape[0]):
        edge = times.stops[i]
        if edge <= t + 4.0 * EPS * abs(t):
            low = max(low, edge + 2.0 * EPS * abs(edge) + 1e-300)
        else:
            high = min(high, edge - 2.0 * EPS * abs(edge) - 1e-300)
    window[0] = low
    window[1] = high
    return float(stop)


@kernel
def set_window_around(stops: Floats, window: Floats, t: float) -> None:
    """Let functions of time be evaluated inside the interval between breakpoints that begins at or before t."""
    low, high = -np.inf, np.inf
    for i in range(stops.shape[0]):
        if stops[i] <= t:
            low = max(low, stops[i] + 2.0 * EPS * abs(stops[i]) + 1e-300)
        else:
            high = min(high, stops[i] - 2.0 * EPS * abs(stops[i]) - 1e-300)
    window[0] = low
    window[1] = high


@kernel
def reached(t: float, stop: float) -> bool:
    """Whether t is the stop, up to round-off."""
    return bool(stop - t <= 20.0 * EPS * max(abs(t), abs(stop)))
