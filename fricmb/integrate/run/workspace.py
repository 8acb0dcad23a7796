"""Rooms that runs work in: lent to a run, given back, and for the next one as they were when they were made."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Generic, TypeVar, cast

import numpy as np

from fricmb.integrate.compile.room import Room, room

_Rooms = TypeVar("_Rooms", bound=tuple[Any, ...])

#: Workspaces kept of each kind, kinds, and bytes above which none is kept.
MANY, KINDS, LARGE = 4, 64, 4_000_000
#: Bytes of a line of memory: arrays begin on one.
LINE = 64


class Workspace(Generic[_Rooms]):
    """Several rooms, all arrays of which lie in one piece of memory; rooms inside them are left where they are.

    Attributes
    ----------
    rooms : named tuple of rooms
    """

    def __init__(self, values: _Rooms) -> None:
        arrays = _arrays_of(values)
        starts = np.cumsum([0, *(-(-array.nbytes // LINE) * LINE for array in arrays)]).tolist()
        self._memory = np.zeros(starts[-1], dtype=np.uint8)
        views = []
        for start, array in zip(starts[:-1], arrays, strict=True):
            view = self._memory[start : start + array.nbytes].view(array.dtype).reshape(array.shape)
            view[...] = array
            views.append(view)
        kind: Any = type(values)
        places = iter(views)
        self.rooms = cast(_Rooms, kind._make([room(_placed(held, places)) for held in values]))
        self._blank = self._memory.copy()

    @property
    def nbytes(self) -> int:
        """Size of the arrays."""
        return self._memory.nbytes

    def clear(self) -> None:
        """Make all arrays what they were at first."""
        self._memory[:] = self._blank


def _arrays_of(values: Any) -> list[Any]:
    """All arrays of nested named tuples, those of rooms left out."""
    found = []
    for held in values:
        if isinstance(held, np.ndarray):
            found.append(held)
        elif not isinstance(held, Room):
            found.extend(_arrays_of(held))
    return found


def _placed(values: Any, places: Iterator[Any]) -> Any:
    """The named tuple with the next places for its arrays."""
    return type(values)._make([
        next(places) if isinstance(held, np.ndarray) else held if isinstance(held, Room) else _placed(held, places)
        for held in values
    ])  # fmt: skip


_store: dict[Any, list[Workspace[Any]]] = {}


@contextmanager
def lent(key: Any, make: Callable[[], _Rooms]) -> Iterator[_Rooms]:
    """Rooms like those that ``make`` makes, for as long as they are needed; equal keys mean equal rooms."""
    free = _store.get(key)
    if free is None:
        for old in list(_store)[: len(_store) + 1 - KINDS]:
            _store.pop(old, None)
        free = _store[key] = []
    try:
        held = free.pop()  # of several threads one gets it
    except IndexError:
        held = Workspace(make())
    yield held.rooms
    if len(free) < MANY and held.nbytes <= LARGE:
        held.clear()
        free.append(held)
