"""A series inside SymPy expressions.  Imports SymPy: imported inside functions only."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import sympy

from fricmb.integrate.signals.pieces import Table, series_value, table_of
from fricmb.values._symbols import TIME, ParameterSymbol


class TableSymbol(ParameterSymbol):
    """A table of polynomial pieces; a parameter whose number is where kernels find it in this process."""

    __slots__ = ("label", "table")
    named = False

    def __new__(cls, table: Table, label: str = "") -> TableSymbol:
        """The symbol of a table, which lives as long; ``label``: how expressions are printed."""
        symbol = ParameterSymbol.__new__(cls, f"series_{table.digest}", float(table.address))
        symbol.table, symbol.label = table, label
        return symbol

    def _hashable_content(self) -> tuple[Any, ...]:
        return (*super()._hashable_content(), self.label)

    def __reduce_ex__(self, protocol: Any) -> Any:
        return symbol_of, (*table_data(self.table), self.label)


class Series(sympy.Function):  # type: ignore[misc]
    """``Series(x, table, order)``: the function in a table at the time x, or its derivative of some order.

    The order -1 is its integral, -2 the integral of that.
    """

    nargs = 3
    is_real = True
    is_commutative = True
    _imp_ = staticmethod(series_value)

    def fdiff(self, argindex: int = 1) -> Any:
        """The slope; none by the table."""
        x, table, order = self.args
        return Series(x, table, order + 1) if argindex == 1 else sympy.S.Zero

    def _eval_evalf(self, prec: int) -> Any:
        x, table, order = self.args
        if not isinstance(table, TableSymbol) or not x.is_number:
            return None
        return sympy.Float(float(table.table.value(float(x), int(order))), precision=prec)

    def _shown(self, printer: Any) -> str:
        x, table, order = self.args
        name = getattr(table, "label", "") or "signal"
        return f"{name}{chr(39) * int(order)}({printer.doprint(x)})" if order.is_number else repr(self)

    _sympystr = _shown

    def _latex(self, printer: Any, exp: Any = None) -> str:
        x, table, order = self.args
        name = (getattr(table, "label", "") or "signal").replace("_", r"\_")
        text = rf"\mathrm{{{name}}}{chr(39) * int(order)}\left({printer.doprint(x)}\right)"
        return text if exp is None else rf"\left({text}\right)^{{{exp}}}"


def series_of(table: Table, label: str = "", at: Any = None, order: int = 0) -> Any:
    """The expression of a table; ``at``: of what, by default of time."""
    return Series(TIME if at is None else sympy.sympify(at), TableSymbol(table, label), sympy.Integer(order))


#: Pieces in a row from which they are a table, and their highest degree.
_MANY, _DEGREE = 24, 5


def with_tables(value: Any) -> Any:
    """An expression in which a ``Piecewise`` of many polynomials of time is a table."""
    for node in [n for n in value.atoms(sympy.Piecewise) if len(n.args) > _MANY and n.free_symbols == {TIME}]:
        found = _table_of_pieces(node)
        if found is not None:
            value = value.xreplace({node: series_of(found, "pieces")})
    return value


def _table_of_pieces(node: Any) -> Table | None:
    """The table of pieces ``t < edge`` one after the other, and of the last; None for pieces of another kind."""
    edge, parts = [], []
    for i, (part, condition) in enumerate(node.args):
        last = i == len(node.args) - 1
        if last != (condition == sympy.true) or not part.is_polynomial(TIME):
            return None
        if not last:
            if not isinstance(condition, sympy.StrictLessThan | sympy.LessThan) or condition.lhs != TIME:
                return None
            edge.append(float(condition.rhs))
        parts.append([float(c) for c in reversed(sympy.Poly(part, TIME).all_coeffs())])
    if any(b <= a for a, b in pairwise(edge)) or max(map(len, parts)) > _DEGREE + 1:
        return None
    anchors = [edge[0], *edge]
    about = [_about(c, a) for c, a in zip(parts, anchors, strict=True)]
    pieces = np.zeros((len(edge) - 1, max(map(len, about))))
    for row, c in zip(pieces, about[1:-1], strict=True):
        row[: len(c)] = c
    return table_of(np.array(edge), pieces, before=about[0], after=about[-1])


def _about(c: Any, a: float) -> Any:
    """Coefficients in powers of t - a."""
    return np.polynomial.Polynomial(c)(np.polynomial.Polynomial([a, 1.0])).coef


def table_data(table: Table) -> tuple[Any, ...]:
    """What a table is made of again from: edges, coefficients, domain."""
    return table.edge.copy(), table.given.copy(), table.domain


def table_again(edge: Any, coefficient: Any, domain: Any) -> Table:
    """The table of :func:`table_data`."""
    return table_of(edge, coefficient[1:-1], before=coefficient[0], after=coefficient[-1], domain=tuple(domain))


def symbol_of(edge: Any, coefficient: Any, domain: Any, label: str) -> TableSymbol:
    """The symbol of :func:`table_data`."""
    return TableSymbol(table_again(edge, coefficient, domain), label)
