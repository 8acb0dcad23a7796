"""A named number that stands wherever a number does, in any number of parts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb._calls import answers
from fricmb.errors import SceneError, shown
from fricmb.values._arithmetic import Arithmetic


@dataclass(frozen=True)
class Parameter(Arithmetic):
    """A named number; made by :func:`parameter`.

    It stands for a number in a declaration and combines with numbers and SymPy expressions; a combination is a SymPy
    expression that remembers name and value.

    Attributes
    ----------
    name : str
        Without dots; equal names in one scene have equal values.
    value : float
    """

    name: str
    value: float

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name or "." in self.name or self.name != self.name.strip():
            raise SceneError(f"parameter: name must be a non-empty string without dots, got {shown(self.name)}")
        value = self.value
        number = isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)
        if not number or not _fits(value):
            raise SceneError(f"parameter {self.name!r}: value must be a finite number, got {shown(value)}")
        object.__setattr__(self, "value", float(value))

    def _sympy_(self) -> Any:
        from fricmb.values._symbols import ParameterSymbol

        return ParameterSymbol(self.name, self.value)


def _fits(value: Any) -> bool:
    """Whether a number is a finite float: whole numbers may be too large for one."""
    try:
        return math.isfinite(value)
    except OverflowError:
        return False


@answers
def parameter(name: str, value: float) -> Parameter:
    """A named number that stands wherever a number does, in any number of parts.

    Parameters
    ----------
    name : str
        The name in ``scene.parameters``; without dots.
    value : float
        Finite.

    Raises
    ------
    SceneError
        If name or value is not accepted.

    Examples
    --------
    >>> N0 = parameter("N0", 15.0)
    >>> N0
    Parameter(name='N0', value=15.0)
    """
    return Parameter(name, value)
