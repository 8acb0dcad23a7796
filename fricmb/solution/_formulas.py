"""SymPy expressions as plain data, and back: a list of names that are known, nothing that is evaluated.

A node is ``[name, argument, ...]``.  Reading makes the node as it was written (``evaluate=False``): nothing is
simplified, no power is worked out, so that no file can keep a reader busy.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from fricmb.errors import FricmbError

#: Nodes that are made of others.
_OPERATIONS = (
    "Add", "Mul", "Pow", "Mod", "Abs", "sign", "floor", "ceiling", "frac", "Min", "Max", "exp", "log", "LambertW",
    "sin", "cos", "tan", "cot", "sec", "csc", "sinc", "asin", "acos", "atan", "acot", "asec", "acsc", "atan2",
    "sinh", "cosh", "tanh", "coth", "sech", "csch", "asinh", "acosh", "atanh", "acoth", "asech", "acsch",
    "Heaviside", "DiracDelta", "erf", "erfc", "erfi", "gamma", "loggamma", "besselj", "bessely", "besseli",
    "besselk", "Piecewise", "ExprCondPair", "Equality", "Unequality", "StrictLessThan", "LessThan",
    "StrictGreaterThan", "GreaterThan", "And", "Or", "Not", "Xor", "ITE", "re", "im", "conjugate", "Series",
)  # fmt: skip
#: Numbers and words that stand alone: name of the class -> attribute of sympy.S.
_CONSTANTS = {
    "Pi": "Pi",
    "Exp1": "Exp1",
    "EulerGamma": "EulerGamma",
    "GoldenRatio": "GoldenRatio",
    "Infinity": "Infinity",
    "NegativeInfinity": "NegativeInfinity",
    "ImaginaryUnit": "ImaginaryUnit",
    "BooleanTrue": "true",
    "BooleanFalse": "false",
}
#: Classes that refuse ``evaluate=False``.
_PLAIN = ("ExprCondPair", "Series", "And", "Or", "Not", "Xor", "ITE", "conjugate")
_SYMBOLS = ("Symbol", "CoordinateSymbol", "SpeedSymbol", "ParameterSymbol")
#: Digits, bits and exponents beyond these are no formula's.
_DIGITS, _BITS, _EXPONENT = 400, 4096, 100_000


class NotStored(FricmbError):
    """Something that a file cannot hold as data."""


def _no_arrays(value: Any) -> Any:
    raise NotStored("a measured series has no place here")


def write_formula(expression: Any, write: Callable[[Any], Any] = _no_arrays) -> list[Any]:
    """The expression as lists, text and numbers; raises :class:`NotStored` for what is not on the list.

    ``write``: puts the arrays of a measured series away.
    """
    import sympy

    name = type(expression).__name__
    if name == "TableSymbol":
        from fricmb.signal._symbols import table_data

        return [name, expression.label, *map(write, table_data(expression.table))]
    if isinstance(expression, sympy.Symbol):
        return _write_symbol(expression, name)
    if isinstance(expression, sympy.Integer):
        return ["Integer", str(int(expression))]
    if isinstance(expression, sympy.Rational):
        return ["Rational", str(int(expression.p)), str(int(expression.q))]
    if isinstance(expression, sympy.Float):
        negative, mantissa, exponent, _ = expression._mpf_
        if not mantissa and exponent:
            raise NotStored(f"the number {expression} is not finite")
        return ["Float", int(negative), hex(int(mantissa)), int(exponent), int(expression._prec)]
    if name in _CONSTANTS:
        return [name]
    if name in _OPERATIONS and type(expression) is _operation(name):
        return [name, *(write_formula(argument, write) for argument in expression.args)]
    raise NotStored(f"{name} in the formula {str(expression)[:80]} is not among the functions that a file can hold")


def _write_symbol(symbol: Any, name: str) -> list[Any]:
    if name not in _SYMBOLS or type(symbol) is not _symbol(name):
        raise NotStored(f"the symbol {symbol} is a {name}")
    _, assumptions = symbol.__getnewargs_ex__()
    held = {key: bool(value) for key, value in assumptions.items()}
    return [name, symbol.name, held, *([symbol.value] if name == "ParameterSymbol" else [])]


def read_formula(node: Any, read: Callable[[Any], Any] = _no_arrays) -> Any:
    """The expression of :func:`write_formula`; raises ValueError or TypeError for anything else."""
    import sympy

    if not isinstance(node, list) or not node or not isinstance(node[0], str):
        raise ValueError("a formula is a list that begins with a name")
    name, *arguments = node
    if name == "TableSymbol":
        return _read_table(arguments, read)
    if name in _SYMBOLS:
        return _read_symbol(name, arguments)
    if name == "Integer":
        return sympy.Integer(_whole(*arguments))
    if name == "Rational":
        above, below = (_whole(text) for text in arguments)
        if below < 1:
            raise ValueError("a fraction needs a denominator above 0")
        return sympy.Rational(above, below)
    if name == "Float":
        return _read_float(*arguments)
    if name in _CONSTANTS and not arguments:
        return getattr(sympy.S, _CONSTANTS[name])
    if name in _OPERATIONS:
        return _build(name, [read_formula(argument, read) for argument in arguments])
    raise ValueError(f"{name!r} is not among the functions that a file can hold")


def _read_table(arguments: list[Any], read: Callable[[Any], Any]) -> Any:
    """A measured series."""
    from fricmb.signal._symbols import symbol_of

    label, edge, coefficient, domain = arguments[0], *map(read, arguments[1:])
    good = isinstance(label, str) and isinstance(domain, tuple) and len(domain) == 2
    good = good and all(isinstance(part, np.ndarray) and part.dtype == np.float64 for part in (edge, coefficient))
    if not good or edge.ndim != 1 or not edge.size or coefficient.ndim != 2 or len(coefficient) != edge.size + 1:
        raise ValueError("a measured series is a name, edges, coefficients of one piece more, and a domain")
    if not (np.isfinite(edge).all() and np.isfinite(coefficient).all() and (np.diff(edge) > 0.0).all()):
        raise ValueError("a measured series has rising edges and finite coefficients")
    return symbol_of(edge, coefficient, (float(domain[0]), float(domain[1])), label)


def _build(name: str, arguments: list[Any]) -> Any:
    operation = _operation(name)
    made = operation(*arguments) if name in _PLAIN else operation(*arguments, evaluate=False)
    if list(made.args) != arguments and set(made.args) != set(arguments):
        made = operation(*arguments)  # Piecewise and the like bring their arguments to another form
    return made


def _read_symbol(name: str, arguments: list[Any]) -> Any:
    text, assumptions, *value = arguments
    good = isinstance(text, str) and isinstance(assumptions, dict)
    good = good and all(type(held) is bool for held in assumptions.values())
    if not good or len(value) != (name == "ParameterSymbol") or not all(type(v) is float for v in value):
        raise ValueError(f"{name}: expected a name, assumptions{' and a number' if value else ''}")
    return _symbol(name)(text, *value, **assumptions)


def _read_float(negative: Any, mantissa: Any, exponent: Any, precision: Any) -> Any:
    import sympy

    good = isinstance(mantissa, str) and len(mantissa) < _BITS // 4 and negative in (0, 1)
    if not good or type(exponent) is not int or abs(exponent) > _EXPONENT:
        raise ValueError("a number of a formula is out of bounds")
    if type(precision) is not int or not 1 <= precision <= _BITS:
        raise ValueError("the precision of a number of a formula is out of bounds")
    return sympy.Float((int(negative), int(mantissa, 16), exponent), precision=precision)


def _whole(text: Any) -> int:
    if not isinstance(text, str) or len(text) > _DIGITS:
        raise ValueError("a whole number of a formula is out of bounds")
    return int(text)


@cache
def _operation(name: str) -> Callable[..., Any]:
    import sympy

    if name == "Series":
        from fricmb.signal._symbols import Series

        return Series
    if name == "ExprCondPair":
        from sympy.functions.elementary.piecewise import ExprCondPair

        return ExprCondPair  # type: ignore[no-any-return]
    return getattr(sympy, name)  # type: ignore[no-any-return]


@cache
def _symbol(name: str) -> Any:
    import sympy

    from fricmb.values import _symbols

    return sympy.Symbol if name == "Symbol" else getattr(_symbols, name)
