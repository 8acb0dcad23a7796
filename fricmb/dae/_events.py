"""Events: functions of the solution whose zeros are found, with the conventions of ``scipy.integrate.solve_ivp``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from scipy.optimize import brentq

from fricmb.dae._engine import Record
from fricmb.dae._function import parameters
from fricmb.dae._result import interpolate
from fricmb.errors import ArgumentError, shown
from fricmb.integrate.problem import Floats


class Event:
    """One event function, ``event(t, y, *args)`` or ``event(t, y, yp, *args)``."""

    def __init__(self, function: Callable[..., Any], args: tuple[Any, ...]) -> None:
        if not callable(function):
            raise ArgumentError(f"`events` must be callable, not {shown(function)}.")
        self.function, self.args = function, args
        self.with_rate = len(parameters(function)) - len(args) >= 3
        self.direction = _direction(getattr(function, "direction", 0))
        self.limit = _limit(getattr(function, "terminal", None))
        self.t: list[float] = []
        self.y: list[Floats] = []
        self.yp: list[Floats] = []
        self.last = 0.0

    def value(self, t: float, y: Floats, yp: Floats) -> float:
        """Evaluate the event function."""
        found = self.function(t, y, yp, *self.args) if self.with_rate else self.function(t, y, *self.args)
        try:
            value = np.asarray(found, dtype=float)
        except (TypeError, ValueError):
            raise ArgumentError(f"An event function must return one number; it returned {shown(found)}.") from None
        if value.size != 1:
            raise ArgumentError(f"An event function must return one number; it returned one of shape {value.shape}.")
        return float(value.reshape(()))

    def crosses(self, new: float) -> bool:
        """Whether a zero lies between the last value and the new one, in the direction asked for."""
        up = self.last <= 0.0 <= new
        down = self.last >= 0.0 >= new
        return (up and self.direction >= 0.0) or (down and self.direction <= 0.0)


def _direction(given: Any) -> float:
    try:
        found = float(given)
    except (TypeError, ValueError, OverflowError):
        found = np.nan
    if np.isnan(found):
        raise ArgumentError(f"The `direction` attribute of each event must be a number, not {shown(given)}.")
    return found


def _limit(terminal: Any) -> float:
    if terminal is None or terminal is False or terminal == 0:
        return np.inf
    if isinstance(terminal, int | float | np.integer | np.floating) and terminal > 0 and terminal == terminal // 1:
        return int(terminal)
    raise ArgumentError("The `terminal` attribute of each event must be a boolean or positive integer.")


class Events:
    """All events of a run."""

    def __init__(self, functions: Any, args: tuple[Any, ...]) -> None:
        if functions is None:
            functions = ()
        elif callable(functions) or not isinstance(functions, (list, tuple)):
            functions = (functions,)
        self.all: Sequence[Event] = [Event(f, args) for f in functions]

    def start(self, record: Record) -> None:
        """Values at the first point."""
        for event in self.all:
            event.last = event.value(float(record.t[0]), record.y[0].copy(), record.yp[0].copy())

    def look(self, record: Record, first: int) -> tuple[int, float] | None:
        """Search the steps that end in points ``first`` and after: point and time at which a terminal event stops."""
        for point in range(first, record.size):
            stop = self._step(record, point)
            if stop is not None:
                return point, stop
        return None

    def _step(self, record: Record, point: int) -> float | None:
        old, new = float(record.t[point - 1]), float(record.t[point])
        found: list[tuple[float, Event]] = []
        for event in self.all:
            value = event.value(new, record.y[point].copy(), record.yp[point].copy())
            if event.crosses(value):
                found.append((_zero(event, record, point, old, new), event))
            event.last = value
        found.sort(key=lambda pair: pair[0] if new > old else -pair[0])
        for t, event in found:
            y, yp = _state(record, point, t)
            event.t.append(t)
            event.y.append(y)
            event.yp.append(yp)
            if len(event.t) >= event.limit:
                return t
        return None


def _state(record: Record, point: int, t: float) -> tuple[Floats, Floats]:
    low = max(0, point - int(record.order[point]))
    part = slice(low, point + 1)
    value, rate = np.empty((2, 1, record.y.shape[1]))
    # the polynomial of this very step, also at its left end
    step = np.array([point - low - 1])
    interpolate(record.t[part], record.y[part], record.order[part], np.array([t]), step, value, rate)
    return value[0], rate[0]


def _zero(event: Event, record: Record, point: int, old: float, new: float) -> float:
    """The zero inside a step, on the step's polynomial, to the last digits of t."""

    def value(t: float) -> float:
        return event.value(t, *_state(record, point, t))

    at_old, at_new = value(old), value(new)
    if at_old == 0.0:
        return old
    if at_new == 0.0 or at_old * at_new > 0.0:  # round-off between a point and its polynomial
        return new
    eps = 4.0 * float(np.finfo(float).eps)
    return float(brentq(value, old, new, xtol=eps, rtol=eps))
