"""Rooms: named tuples of arrays that kernels take as one pointer.

Numba passes a named tuple by value, array by array, seven words each; a program of some sixty arrays takes minutes to
compile so.  A *room* puts the descriptors of the arrays of a (nested) named tuple into memory once, and kernels get its
address.  Single numbers stand in that memory themselves: kernels, and Python, read and write them by name.

    class Clock(Layout):
        h: float
        stops: Floats

    clock = room(Clock(h=0.1, stops=np.zeros(3)))
    clock.h *= 2.0              in a kernel or outside
"""

from __future__ import annotations

from ctypes import addressof, c_char
from functools import lru_cache
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AttributeTemplate
from numba.extending import (
    NativeValue,
    infer_getattr,
    lower_getattr_generic,
    lower_setattr_generic,
    models,
    register_model,
    typeof_impl,
    unbox,
)

from fricmb.integrate.compile.layout import WORD, RoomType, room_type

_Tuple = TypeVar("_Tuple")
_Nothing = c_char * 0

def address_of(array: Any) -> int:
    """Where the numbers of an array begin; ``array.ctypes.data`` in a third of its time, which small runs notice."""
    try:
        return addressof(_Nothing.from_buffer(array))
    except (TypeError, ValueError):  # an array that is read only, or in no order
        return int(array.ctypes.data)


class Room:
    """Keeps a named tuple alive beside the descriptors of its arrays, and holds its numbers."""

    def __init__(self, values: Any) -> None:
        # numbers are found in the room all the same: properties of a class come before what an object holds
        self.__dict__.update(zip(values._fields, values, strict=True))
        self._address: int
        self.room_type: RoomType = room_type(cast(Any, type(values)))
        words: list[int] = []
        self._own: list[Room] = []
        for (name, wanted), value in zip(self.room_type.takes.items(), values, strict=True):
            if wanted is None:
                inner = value if isinstance(value, Room) else room(value)
                if inner is not value:
                    self._own.append(inner)
                    self.__dict__[name] = inner
                words.append(inner._address)
            elif wanted[1] == 0:
                words.append(0)
            elif value.dtype != wanted[0] or value.ndim != wanted[1] or not value.flags.c_contiguous:
                expected = self.room_type.of[name]
                raise TypeError(f"{name} is {value.dtype} with {value.ndim} axes; expected {expected}")
            else:
                words.append(address_of(value))
                words.extend(value.shape)
        self._keep(np.array(words, dtype=np.int64))
        for name in self.room_type.numbers:
            setattr(self, name, getattr(values, name))

    def _keep(self, memory: Any) -> None:
        """Be what stands in a memory of words."""
        self._memory = memory
        self._views = {"int64": memory, "float64": memory.view(np.float64)}
        self._address = address_of(memory)

    def memories(self) -> list[Any]:
        """Words of this room that hold numbers, and of rooms made with it; others in it belong to somebody else."""
        inner = [memory for held in self._own for memory in held.memories()]
        return [self._memory, *inner] if self.room_type.numbers else inner

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...


@lru_cache(maxsize=64)
def _room_class(kind: Any) -> type[Room]:
    """Rooms of a named tuple, whose numbers are attributes that stand in the memory of the room."""
    made = room_type(kind)
    return type(f"{kind.__name__}Room", (Room,), {name: _number(made, name) for name in made.numbers})


def _number(kind: RoomType, name: str) -> property:
    word, held = kind.at[name] // WORD, str(kind.of[name])

    def read(self: Room) -> Any:
        return self._views[held][word].item()

    def write(self: Room, value: float) -> None:
        self._views[held][word] = value

    return property(read, write)


def room(values: _Tuple) -> _Tuple:
    """The named tuple as a room; to a kernel and to a reader of attributes it looks the same."""
    return cast(_Tuple, _room_class(cast(Any, type(values)))(values))


@typeof_impl.register(Room)
def _typeof_room(value: Room, context: Any) -> RoomType:
    return value.room_type


@register_model(RoomType)
class _RoomModel(models.OpaqueModel):
    pass


@unbox(RoomType)
def _unbox_room(kind: RoomType, value: Any, c: Any) -> Any:
    address = c.pyapi.object_getattr_string(value, "_address")
    number = c.pyapi.long_as_longlong(address)
    c.pyapi.decref(address)
    failed = cgutils.is_not_null(c.builder, c.pyapi.err_occurred())
    return NativeValue(c.builder.inttoptr(number, cgutils.voidptr_t), is_error=failed)


@infer_getattr
class _RoomAttributes(AttributeTemplate):
    key = RoomType

    def generic_resolve(self, kind: RoomType, name: str) -> Any:
        return kind.of.get(name)


def _place(builder: Any, room: Any, at: int, kind: Any) -> Any:
    """Pointer to what begins at the byte ``at`` of a room."""
    return builder.bitcast(builder.gep(room, [ir.IntType(64)(at)]), kind.as_pointer())


def load_word(builder: Any, room: Any, at: int, i: int) -> Any:
    """A word of a descriptor in a room, counted from the byte ``at``."""
    loaded = builder.load(_place(builder, room, at + i * WORD, ir.IntType(64)))
    # descriptors never change while a kernel runs: loads may leave the loops
    loaded.set_metadata("invariant.load", builder.module.add_metadata([]))
    return loaded


@lower_getattr_generic(RoomType)
def _room_attribute(context: Any, builder: Any, kind: RoomType, value: Any, name: str) -> Any:
    word = ir.IntType(64)

    def load(i: int) -> Any:
        return load_word(builder, value, kind.at[name], i)

    field = kind.of[name]
    if isinstance(field, RoomType):
        return builder.inttoptr(load(0), cgutils.voidptr_t)
    if isinstance(field, types.Number):
        return builder.load(_place(builder, value, kind.at[name], context.get_value_type(field)))
    array = context.make_array(field)(context, builder)
    size = context.get_abi_sizeof(context.get_data_type(field.dtype))
    shape = [load(1 + i) for i in range(field.ndim)]
    strides: list[Any] = [None] * field.ndim
    step = ir.Constant(word, size)
    items = ir.Constant(word, 1)
    for i in reversed(range(field.ndim)):
        strides[i] = step
        step = builder.mul(step, shape[i])
        items = builder.mul(items, shape[i])
    # the descriptor owns nothing
    array.meminfo = cgutils.get_null_value(array.meminfo.type)
    array.parent = cgutils.get_null_value(array.parent.type)
    array.nitems = items
    array.itemsize = ir.Constant(word, size)
    array.data = builder.inttoptr(load(0), context.get_data_type(field.dtype).as_pointer())
    array.shape = cgutils.pack_array(builder, shape, ty=word)
    array.strides = cgutils.pack_array(builder, strides, ty=word)
    return array._getvalue()


@lower_setattr_generic(RoomType)
def _set_room_number(context: Any, builder: Any, signature: Any, values: Any, name: str) -> None:
    """Write to a number of a room; its arrays and rooms stay what they are."""
    kind = signature.args[0]
    field = kind.of[name]
    if not isinstance(field, types.Number):
        raise TypeError(f"{name} of a {kind} is no number: kernels write to its items, not to it")
    builder.store(values[1], _place(builder, values[0], kind.at[name], context.get_value_type(field)))
