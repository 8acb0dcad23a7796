"""Arrays that lie in one piece of memory: made, emptied and exchanged in a room all at once."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from fricmb.integrate.compile.layout import WORD, room_type
from fricmb.integrate.compile.room import Room, address_of


class Piece(NamedTuple):
    """``memory`` holds all ``arrays``, by their names, one behind the other."""

    memory: NDArray[np.float64]
    arrays: dict[str, Any]


class Pattern:
    """Sizes of arrays that a layout names: pieces of one pattern are put into rooms of that layout.

    Parameters
    ----------
    kind : type
        The layout.
    floats, whole : mapping of str to tuple of int
        Sizes of arrays of floats and of whole numbers, by their names.
    """

    def __init__(
        self, kind: Any, floats: Mapping[str, tuple[int, ...]], whole: Mapping[str, tuple[int, ...]] = {}
    ) -> None:
        sizes = {**floats, **whole}
        ends = np.cumsum([int(np.prod(size, dtype=np.int64)) for size in sizes.values()], dtype=np.int64)
        starts = np.append(0, ends[:-1])
        self._length = int(ends[-1])
        places = list(zip(sizes.items(), map(slice, starts.tolist(), ends.tolist()), strict=True))
        self._floats = [(name, place, size) for (name, size), place in places if name in floats]
        self._whole = [(name, place, size) for (name, size), place in places if name in whole]
        held = room_type(kind)
        self._words = np.array([held.at[name] // WORD for name in sizes], dtype=np.int64)
        self._starts = starts * WORD

    def zeros(self) -> Piece:
        """A piece of zeros."""
        memory = np.zeros(self._length)
        arrays: dict[str, Any] = {name: memory[place].reshape(size) for name, place, size in self._floats}
        if self._whole:
            numbers = memory.view(np.int64)
            arrays |= {name: numbers[place].reshape(size) for name, place, size in self._whole}
        return Piece(memory, arrays)

    def put(self, values: Any, piece: Piece) -> None:
        """Let a room have the arrays of a piece of this pattern in place of those of another one."""
        held = cast(Room, values)
        held.__dict__.update(piece.arrays)
        held._memory[self._words] = self._starts + address_of(piece.memory)
