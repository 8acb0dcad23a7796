"""The forces of an element from what its author states, in many digits, by differences: no derivation, no code."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.equations import numbers
from fricmb.scene import Element, Force, expression_uses
from fricmb.testing._base import Floats
from fricmb.values import is_expression, value_of

#: Digits, and steps of first and second differences: 30 digits are left of a Jacobian.
_DIGITS, _STEP, _SECOND = 80, "1e-20", "1e-12"


@dataclass(frozen=True)
class State:
    """Local coordinates, their rates, and time."""

    x: Floats
    v: Floats
    t: float

    def __str__(self) -> str:
        return f"x = {self.x.tolist()}, x' = {self.v.tolist()}, t = {self.t:g}"


@dataclass(frozen=True)
class Stated:
    """Functions of ``[*x, *v, t]`` in mpmath's numbers; ``outer`` one for each coordinate.

    ``conservative``: there is a potential alone.
    """

    n: int
    potential: Callable[..., Any]
    dissipation: Callable[..., Any]
    outer: Callable[..., Any]
    conservative: bool

    def energies(self, state: State) -> tuple[float, float, float]:
        """Potential, power that the dissipation takes, power of the outer force."""
        import mpmath

        with mpmath.workdps(_DIGITS):
            y = _many(state)
            loss = sum(y[self.n + i] * _slope(self.dissipation, y, self.n + i, _STEP) for i in range(self.n))
            power = sum(f * v for f, v in zip(self.outer(*y), y[self.n : -1], strict=True))
            return _real(self.potential(*y)), _real(loss), _real(power)

    def force(self, state: State) -> Floats:
        """Whole force on the coordinates, (n,)."""
        import mpmath

        with mpmath.workdps(_DIGITS):
            y = _many(state)
            return np.array([_real(self._entry(i)(*y)) for i in range(self.n)])

    def jacobian(self, state: State) -> Floats:
        """Derivatives of the force by [x, v, t], (n, 2 n + 1)."""
        import mpmath

        with mpmath.workdps(_DIGITS):
            y = _many(state)
            rows = [[_real(_slope(self._entry(i), y, j, _SECOND)) for j in range(len(y))] for i in range(self.n)]
            return np.array(rows)

    def _entry(self, i: int) -> Callable[..., Any]:
        def entry(*y: Any) -> Any:
            stored = _slope(self.potential, y, i, _STEP)
            return self.outer(*y)[i] - stored - _slope(self.dissipation, y, self.n + i, _STEP)

        return entry


def _many(state: State) -> list[Any]:
    import mpmath

    return [mpmath.mpf(float(number)) for number in (*state.x, *state.v, state.t)]


def _slope(function: Callable[..., Any], y: Sequence[Any], place: int, step: str) -> Any:
    import mpmath

    h = mpmath.mpf(step)
    up, down = list(y), list(y)
    up[place] += h
    down[place] -= h
    return (function(*up) - function(*down)) / (2 * h)


def _real(value: Any) -> float:
    import mpmath

    return float("nan") if isinstance(value, mpmath.mpc) and value.imag != 0 else float(mpmath.re(value))


def stated(element: Element) -> Stated:
    """What an element states, its methods asked anew."""
    import sympy

    if isinstance(element, Force):
        return _stated_value(element)
    from fricmb.equations._authors import element_math

    math = element_math(element, len(element.local_coordinates()))
    values = {symbol: _exact(number) for symbol, number in zip(math.parameters, numbers(element), strict=True)}
    arguments = [*math.x, *math.v, math.t]

    def compiled(expression: Any) -> Callable[..., Any]:
        return sympy.lambdify(arguments, _put(expression, values), "mpmath")  # type: ignore[no-any-return]

    return Stated(
        len(math.x),
        compiled(math.potential),
        compiled(math.dissipation),
        compiled(tuple(math.force)),
        math.dissipation == 0 and not any(math.force),
    )


def _stated_value(element: Force) -> Stated:
    """Of a force whose value is a number or an expression in the user's symbols."""
    import sympy

    from fricmb.scene import coordinate, speed, t
    from fricmb.values._symbols import ParameterSymbol

    motions = expression_uses(element.value).motions
    value = element.value if is_expression(element.value) else _exact(value_of(element.value))
    known = {s: _exact(s.value) for s in sympy.sympify(value).free_symbols if isinstance(s, ParameterSymbol)}
    own = sympy.symbols("own_x own_v", real=True)
    arguments = [own[0], *map(coordinate, motions), own[1], *map(speed, motions), t]
    zero = sympy.lambdify(arguments, sympy.S.Zero, "mpmath")
    outer = (_put(value, known), *(sympy.S.Zero for _ in motions))
    return Stated(1 + len(motions), zero, zero, sympy.lambdify(arguments, outer, "mpmath"), False)


def _exact(number: Any) -> Any:
    """A float as the fraction that it is."""
    import sympy

    return sympy.Rational(*float(number).as_integer_ratio())


def _put(expression: Any, values: dict[Any, Any]) -> Any:
    import sympy

    if isinstance(expression, tuple):
        return tuple(sympy.sympify(entry).xreplace(values) for entry in expression)
    return sympy.sympify(expression).xreplace(values)
