"""Breakpoints of functions of time: when they are, and when parameters move them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.errors import SceneError
from fricmb.integrate.problem import Floats
from fricmb.scene import Scene
from fricmb.sensitivity._dual import Dual
from fricmb.sensitivity._functions import Function
from fricmb.sensitivity._motions import Given
from fricmb.sensitivity._parts import Acts
from fricmb.sensitivity._phases import SAME
from fricmb.sensitivity._seeds import Seeds
from fricmb.values import is_expression


@dataclass(frozen=True, kw_only=True)
class Timed:
    """A function of time of a part; argument number ``time`` is time; of ``arguments`` motions are None."""

    label: str
    function: Function
    arguments: Sequence[Dual | None]
    time: int

    def breakpoint_derivatives(self, t: float, columns: range) -> list[Floats]:
        """Derivatives (n_p,) of the time t by parameters, one for each condition that changes sign there."""
        values = [0.0 if argument is None else float(argument.value) for argument in self.arguments]
        values[self.time] = t
        found = [self._one(condition, values, columns) for condition in self.function.switching(self.time)]
        return [dt for dt in found if dt is not None]

    def _one(
        self, condition: tuple[Callable[..., Any], tuple[int, ...]], values: Sequence[float], columns: range
    ) -> Floats | None:
        function, own = condition
        if any(self.arguments[j] is None for j in own if j != self.time):
            return None
        with np.errstate(all="ignore"):
            c, *slopes = (float(x) for x in function(*values))
        by = dict(zip(own, slopes, strict=True))
        rate = by.pop(self.time)
        if rate == 0.0 or not abs(c) <= SAME * max(1.0, abs(values[self.time])) * abs(rate):
            return None
        found = np.zeros(len(columns))
        for j, slope in by.items():
            for column, share in (self.arguments[j] or Dual(value=0.0)).slopes.items():
                found[columns.index(column)] -= slope * share / rate
        return found


def timed_of(scene: Scene, acting: Sequence[Any], seeds: Seeds) -> list[Timed]:
    """Functions of time in the declarations of a scene, and in what its elements state."""
    found = []
    for part in scene.parts:
        for path, value in part.slots().items():
            if is_expression(value):
                given = Given(value, f"{part.name}.{path}", seeds)
                found.append(Timed(label=part._label(), function=given.function, arguments=given.arguments, time=0))
    for one in acting:
        if isinstance(one, Acts):
            arguments = [*[None] * (2 * len(one.forms)), Dual(value=0.0), *one.numbers]
            found.append(Timed(label=one.label, function=one.function, arguments=arguments, time=2 * len(one.forms)))
    return found


class Breakpoints:
    """Breakpoints of a run.

    Parameters
    ----------
    t : (n_b,)
        Their times.
    timed : list of Timed
    parameters : tuple of str
        What derivatives are with respect to.
    first : int
        Column of the first parameter.
    """

    def __init__(self, t: Floats, timed: Sequence[Timed], parameters: Sequence[str], first: int) -> None:
        self.t = np.unique(t)
        self.parameters = parameters
        columns = range(first, first + len(parameters))
        self.dt = np.zeros((self.t.size, len(parameters)))
        for i, time in enumerate(self.t.tolist()):
            self.dt[i] = self._breakpoint_derivatives(time, timed, columns)

    def _breakpoint_derivatives(self, t: float, timed: Sequence[Timed], columns: range) -> Floats:
        """Derivatives of one breakpoint; refused where several that parameters move apart stand at one time."""
        found = [(one.label, dt) for one in timed for dt in one.breakpoint_derivatives(t, columns)]
        for label, dt in found[1:]:
            apart = np.flatnonzero(~np.isclose(dt, found[0][1], rtol=1e-9, atol=1e-12))
            if apart.size:
                raise SceneError(
                    f"sensitivities: functions of time of {found[0][0]} and {label} have breakpoints at the same time"
                    f" t = {t:.10g}, which {self.parameters[apart[0]]!r} moves apart; there is no one derivative"
                )
        return found[0][1] if found else np.zeros(len(columns))

    def at(self, t: float) -> Floats | None:
        """Derivatives (n_p,) of the breakpoint at a time; None where there is none."""
        near = np.flatnonzero(np.abs(self.t - t) <= SAME * max(1.0, abs(t)))
        found: Floats | None = self.dt[near[0]] if near.size else None
        return found

    def moving(self) -> Floats:
        """Times of those that a parameter moves."""
        found: Floats = self.t[np.any(self.dt != 0.0, axis=1)]
        return found
