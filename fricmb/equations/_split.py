"""Splitting a potential, a dissipation or a force into its affine part and the nonlinear remainder."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import sympy


@dataclass(frozen=True, kw_only=True)
class Split:
    """``total = low + rest``; ``low`` is a polynomial of low degree, ``rest`` all else.

    ``factors`` are expressions of the parameters; where all are 0, so is ``rest``.
    """

    low: Any
    rest: Any
    factors: tuple[Any, ...]


def split(expression: Any, variables: Sequence[Any], blocked: Sequence[Any], degree: int) -> Split:
    """Split into a polynomial of at most ``degree`` in ``variables``, free of ``blocked``, and the rest.

    A polynomial term is left as it is written (a cubic spring about its length stays ``(x - L)**4``, without
    cancellation); anything else is multiplied out where that sets a polynomial free, so that ``k (|x| - L)**2`` yields
    its linear spring.
    """
    low, rest = sympy.S.Zero, []
    for term in _terms(sympy.sympify(expression), variables, blocked):
        if _degree(term, variables, blocked) <= degree:
            low += term
        else:
            rest.append(term)
    return Split(low=low, rest=sympy.Add(*rest), factors=tuple(_factors(rest, [*variables, *blocked])))


def _terms(expression: Any, variables: Sequence[Any], blocked: Sequence[Any]) -> list[Any]:
    terms: list[Any] = []
    for term in sympy.Add.make_args(expression):
        if _degree(term, variables, blocked) < _NEVER:
            terms.append(term)
            continue
        parts = sympy.Add.make_args(_around_branches(term, sympy.expand))
        useful = any(_degree(part, variables, blocked) < _NEVER for part in parts)
        terms.extend(parts if useful else (term,))
    return terms


_NEVER = 1000


def _degree(term: Any, variables: Sequence[Any], blocked: Sequence[Any]) -> int:
    """Degree of a polynomial in the variables, or a number above any for what is none."""
    if term.free_symbols & set(blocked):
        return _NEVER
    if not term.free_symbols & set(variables):
        return 0
    if not term.is_polynomial(*variables):
        return _NEVER
    return int(sympy.Poly(term, *variables).total_degree())


def _factors(terms: Sequence[Any], variables: Sequence[Any]) -> list[Any]:
    found: list[Any] = []
    for term in terms:
        factor, _ = _around_branches(term, sympy.factor_terms).as_independent(*variables, as_Add=False)
        if factor not in found:
            found.append(factor)
    return found


def _around_branches(term: Any, change: Callable[[Any], Any]) -> Any:
    """Change a term, but for what stands inside its branches: that sets nothing free, and takes long."""
    found = sorted(term.atoms(sympy.Piecewise), key=sympy.default_sort_key)
    names = {branches: sympy.Dummy(real=True) for branches in found}
    return change(term.xreplace(names)).xreplace({name: branches for branches, name in names.items()})


def affine(expression: Any, variables: Sequence[Any]) -> tuple[list[Any], Any]:
    """Coefficients of the variables and the constant of an affine expression."""
    slopes = [sympy.diff(expression, x) for x in variables]
    constant = expression.xreplace(dict.fromkeys(variables, sympy.S.Zero))
    return slopes, constant
