"""What mechanisms have in common that differ in numbers alone: found once, and again by all that is no such number."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import is_dataclass
from typing import Any, TypeVar

import numpy as np

from fricmb.integrate.implicit.scene.structure import mechanism_of
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import Problem

_T = TypeVar("_T")

#: Patterns that are kept.
MANY = 32
_store: dict[Any, dict[str, Any]] = {}


def of_pattern(problem: Problem, name: str, make: Callable[[], _T]) -> _T:
    """What was made under a name for a problem with the same pattern; it must never be written to."""
    facts = once_per(problem, "pattern", lambda: _facts((*_pattern(problem), *_pattern(mechanism_of(problem)))))
    if name not in facts:
        facts[name] = make()
    value: _T = facts[name]
    return value


def _facts(key: tuple[Any, ...]) -> dict[str, Any]:
    for old in list(_store)[: len(_store) + 1 - MANY]:
        if old != key:
            _store.pop(old, None)
    return _store.setdefault(key, {})


def _pattern(held: Any) -> Iterator[Any]:
    """Names, whole numbers and arrays of them, and the lengths of all other arrays."""
    for value in vars(held).values():
        if isinstance(value, np.ndarray):
            yield value.shape
            if value.dtype.kind != "f":
                yield value.tobytes()
        elif is_dataclass(value):
            yield from _pattern(value)
        elif isinstance(value, tuple | int):
            yield value
