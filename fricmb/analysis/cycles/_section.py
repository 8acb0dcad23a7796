"""Where a cycle is cut: an instant of it at which, if there is one, every contact slips."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmb.analysis._errors import AnalysisError, Floats
from fricmb.errors import shown, unknown_name
from fricmb.integrate import STICK

if TYPE_CHECKING:
    from fricmb.solution import Names, Solution


@dataclass(frozen=True, kw_only=True)
class Section:
    """One coordinate or velocity that has a given value: ``y[index] = value``."""

    name: str
    index: int
    value: float


def checked_section(section: Any, names: Names, who: str) -> Section:
    """A section out of ``("mass.x", 0.0)`` or ``("mass.x.velocity", 0.0)``."""
    try:
        name, value = section
        value = float(value)
    except (TypeError, ValueError):
        raise AnalysisError(
            f'{who}: section must be a name and a value such as ("mass.x.velocity", 0.0); got {shown(section)}'
        ) from None
    known = [*names.dofs, *(f"{dof}.velocity" for dof in names.dofs)]
    if name not in known:
        raise unknown_name("section (a degree of freedom or its velocity)", name, known)
    return Section(name=name, index=known.index(name), value=value)


def calm_time(sol: Solution, t_start: float, t_end: float) -> float:
    """The middle of the longest stretch without events between two times, of those with the fewest stuck contacts."""
    events = sol.events.t
    inside = events[(events > t_start) & (events < t_end)]
    bounds = np.concatenate([[t_start], inside, [t_end]])
    middles = 0.5 * (bounds[1:] + bounds[:-1])
    stuck = (sol.at(middles).record.samples.mode == STICK).sum(axis=0)
    lengths = np.where(stuck == stuck[lengthy(bounds)].min(), np.diff(bounds), 0.0)
    return float(middles[np.argmax(lengths)])


def lengthy(bounds: Floats) -> Any:
    """Which stretches are no mere instants between two events."""
    lengths = np.diff(bounds)
    return lengths > 1e-3 * (bounds[-1] - bounds[0])
