"""What of an expression depends on time alone, as tapes: lists of operations that bounds can be asked of.

See :mod:`fricmb.integrate.signals.jets`.  A part with an operation that has no bounds is given as Python source, and is
sampled.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy

from fricmb.equations._element import parameter_source
from fricmb.integrate.signals.jets import OPERATIONS
from fricmb.signal._symbols import Series

#: Functions of SymPy under names of their own; others stand under their lower-case name, or have no bounds.
_NAMES = {sympy.Max: "max", sympy.Min: "min", sympy.Abs: "abs", sympy.sign: "sign", sympy.Heaviside: "heaviside"}


class _Unbounded(Exception):
    """An operation that tapes do not have."""


def time_inputs(value: Any, t: Any, parameters: Sequence[Any], rates: int = 0) -> list[dict[str, Any]]:
    """The largest parts of an expression that depend on time and parameters alone, linear ones left out.

    ``rates``: how many of their derivatives act as well.
    """
    found = []
    for part in dict.fromkeys(_timed(sympy.sympify(value), t, frozenset(parameters))):
        if sympy.diff(part, t, 2) == 0 and not part.has(sympy.Piecewise, sympy.Abs, sympy.Max, sympy.Min):
            continue
        try:
            tape = _Tape(t, parameters)
            tape.of(_explicit(part))
            found.append({"tape": tape.entries, "rates": rates})
        except _Unbounded:
            found.append({"source": parameter_source(part, parameters, (t,)), "rates": rates})
    return found


def series_in(value: Any, t: Any, parameters: Sequence[Any], rates: int = 0) -> list[dict[str, Any]]:
    """Series in an expression: slope and shift of what they are taken at, the parameter of the table, what acts."""
    place = {symbol: i for i, symbol in enumerate(parameters)}
    found = []
    for node in sorted(value.atoms(Series), key=sympy.default_sort_key):
        x, table, order = node.args
        at = [sympy.diff(x, t), x.xreplace({t: sympy.S.Zero})]
        texts = [parameter_source(part, parameters) for part in at]
        found.append({"at": texts, "table": place[table], "order": int(order) + rates})
    return found


def whole_tape(value: Any, t: Any, parameters: Sequence[Any]) -> list[list[Any]] | None:
    """The tape of an expression of time; None where it has an operation without bounds."""
    tape = _Tape(t, parameters)
    try:
        tape.of(_explicit(value))
    except _Unbounded:
        return None
    return tape.entries


def _explicit(part: Any) -> Any:
    """With functions that tapes do not have written by those that they have."""
    part = part.replace(sympy.tan, lambda u: sympy.sin(u) / sympy.cos(u))
    return part.rewrite([sympy.sinh, sympy.cosh, sympy.coth, sympy.sech, sympy.csch], sympy.exp)


def _timed(expression: Any, t: Any, parameters: frozenset[Any]) -> list[Any]:
    free = expression.free_symbols
    if t not in free:
        return []
    if free <= parameters | {t} and isinstance(expression, sympy.Expr):
        return [expression]
    if isinstance(expression, sympy.Add | sympy.Mul):
        # what depends on time alone acts together: sin(t) and t^2 in x sin(t) t^2 are one input
        own = [arg for arg in expression.args if t in arg.free_symbols and arg.free_symbols <= parameters | {t}]
        rest = [arg for arg in expression.args if arg not in own]
        together = [expression.func(*own)] if own else []
        return [*together, *(part for arg in rest for part in _timed(arg, t, parameters))]
    return [part for arg in expression.args for part in _timed(arg, t, parameters)]


class _Tape:
    """Entries so far; each expression once."""

    def __init__(self, t: Any, parameters: Sequence[Any]) -> None:
        self.entries: list[list[Any]] = []
        self._place: dict[Any, int] = {}
        self._t = t
        self._number = {symbol: i for i, symbol in enumerate(parameters)}

    def of(self, e: Any) -> int:
        """Number of the entry of an expression."""
        if e not in self._place:
            entry = self._entry(e) if isinstance(e, sympy.Expr) else self._condition(e)
            self._place[e] = self._add(*entry)
        return self._place[e]

    def _add(self, *entry: Any) -> int:
        if entry[0] not in OPERATIONS:
            raise _Unbounded(entry[0])
        self.entries.append(list(entry))
        return len(self.entries) - 1

    def _entry(self, e: Any) -> tuple[Any, ...]:
        if e == self._t:
            return ("t",)
        if e in self._number:
            return ("p", self._number[e])
        if not e.free_symbols and e.is_number:
            number = complex(e)
            if number.imag != 0.0:
                raise _Unbounded("complex number")
            return ("c", number.real)
        if e.is_Add or e.is_Mul:
            return ("add" if e.is_Add else "mul", *(self.of(arg) for arg in e.args))
        if e.is_Pow:
            return self._power(e)
        if isinstance(e, sympy.exp):
            return ("exp", self.of(e.args[0]))
        if isinstance(e, sympy.Piecewise):
            return ("pieces", *(self.of(part) for value, condition in e.args for part in (condition, value)))
        if isinstance(e, Series):
            return ("series", self.of(e.args[0]), self._number[e.args[1]], int(e.args[2]))
        name = _NAMES.get(e.func, e.func.__name__.lower())
        arguments = e.args[:1] if isinstance(e, sympy.Heaviside) else e.args
        return (name, *(self.of(arg) for arg in arguments))

    def _power(self, e: Any) -> tuple[Any, ...]:
        if e.base == sympy.E:
            return ("exp", self.of(e.exp))
        if not e.exp.free_symbols:
            return ("pow", self.of(e.base), float(e.exp))
        logarithm = self._add("log", self.of(e.base))
        return ("exp", self._add("mul", self.of(e.exp), logarithm))

    def _condition(self, e: Any) -> tuple[Any, ...]:
        if e == sympy.true:
            return ("true",)
        if e == sympy.false:
            return ("not", self._add("true"))
        if isinstance(e, sympy.And | sympy.Or | sympy.Not):
            return (type(e).__name__.lower(), *(self.of(arg) for arg in e.args))
        if isinstance(e, sympy.StrictLessThan | sympy.LessThan):
            return ("less", self.of(e.lhs), self.of(e.rhs))
        if isinstance(e, sympy.StrictGreaterThan | sympy.GreaterThan):
            return ("less", self.of(e.rhs), self.of(e.lhs))
        raise _Unbounded(type(e).__name__)
