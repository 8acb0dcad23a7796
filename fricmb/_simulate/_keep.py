"""What of a run is kept: all of it, the values at certain times, or one part at a time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fricmb._simulate._arguments import Span, number
from fricmb._simulate._asked_events import Asked, Finish, Known, UpTo, cut, find_end
from fricmb.errors import SceneError, shown
from fricmb.integrate import Integrator, Problem, Start, Trajectory
from fricmb.integrate.problem import Floats
from fricmb.integrate.run.chunked_run import MEMORY, KeptTrajectory, pieces, run_kept
from fricmb.solution import Event, LooksFor, Solution
from fricmb.values import is_flag

#: Bytes of rows at a time where no dense output is wanted.
SMALL = 3e7


@dataclass(frozen=True, kw_only=True)
class Keep:
    """``dense``: the dense output, too (None: while it is small); ``on_chunk`` gets each ``chunk`` of time instead.

    ``asked``: events beside the transitions, and those at which the run ends.
    """

    dense: bool | None
    chunk: float
    on_chunk: Callable[[Solution], object] | None
    asked: Asked


def check_keep(dense: Any, chunk: Any, on_chunk: Any, span: Span, asked: Asked) -> Keep:
    """Check the arguments of these names."""
    if dense is not None and not is_flag(dense):
        raise SceneError(f"dense: got {shown(dense)}; expected True, False or None")
    if on_chunk is not None and not callable(on_chunk):
        raise SceneError(
            f"on_chunk: got {shown(on_chunk)};"
            " expected a function of one argument, the Solution of a part"
        )
    if chunk is not None and on_chunk is None:
        raise SceneError(f"chunk: got {shown(chunk)} without on_chunk; expected both or neither")
    length = span.t_end - span.t_start
    if chunk is None:
        return Keep(dense=dense, chunk=length / 100.0, on_chunk=on_chunk, asked=asked)
    accepted = f"a positive time of at least a millionth of the run's length {length:g}"
    chunk = number("chunk", chunk, accepted, lambda x: x >= 1e-6 * length)
    return Keep(dense=dense, chunk=chunk, on_chunk=on_chunk, asked=asked)


def run(
    keep: Keep, integrator: Integrator, problem: Problem, start: Start, span: Span, finish: Finish, **options: Any
) -> Solution:
    """Integrate and make the solution; ``finish`` makes one from a trajectory, ``options`` are the integrator's."""
    asked = keep.asked
    end = find_end(asked, integrator, problem, start, span, finish, options) if asked.terminal else None
    if end is None:
        return _run(keep, integrator, problem, start, span, finish, asked if asked.events else None, **options)
    until = UpTo(asked=asked, end=end)
    sol = _run(keep, integrator, problem, start, cut(span, end.t), finish, until, **options)
    sol.add_notes((f"the run ends at t = {end.t:.10g}, where {end.name!r} changes its sign",))
    return sol


def _run(
    keep: Keep, integrator: Integrator, problem: Problem, start: Start, span: Span, finish: Finish,
    look_for: LooksFor | None, **options: Any,
) -> Solution:  # fmt: skip
    if keep.on_chunk is not None:
        return _stream(keep.on_chunk, keep.chunk, integrator, problem, start, span, finish, look_for, **options)
    if keep.dense or (keep.dense is None and span.t_eval is None):
        trajectory = integrator.integrate(problem, start, span.t_end, t_eval=span.t_eval, **options)
        return finish(trajectory, span, look_for)
    memory = MEMORY if keep.dense is None else SMALL
    found: list[Event] = []

    def look(part: Trajectory) -> None:
        if look_for is not None:
            found.extend(look_for.found(finish(part, _part_of(replace(span, t_eval=None), part), None)))

    trajectory = run_kept(
        integrator, problem, start, span.t_end, t_eval=span.t_eval, memory=memory, look=look, **options
    )
    if isinstance(trajectory, KeptTrajectory) and look_for is not None:
        look_for = Known(events=keep.asked.events, known=tuple(found))
    return finish(trajectory, span, look_for)


def _stream(
    on_chunk: Callable[[Solution], object], chunk: float, integrator: Integrator, problem: Problem, start: Start,
    span: Span, finish: Finish, look_for: LooksFor | None, **options: Any,
) -> Solution:  # fmt: skip
    count = int((span.t_end - span.t_start) / chunk)
    inner = span.t_start + chunk * np.arange(1, count + 1, dtype=np.float64)
    stops: Floats = np.append(inner[inner < span.t_end - 1e-9 * chunk], span.t_end).astype(np.float64)
    solution = None
    for part in pieces(integrator, problem, start, stops, memory=MEMORY, **options):
        solution = finish(part, _part_of(span, part), look_for)
        on_chunk(solution)
    if solution is None:
        raise SceneError("t_end: the run has no length")
    return solution


def _part_of(span: Span, part: Trajectory) -> Span:
    """The times within a part: the later one has a time where two meet."""
    t_start, t_end = float(part.t[0]), float(part.t[-1])
    times = span.t_eval
    if times is not None:
        last = t_end >= span.t_end
        times = times[(times >= t_start) & ((times <= t_end) if last else (times < t_end))]
    return Span(t_start=t_start, t_end=t_end, t_eval=times)
