"""What is made of arrays once, and found again with the same arrays: by all who read it, or by one at a time."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
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


@contextmanager
def lent_per(arrays: Kept, key: Any, make: Callable[[], _T]) -> Iterator[_T]:
    """What was made under ``key`` for these very arrays, to be written to: nobody else has it meanwhile.

    Another thread, or a run that is made inside this one, gets its own.  It is given back as it is left; after an error
    it is not.
    """
    free: list[_T] = once_per(arrays, key, list)
    try:
        found = free.pop()  # of several threads one gets it
    except IndexError:
        found = make()
    yield found
    free.append(found)
