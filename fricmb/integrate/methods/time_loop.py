"""The loop of a one-step run, and how runs stop exactly at breakpoints."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import entry, kernel
from fricmb.integrate.contact.event_location import EPS, Before, transition
from fricmb.integrate.contact.mode_decision import Rest
from fricmb.integrate.methods.attempt_step import (
    CHANGED,
    DONE,
    FULL,
    Clock,
    advance,
    settled,
)
from fricmb.integrate.model.accelerations import State
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.output.recorder import Rows
from fricmb.integrate.problem import Ints
from fricmb.integrate.run.stop import stopped
from fricmb.integrate.step.radau_step import Accuracy, OneStep


@kernel
def next_stop(clock: Clock, t: float) -> float:
    """The next time that has to be stepped to exactly."""
    stop = clock.span[1]
    for i in range(clock.stops.shape[0]):
        if clock.stops[i] > t + 4.0 * EPS * abs(t) and clock.stops[i] < stop:
            stop = clock.stops[i]
    return float(stop)


@kernel
def set_window(clock: Clock, s: Scratch, t: float) -> float:
    """Let functions of time be evaluated inside the present interval between breakpoints; returns its end."""
    stop = next_stop(clock, t)
    low, high = clock.span[0] + 2.0 * EPS * abs(clock.span[0]) + 1e-300, np.inf
    for i in range(clock.stops.shape[0]):
        edge = clock.stops[i]
        if edge <= t + 4.0 * EPS * abs(t):
            low = max(low, edge + 2.0 * EPS * abs(edge) + 1e-300)
        else:
            high = min(high, edge - 2.0 * EPS * abs(edge) - 1e-300)
    s.window[0] = low
    s.window[1] = high
    return float(stop)


@kernel
def arrive(
    packed: Packed, s: Scratch, y: State, r: Rest, old: Before, out: Rows, clock: Clock, stop: float, address: Ints
) -> int:
    """Go through a stop that has been reached: DONE at the end of the run, else as a transition."""
    y.t[0] = stop
    if out.used[0] > 0:
        # the last row is this instant up to round-off
        out.values[out.used[0] - 1, 0] = stop
    if stop >= clock.span[1]:
        return DONE
    stop = set_window(clock, s, stop)
    code = settled(transition(packed, s, y, -1, False, r, old, out, address))
    clock.h[0] = min(clock.usual[0], 0.1 * (stop - y.t[0]))
    return code


@kernel
def crowded(out: Rows, n_s: int, nc: int) -> bool:
    """Whether the rows of one more step might not find room."""
    return bool(out.used[0] + 2 * n_s + 4 > out.kind.shape[0] or out.used[1] + nc > out.event.shape[0])


@kernel
def reached(t: float, stop: float) -> bool:
    """Whether t is the stop, up to round-off."""
    return bool(stop - t <= 20.0 * EPS * max(abs(t), abs(stop)))


@entry
def drive(
    packed: Packed, s: Scratch, y: State, end: State, one: OneStep, acc: Accuracy, r: Rest, old: Before, out: Rows,
    clock: Clock, address: Ints,
) -> int:  # fmt: skip
    """Step from y until the end of the span, or until the room for rows is used up."""
    stop = set_window(clock, s, y.t[0])
    while True:
        if stopped() or crowded(out, one.tab.c.shape[0], y.mode.shape[0]):
            return FULL
        if reached(y.t[0], stop):
            code = arrive(packed, s, y, r, old, out, clock, stop, address)
            stop = set_window(clock, s, y.t[0])
            one.last[1] = 0.0
        else:
            code = advance(packed, s, y, end, one, acc, r, old, out, clock, stop - y.t[0], address)
        if code > CHANGED:
            return code
