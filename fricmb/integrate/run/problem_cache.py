"""What integrators make of a problem once, and find again with the same arrays."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from fricmb.integrate.problem import Kept, Problem

_T = TypeVar("_T")


def once_per(arrays: Kept, key: Any, make: Callable[[], _T]) -> _T:
    """What was made under ``key`` for these very arrays; forgotten with them.

    Problems that differ in one value share the arrays of their structure or of their contacts.
    """
    kept = arrays.kept
    if key not in kept:
        kept[key] = make()
    value: _T = kept[key]
    return value


def once_per_problem(problem: Problem, key: Any, make: Callable[[], _T]) -> _T:
    """What was made for this very problem object under ``key``."""
    return once_per(problem, key, make)
