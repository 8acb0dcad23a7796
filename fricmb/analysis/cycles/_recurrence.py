"""A first guess of a cycle from a run: when the motion comes back to where it was."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fricmb.analysis._errors import AnalysisError, Floats
from fricmb.analysis.cycles._flow import states_at
from fricmb.analysis.cycles._section import Section, calm_time

if TYPE_CHECKING:
    from fricmb.solution import Solution

#: Times at which the run is looked at.
_POINTS = 8000
#: Motion whose extent is below this part of the whole run's has died out.
_STILL = 1e-5
#: A return may miss by this part of the cycle's extent.
_NEAR = 0.15


def guess_cycle(
    sol: Solution, section: Section | None, laps: int, period: float | None, who: str
) -> tuple[float, float]:
    """A time of the run and a period after which the motion is about where it was.

    Looked for in the second half of the run; ``laps`` times the first return that is about as close as the best one.
    """
    begin, end = 0.5 * (sol.t_start + sol.t_end), sol.t_end
    t = np.linspace(begin, end, _POINTS)
    y = states_at(sol, t)
    extent = np.ptp(y, axis=1)
    whole = np.ptp(states_at(sol, np.linspace(sol.t_start, end, _POINTS)), axis=1)
    n = len(sol.names.dofs)
    least = np.maximum(_STILL * whole, 1e-9 * np.abs(y).max(axis=1))
    if not (extent > least)[:n].any():
        raise AnalysisError(f"{who}: the run does not oscillate in its second half")
    if period is None:
        scale = np.where(extent > 0.0, extent, np.inf)
        period = laps * _first_return(t, (np.abs(y - y[:, :1]) / scale[:, None]).max(axis=0), who)
    if section is None:
        return calm_time(sol, max(begin, end - period), end), period
    return _crossing(t, y[section.index] - section.value, section, who), period


def _crossing(t: Floats, x: Floats, section: Section, who: str) -> float:
    turns = np.flatnonzero(np.signbit(x[:-1]) != np.signbit(x[1:]))
    if not turns.size:
        raise AnalysisError(f"{who}: {section.name} does not pass {section.value:g} in the second half of the run")
    i = int(turns[-1])
    return float(t[i] - x[i] * (t[i + 1] - t[i]) / (x[i + 1] - x[i]))


def _first_return(t: Floats, distance: Floats, who: str) -> float:
    away = int(np.argmax(distance > 2.0 * _NEAR))  # first leave, then come back
    d = distance[away:]
    lowest = 1 + np.flatnonzero((d[1:-1] <= d[:-2]) & (d[1:-1] < d[2:]))
    if distance[away] <= 2.0 * _NEAR or not lowest.size or d[lowest].min() > _NEAR:
        raise AnalysisError(
            f"{who}: the run does not come back to where it was; run longer, or give period= and a start nearer to it"
        )
    good = lowest[d[lowest] <= max(2.0 * d[lowest].min(), 0.02)]
    return float(t[away + good[0]] - t[0])
