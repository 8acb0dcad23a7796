"""Highest and lowest points of a motion over a cycle, and how they move with a parameter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmb.analysis._errors import AnalysisError, Floats

if TYPE_CHECKING:
    from fricmb.solution import Solution

#: Times at which a lap is looked at for its extremes, besides its accepted steps.
_POINTS = 2000


@dataclass(frozen=True, kw_only=True)
class Extreme:
    """Where a motion is highest or lowest."""

    t: float
    value: float


def extremes(sol: Solution, name: str) -> tuple[Extreme, Extreme]:
    """Lowest and highest point of a dof or point."""
    from scipy.optimize import brentq

    t = np.unique(np.concatenate([np.linspace(sol.t_start, sol.t_end, _POINTS), sol.run.row_motion().samples.t]))
    seen = sol.at(t)
    x, v = seen[name], seen.velocity(name)
    found: list[Extreme] = []
    for i in (int(np.argmin(x)), int(np.argmax(x))):
        around = [j for j in (i - 1, i) if 0 <= j < t.size - 1 and np.signbit(v[j]) != np.signbit(v[j + 1])]
        best = Extreme(t=float(t[i]), value=float(x[i]))
        for j in around:
            at = brentq(lambda s: float(sol.at([s]).velocity(name)[0]), t[j], t[j + 1], xtol=1e-15, rtol=1e-14)
            value = float(sol.at([at])[name][0])
            better = value < best.value if not found else value > best.value
            if better or len(around) == 1:
                best = Extreme(t=float(at), value=value)
        found.append(best)
    return found[0], found[1]


def amplitude_slope(cycle: Any, name: str, parameter: str, start: Floats) -> float:
    """Derivative of an amplitude by a parameter, ``start`` being that of the state at the section.

    The velocity is 0 at an extreme, so that its own shift in time has no influence.
    """
    sol, shooting = cycle.solution, cycle.orbit.shooting
    low, high = extremes(sol, name)
    found = []
    for extreme in (low, high):
        if extreme.t <= sol.t_start:
            found.append(_row(sol, name) @ start)
            continue
        arc = shooting.flow.arc(cycle.orbit.y, shooting.t_start, extreme.t, shooting.names, (parameter,))
        found.append(_row(sol, name) @ (arc.by_state @ start + arc.by[parameter]))
    return float(0.5 * (found[1] - found[0]))


def _row(sol: Solution, name: str) -> Floats:
    """Derivative (n_y,) of a motion by the state."""
    n = len(sol.names.dofs)
    row = np.zeros(2 * n + sol.end.z.size)
    if name in sol.names.dof_index:
        row[sol.names.dof_index[name]] = 1.0
    elif name in sol.names.motions:
        motion = sol.names.motions[name]
        row[:n] = (motion.position(np.eye(n)) - motion.position(np.zeros((n, n))))[:n]
    else:
        raise AnalysisError(f"amplitude: {name} is driven and has no derivative")
    return row
