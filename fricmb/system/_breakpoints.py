"""Instants at which expressions of time switch: computed where they are known, searched where not."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from fricmb.equations import SwitchFormulas, Template
from fricmb.integrate.problem import Floats
from fricmb.integrate.signals.jets import Entry
from fricmb.integrate.signals.sign_changes import stretches

#: A search without bounds looks at this many points at first, and at twice as many until it finds no more sign changes.
_FIRST, _MOST = 512, 2**18
#: It goes beyond the ends of a run by this part of it: what switches at an end does so as exactly as elsewhere.
#: Round-off of a time, relative to the ends.
_BEYOND, _SAME = 1e-7, 1e-14
NOWHERE = np.zeros(0)


@dataclass(frozen=True)
class Switch:
    """A function of time, or of slip speed, at whose sign changes an expression switches; parameters come first."""

    function: Callable[[Sequence[float]], float]
    parameters: tuple[float, ...]
    tape: tuple[Entry, ...] | None = None

    def value(self, t: float) -> float:
        """The function; 0 where it cannot be evaluated."""
        try:
            return float(self.function((*self.parameters, t)))
        except (ArithmeticError, ValueError):
            return 0.0

    def instants(self, t_start: float, t_end: float, bends: Floats = NOWHERE) -> Floats:
        """Sign changes from one time to another, both included, rising; ``bends``: times at which series bend."""
        count, found = _FIRST, np.zeros(0)
        beyond = _BEYOND * (t_end - t_start)
        if self.tape is not None:
            bends = np.union1d(bends, stretches(self.tape, self.parameters, t_start - beyond, t_end + beyond))
        while count <= _MOST:
            grid = np.linspace(t_start - beyond, t_end + beyond, count + 1)
            brackets = self.brackets(np.union1d(grid, bends) if bends.size else grid)
            if len(brackets) == len(found) and count > _FIRST:
                break
            found = np.array([self.root(low, high) for low, high in brackets])
            # a search that is dense enough finds no more
            if count >= 64 * (len(found) + 1):
                break
            count *= 2
        for end in (t_start, t_end):
            found[np.abs(found - end) <= _SAME * max(abs(t_start), abs(t_end))] = end
        return found[(found >= t_start) & (found <= t_end)]

    def brackets(self, grid: Floats) -> list[tuple[float, float]]:
        """Neighbouring times of a grid between which the function changes its sign."""
        signs = np.sign([self.value(t) for t in grid.tolist()])
        places = np.flatnonzero(signs)
        changes = np.flatnonzero(np.diff(signs[places]))
        return [(float(grid[places[i]]), float(grid[places[i + 1]])) for i in changes]

    def root(self, low: float, high: float) -> float:
        """Where it does so between two such times."""
        from scipy.optimize import brentq

        root = float(brentq(self.value, low, high, xtol=1e-15, rtol=1e-15))
        # to the last digit: integrators ask for values on either side of it, as near as two digits
        reach = 16.0 * math.ulp(root)
        low, high = max(low, root - reach), min(high, root + reach)
        below = self.value(low) > 0.0
        while True:
            middle = 0.5 * (low + high)
            if not low < middle < high:
                return high
            low, high = (middle, high) if (self.value(middle) > 0.0) == below else (low, middle)


def switches_of(timed: Sequence[tuple[Template, tuple[float, ...]]]) -> tuple[Floats, tuple[Switch, ...]]:
    """Known instants of the given expressions, rising, and the functions whose sign changes must be searched."""
    return places_of([(template.instants, parameters) for template, parameters in timed])


def places_of(
    stated: Sequence[tuple[Sequence[SwitchFormulas], tuple[float, ...]]],
) -> tuple[Floats, tuple[Switch, ...]]:
    """As :func:`switches_of`, of formulas with their parameters."""
    known: set[float] = set()
    searched = []
    for formulas, parameters in stated:
        for instant, function, tape in formulas:
            if instant is None:
                searched.append(Switch(function, parameters, tape))
                continue
            try:
                time = float(instant(parameters))
            except (ArithmeticError, ValueError):
                continue
            if np.isfinite(time):
                known.add(time)
    return np.array(sorted(known), dtype=float), tuple(searched)
