"""Numbers in declarations: a float, a parameter, or an expression of parameters."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Iterator
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fricmb.values._parameter import Parameter

#: A float, a Parameter or a SymPy expression of parameters.
Number: TypeAlias = Any


def is_expression(value: object) -> bool:
    """Whether ``value`` is a SymPy expression (SymPy is not imported to find out)."""
    module = sys.modules.get("sympy")
    return module is not None and isinstance(value, module.Expr)


def is_plain(value: object) -> bool:
    """Whether ``value`` is a Python or numpy number (not a bool, not complex)."""
    return isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)


def as_float(value: Any) -> float:
    """A Python or numpy number as a float; nan where it is none, or too large for one."""
    try:
        return float(value) if is_plain(value) else math.nan
    except OverflowError:
        return math.nan


def is_flag(value: object) -> bool:
    """Whether ``value`` is True or False, of Python or numpy."""
    return isinstance(value, bool | np.bool_)


def is_one_of(value: object, *options: object) -> bool:
    """Whether ``value`` is one of some words, flags or None; whatever else it may be, arrays and all, it is none."""
    return any(value is option or (type(value) is type(option) and value == option) for option in options)


def is_list(value: object) -> bool:
    """Whether ``value`` is a list, a tuple, or an array that has entries to go through."""
    return isinstance(value, list | tuple) or (isinstance(value, np.ndarray) and value.ndim > 0)


def has_entries(value: object) -> bool:
    """Whether ``value`` can be gone through; an array without dimensions only looks so."""
    return isinstance(value, Iterable) and not (isinstance(value, np.ndarray) and value.ndim == 0)


def depth_of(value: Any) -> int:
    """How deep a list is nested; that of rows of different lengths counts as 2."""
    try:
        return np.ndim(value)
    except ValueError:
        return 2


def is_sparse(value: object) -> bool:
    """Whether ``value`` is a scipy sparse matrix (scipy is not imported to find out)."""
    module = sys.modules.get("scipy.sparse")
    return module is not None and bool(module.issparse(value))


def symbol_values(value: Any) -> list[Parameter]:
    """Parameters in a SymPy expression, by name."""
    from fricmb.values._symbols import ParameterSymbol

    found = [s for s in value.free_symbols if isinstance(s, ParameterSymbol) and s.named]
    return [Parameter(s.name, s.value) for s in sorted(found, key=lambda s: (s.name, s.value))]


def parameters_in(value: Any) -> Iterator[Parameter]:
    """Every named parameter inside a slot's value, nested ones included."""
    if isinstance(value, Parameter):
        yield value
    elif is_expression(value):
        yield from symbol_values(value)
    elif isinstance(value, tuple):
        for entry in value:
            yield from parameters_in(entry)
    elif isinstance(value, np.ndarray) and value.dtype == object:
        for entry in value.flat:
            yield from parameters_in(entry)


def value_of(value: Any) -> Any:
    """The numbers behind a slot's value: float, array of floats, or sparse matrix.

    Raises
    ------
    TypeError
        If an expression holds symbols that are not parameters (time, coordinates).
    """
    if isinstance(value, Parameter):
        return value.value
    if is_expression(value):
        from fricmb.values._symbols import ParameterSymbol

        numbers = {s: s.value for s in value.free_symbols if isinstance(s, ParameterSymbol)}
        return float(value.xreplace(numbers))
    if isinstance(value, tuple):
        return np.array([value_of(entry) for entry in value], dtype=float)
    if isinstance(value, np.ndarray):
        return _array_of(value)
    return value


def _array_of(value: NDArray[Any]) -> NDArray[np.float64]:
    if value.dtype != object:
        return value
    return np.array([value_of(entry) for entry in value.flat], dtype=float).reshape(value.shape)


def substitute(value: Any, changes: dict[str, float]) -> Any:
    """``value`` with the named parameters given new numbers."""
    if isinstance(value, Parameter):
        return Parameter(value.name, changes[value.name]) if value.name in changes else value
    if is_expression(value):
        from fricmb.values._symbols import ParameterSymbol

        held = [s for s in value.free_symbols if isinstance(s, ParameterSymbol) and s.name in changes]
        return value.xreplace({s: ParameterSymbol(s.name, changes[s.name]) for s in held}) if held else value
    if isinstance(value, tuple):
        return tuple(substitute(entry, changes) for entry in value)
    if isinstance(value, np.ndarray) and value.dtype == object:
        result = np.empty(value.shape, dtype=object)
        result.ravel()[:] = [substitute(entry, changes) for entry in value.flat]
        return result
    return value


def finite(value: Any) -> bool:
    """Whether a plain number is finite."""
    return math.isfinite(value)
