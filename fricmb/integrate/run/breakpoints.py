"""How runs stop exactly at the times where functions of time, or their derivatives, jump."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import Floats
from fricmb.integrate.run.room_protocols import Times

EPS = 2.220446049250313e-16


@kernel
def count_until(times: Floats, t: float) -> int:
    """How many times, which rise, are at or before t."""
    low, high = 0, times.shape[0]
    while low < high:
        middle = (low + high) // 2
        if times[middle] <= t:
            low = middle + 1
        else:
            high = middle
    return low


@kernel
def next_stop(times: Times, t: float) -> float:
    """The next time that has to be stepped to exactly."""
    stop, i = times.span[1], count_until(times.stops, t + 4.0 * EPS * abs(t))
    if i < times.stops.shape[0]:
        stop = min(stop, times.stops[i])
    return float(stop)


@kernel
def set_window(times: Times, window: Floats, t: float) -> float:
    """Let functions of time be evaluated inside the present interval between breakpoints; returns its end.

    ``window`` (2,): that of :class:`~fricmb.integrate.model.forces.Scratch`.
    """
    stop = next_stop(times, t)
    low, high = times.span[0] + 2.0 * EPS * abs(times.span[0]) + 1e-300, np.inf
    i = count_until(times.stops, t + 4.0 * EPS * abs(t))
    if i > 0:
        edge = times.stops[i - 1]
        low = max(low, edge + 2.0 * EPS * abs(edge) + 1e-300)
    if i < times.stops.shape[0]:
        edge = times.stops[i]
        high = edge - 2.0 * EPS * abs(edge) - 1e-300
    window[0] = low
    window[1] = high
    return float(stop)


@kernel
def set_window_around(stops: Floats, window: Floats, t: float) -> None:
    """Let functions of time be evaluated inside the interval between breakpoints that begins at or before t."""
    low, high = -np.inf, np.inf
    i = count_until(stops, t)
    if i > 0:
        low = stops[i - 1] + 2.0 * EPS * abs(stops[i - 1]) + 1e-300
    if i < stops.shape[0]:
        high = stops[i] - 2.0 * EPS * abs(stops[i]) - 1e-300
    window[0] = low
    window[1] = high


@kernel
def reached(t: float, stop: float) -> bool:
    """Whether t is the stop, up to round-off."""
    return bool(stop - t <= 20.0 * EPS * max(abs(t), abs(stop)))
