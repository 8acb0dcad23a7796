"""Enough points for a curve: a step of high order may span half a turn; and which part of a run shows its swings."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from fricmb.solution import Solution

Floats = NDArray[np.float64]
#: What is looked at in a run: arrays (n_t,).
Signals = Callable[["Solution"], list[Floats]]
#: The run at so many times from one on to another.
Look = Callable[[float, float, int], "Solution"]
#: Points of a curve over the whole of what is drawn, beside those that the solution has.
POINTS = 60_000
#: Numbers that a refined run holds at most, whatever the size of the scene, and points that a curve has at least.
_NUMBERS, _LEAST = 50_000_000, 4000
#: Signals whose swings are counted, those that vary most.
_COUNTED = 8
#: Steps at the end of a run from which its period is taken, and the samples in them.
_STEPS, _SAMPLES = 2000, 16_384
#: A swing that is smaller than this share of the largest is none.
_SWING = 0.03
#: Part of the largest swings that a stretch must have to be shown.
_ALIVE = 0.5


def span_of(sol: Solution, t_start: float | None, t_end: float | None) -> tuple[float, float]:
    """Ends of the part of a run that is drawn; default: all of it.

    Raises AnalysisError where they are not in the run, in this order.
    """
    begin = sol.t_start if t_start is None else float(t_start)
    end = sol.t_end if t_end is None else float(t_end)
    margin = 1e-9 * max(abs(sol.t_start), abs(sol.t_end))
    if not sol.t_start - margin <= begin < end <= sol.t_end + margin:
        from fricmb.analysis import AnalysisError  # all of it is slow to load, and few pictures need it

        raise AnalysisError(
            f"t_start, t_end: got {begin:g}, {end:g}; they must rise and lie in {sol.t_start:g} to {sol.t_end:g}"
        )
    return max(begin, sol.t_start), min(end, sol.t_end)


def refined(sol: Solution, t_start: float | None = None, t_end: float | None = None) -> Solution:
    """The run at more times, from its dense output; left- and right-hand values at each transition."""
    t = np.unique(sol.t)
    if t_start is not None or t_end is not None:
        begin, end = span_of(sol, t_start, t_end)
        t = np.unique(np.concatenate(([begin], t[(t > begin) & (t < end)], [end])))
    if t.size < 2:
        return sol
    gaps = np.diff(t)
    parts = np.ceil(gaps * (_most(sol, POINTS) / (t[-1] - t[0]))).astype(np.int64)
    first = np.cumsum(parts) - parts
    inside = np.repeat(t[:-1], parts) + (np.arange(parts.sum()) - np.repeat(first, parts)) * np.repeat(
        gaps / parts, parts
    )
    events = sol.events.t
    events = events[(events > t[0]) & (events < t[-1])]
    return sol.at(np.unique(np.concatenate((inside, t[-1:], events, np.nextafter(events, -np.inf)))))


def _most(sol: Solution, wanted: int) -> int:
    """As many points as wanted, fewer for a scene so large that its curves would fill the memory."""
    return max(min(wanted, at_once(sol)), min(wanted, _LEAST))


def at_once(sol: Solution) -> int:
    """At how many times a run of this size may be seen together."""
    return max(1, _NUMBERS // max(1, 2 * len(sol.dof_names) + 6 * len(sol.contact_names)))


def looks(sol: Solution) -> Look:
    """The run at evenly spread times, looked up once for all signals that ask for the same."""

    @cache
    def look(begin: float, end: float, count: int) -> Solution:
        return sol.at(np.linspace(begin, end, count))

    return look


def reversals(x: Floats, least: float) -> int:
    """How often a signal turns round by more than ``least``."""
    turns, up = 0, 0
    top = bottom = float(x[0])
    for value in x.tolist():
        top, bottom = max(top, value), min(bottom, value)
        if up >= 0 and value < top - least:
            turns, up, bottom = turns + (up > 0), -1, value
        elif up <= 0 and value > bottom + least:
            turns, up, top = turns + (up < 0), 1, value
    return turns


def period_of(
    sol: Solution, signals: Signals, t_start: float, t_end: float, look: Look | None = None
) -> float | None:
    """Mean period of the swings of signals that can be seen beside the largest of them; None where none swings.

    Taken from the last steps of the stretch, which resolve whatever swings.  ``look``: that of others who ask, too.
    """
    look = look or looks(sol)
    steps = np.unique(sol.t if sol.has_rows else sol.run.row_motion().samples.t)
    steps = steps[(steps >= t_start) & (steps <= t_end)]
    begin = max(t_start, float(steps[-_STEPS])) if steps.size > _STEPS else t_start
    for low in (begin, t_start):
        seen = look(low, t_end, _most(sol, _SAMPLES))
        values = sorted(signals(seen), key=np.ptp, reverse=True)[:_COUNTED]
        largest = float(np.ptp(values[0])) if values else 0.0
        turns = max(reversals(x, _SWING * largest) for x in values) if largest > 0.0 else 0
        if turns >= 3:
            return 2.0 * (t_end - low) / turns
    return None


def window_of(
    sol: Solution, signals: Signals, t_start: float, t_end: float, *, swings: float, look: Look | None = None
) -> tuple[float, float] | None:
    """A stretch of so many swings: the last in which they are half as large as the largest; None for a few swings."""
    look = look or looks(sol)
    period = period_of(sol, signals, t_start, t_end, look)
    if period is None or swings * period >= t_end - t_start:
        return None
    length = swings * period
    ends = np.linspace(t_end, t_start + length, min(25, max(2, int((t_end - t_start) / length))))
    sizes = []
    for end in ends.tolist():
        seen = look(end - length, end, 200)
        sizes.append(max(float(np.ptp(x)) for x in signals(seen)))
    end = float(ends[np.argmax(np.array(sizes) >= _ALIVE * max(sizes))])
    return end - length, end
