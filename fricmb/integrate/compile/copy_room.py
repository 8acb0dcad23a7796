"""Copying a room into another, and exchanging two: all their arrays, whatever these are."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from numba import types
from numba.core import cgutils
from numba.core.errors import TypingError
from numba.extending import intrinsic

from fricmb.integrate.compile.room import RoomType, field_of


def _arrays(context: Any, builder: Any, kind: RoomType, rooms: Any) -> Iterator[tuple[list[Any], Any, Any]]:
    """Of every field the addresses of its data in both rooms, the number of entries and their type."""
    for name, field in kind.of.items():
        pair = [context.make_array(field)(context, builder, field_of(context, builder, kind, x, name)) for x in rooms]
        yield [array.data for array in pair], pair[0].nitems, context.get_data_type(field.dtype)


def _signature(one: Any, other: Any) -> Any:
    if not isinstance(one, RoomType) or one != other or any(isinstance(field, RoomType) for field in one.of.values()):
        raise TypingError(f"two rooms of arrays of one kind are expected, not {one} and {other}")
    return types.void(one, other)


@intrinsic
def copy_room(typingctx: Any, source: Any, target: Any) -> Any:
    """Copy the entries of all arrays of ``source`` to those of ``target``."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        for (data, into), count, kind in _arrays(context, builder, signature.args[0], args):
            cgutils.raw_memcpy(builder, into, data, count, context.get_abi_sizeof(kind))
        return context.get_dummy_value()

    return _signature(source, target), codegen


@intrinsic
def swap_rooms(typingctx: Any, one: Any, other: Any) -> Any:
    """Exchange the entries of all arrays of two rooms."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        for (a, b), count, _ in _arrays(context, builder, signature.args[0], args):
            with cgutils.for_range(builder, count) as loop:
                here, there = builder.gep(a, [loop.index]), builder.gep(b, [loop.index])
                kept = builder.load(here)
                builder.store(builder.load(there), here)
                builder.store(kept, there)
        return context.get_dummy_value()

    return _signature(one, other), codegen
