"""What parts state in SymPy as numpy functions with their derivatives: made once for each content in a process."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import Any

import numpy as np

from fricmb.equations._values import structure
from fricmb.laws._numeric import _MODULES, _lengths
from fricmb.sensitivity._dual import Dual, composed

#: Arguments and outputs in SymPy.
Stated = tuple[Sequence[Any], Sequence[Any]]

_stated: dict[Hashable, Stated] = {}
_compiled: dict[Hashable, tuple[Callable[..., Any], list[tuple[int, int]]]] = {}
_linear: dict[Hashable, bool] = {}
_switching: dict[Hashable, list[tuple[Callable[..., Any], tuple[int, ...]]]] = {}


class Function:
    """A function that a part states; called with values and slopes, it gives values and slopes.

    Parameters
    ----------
    key : hashable
        What selects the formulas.
    make : callable
        Arguments and outputs in SymPy.
    """

    def __init__(self, key: Hashable, make: Callable[[], Stated]) -> None:
        self._key, self._make = key, make

    def __call__(self, arguments: Sequence[Dual]) -> list[Dual]:
        """Outputs with slopes; those arguments count that have any."""
        active = tuple(j for j, argument in enumerate(arguments) if argument.slopes)
        function, places = self._function(active)
        with np.errstate(all="ignore"):
            values = function(*[argument.value for argument in arguments])
        count = len(values) - len(places)
        partials: list[list[tuple[Any, Dual]]] = [[] for _ in range(count)]
        for (i, j), slope in zip(places, values[count:], strict=True):
            partials[i].append((slope, arguments[j]))
        return [composed(value, own) for value, own in zip(values[:count], partials, strict=True)]

    def is_linear(self, time: int, zeros: tuple[int, ...]) -> bool:
        """Whether outputs are linear in the arguments before number ``time`` and do not depend on time.

        ``zeros``: numbers of arguments that are 0.
        """
        key = (self._key, time, zeros)
        if key not in _linear:
            arguments, outputs = self._statement()
            plain = [e.subs({arguments[j]: 0 for j in zeros}) for e in outputs]
            moved = set(arguments[: time + 1])
            slopes = [e.diff(a) for e in plain for a in arguments[:time]]
            timeless = not any(arguments[time] in e.free_symbols for e in plain)
            _linear[key] = timeless and not any(moved & e.free_symbols for e in slopes)
        return _linear[key]

    def _statement(self) -> Stated:
        if self._key not in _stated:
            arguments, outputs = self._make()
            import sympy

            _stated[self._key] = arguments, [sympy.sympify(e) for e in outputs]
        return _stated[self._key]

    def switching(self, time: int) -> list[tuple[Callable[..., Any], tuple[int, ...]]]:
        """What it switches on that varies with argument number ``time``: slopes by arguments, and which these are.

        A function of all arguments gives the value, then the slopes.
        """
        key = (self._key, time)
        if key not in _switching:
            _switching[key] = _conditions(*self._statement(), time)
        return _switching[key]

    def _function(self, active: tuple[int, ...]) -> tuple[Callable[..., Any], list[tuple[int, int]]]:
        key = (self._key, active)
        found = _compiled.get(key)
        if found is None:
            found = _compiled[key] = _with_slopes(*self._statement(), active)
        return found


def _with_slopes(
    arguments: Sequence[Any], outputs: Sequence[Any], active: Sequence[int]
) -> tuple[Callable[..., Any], list[tuple[int, int]]]:
    """Outputs, then their derivatives that do not vanish, and (output, argument) of these."""
    import sympy

    plain = [sympy.sympify(e).rewrite(sympy.Heaviside, sympy.Piecewise) for e in outputs]
    slopes, places = [], []
    for i, expression in enumerate(plain):
        for j in active:
            # a jump is a transition of its own, not a slope
            slope = sympy.diff(expression, arguments[j]).replace(sympy.DiracDelta, lambda *_: sympy.S.Zero)
            if slope != 0:
                slopes.append(slope)
                places.append((i, j))
    made = sympy.lambdify(list(arguments), [_lengths(e) for e in [*plain, *slopes]], _MODULES, cse=True)
    return made, places


def _conditions(
    arguments: Sequence[Any], outputs: Sequence[Any], time: int
) -> list[tuple[Callable[..., Any], tuple[int, ...]]]:
    """Functions at whose sign changes outputs jump: values and slopes, with the arguments that these belong to."""
    import sympy

    from fricmb.equations._expression import switching_functions

    stated = dict.fromkeys(c for output in outputs for c in switching_functions(output))
    found = []
    for condition in stated:
        if arguments[time] in condition.free_symbols:
            own = tuple(j for j, argument in enumerate(arguments) if argument in condition.free_symbols)
            values = [condition, *(sympy.diff(condition, arguments[j]) for j in own)]
            found.append((sympy.lambdify(list(arguments), values, _MODULES), own))
    return found


def element_function(element: Any, n: int) -> Function:
    """Forces of an element on its n local coordinates: of x, their rates, t and the element's numbers."""

    def make() -> Stated:
        from fricmb.equations._authors import element_math

        math = element_math(element, n)
        return [*math.x, *math.v, math.t, *math.parameters], math.total_force()

    return Function(("element", structure(element), n), make)


def normal_function(law: Any) -> Function:
    """A normal-force law before the cut at 0, of elongation, its rate and the law's numbers."""

    def make() -> Stated:
        from fricmb.equations._normal import normal_expression

        e, rate, N, parameters = normal_expression(law)
        return [e, rate, *parameters], [N]

    return Function(("normal", structure(law)), make)


def coefficient_function(law: Any) -> Function:
    """A friction coefficient, of slip speed, normal force and the law's numbers."""

    def make() -> Stated:
        from fricmb.laws._numeric import coefficient_expression
        from fricmb.values import symbolic

        stand = symbolic(law)
        r, N, mu = coefficient_expression(law, stand)
        return [r, N, *stand.flat], [mu]

    return Function(("coefficient", structure(law)), make)


def smooth_function(law: Any, d: int) -> Function:
    """Force, then rate of the states, of a law that is a force: of v, N, z and the law's numbers."""

    def make() -> Stated:
        from fricmb.laws._numeric import force_expression
        from fricmb.values import symbolic

        stand = symbolic(law)
        v, N, z, force, rate = force_expression(law, stand, d)
        return [*v, N, *z, *stand.flat], [*force, *rate]

    return Function(("smooth", structure(law), d), make)


def expression_function(value: Any, arguments: tuple[Any, ...], order: int) -> Function:
    """An expression of a declaration, or its derivative of some order by the first argument (time)."""

    def make() -> Stated:
        import sympy

        plain = sympy.sympify(value).rewrite(sympy.Heaviside, sympy.Piecewise)
        for _ in range(order):
            plain = sympy.diff(plain, arguments[0]).replace(sympy.DiracDelta, lambda *_: sympy.S.Zero)
        return list(arguments), [plain]

    return Function(("expression", value, arguments, order), make)
