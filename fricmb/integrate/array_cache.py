"""Results of functions of arrays, found again by what the arrays hold: runs that differ in other numbers share them."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from functools import wraps
from typing import ParamSpec, TypeVar

import numpy as np

_P = ParamSpec("_P")
_T = TypeVar("_T")

#: Results that are kept of one function, and bytes of arguments above which none is.
MANY, LARGE = 32, 65_536

#: Results of every such function.
_kept: list[dict[object, object]] = []


def forget_results() -> None:
    """Keep nothing of what has been found, as when the program begins."""
    for found in _kept:
        found.clear()


def cached_by_content(function: Callable[_P, _T]) -> Callable[_P, _T]:
    """The function with its last results kept, for small arrays; what it returns must never be written to.

    Arguments are arrays, and other things that can be keys of a dict.
    """
    found: dict[object, _T] = {}
    _kept.append(found)  # type: ignore[arg-type]

    @wraps(function)
    def call(*args: _P.args, **kwargs: _P.kwargs) -> _T:
        given = (*args, *kwargs.items())
        arrays = [held for held in given if isinstance(held, np.ndarray)]
        if sum([held.nbytes for held in arrays]) > LARGE:
            return function(*args, **kwargs)
        key = tuple([(held.shape, held.tobytes()) if isinstance(held, np.ndarray) else held for held in given])
        if key in found:
            with suppress(KeyError):  # another thread may have made space meanwhile
                return found[key]
        made = function(*args, **kwargs)
        for old in list(found)[: len(found) + 1 - MANY]:
            found.pop(old, None)
        found[key] = made
        return made

    return call
