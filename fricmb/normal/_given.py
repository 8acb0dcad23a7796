"""Normal forces that are given: they act on nobody, and stand for a number or an expression."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from fricmb.errors import FricmbError, LawError
from fricmb.values import Declaration, is_expression


@dataclass(frozen=True, kw_only=True)
class Constant(Declaration):
    """A constant normal force; ``normal_force=fm.normal.Constant(force=15.0)`` is ``normal_force=15.0``.

    Parameters
    ----------
    force : float
        >= 0.
    """

    _error: ClassVar[type[FricmbError]] = LawError

    force: Any

    def __post_init__(self) -> None:
        self._set("force", self._number("force", self.force, minimum=0.0))


@dataclass(frozen=True, kw_only=True)
class Prescribed(Declaration):
    """A normal force prescribed in time, or by coordinates and speeds: an expression; below 0 it counts as 0.

    ``normal_force=fm.normal.Prescribed(force=N)`` is ``normal_force=N``.

    Parameters
    ----------
    force : SymPy expression
        In ``fm.t``, ``fm.coordinate(...)``, ``fm.speed(...)`` and parameters.
    """

    _error: ClassVar[type[FricmbError]] = LawError

    force: Any

    def __post_init__(self) -> None:
        if not is_expression(self.force):
            self._refuse("force", self.force, "a SymPy expression in fm.t, coordinates and speeds")
