"""Asking authors' ``define_...`` methods: with the arguments that they take, for expressions that can be used."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from numbers import Real
from typing import Any

from fricmb.errors import FricmbError, shown
from fricmb.values._in_symbols import in_symbols


def ask(error: type[FricmbError], label: str, method: str, function: Callable[..., Any], **arguments: Any) -> Any:
    """What a method returns for symbols, its arguments in order.

    Raises
    ------
    FricmbError
        Of the given type, where it does not take these arguments, or where its formula needs numbers.
    """
    try:
        signature = inspect.signature(function)
    except ValueError:
        signature = None  # not one of Python
    if signature is not None:
        try:
            signature.bind(*arguments.values())
        except TypeError:
            takes = ", ".join(["self", *map(str, signature.parameters.values())])
            wanted = ", ".join(["self", *arguments])
            raise error(f"{label}: {method} takes ({takes}); expected is {method}({wanted})") from None
    with in_symbols(error, label, method):
        return function(*arguments.values())


def one_expression(error: type[FricmbError], label: str, method: str, value: Any, known: Iterable[Any]) -> Any:
    """A returned expression in SymPy: of numbers and the symbols ``known``.

    Raises
    ------
    FricmbError
        Of the given type, for what is no such expression.
    """
    import sympy

    if not isinstance(value, sympy.Expr) and (isinstance(value, bool) or not isinstance(value, Real)):
        raise error(f"{label}: {method} must return one expression, got {shown(value)}")
    found = sympy.sympify(value)
    left = found.free_symbols - set(known)
    if left:
        names = ", ".join(sorted(map(str, left)))
        raise error(
            f"{label}: {method}: undefined symbols in a derived expression: {names}; accepted are arguments and fields"
        )
    if found.has(sympy.I):
        raise error(f"{label}: {method} must return a real expression, got {found}")
    return found


def expressions(
    error: type[FricmbError], label: str, method: str, value: Any, n: int, known: Iterable[Any], what: str
) -> tuple[Any, ...]:
    """The same of ``n`` expressions, ``what`` they are; one may stand alone."""
    import sympy

    entries = tuple(value) if isinstance(value, list | tuple | sympy.MatrixBase) else (value,)
    if len(entries) != n:
        raise error(f"{label}: {method} must return {n} {what}, got {len(entries)}")
    if any(entry is None or isinstance(entry, str | bool) for entry in entries):
        raise error(f"{label}: {method} must return {n} {what}, got {shown(value)}")
    return tuple(one_expression(error, label, method, entry, known) for entry in entries)
