"""The user's function behind one face, whatever way it is written."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import numpy as np
from numba.core.registry import CPUDispatcher

from fricmb.errors import ArgumentError
from fricmb.integrate.problem import Floats


def parameters(function: Any) -> list[inspect.Parameter]:
    """Positional parameters without default; an empty list where Python cannot tell."""
    try:
        found = inspect.signature(getattr(function, "py_func", function)).parameters.values()
    except (TypeError, ValueError):
        return []
    kinds = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    return [p for p in found if p.kind in kinds and p.default is inspect.Parameter.empty]


def is_compiled(function: Any) -> bool:
    """Whether it is a function compiled by numba."""
    return isinstance(function, CPUDispatcher)


def writes_in_place(function: Any) -> bool:
    """Whether the function is of the form ``fun(t, y, yp, out, ...)``."""
    names = [p.name for p in parameters(function)]
    return len(names) > 3 and names[3] == "out"


class Residual:
    """``fun(t, y, yp, *args)`` or ``fun(t, y, yp, out, *args)`` as ``residual(t, y, yp, out) -> bool`` (all finite).

    The first evaluation checks the shape.
    """

    def __init__(self, fun: Callable[..., Any], args: tuple[Any, ...], n: int) -> None:
        if not callable(fun):
            raise ArgumentError(f"`fun` must be callable as fun(t, y, yp), not {type(fun).__name__}.")
        self.fun = fun
        self.args = args
        self.n = n
        self.in_place = writes_in_place(fun)
        self.compiled = is_compiled(fun)

    def first(self, t: float, y: Floats, yp: Floats) -> Floats:
        """Evaluate once with all checks.

        Raises
        ------
        ArgumentError
            The result is not n real numbers.
        """
        mine, rate = y.copy(), yp.copy()
        if self.in_place:
            value: Any = np.full(self.n, np.nan)
            self.fun(t, mine, rate, value, *self.args)
        else:
            value = np.asarray(self.fun(t, mine, rate, *self.args))
        if not (np.array_equal(mine, y) and np.array_equal(rate, yp)):
            raise ArgumentError("`fun` must not change y or yp in place.")
        if value.dtype.kind not in "fiub":
            raise ArgumentError(f"`fun` must return real numbers; it returned {value.dtype}.")
        if value.shape != (self.n,):
            raise ArgumentError(
                f"`fun` must return an array of shape ({self.n},) as `y0` has; it returned {value.shape}."
            )
        return np.asarray(value, dtype=float)

    def __call__(self, t: float, y: Floats, yp: Floats, out: Floats) -> bool:
        """Evaluate into ``out``; False if a value is not finite."""
        if self.in_place:
            self.fun(t, y.copy(), yp.copy(), out, *self.args)
        else:
            out[:] = self.fun(t, y.copy(), yp.copy(), *self.args)
        # a sum is enough to find a NaN or an infinity; only an overflow of finite numbers looks the same
        return bool(np.isfinite(out.sum())) or bool(np.isfinite(out).all())
