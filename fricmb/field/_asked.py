"""Expressions of ``simulate(events=...)``: their values along a run, and the times at which they change their sign."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmb import stated
from fricmb.field._functions import Given
from fricmb.field._sign_changes import Function, sign_changes
from fricmb.integrate.problem import Floats
from fricmb.solution import ASKED, Event

if TYPE_CHECKING:
    from fricmb.solution import Solution

#: What counts as 0, as a part of ``rtol`` times the greatest value of a run: a touch that errors alone make.
_TOUCH = 1e-2
#: In place of ``rtol`` for runs of fixed steps.
_FIXED = 1e-3


@dataclass(frozen=True, eq=False)
class AskedEvent:
    """An expression by its name, or a signal of a solution less a number."""

    name: str
    value: Any

    @property
    def motions(self) -> tuple[str, ...]:
        """Names of what it reads."""
        if isinstance(self.value, tuple):
            return (self.value[0],)
        read = Given(self.value)
        return (*read.coordinates, *read.speeds)

    def along(self, sol: Solution) -> Function:
        """Its values (n,) at times of a run (n,)."""
        if isinstance(self.value, tuple):
            signal, level = self.value
            return lambda t: sol.at(t).scalar(signal, self.name) - level
        read = Given(self.value)
        return lambda t: np.broadcast_to(np.asarray(read.at(Seen(sol.at(t))), dtype=float), t.shape)

    def events(self, sol: Solution) -> list[Event]:
        """Where it changes its sign along a run."""
        return [Event(one, self.name, ASKED) for t, _ in self.changes(sol) for one in t.tolist()]

    def first(self, sol: Solution) -> Event | None:
        """Where it first does; no more of the run is looked at."""
        found = next(self.changes(sol), None)
        return None if found is None else Event(float(found[0][0]), self.name, ASKED)

    def greatest(self, sol: Solution) -> float:
        """Its greatest magnitude at the ends of steps."""
        return float(np.abs(self.along(sol)(self._steps(sol))).max())

    def slopes(self) -> tuple[dict[str, Any], dict[str, Any], dict[str, Any], Any]:
        """Derivatives by coordinates, by speeds and by parameters, each by name, and by time, as expressions."""
        if isinstance(self.value, tuple):
            motion = self.value[0].removesuffix(".velocity")
            held: tuple[dict[str, Any], dict[str, Any]] = ({motion: 1.0}, {})
            return (*(held if motion == self.value[0] else held[::-1]), {}, 0.0)
        from fricmb.values._symbols import TIME

        read = stated.reads(self.value)
        symbols = {str(symbol.name): symbol for symbol in self.value.free_symbols}
        by = [
            {name: self.value.diff(symbols[f"{name}{mark}"]) for name in names}
            for names, mark in ((read.coordinates, ""), (read.speeds, "'"))
        ]
        return *by, {s.name: self.value.diff(s) for s in read.parameters}, self.value.diff(TIME)

    def _steps(self, sol: Solution) -> Floats:
        return np.unique(np.concatenate([[sol.t_start], sol.run.row_motion().samples.t, [sol.t_end]]))

    def changes(self, sol: Solution, begin: float = -np.inf) -> Iterator[tuple[Floats, Floats]]:
        """Times of its changes of sign from ``begin`` on, and the sign from each on, some at a time in rising order."""
        value = self.along(sol)
        band = _TOUCH * (sol.stats.rtol or _FIXED) * self.greatest(sol)
        width = 2 * len(sol.names.dofs) + 3 * len(sol.names.contacts) + 1
        steps = self._steps(sol)
        return sign_changes(value, np.append(max(begin, steps[0]), steps[steps > begin]), band, width=width)


class Seen:
    """A solution as an expression reads it."""

    def __init__(self, sol: Solution) -> None:
        self.t = sol.t
        self._sol = sol

    def position(self, name: str) -> Floats:
        """A motion (n_t,)."""
        return self._sol._motion(name, 0)

    def velocity(self, name: str) -> Floats:
        """Its rate (n_t,)."""
        return self._sol._motion(name, 1)
