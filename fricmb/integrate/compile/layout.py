"""Layouts: what is in a room, by annotations, and the types that kernels see of it.

    class Clock(Layout):
        h: float
        stops: Floats

Numbers are ``float`` and ``int``; arrays have the aliases of ``problem`` (Floats2: two axes); a layout in another one
is a room in a room.
"""

from __future__ import annotations

import hashlib
import sys
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple, dataclass_transform

import numpy as np
from numba import types

#: Bytes of a word.
WORD = 8

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Self

    @dataclass_transform()
    class Layout:
        """What is in a room, by annotations: ``float`` and ``int`` numbers, arrays (Floats2: two axes), other layouts.

        A named tuple, but for those who check types: numbers of a room may be written to.
        """

        _fields: tuple[str, ...]

        @classmethod
        def _make(cls, values: Any) -> Self: ...
        def _replace(self, **new: Any) -> Self: ...
        def _asdict(self) -> dict[str, Any]: ...
        def __iter__(self) -> Iterator[Any]: ...
else:
    Layout = NamedTuple

_SCALARS = {"int": types.int64, "float": types.float64, "bool": types.boolean, "None": types.void}
_NUMBERS = {"int": types.int64, "float": types.float64}
_DTYPES = {"Floats": types.float64, "Complexes": types.complex128, "Ints": types.int64, "Codes": types.int8}


def array_type(name: str) -> Any:
    """Numba's type of the annotation (Floats2: two axes); None where it names no array."""
    stem = name.rstrip("234")
    if name == "Pivots":
        return types.Array(types.int32, 1, "C")
    if stem not in _DTYPES:
        return None
    return types.Array(_DTYPES[stem], int(name[len(stem) :] or 1), "C")


class RoomType(types.Type):
    """Numba's type of a room: names with the types of arrays, numbers and rooms in it, and where each begins."""

    def __init__(self, title: str, fields: tuple[tuple[str, Any], ...]) -> None:
        self.at: dict[str, int] = {}
        self.of: dict[str, Any] = dict(fields)
        #: What each field takes: dtype and number of axes of an array (0: a number), None for a room.
        self.takes: dict[str, tuple[Any, int] | None] = {}
        words = 0
        for name, kind in fields:
            axes = getattr(kind, "ndim", 0)
            dtype = np.dtype(str(getattr(kind, "dtype", kind))) if not isinstance(kind, RoomType) else None
            self.takes[name] = None if dtype is None else (dtype, axes)
            self.at[name] = words * WORD
            words += 1 + axes
        #: Numbers among the fields, and in which words they stand.
        self.numbers = tuple(name for name, kind in fields if isinstance(kind, types.Number))
        self.words = np.array([self.at[name] // WORD for name in self.numbers], dtype=np.int64)
        inside = ", ".join(f"{name}: {kind}" for name, kind in fields)
        # its name is part of the name of every kernel that takes it, in every call: a digest is short
        super().__init__(name=f"room {title} {hashlib.sha256(inside.encode()).hexdigest()[:12]}")


@lru_cache(maxsize=64)
def room_type(kind: Any) -> RoomType:
    """The type of a room made from the named tuple ``kind``, read from its annotations (Floats2: two axes)."""
    around = vars(sys.modules[kind.__module__])
    fields = [
        (name, _NUMBERS.get(note) or array_type(note) or room_type(around[note]))
        for name, note in annotations_of(kind).items()
    ]
    return RoomType(kind.__name__, tuple(fields))


def annotations_of(annotated: Any) -> dict[str, str]:
    """The annotations of a function or named tuple, as they are written."""
    notes = annotated.__annotations__
    return {name: getattr(note, "__forward_arg__", note) for name, note in notes.items()}


def argument_types(function: Any) -> tuple[tuple[Any, ...], Any]:
    """Numba's types of a function's arguments and of its result, read from its annotations.

    Those are rooms, Floats (Floats2, ...), Ints, Codes, Pivots, int, float, bool.
    """
    around = function.__globals__
    *arguments, result = (
        _SCALARS.get(note) or array_type(note) or room_type(around[note]) for note in annotations_of(function).values()
    )
    return tuple(arguments), result
