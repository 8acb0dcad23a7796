"""What parts state in SymPy as numpy functions with their derivatives: made once for each content in a process."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar
from functools import lru_cache
from typing import Any

import numpy as np

from fricmb.laws._numeric import _lengths, squares
from fricmb.sensitivity._dual import Dual, composed
from fricmb.stated import MODULES, Statement

#: Arguments and outputs in SymPy.
Stated = tuple[Sequence[Any], Sequence[Any]]

_stated: dict[Hashable, Stated] = {}
_compiled: dict[Hashable, tuple[Callable[..., Any], list[tuple[int, int]]]] = {}
_linear: dict[Hashable, bool] = {}
_switches: dict[Hashable, list[Any]] = {}
_roots: dict[Hashable, bool] = {}
_switching: dict[Hashable, list[tuple[Callable[..., Any], tuple[int, ...]]]] = {}
#: Where conditions are gathered, while somebody asks for them.
_seen: ContextVar[list[Dual] | None] = ContextVar("_seen", default=None)


@contextmanager
def conditions_seen() -> Iterator[list[Dual]]:
    """A list of all that functions called inside switch on, in the order of the calls."""
    found: list[Dual] = []
    with _gathered(found):
        yield found


def unseen() -> AbstractContextManager[None]:
    """Within ``conditions_seen``: functions are called at other times than the rest, and do not count."""
    return _gathered(None)


@contextmanager
def _gathered(found: list[Dual] | None) -> Iterator[None]:
    token = _seen.set(found)
    try:
        yield
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
        if seen is not None and self.switches():
            seen += self._composed("switches", (self._statement()[0], self.switches()), arguments)
        return self._composed("outputs", None, arguments)

    def switches(self) -> list[Any]:
        """What it switches on, expressions of the arguments: it has jumps or kinks where these change sign."""
        if self._key not in _switches:
            arguments, outputs = self._statement()
            stated = dict.fromkeys(c for output in outputs for c in _switching_functions(output))
            _switches[self._key] = [_bounded(c) for c in stated if c.free_symbols & set(arguments)]
        return _switches[self._key]

    def roots(self) -> bool:
        """Whether it raises an argument to a power that is no whole number: it has branch points."""
        if self._key not in _roots:
            import sympy

            arguments, outputs = self._statement()
            powers = [power for output in outputs for power in sympy.sympify(output).atoms(sympy.Pow)]
            given = set(arguments)
            _roots[self._key] = any(not p.exp.is_integer and bool(p.base.free_symbols & given) for p in powers)
        return _roots[self._key]

    def _composed(self, kind: str, stated: Stated | None, arguments: Sequence[Dual]) -> list[Dual]:
        """Expressions of the arguments with slopes; ``stated``: other ones than the outputs."""
        active = tuple(j for j, argument in enumerate(arguments) if argument.slopes)
        key = (self._key, kind, active)
        if key not in _compiled:
            _compiled[key] = _with_slopes(*(stated or self._statement()), active)
        function, places = _compiled[key]
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
    parts, reduced = sympy.cse(plain, symbols=sympy.numbered_symbols(prefix, real=True), order="none")
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
        # what SymPy's printer would simplify first, for seconds
        slope = slope.rewrite(sympy.Heaviside, sympy.Piecewise)
        slope = slope.replace(sympy.ITE, lambda a, b, c: sympy.Or(sympy.And(a, b), sympy.And(sympy.Not(a), c)))
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
    """Functions at whose sign changes it has a jump or a kink: the length of one component is an absolute value."""
    import sympy

    from fricmb.equations._expression import switching_functions

    lengths = (squares(node.base) or [] for node in sympy.sympify(output).atoms(sympy.Pow))
    return [*switching_functions(output), *(parts[0] for parts in lengths if len(parts) == 1)]


def _bounded(condition: Any) -> Any:
    """A sum over the sizes of its terms: of the same sign, at most 1, and round-off where it is 0 by cancellation."""
    import sympy

    return condition / sympy.Add(*map(sympy.Abs, condition.args)) if condition.is_Add else condition


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
