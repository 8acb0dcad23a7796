"""A kernel that goes through all that the quick passes replace, compiled and compared with Python."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numba import njit
from numba.core.compiler import CompilerBase

from fricmb.integrate.compile.fast.passes import LowerForLinking, LowerShort, lowered_by
from fricmb.integrate.compile.layout import Layout, argument_types
from fricmb.integrate.compile.room import room
from fricmb.integrate.problem import Floats, Floats2

#: What Python makes of the same (a test holds that).
_WANTED = 48.5


class _Machine(CompilerBase):  # type: ignore[misc]
    def define_pipelines(self) -> list[Any]:
        return lowered_by(LowerShort, self.state)


class _Linked(CompilerBase):  # type: ignore[misc]
    def define_pipelines(self) -> list[Any]:
        return lowered_by(LowerForLinking, self.state)


class _Box(Layout):
    """A number, and arrays of one and two axes."""

    h: float
    x: Floats
    A: Floats2


def _inner(row: Floats, k: int) -> float:
    total = 0.0
    for i in range(row.shape[0]):
        total += row[i] * (i + k)
    return total


def _outer_of(inner: Callable[[Floats, int], float]) -> Callable[[_Box], float]:
    def outer(box: _Box) -> float:
        whole = box.x  # of one assignment: used by its items, and as a whole
        row = whole  # of two: an array that has to be built
        total = inner(whole, 0) + whole[1]
        for i in range(box.A.shape[0]):
            box.A[i, 0] = box.h * i
            if i > 0:
                row = box.A[i]
            total += inner(row, i) + box.A[i, -1]
        box.A[0] = box.x
        made = np.sqrt(box.x) + row  # arrays that the kernel owns
        box.h = made.sum()
        return float(total)

    return outer


def try_out() -> None:
    """Raise an error of some kind where the passes do not work with this numba."""
    linked = njit(error_model="numpy", no_cfunc_wrapper=True, no_cpython_wrapper=True, pipeline_class=_Linked)
    machine = njit(error_model="numpy", no_cfunc_wrapper=True, pipeline_class=_Machine)
    compiled = machine(_outer_of(linked(_inner)))
    arguments, result = argument_types(compiled.py_func)
    compiled.compile(result(*arguments))
    made = room(_Box(h=0.5, x=np.array([1.0, 2.0, 3.0]), A=np.arange(6.0).reshape(2, 3)))
    found = compiled(made)
    if found != _WANTED or made.A.tolist() != [[1.0, 2.0, 3.0], [0.5, 4.0, 5.0]]:
        raise ValueError(f"a kernel gave {found}, not {_WANTED}, and {made.A.tolist()}")
