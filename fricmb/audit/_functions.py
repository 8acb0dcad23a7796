"""What parts state in SymPy as numpy functions: made once for each content and kept for the process."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from functools import cache
from typing import Any

import numpy as np

from fricmb.equations._values import structure
from fricmb.laws._numeric import _MODULES
from fricmb.values import is_expression, value_of

Function = Callable[..., Any]

_made: dict[Hashable, Any] = {}


def _kept(key: Hashable, make: Callable[[], Any]) -> Any:
    found = _made.get(key)
    if found is None:
        found = _made[key] = make()
    return found


def _compiled(arguments: Sequence[Any], outputs: Sequence[Any]) -> Function:
    """A numpy function of the arguments, one after the other, that returns a list."""
    import sympy

    return sympy.lambdify(list(arguments), list(outputs), _MODULES, cse=True)  # type: ignore[no-any-return]


def element_function(element: Any, n: int) -> Function:
    """Forces of an element on its n local coordinates: of x, their rates, t and the element's numbers."""

    def make() -> Function:
        from fricmb.equations._authors import element_math

        math = element_math(element, n)
        return _compiled([*math.x, *math.v, math.t, *math.parameters], math.total_force())

    return _kept(("element", structure(element), n), make)  # type: ignore[no-any-return]


def joint_function(joint: Any, n: int) -> tuple[Function, int, int]:
    """A joint's statements, of x, multipliers and the joint's numbers; the numbers of constraints and of slips.

    The function gives constraints, their gradient by rows, and with friction the factors of each slip and the load.
    """

    def make() -> tuple[Function, int, int]:
        import sympy

        from fricmb.equations._joint import joint_math

        math = joint_math(joint, n)
        outputs = [*math.phi, *(sympy.diff(phi, a) for phi in math.phi for a in math.x)]
        if math.slip is not None:
            outputs += [*(s for row in math.slip for s in row), math.load]
        return _compiled([*math.x, *math.lam, *math.parameters], outputs), len(math.phi), len(math.slip or ())

    return _kept(("joint", structure(joint.bare()), n, joint.friction is None), make)  # type: ignore[no-any-return]


def normal_function(law: Any) -> Function:
    """A normal-force law before the cut at 0, of elongation, its rate and the law's numbers."""

    def make() -> Function:
        from fricmb.equations._normal import normal_expression

        e, rate, N, parameters = normal_expression(law)
        return _compiled([e, rate, *parameters], [N])

    return _kept(("normal", structure(law)), make)  # type: ignore[no-any-return]


def place_function(body: Any) -> Function:
    """A point of a type of body, of the body's coordinates and the point's offset: position, gradient by rows."""

    def make() -> Function:
        import sympy

        q = sympy.symbols(f"q:{len(body.dof_names)}", real=True)
        offset = sympy.symbols("a b", real=True)
        position = body.define_point(q, offset)
        return _compiled([*q, *offset], [*position, *(sympy.diff(x, a) for x in position for a in q)])

    return _kept(("place", type(body)), make)  # type: ignore[no-any-return]


class Given:
    """A number or expression of a declaration: ``motions`` it reads, and its value at given times.

    ``derivative``: of time, instead of the value.
    """

    def __init__(self, value: Any, *, derivative: bool = False) -> None:
        self.number: float | None = None
        self.coordinates: list[str] = []
        self.speeds: list[str] = []
        self._parameters: list[float] = []
        if not is_expression(value):
            self.number = 0.0 if derivative else float(value_of(value))
            return
        from fricmb.values._symbols import TIME, CoordinateSymbol, ParameterSymbol, SpeedSymbol

        free = sorted(value.free_symbols, key=str)
        moved = [s for s in free if isinstance(s, CoordinateSymbol)]
        rates = [s for s in free if isinstance(s, SpeedSymbol)]
        held = [s for s in free if isinstance(s, ParameterSymbol)]
        self.coordinates, self.speeds = [s.motion for s in moved], [s.motion for s in rates]
        self._parameters = [float(s.value) for s in held]
        self._function = _expression(value, derivative, (TIME, *moved, *rates, *held))

    def at(self, moment: Any) -> Any:
        """Values (n_t,) in a state of the run, or one number."""
        if self.number is not None:
            return self.number
        motions = [moment.position(name) for name in self.coordinates] + [moment.velocity(name) for name in self.speeds]
        return self._function(moment.t, *motions, *self._parameters)[0]

    def over(self, t: Any) -> Any:
        """Values (n_t,) of an expression of time alone."""
        value = self.number if self.number is not None else self._function(t, *self._parameters)[0]
        return np.broadcast_to(np.asarray(value, dtype=float), np.shape(t))


@cache
def _expression(value: Any, derivative: bool, arguments: tuple[Any, ...]) -> Function:
    import sympy

    plain = sympy.sympify(value).rewrite(sympy.Heaviside, sympy.Piecewise)
    return _compiled(arguments, [sympy.diff(plain, arguments[0]) if derivative else plain])
