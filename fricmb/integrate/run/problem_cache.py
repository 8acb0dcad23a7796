"""What integrators make of a problem once, and find again with the same problem object."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from fricmb.integrate.problem import Problem

_T = TypeVar("_T")


def once_per_problem(problem: Problem, key: Any, make: Callable[[], _T]) -> _T:
    """What was made for this very problem object under ``key``; forgotten with the object."""
    kept = problem.kept
    if key not in kept:
        kept[key] = make()
    value: _T = kept[key]
    return value
