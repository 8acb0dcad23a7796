"""Eight numbers side by side: one instruction of the processor in place of a loop.

LLVM makes such instructions out of loops by itself where it knows how long these are, and that what is written is not
what is read.  Of short loops over arrays of a room it knows neither.  A kernel says so itself:

    x = lanes(a, at)             the numbers a[at], ..., a[at+7] of an array of one axis
    y = x * x + 2.0 * x          sums, differences, products, quotients, with numbers too
    rounded(x, y) + z * x        of two products in a sum one is rounded before, the other is not
    roots(x)                     square roots
    total(x)                     the sum of all eight
    set_lanes(b, at, y)
    all_lanes(1.0)               a number eight times

Where a processor has shorter vectors, LLVM takes several of them.
"""

from __future__ import annotations

import operator
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.imputils import lower_builtin
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numba.extending import intrinsic, models, register_model

#: How many numbers stand side by side.
LANES = 8

_VECTOR = ir.VectorType(ir.DoubleType(), LANES)


class LanesType(types.Type):  # type: ignore[misc]
    """Numba's type of eight numbers."""

    def __init__(self) -> None:
        super().__init__(name="lanes")


lanes_type = LanesType()


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _VECTOR)


def padded(count: int) -> int:
    """The least multiple of ``LANES`` that is not below ``count``."""
    return -(-count // LANES) * LANES


def _place(context: Any, builder: Any, kind: Any, array: Any, at: Any) -> Any:
    data = context.make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [at]), _VECTOR.as_pointer())


@intrinsic  # type: ignore[untyped-decorator]
def lanes(typingctx: Any, array: Any, at: Any) -> Any:
    """Eight numbers of an array of one axis from the place ``at`` on."""
    found = lanes_type(array, types.intp)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.load(_place(context, builder, signature.args[0], *args), align=8)

    return found, codegen


@intrinsic  # type: ignore[untyped-decorator]
def set_lanes(typingctx: Any, array: Any, at: Any, values: Any) -> Any:
    """Put eight numbers into an array of one axis from the place ``at`` on."""
    found = types.void(array, types.intp, lanes_type)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        builder.store(args[2], _place(context, builder, signature.args[0], *args[:2]), align=8)
        return context.get_dummy_value()

    return found, codegen


@intrinsic  # type: ignore[untyped-decorator]
def all_lanes(typingctx: Any, value: Any) -> Any:
    """A number eight times."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return _spread(builder, types.float64, args[0])

    return lanes_type(types.float64), codegen


@intrinsic  # type: ignore[untyped-decorator]
def roots(typingctx: Any, values: Any) -> Any:
    """The square roots of eight numbers."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        kind = ir.FunctionType(_VECTOR, [_VECTOR])
        name = f"llvm.sqrt.v{LANES}f64"
        return builder.call(cgutils.get_or_insert_function(builder.module, kind, name), args)

    return lanes_type(lanes_type), codegen


@intrinsic  # type: ignore[untyped-decorator]
def rounded(typingctx: Any, one: Any, other: Any) -> Any:
    """A product that is rounded before it goes into a sum.

    Sums take up products unrounded (:func:`_define`).  Of two products in one sum they can take up one, and LLVM
    chooses it by what else stands around: the other is marked, so that results depend on nothing but what is written.
    """

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.fmul(*(_spread(builder, kind, value) for kind, value in zip(signature.args, args, strict=True)))

    return lanes_type(one, other), codegen


@intrinsic  # type: ignore[untyped-decorator]
def total(typingctx: Any, values: Any) -> Any:
    """The sum of eight numbers, by halves."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        left, count = args[0], LANES
        while count > 1:
            count //= 2
            kind = ir.VectorType(ir.IntType(32), count)
            low, high = (ir.Constant(kind, list(range(first, first + count))) for first in (0, count))
            left = builder.fadd(builder.shuffle_vector(left, left, low), builder.shuffle_vector(left, left, high))
        return builder.extract_element(left, ir.Constant(ir.IntType(32), 0))

    return types.float64(lanes_type), codegen


def _spread(builder: Any, kind: Any, value: Any) -> Any:
    """A number in all lanes; lanes as they are."""
    if kind == lanes_type:
        return value
    first = builder.insert_element(ir.Constant(_VECTOR, ir.Undefined), value, ir.Constant(ir.IntType(32), 0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
    return builder.shuffle_vector(first, first, zeros)


def _define(symbol: Any, instruction: str) -> None:
    """Let an operator take lanes, and numbers on one side."""
    pairs = [(lanes_type, lanes_type), (lanes_type, types.float64), (types.float64, lanes_type)]

    @infer_global(symbol)
    class _Template(ConcreteTemplate):  # type: ignore[misc]
        cases = [signature(lanes_type, *pair) for pair in pairs]  # numba's attribute

    for pair in pairs:

        @lower_builtin(symbol, *pair)  # type: ignore[untyped-decorator]
        def _lower(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            both = [_spread(builder, kind, value) for kind, value in zip(signature.args, args, strict=True)]
            # products may go into sums without a rounding of their own
            return getattr(builder, instruction)(*both, flags=("contract",))


_define(operator.add, "fadd")
_define(operator.sub, "fsub")
_define(operator.mul, "fmul")
_define(operator.truediv, "fdiv")
