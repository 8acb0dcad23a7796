"""Declarations whose numbers are symbols: what the ``define_...`` methods of authors see."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from fricmb.values._declaration import Declaration
from fricmb.values._numbers import is_expression, is_plain
from fricmb.values._parameter import Parameter


@dataclass(frozen=True)
class Symbolic:
    """A stand-in and its symbols.

    Attributes
    ----------
    standin : Declaration
        Of the declaration's own class; its slots hold symbols.
    symbols : dict of str to tuple of Symbol
        Slot path -> its symbols (one for a number; one for each entry of a tuple), in the order of
        :meth:`Declaration.slots`.
    values : tuple of float
        Numbers of all symbols, flattened in the same order.
    """

    standin: Any
    symbols: dict[str, tuple[Any, ...]]
    values: tuple[float, ...]

    @property
    def flat(self) -> tuple[Any, ...]:
        """All symbols in order."""
        return tuple(s for held in self.symbols.values() for s in held)


def symbolic(declaration: Declaration, **fields: Any) -> Symbolic:
    """A stand-in for ``declaration`` whose slots are real SymPy symbols, named by their path.

    Those of the fields in ``declaration.positive`` are positive.

    Parameters
    ----------
    declaration : Declaration
        A law, an element, a normal-force law.
    **fields
        Fields that get this value instead (an expression whose coordinates are local symbols).  Arrays, matrices and
        parts that fields refer to are left as they are.
    """
    symbols: dict[str, tuple[Any, ...]] = {}
    values: list[float] = []
    return Symbolic(_stand_in(declaration, "", symbols, values, fields), symbols, tuple(values))


def _stand_in(
    declaration: Declaration,
    prefix: str,
    symbols: dict[str, tuple[Any, ...]],
    values: list[float],
    fields: Mapping[str, Any] = MappingProxyType({}),
) -> Any:
    """The stand-in itself; a declaration inside a field (a law made of another) is stood in for as well."""
    copy = object.__new__(type(declaration))
    numbers = declaration.numeric_slots()
    for field in dataclasses.fields(declaration):  # type: ignore[arg-type]
        held = getattr(declaration, field.name)
        if field.name in fields:
            held = fields[field.name]
        elif isinstance(held, Declaration):
            if not held._referred:
                held = _stand_in(held, f"{prefix}{field.name}.", symbols, values)
        elif field.name in numbers and (is_plain(held) or isinstance(held, Parameter | tuple) or is_expression(held)):
            sign = {"positive": True} if field.name in declaration.positive else {"real": True}
            held = _symbols(prefix + field.name, held, numbers[field.name], symbols, values, sign)
        elif isinstance(held, Mapping):
            held = {
                key: _symbols(f"{prefix}{field.name}.{key}", entry, numbers[f"{field.name}.{key}"], symbols, values)
                if f"{field.name}.{key}" in numbers
                else entry
                for key, entry in held.items()
            }
        object.__setattr__(copy, field.name, held)
    return copy


def _symbols(
    path: str,
    held: Any,
    number: Any,
    symbols: dict[str, tuple[Any, ...]],
    values: list[float],
    assumptions: Mapping[str, bool] = MappingProxyType({"real": True}),
) -> Any:
    import sympy

    if isinstance(held, tuple):
        made = tuple(sympy.Symbol(f"{path}_{i}", **assumptions) for i in range(len(held)))
        symbols[path] = made
        values.extend(float(n) for n in number)
        return made
    symbol = sympy.Symbol(path, **assumptions)
    symbols[path] = (symbol,)
    values.append(float(number))
    return symbol
