"""Rooms with other arrays in some places, without a look at all the others."""

from __future__ import annotations

from typing import Any, TypeVar, cast

from fricmb.integrate.compile.room import Room, address_of

_Tuple = TypeVar("_Tuple")
_WORD = 8


def with_arrays(values: _Tuple, **new: Any) -> _Tuple:
    """A room with other arrays of the same type in some places; the old one stays as it is."""
    old = cast(Room, values)
    made = object.__new__(Room)
    made._show(old._tuple._replace(**new))
    made.room_type, made._rooms = old.room_type, old._rooms
    made._memory = old._memory.copy()
    words, kind = made._memory.data, old.room_type
    for name, array in new.items():
        if (array.dtype, array.ndim) != kind.takes[name] or not array.flags.c_contiguous:
            raise TypeError(f"{name} is {array.dtype} with {array.ndim} axes; expected {kind.of[name]}")
        place = kind.at[name] // _WORD
        words[place] = address_of(array)
        for size in array.shape:
            place += 1
            words[place] = size
    made.address = address_of(made._memory)
    return cast(_Tuple, made)
