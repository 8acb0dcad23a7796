"""Workspaces: rooms that are lent to a run, given back, and for the next one as they were when they were made."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Generic, TypeVar, cast

import numpy as np

from fricmb.integrate.compile.layout import annotations_of, array_type
from fricmb.integrate.compile.room import room

_Rooms = TypeVar("_Rooms", bound=tuple[Any, ...])

#: Workspaces kept of each kind, kinds, and bytes above which none is kept.
MANY, KINDS, LARGE = 4, 64, 4_000_000
#: Bytes of a line of memory: arrays begin on one.
LINE = 64


class Workspace(Generic[_Rooms]):
    """Several rooms, all arrays of which lie in one piece of memory; rooms inside them are left where they are.

    Where that is too much to be kept, arrays are left where they are, too.

    Attributes
    ----------
    rooms : named tuple of rooms
    kept : whether they may be lent again
    """

    def __init__(self, values: _Rooms) -> None:
        arrays = _arrays_of(values)
        self.kept = sum(array.nbytes for array in arrays) <= LARGE
        kind: Any = type(values)
        if not self.kept:
            self.rooms = cast(_Rooms, kind._make([room(held) for held in values]))
            return
        starts = np.cumsum([0, *(-(-array.nbytes // LINE) * LINE for array in arrays)]).tolist()
        self._memory = np.zeros(starts[-1], dtype=np.uint8)
        views = []
        for start, array in zip(starts[:-1], arrays, strict=True):
            view = self._memory[start : start + array.nbytes].view(array.dtype).reshape(array.shape)
            view[...] = array
            views.append(view)
        places = iter(views)
        self.rooms = cast(_Rooms, kind._make([room(_placed(held, places)) for held in values]))
        written = [self._memory, *(memory for held in self.rooms for memory in held.memories())]
        self._blank = [(memory, memory.copy()) for memory in written]

    def clear(self) -> None:
        """Make all arrays and numbers what they were at first."""
        for memory, blank in self._blank:
            memory[:] = blank


def empty_arrays(kind: Any) -> dict[str, Any]:
    """Arrays of no length, and zeros, for the fields of a layout that are arrays and numbers, by their annotations."""
    notes = annotations_of(kind)
    types = {name: array_type(note) for name, note in notes.items()}
    arrays = {name: np.zeros((0,) * held.ndim, str(held.dtype)) for name, held in types.items() if held is not None}
    return arrays | {name: 0 for name, note in notes.items() if note in ("int", "float")}


def _arrays_of(values: Any) -> list[Any]:
    """All arrays of nested named tuples, those of rooms left out."""
    found = []
    for held in values:
        if isinstance(held, np.ndarray):
            found.append(held)
        elif isinstance(held, tuple):
            found.extend(_arrays_of(held))
    return found


def _placed(values: Any, places: Iterator[Any]) -> Any:
    """The named tuple with the next places for its arrays."""
    return type(values)._make([
        next(places) if isinstance(held, np.ndarray) else _placed(held, places) if isinstance(held, tuple) else held
        for held in values
    ])  # fmt: skip


#: Workspaces by their kind.
Store = dict[Any, list[Workspace[Any]]]
_store: Store = {}


@contextmanager
def lent(key: Any, make: Callable[[], _Rooms], among: Store | None = None) -> Iterator[_Rooms]:
    """Rooms like those that ``make`` makes, for as long as they are needed; equal keys mean equal rooms.

    ``among``: those to find them among, of one scene for instance; by default of all scenes.
    """
    store = _store if among is None else among
    free = store.get(key)
    if free is None:
        for old in list(store)[: len(store) + 1 - KINDS]:
            store.pop(old, None)
        free = store[key] = []
    try:
        held = free.pop()  # of several threads one gets it
    except IndexError:
        held = Workspace(make())
    yield held.rooms
    if held.kept and len(free) < MANY:
        held.clear()
        free.append(held)
