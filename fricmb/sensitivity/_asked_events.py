"""Derivatives of the times of events that were asked for.

An event is where f(t, q, v, p) = 0, so its time moves by dt/dp = -(df/dp at fixed time) / (df/dt).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from fricmb.errors import SceneError
from fricmb.field import AskedEvent, Seen
from fricmb.field._functions import Given
from fricmb.integrate.problem import Floats
from fricmb.solution import Derivatives


def with_asked_events(sol: Any, tangent: Any, found: Derivatives) -> Derivatives:
    """Derivatives of all events of a solution, from those of its transitions."""
    transition = sol.events.is_transition
    if transition.all():
        return found
    event_times = np.full((transition.size, len(found.columns)), np.nan)
    transversality = np.full(transition.size, np.nan)
    event_times[transition], transversality[transition] = found.event_times, found.transversality
    names = np.array([event.name for event in sol.events])
    for one in sol.asked_events:
        mine = np.flatnonzero(~transition & (names == one.name))
        if mine.size:
            t = sol.events.t[mine]
            event_times[mine], transversality[mine] = _times(sol, tangent, found, one, t)
    unsafe = tuple(np.flatnonzero(transition)[list(found.unsafe)].tolist())
    return replace(found, event_times=event_times, transversality=transversality, unsafe=unsafe)


def _times(sol: Any, tangent: Any, found: Derivatives, one: AskedEvent, t: Floats) -> tuple[Floats, Floats]:
    """Derivatives (n, n_columns) of the times of one of them, and how surely it happens (n,)."""
    seen = sol.at(t)
    none = np.zeros((0, len(found.columns)))
    here = replace(found, S=tangent.at(t), event_times=none, transversality=none[:, 0], unsafe=())
    by_coordinates, by_speeds, by_parameters, by_time = one.slopes()

    def value(expression: Any) -> Floats:
        return np.broadcast_to(np.asarray(Given(expression).at(Seen(seen)), dtype=float), t.shape)

    rate = value(by_time).copy()
    moved = np.zeros((len(found.columns), t.size))
    for motions, end, kind in ((by_coordinates, "", "velocity"), (by_speeds, ".velocity", "acceleration")):
        for name, slope in motions.items():
            along = value(slope)
            rate += along * seen[f"{name}.{kind}"]
            moved += along * np.array([_slope(here, sol, f"{name}{end}", column, seen) for column in found.columns])
    for name, slope in by_parameters.items():
        if name in found.columns:
            moved[found.columns.index(name)] += value(slope)
    greatest = one.greatest(sol)
    sure = np.abs(rate) * (sol.t_end - sol.t_start) / greatest if greatest else np.zeros(t.size)
    flat = rate == 0.0
    return np.where(flat, 0.0, -moved / np.where(flat, 1.0, rate)).T, sure


def _slope(here: Derivatives, sol: Any, signal: str, column: str, seen: Any) -> Floats:
    """Derivative of a motion at fixed times; that of a driven one is 0, unless a parameter moves it."""
    if signal.removesuffix(".velocity") in sol.names.signals:
        raise SceneError(
            f"sensitivities: the event that reads {signal!r} has no derivative: the motion is driven; state it in fm.t"
        )
    return here.signal(sol.names, signal, column, seen.record.samples)
