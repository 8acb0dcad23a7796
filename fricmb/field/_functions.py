"""What parts state in SymPy as numpy functions: made once for each content and kept for the process."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any

import numpy as np

from fricmb import stated
from fricmb.values import is_expression, value_of

Function = Callable[..., Any]

_made: dict[Hashable, Function] = {}


def function(statement: stated.Statement) -> Function:
    """A numpy function of the arguments of a statement, one after the other, that returns a list."""
    found = _made.get(statement.key)
    if found is None:
        import sympy

        arguments, outputs = statement.make()
        found = _made[statement.key] = sympy.lambdify(list(arguments), list(outputs), stated.MODULES, cse=True)
    return found


class Given:
    """A number or expression of a declaration: ``motions`` it reads, and its value at given times.

    ``order``: of the derivative by time that is meant, 0 for the value itself.
    """

    def __init__(self, value: Any, *, order: int = 0) -> None:
        self.number: float | None = None
        self.coordinates: list[str] = []
        self.speeds: list[str] = []
        self._parameters: list[float] = []
        if not is_expression(value):
            self.number = 0.0 if order else float(value_of(value))
            return
        read = stated.reads(value)
        self.coordinates, self.speeds = list(read.coordinates), list(read.speeds)
        self._parameters = [float(s.value) for s in read.parameters]
        self._function = function(stated.expression(value, read.symbols, order))

    def at(self, moment: Any) -> Any:
        """Values (n_t,) in a state of the run, or one number."""
        if self.number is not None:
            return self.number
        motions = [moment.position(name) for name in self.coordinates] + [moment.velocity(name) for name in self.speeds]
        return self._function(moment.t, *motions, *self._parameters)[0]

    def over(self, t: Any) -> Any:
        """Values (n_t,) of an expression of time alone."""
        value = self.number if self.number is not None else self._function(t, *self._parameters)[0]
        return np.broadcast_to(np.asarray(value, dtype=float), np.shape(t))
