"""Steps along a branch: its direction, and the way back onto it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fricmb.analysis._errors import AnalysisError, Floats
from fricmb.analysis.cycles._drive import places_are_integrals
from fricmb.analysis.cycles._section import calm_time
from fricmb.analysis.cycles._shooting import Orbit, Shooting
from fricmb.errors import IntegrationError, SceneError, shown

_MOST_STEPS = 8


@dataclass(frozen=True, kw_only=True)
class Point:
    """A cycle on a branch, with the direction (n,) in which the branch goes on: start, period, parameter, scaled."""

    orbit: Orbit
    over: str
    p_scale: float
    forward: Floats

    @property
    def value(self) -> float:
        """Of the parameter."""
        return float(self.orbit.shooting.flow.scene.parameters[self.over])

    @property
    def slope(self) -> float:
        """Of the parameter along the branch."""
        return float(self.forward[-1])


def columns(orbit: Orbit, over: str, p_scale: float) -> Floats:
    """Derivative of an orbit's residual by its start, period (where free) and parameter, scaled."""
    J = orbit.matrix.copy()
    if orbit.shooting.drive is None:
        J[:, -1] *= orbit.T
    return np.hstack([J, p_scale * orbit.column(over)[:, None]])


def direction(orbit: Orbit, over: str, p_scale: float) -> Floats:
    """Unit vector along the branch, of either sign."""
    return np.asarray(np.linalg.svd(columns(orbit, over, p_scale))[2][-1])


def shifted(orbit: Orbit, over: str, p_scale: float, step: Floats) -> Orbit | None:
    """The lap after a step; None where there is none."""
    shooting = orbit.shooting
    p = float(shooting.flow.scene.parameters[over]) + p_scale * float(step[-1])
    scaled = step[:-1].copy()
    if shooting.drive is None:
        scaled[-1] *= orbit.T
    y, T = orbit.after_step(scaled)
    try:
        there = shooting.with_values({over: p})
        y = there.onto_belt(y, orbit.sticks)
        T = there.period(T)
        return there.orbit(y, T, (over,)) if T > 0.0 else None
    except (IntegrationError, SceneError):
        return None


def correct(start: Orbit, over: str, p_scale: float, step: Floats, normal: Floats, goal: float) -> Orbit | None:
    """From a predicted step back onto the branch, in the plane across ``normal`` through the prediction."""
    orbit = shifted(start, over, p_scale, step)
    best = np.inf
    for _ in range(_MOST_STEPS):
        if orbit is None or not np.isfinite(orbit.miss) or orbit.miss > 0.5:
            return None
        if orbit.miss <= goal:
            return orbit
        if orbit.miss > 0.7 * best:
            return orbit if orbit.miss < 1e2 * goal else None
        best = orbit.miss
        J = np.vstack([columns(orbit, over, p_scale), normal])
        move = -np.linalg.lstsq(J, np.append(orbit.residual, 0.0), rcond=None)[0]
        orbit = shifted(orbit, over, p_scale, move)
    return orbit if orbit is not None and orbit.miss <= 1e2 * goal else None


def recut(orbit: Orbit, over: str) -> Orbit:
    """The same cycle from the middle of its longest slip, its phase fixed across the motion there."""
    sol, shooting = orbit.arc.solution, orbit.shooting
    T, begin = orbit.T, sol.t_start
    t = calm_time(sol, begin, begin + T)
    if _is_calm(orbit) or (shooting.drive is not None and places_are_integrals(shooting.system, shooting.flow.scene)):
        return replace(orbit, shooting=_anchored(shooting, orbit)) if shooting.drive is None else orbit
    samples = sol.at([t]).record.samples
    y = np.concatenate([samples.q, samples.v, samples.z])[:, 0]
    phase = 0.0 if shooting.drive is None else (t / T) % 1.0
    there = replace(shooting, phase=phase, section=None)
    moved = there.orbit(y, T, (over,))
    return replace(moved, shooting=_anchored(there, moved)) if there.drive is None else moved


def _is_calm(orbit: Orbit) -> bool:
    """Whether the section is away from the transitions, and in slip if anything is."""
    sol, T = orbit.arc.solution, orbit.T
    events = sol.events.t - sol.t_start
    far = not events.size or (events[0] > 0.1 * T and events[-1] < 0.9 * T)
    return bool(far and not orbit.sticks)


def _anchored(shooting: Shooting, orbit: Orbit) -> Shooting:
    return replace(shooting, section=None).anchored(orbit.y, orbit.arc.solution)


def check_parameter(orbit: Orbit, over: str, to: float, who: str) -> float:
    """The value that a parameter has now; refuses what cannot be continued over."""
    from fricmb.errors import unknown_name

    values = orbit.shooting.flow.scene.parameters
    if not isinstance(over, str) or over not in values:
        raise unknown_name("parameter", over, values)
    try:
        value, end = float(values[over]), float(to)
    except (TypeError, ValueError, OverflowError):
        raise AnalysisError(f"{who}: {over} = {shown(values[over])} and to = {shown(to)} must be numbers") from None
    if not np.isfinite(end) or end == value:
        raise AnalysisError(f"{who}: to must be a finite number other than {over} = {value:g}; got {shown(to)}")
    return value
