"""The SymPy symbols of declarations.  Imports SymPy: imported inside functions only."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy


class ParameterSymbol(sympy.Symbol):  # type: ignore[misc]
    """A named parameter inside an expression; two of one name are equal if their values are."""

    __slots__ = ("value",)
    #: Whether users know it by its name: not what stands for a table of a series.
    named = True

    def __new__(cls, name: str, value: float, **assumptions: Any) -> ParameterSymbol:
        """Not cached by SymPy: its cache knows the name alone."""
        symbol = sympy.Symbol.__xnew__(cls, name, **(assumptions or {"real": True}))
        symbol.value = float(value)
        return symbol  # type: ignore[no-any-return]

    def __getnewargs_ex__(self) -> tuple[tuple[str, float], dict[str, Any]]:
        return (self.name, self.value), {"real": True}

    def _hashable_content(self) -> tuple[Any, ...]:
        return (*super()._hashable_content(), self.value)


class CoordinateSymbol(sympy.Symbol):  # type: ignore[misc]
    """The coordinate of a named motion ("pad.x")."""

    __slots__ = ()

    @property
    def motion(self) -> str:
        """Name of the motion."""
        return str(self.name)


class SpeedSymbol(sympy.Symbol):  # type: ignore[misc]
    """The velocity of a named motion; its own name ends in a prime."""

    __slots__ = ()

    @property
    def motion(self) -> str:
        """Name of the motion."""
        return str(self.name)[:-1]


TIME = sympy.Symbol("t", real=True)


def coordinate(motion: str) -> CoordinateSymbol:
    """Symbol of the coordinate ``motion``."""
    return CoordinateSymbol(motion, real=True)


def speed(motion: str) -> SpeedSymbol:
    """Symbol of the velocity of ``motion``."""
    return SpeedSymbol(motion + "'", real=True)


def norm(components: Sequence[Any]) -> Any:
    """Length of a vector of SymPy expressions, with derivatives that stay finite at 0.

    The guard 1e-200 under the root is far below round-off wherever the length is above 1e-92; the second derivatives,
    of the order of 1e100 to 1e300 at 0, still are finite numbers there.
    """
    return sympy.sqrt(sum(c**2 for c in components) + sympy.Float("1e-200"))
