"""Whether a scene is driven in time, and with which period."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmb.analysis._errors import AnalysisError

if TYPE_CHECKING:
    from fricmb.scene import Scene
    from fricmb.system import System

#: Ratios of periods count as fractions up to this denominator, and only if they are that to round-off.
_LARGEST = 64


@dataclass(frozen=True, kw_only=True)
class DrivePeriod:
    """The period of what drives a scene: an expression in named parameters, times a whole number of laps."""

    expression: Any
    laps: int = 1

    def value(self, values: Mapping[str, Any]) -> float:
        """The period for the values of a scene's parameters."""
        return self.laps * float(self.expression.subs(self._known(values)))

    def slope(self, name: str, values: Mapping[str, Any]) -> float:
        """Derivative of the period by a parameter."""
        import sympy

        if all(symbol.name != name for symbol in self.expression.free_symbols):
            return 0.0
        (symbol,) = (s for s in self.expression.free_symbols if s.name == name)
        return self.laps * float(sympy.diff(self.expression, symbol).subs(self._known(values)))

    def _known(self, values: Mapping[str, Any]) -> dict[Any, float]:
        return {symbol: values[symbol.name] for symbol in self.expression.free_symbols}


def is_driven(scene: Scene) -> bool:
    """Whether anything in a scene depends on time by itself (a body that is driven at a constant speed does not)."""
    return next(_time_expressions(scene), None) is not None


def drive_period(scene: Scene, laps: int, who: str) -> DrivePeriod:
    """Period of all that drives a scene.

    Raises
    ------
    AnalysisError
        For a drive without a period, or several whose periods have no common multiple.
    """
    total: Any = None
    for where, expression in _time_expressions(scene):
        period = _period_of(expression)
        if period is None:
            raise AnalysisError(f"{who}: {where} = {expression} has no period that is known; give period=")
        total = period if total is None else _common(who, total, period, scene.parameters)
    return DrivePeriod(expression=total, laps=laps)


def given_period(period: float, laps: int) -> DrivePeriod:
    """A period that is a number."""
    import sympy

    return DrivePeriod(expression=sympy.Float(period), laps=laps)


def places_are_integrals(system: System, scene: Scene) -> bool:
    """Whether forces depend on where a body is whose velocity is given over time.

    A run that starts at another time starts with such a body where it was declared to be, so that a cycle can only be
    cut at whole periods.
    """
    from fricmb.scene._expressions import expression_uses

    if not any(expression_uses(value).time for body in scene.driven for value in dict(body.velocity).values()):
        return False
    problem = system.problem
    first = 1 + 2 * problem.n
    used = np.concatenate([problem.elements.table.form_index, problem.contacts.normal_table.form_index])
    return bool(problem.linear.Kx[:, problem.n :].any() or ((used >= first) & (used < first + problem.n_u)).any())


def _time_expressions(scene: Scene) -> Iterator[tuple[str, Any]]:
    from fricmb.scene._expressions import expression_uses

    for part in scene.parts:
        for path, value in part.slots().items():
            for entry in value if isinstance(value, tuple) else (value,):
                if expression_uses(entry).time:
                    yield f"{part.name}.{path}", entry


def _period_of(expression: Any) -> Any:
    """Least period of an expression in plain symbols, or None."""
    import sympy

    from fricmb.values._symbols import TIME

    t = sympy.Symbol("t", real=True)
    plain = {s: sympy.Symbol(s.name, positive=True) for s in expression.free_symbols - {TIME}}
    exact = sympy.nsimplify(expression.subs({**plain, TIME: t}), rational=True)
    found = sympy.periodicity(exact, t)
    return None if found is None or found.has(t) else found


def _common(who: str, first: Any, second: Any, values: Mapping[str, Any]) -> Any:
    import sympy

    ratio = sympy.simplify(first / second)
    value = float(ratio.subs({s: values[s.name] for s in ratio.free_symbols}))
    near = Fraction(value).limit_denominator(_LARGEST)
    if abs(float(near) - value) > 1e-12 * value:
        raise AnalysisError(f"{who}: drives with the periods {first} and {second} have no common one; give period=")
    return first * near.denominator
