"""What is made of arrays once, and found again with the same arrays."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, TypeVar

_T = TypeVar("_T")


class Kept:
    """Frozen arrays that remember what was made of them; pickles do without."""

    @cached_property
    def kept(self) -> dict[Any, Any]:
        """What was made of these arrays (see :func:`once_per`)."""
        return {}

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name != "kept"}


def once_per(arrays: Kept, key: Any, make: Callable[[], _T]) -> _T:
    """What was made under ``key`` for these very arrays (a problem, its structure, its contacts); forgotten with them.

    Problems that differ in one value share the arrays of their structure or of their contacts.
    """
    kept = arrays.kept
    if key not in kept:
        kept[key] = make()
    value: _T = kept[key]
    return value
