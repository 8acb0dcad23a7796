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
    for name, array in new.items():
        before = getattr(old._tuple, name)
        if array.dtype != before.dtype or array.ndim != before.ndim or not array.flags.c_contiguous:
            raise TypeError(f"{name} is {array.dtype} with {array.ndim} axes; expected {old.room_type.of[name]}")
        first = old.room_type.at[name] // _WORD
        made._memory[first : first + 1 + array.ndim] = (address_of(array), *array.shape)
    made.address = address_of(made._memory)
    return cast(_Tuple, made)
