"""What integrators make of a problem once, and find again with the same problem object."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import Any, TypeVar

from fricmb.integrate.problem import Problem

_T = TypeVar("_T")
_store: dict[int, dict[Any, Any]] = {}


def once_per_problem(problem: Problem, key: Any, make: Callable[[], _T]) -> _T:
    """What was made for this very problem object under ``key``; forgotten with the object."""
    mine = _store.get(id(problem))
    if mine is None:
        mine = _store[id(problem)] = {}
        weakref.finalize(problem, _store.pop, id(problem), None)
    if key not in mine:
        mine[key] = make()
    value: _T = mine[key]
    return value
