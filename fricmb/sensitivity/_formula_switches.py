"""Switches of formulas at which rates of states jump: events that have no name, and move derivatives like any other."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fricmb.integrate.problem import Floats
from fricmb.sensitivity._bends import Bends
from fricmb.sensitivity._equations import Equations
from fricmb.sensitivity._found import total, whole
from fricmb.sensitivity._phases import BEFORE, Phases

#: Differences of rates below this share of their largest are none.
_NOTHING = 1e-8
#: Share of the parts of a condition's rate below which it only touches 0.
_TOUCHES = 1e-3


@dataclass(frozen=True, kw_only=True)
class FormulaSwitch:
    """Rates before less those after (n_y,); of the condition its slopes (columns,) and how fast it passes 0.

    ``sound``: False where it hardly passes, or depends on reactions, whose slopes are not followed here.
    """

    t: float
    rates: Floats
    slopes: Floats
    rate: float
    sound: bool

    def over(self, S: Floats) -> Floats:
        """Derivatives behind it from those before: S+ = S- + (f- - f+) dt, dt = -(c_y S- + c_p)/c'."""
        dt = -total(self.slopes, S, len(S)) / self.rate
        return np.asarray(S + np.outer(self.rates, dt))


def formula_switches(e: Equations, phases: Phases, sample: Any, bends: Bends) -> dict[int, FormulaSwitch]:
    """Switches by the stretch that begins with each."""
    if not bends.t.size:
        return {}
    begins = np.searchsorted(phases.t, bends.t)
    beside = BEFORE * np.maximum(1.0, np.abs(bends.t))
    before = e.field(sample(bends.t - beside), phases.mode[:, begins - 1], phases.sign[:, begins - 1])
    after = e.field(sample(bends.t + beside), phases.mode[:, begins], phases.sign[:, begins])
    off, size = before.y_dot - after.y_dot, np.abs(before.y_dot).max(axis=0)
    size[: e.n] = np.maximum(size[: e.n], phases.speed)
    large = np.flatnonzero((np.abs(off) > _NOTHING * size).any(axis=1))
    found = {}
    for i in large.tolist():
        condition = bends.conditions(bends.t[i : i + 1] - beside[i])[bends.which[i]]
        # slopes by reactions stand behind those of the columns
        own = {j: slope for j, slope in condition.slopes.items() if j < e.columns}
        loaded = any(np.any(slope != 0.0) for j, slope in condition.slopes.items() if j >= e.columns)
        slopes = whole([replace(condition, slopes=own)], 1, e.columns)[1][0, 0]
        parts = np.append(slopes[: e.n_y] * before.y_dot[i], slopes[-1])
        rate = float(parts.sum())
        sound = not loaded and abs(rate) > _TOUCHES * np.abs(parts).sum()
        found[int(begins[i])] = FormulaSwitch(
            t=float(bends.t[i]), rates=off[i], slopes=slopes, rate=rate or 1e-300, sound=sound,
        )
    return found
