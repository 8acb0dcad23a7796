"""Checks of what a user gives to simulate: one line with argument, value and what is accepted."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb._simulate._asked import check_names
from fricmb.errors import SceneError, shown, unknown_name
from fricmb.integrate import Tolerance
from fricmb.integrate.problem import Floats
from fricmb.integrate.run.memory import available
from fricmb.scene import Scene
from fricmb.solution import times_inside
from fricmb.values import as_float

#: Tightest and loosest relative tolerance: what double precision can hold, and what still means something.
RTOL_RANGE = 1e-14, 0.1
#: Bytes that a result may have without a look at what is left: the look takes as long as a fifth of a run of nothing.
LITTLE = 1e7


@dataclass(frozen=True, kw_only=True)
class Span:
    """Times of a run."""

    t_start: float
    t_end: float
    t_eval: Floats | None


def number(name: str, value: Any, accepted: str, fits: Callable[[float], bool] = math.isfinite) -> float:
    """A finite float that fits, else a SceneError."""
    found = as_float(value)
    if not math.isfinite(found) or not fits(found):
        raise SceneError(f"{name}: got {shown(value)}; expected {accepted}")
    return found


def check_scene(scene: Any) -> Scene:
    """A scene."""
    if not isinstance(scene, Scene):
        raise SceneError(f"scene: got {shown(scene)}; expected a Scene")
    return scene


def check_options(
    who: str,
    options: Mapping[str, Any],
    simulate: Callable[..., Any],
    *own: str,
    call: Callable[..., Any] | None = None,
) -> None:
    """Whether what is passed on to ``simulate`` are options of it.

    ``own``: those that the caller gives it himself; ``call``: the function called, whose arguments may be meant.
    """
    known = [name for name in inspect.signature(simulate).parameters if name not in ("scene", *own)]
    for name in options:
        if name not in known:
            meant = [] if call is None else [a for a in inspect.signature(call).parameters if a != "options"]
            raise unknown_name(f"option of {who}", name, [*known, *meant])


def check_span(t_start: float, t_end: Any, t_eval: Any) -> Span:
    """Start, end and output times."""
    end = number("t_end", t_end, f"a finite time after t_start = {t_start:.10g}", lambda t: t > t_start)
    if t_start + (end - t_start) / 2 in (t_start, end):
        raise SceneError(
            f"t_end: got {shown(t_end)}, next to t_start = {t_start!r};"
            " expected room for a step between them"
        )
    return Span(t_start=t_start, t_end=end, t_eval=None if t_eval is None else check_times(t_eval, t_start, end))


def check_times(t_eval: Any, t_start: float, t_end: float) -> Floats:
    """Output times: at least one, in order, within the run."""
    times = times_inside(t_eval, t_start, t_end, "t_eval")
    if times.size == 0:
        raise SceneError("t_eval: got no time; expected one or more, or None for the accepted steps")
    falls = np.flatnonzero(times[1:] < times[:-1])
    if falls.size:
        i = int(falls[0])
        raise SceneError(f"t_eval: {times[i + 1]:.10g} follows {times[i]:.10g}; expected times in rising order")
    return times


def check_tolerance(rtol: Any, atol: Any, n: int, max_step: Any = None) -> Tolerance:
    """Relative tolerance, absolute ones for position and velocity (n,) each, and the longest step."""
    low, high = RTOL_RANGE
    found = number("rtol", rtol, f"a number from {low:g} to {high:g}", lambda r: low <= r <= high)
    longest = math.inf
    if max_step is not None:
        longest = number("max_step", max_step, "a positive time, or None", lambda x: x > 0.0)
    if atol is None:
        return Tolerance(rtol=found, max_step=longest)
    try:
        values = np.asarray(atol, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        values = np.full(1, np.nan)
    if values.shape not in ((), (n,), (2 * n,)) or not (np.isfinite(values).all() and (values > 0).all()):
        raise SceneError(
            f"atol: got {shown(atol)}; expected None, a positive number, or an array of {n} (one a degree of freedom) "
            f"or {2 * n} (positions, then velocities)"
        )
    both = np.broadcast_to(values, (2 * n,)) if values.size in (1, 2 * n) else np.tile(values, 2)
    return Tolerance(rtol=found, atol_q=both[:n].copy(), atol_v=both[n:].copy(), max_step=longest)


def floors(tolerance: Tolerance) -> tuple[float, ...] | None:
    """The absolute tolerances of positions, then of velocities; one of each where all are alike; None: none given."""
    q, v = tolerance.atol_q, tolerance.atol_v
    if q is None or v is None:
        return None
    alike = q.size > 0 and bool((q == q[0]).all() and (v == v[0]).all())
    return (float(q[0]), float(v[0])) if alike else (*q.tolist(), *v.tolist())


def check_limit(seconds: Any) -> float | None:
    """A limit on the time of a run."""
    if seconds is None:
        return None
    return number("time_limit", seconds, "a positive number of seconds, or None", lambda x: x > 0.0)


def check_memory(numbers: int, span: Span) -> None:
    """Whether the values at the times asked for fit into memory; ``numbers``: of each time."""
    wanted = 0.0 if span.t_eval is None else 8.0 * numbers * span.t_eval.size
    if span.t_eval is None or wanted < LITTLE:
        return
    there = available()
    if there is not None and wanted > there:
        raise SceneError(
            f"t_eval: {span.t_eval.size} times of {numbers} numbers take {wanted / 1e9:.3g} GB, and {there / 1e9:.3g} "
            "GB of memory are left; expected fewer times, or on_chunk="
        )


def check_step(step: Any, adaptive: bool, method: str, length: float) -> float | None:
    """The step of a method of fixed step, and of no other."""
    if adaptive:
        if step is not None:
            raise SceneError(
                f"step: got {shown(step)}, but the method {method!r} chooses its steps itself;"
                " expected None"
            )
        return None
    accepted = f"a positive step of at most the run's length {length:g}, which the method {method!r} needs"
    return number("step", step, accepted, lambda h: 0 < h <= length)


def check_sensitivities(scene: Any, given: Any, on_chunk: Any) -> tuple[str, ...]:
    """Names to differentiate by; none for None."""
    if given is None:
        return ()
    if on_chunk is not None:
        raise SceneError("sensitivities: not together with on_chunk, which keeps nothing of the run")
    return check_names(scene, given)
