"""What parts state in SymPy as numpy functions with their derivatives: made once for each content in a process."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache
from typing import Any

import numpy as np

from fricmb.laws._numeric import _lengths
from fricmb.sensitivity._dual import Dual, composed
from fricmb.stated import MODULES, Statement

#: Arguments and outputs in SymPy.
Stated = tuple[Sequence[Any], Sequence[Any]]

_stated: dict[Hashable, Stated] = {}
_compiled: dict[Hashable, tuple[Callable[..., Any], list[tuple[int, int]]]] = {}
_linear: dict[Hashable, bool] = {}
_switches: dict[Hashable, list[Callable[..., Any]]] = {}
_switching: dict[Hashable, list[tuple[Callable[..., Any], tuple[int, ...]]]] = {}
#: Where values of conditions are gathered, while somebody asks for them.
_seen: ContextVar[list[Any] | None] = ContextVar("_seen", default=None)


@contextmanager
def conditions_seen() -> Iterator[list[Any]]:
    """A list of the values of all that functions called inside switch on, in the order of the calls."""
    found: list[Any] = []
    token = _seen.set(found)
    try:
        yield found
    finally:
        _seen.reset(token)


class Function:
    """A function that a part states; called with values and slopes, it gives values and slopes.

    Parameters
    ----------
    statement : Statement
    """

    def __init__(self, statement: Statement) -> None:
        self._key, self._make = statement.key, statement.make

    def __call__(self, arguments: Sequence[Dual]) -> list[Dual]:
        """Outputs with slopes; those arguments count that have any."""
        seen = _seen.get()
        if seen is not None:
            self._tell(seen, [argument.value for argument in arguments])
        active = tuple(j for j, argument in enumerate(arguments) if argument.slopes)
        function, places = self._function(active)
        with np.errstate(all="ignore"):
            values = function(*[argument.value for argument in arguments])
        count = len(values) - len(places)
        partials: list[list[tuple[Any, Dual]]] = [[] for _ in range(count)]
        for (i, j), slope in zip(places, values[count:], strict=True):
            partials[i].append((slope, arguments[j]))
        return [composed(value, own) for value, own in zip(values[:count], partials, strict=True)]

    def switches(self) -> list[Any]:
        """What it switches on, functions of all arguments: it has jumps or kinks where these change sign."""
        if self._key not in _switches:
            arguments, outputs = self._statement()
            stated = dict.fromkeys(c for output in outputs for c in _switching_functions(output))
            moved = [c for c in stated if c.free_symbols & set(arguments)]
            import sympy

            _switches[self._key] = [sympy.lambdify(list(arguments), moved, MODULES)] if moved else []
        return _switches[self._key]

    def _tell(self, seen: list[Any], values: Sequence[Any]) -> None:
        with np.errstate(all="ignore"):
            for function in self.switches():
                seen += function(*values)

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
    """Outputs, then their derivatives that do not vanish, and (output, argument) of these.

    By the chain rule over common subexpressions: SymPy's derivative of the whole grows much faster than the expression.
    """
    import sympy

    plain = [_lengths(sympy.sympify(e).rewrite(sympy.Heaviside, sympy.Piecewise), _length()) for e in outputs]
    prefix = "part"
    while any(str(argument).startswith(prefix) for argument in arguments):  # parameters are named by their authors
        prefix += "_"
    parts, reduced = sympy.cse(plain, symbols=sympy.numbered_symbols(prefix), order="none")
    statements: list[tuple[Any, Any]] = []
    slopes: dict[Any, dict[int, Any]] = {arguments[j]: {j: sympy.S.One} for j in active}
    for symbol, expression in parts:
        statements.append((symbol, expression))
        if expression.is_Relational or expression.is_Boolean:  # a condition that occurs twice
            continue
        slopes[symbol] = {}
        for j, slope in _chained(expression, slopes).items():
            name = sympy.Symbol(f"{symbol}_{j}", real=True)
            statements.append((name, slope))
            slopes[symbol][j] = name
    places, results = [], list(reduced)
    for i, expression in enumerate(reduced):
        for j, slope in sorted(_chained(expression, slopes).items()):
            places.append((i, j))
            results.append(slope)
    made = sympy.lambdify(list(arguments), results, MODULES, cse=lambda given: (statements, given))
    return made, places


def _chained(expression: Any, slopes: dict[Any, dict[int, Any]]) -> dict[int, Any]:
    """Derivatives of a short expression by the arguments, from those of symbols in it; vanishing ones left out."""
    import sympy

    terms: dict[int, list[Any]] = {}
    for symbol in sorted(expression.free_symbols & slopes.keys(), key=str):
        # a jump is a transition of its own, not a slope
        slope = sympy.diff(expression, symbol).replace(sympy.DiracDelta, lambda *_: sympy.S.Zero)
        if slope != 0:
            for j, inner in slopes[symbol].items():
                terms.setdefault(j, []).append(slope * inner)
    return {j: total for j, own in terms.items() if (total := sympy.Add(*own)) != 0}


@lru_cache(maxsize=1)
def _length() -> Any:
    """The length of a vector as a function of SymPy: its slope is the unit vector."""
    import sympy

    class vector_length(sympy.Function):  # type: ignore[misc]  # the name that numpy code calls it by
        is_positive = True

        def fdiff(self, argindex: int = 1) -> Any:
            return self.args[argindex - 1] / self

    return vector_length


def _switching_functions(output: Any) -> list[Any]:
    from fricmb.equations._expression import switching_functions

    return switching_functions(output)


def _conditions(
    arguments: Sequence[Any], outputs: Sequence[Any], time: int
) -> list[tuple[Callable[..., Any], tuple[int, ...]]]:
    """Functions at whose sign changes outputs jump: values and slopes, with the arguments that these belong to."""
    import sympy

    stated = dict.fromkeys(c for output in outputs for c in _switching_functions(output))
    found = []
    for condition in stated:
        if arguments[time] in condition.free_symbols:
            own = tuple(j for j, argument in enumerate(arguments) if argument in condition.free_symbols)
            values = [condition, *(sympy.diff(condition, arguments[j]) for j in own)]
            found.append((sympy.lambdify(list(arguments), values, MODULES), own))
    return found
