"""Arrays while a kernel is lowered: an address and lengths, asked for when something needs them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, reduce
from typing import Any

from llvmlite import ir
from numba import types

from fricmb.integrate.compile.room import load_word

WORD = ir.IntType(64)


class View:
    """A contiguous array: its address and the length of each axis are asked for once.

    Parameters
    ----------
    kind : numba.types.Array
        Its type.
    data, length : callable
        What gives the address of the first item, and the length of an axis.
    """

    def __init__(self, kind: Any, data: Callable[[], Any], length: Callable[[int], Any]) -> None:
        self.kind = kind
        self._data, self._length = data, length
        self._lengths: dict[int, Any] = {}

    @cached_property
    def data(self) -> Any:
        """Address of the first item."""
        return self._data()

    def length(self, axis: int) -> Any:
        """Length of an axis."""
        if axis not in self._lengths:
            self._lengths[axis] = self._length(axis)
        return self._lengths[axis]

    def lengths(self) -> list[Any]:
        """Lengths of all axes."""
        return [self.length(axis) for axis in range(self.kind.ndim)]

    def place(self, builder: Any, indices: list[Any]) -> Any:
        """Address of what leading indices choose; negative ones count from the end of their axis."""
        offsets = []
        for axis, given in enumerate(indices):
            index = given
            if not (isinstance(index, ir.Constant) and index.constant >= 0):
                negative = builder.icmp_signed("<", given, WORD(0))
                index = builder.select(negative, builder.add(given, self.length(axis)), given)
            later = [self.length(after) for after in range(axis + 1, self.kind.ndim)]
            offsets.append(builder.mul(index, reduce(builder.mul, later)) if later else index)
        return builder.gep(self.data, [reduce(builder.add, offsets)]) if offsets else self.data

    def part(self, builder: Any, kind: Any, indices: list[Any]) -> View:
        """The array that leading indices choose; lengths are asked for now, before a name has another array."""
        place, lengths = self.place(builder, indices), self.lengths()[len(indices) :]
        return View(kind, lambda: place, lambda axis: lengths[axis])

    def item_size(self, context: Any) -> Any:
        """Bytes of an item."""
        return WORD(context.get_abi_sizeof(context.get_data_type(self.kind.dtype)))

    def built(self, context: Any, builder: Any) -> Any:
        """The array as numba holds it, owned by nobody."""
        at = context.data_model_manager[self.kind].get_field_position
        lengths = self.lengths()
        strides = [self.item_size(context)]
        for length in lengths[:0:-1]:
            strides.insert(0, builder.mul(strides[0], length))
        array = ir.Constant(context.get_value_type(self.kind), None)
        for name, value in (("nitems", reduce(builder.mul, lengths)), ("itemsize", strides[-1]), ("data", self.data)):
            array = builder.insert_value(array, value, at(name))
        for name, values in (("shape", lengths), ("strides", strides)):
            for axis, value in enumerate(values):
                array = builder.insert_value(array, value, [at(name), axis])
        return array


def view_of_field(context: Any, builder: Any, room: Any, kind: Any, at: int) -> View:
    """An array of a room, whose descriptor begins at the byte ``at``."""
    pointer = context.get_data_type(kind.dtype).as_pointer()
    return View(
        kind,
        lambda: builder.inttoptr(load_word(builder, room, at, 0), pointer),
        lambda axis: load_word(builder, room, at, 1 + axis),
    )


def view_of_array(context: Any, kind: Any, find: Callable[..., Any]) -> View:
    """An array that numba holds; ``find`` gives the part of it at a position."""
    at = context.data_model_manager[kind].get_field_position
    return View(kind, lambda: find(at("data")), lambda axis: find(at("shape"), axis))


def is_plain(kind: Any) -> bool:
    """Whether an array is contiguous, of numbers."""
    return (
        isinstance(kind, types.Array)
        and kind.layout == "C"
        and kind.aligned
        and kind.ndim > 0
        and isinstance(kind.dtype, types.Number | types.Boolean)
    )
