"""Rooms with other arrays or numbers in some places, without a look at all the others; their numbers, all at once."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, TypeVar, cast

import numpy as np

from fricmb.integrate.compile.layout import RoomType
from fricmb.integrate.compile.room import Room, address_of

Words = np.ndarray[Any, np.dtype[np.int64]]
_Tuple = TypeVar("_Tuple")
_WORD = 8


def with_arrays(values: _Tuple, **new: Any) -> _Tuple:
    """A room with other arrays or rooms of the same type, or other numbers, in some places; the old one stays."""
    old = cast(Room, values)
    made = object.__new__(type(old))
    made.__dict__ = {**old.__dict__, **new}
    made._own = []
    made._keep(old._memory.copy())
    words, kind = made._memory.data, old.room_type
    for name, value in new.items():
        if name in kind.numbers:
            setattr(made, name, value)
            continue
        if kind.takes[name] is None:
            if value.room_type is not kind.of[name]:
                raise TypeError(f"{name} is a {value.room_type}; expected {kind.of[name]}")
            words[kind.at[name] // _WORD] = value._address
            continue
        if (value.dtype, value.ndim) != kind.takes[name] or not value.flags.c_contiguous:
            raise TypeError(f"{name} is {value.dtype} with {value.ndim} axes; expected {kind.of[name]}")
        place = kind.at[name] // _WORD
        words[place] = address_of(value)
        for size in value.shape:
            place += 1
            words[place] = size
    return cast(_Tuple, made)


def numbers_of(values: Any) -> Words:
    """A copy of the numbers of a room, as it holds them."""
    held = cast(Room, values)
    return cast(Words, held._memory[held.room_type.words])


def put_numbers(values: Any, numbers: Words) -> None:
    """Give a room the numbers of another one of its type, or those that it had."""
    held = cast(Room, values)
    held._memory[held.room_type.words] = numbers


def put_zeros(values: Any, names: tuple[str, ...]) -> None:
    """Make some numbers of a room 0."""
    held = cast(Room, values)
    held._memory[_words_of(held.room_type, names)] = 0


@lru_cache(maxsize=64)
def _words_of(kind: RoomType, names: tuple[str, ...]) -> Words:
    return np.array([kind.at[name] // _WORD for name in names], dtype=np.int64)
