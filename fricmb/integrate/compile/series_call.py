"""Calls of tables of polynomial pieces from generated kernels: ``series(x, address, order)``.

A table begins with the address of the function that reads it, so that kernels of expressions hold no code for tables.
"""

from __future__ import annotations

from typing import Any, cast

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

_DOUBLE = ir.DoubleType()
_POINTER = _DOUBLE.as_pointer()
_FUNCTION = ir.FunctionType(ir.VoidType(), [_POINTER] * 3).as_pointer()


def write_series(builder: Any, x: Any, address: Any, order: Any) -> Any:
    """Instructions that read the table at an address, which is given as a float."""
    given = cgutils.alloca_once(builder, _DOUBLE, size=2)
    found = cgutils.alloca_once(builder, _DOUBLE)
    builder.store(x, given)
    builder.store(order, builder.gep(given, [ir.Constant(ir.IntType(64), 1)]))
    word = ir.IntType(64)
    table = builder.inttoptr(builder.fptoui(address, word), _POINTER)
    function = builder.inttoptr(builder.fptoui(builder.load(table), word), _FUNCTION)
    builder.call(function, [given, table, found])
    return builder.load(found)


@intrinsic  # type: ignore[untyped-decorator]
def _series(typingctx: Any, x: Any, address: Any, order: Any) -> Any:
    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        plain = [
            context.cast(builder, arg, kind, types.float64) for arg, kind in zip(args, signature.args, strict=True)
        ]
        return write_series(builder, *plain)

    return types.float64(x, address, order), codegen


#: The same inside kernels that numba compiles.
series = cast(Any, _series)
