"""LAPACK's factors and solutions inside kernels, through the addresses that scipy publishes."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any, cast

from llvmlite import ir
from numba import types
from numba.extending import get_cython_function_address, intrinsic

from fricmb.integrate.compile.block import cell, loaded_from

#: The routines that kernels call.
ROUTINES = ("dgetrf", "dgetrs", "zgbtrf", "zgbtrs", "dgbtrf", "dgbtrs")


@lru_cache(maxsize=1)
def load_lapack() -> None:
    """Put the addresses of the routines into their cells."""
    for name in ROUTINES:
        cell(name).value = get_cython_function_address("scipy.linalg.cython_lapack", name)


def _routine(name: str) -> Callable[..., None]:
    """A routine as kernels call it, Fortran's way: with pointers to the data of a tuple of arrays."""
    cell(name)

    @intrinsic
    def called(typingctx: Any, arguments: Any) -> Any:
        signature = types.void(arguments)

        def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            byte = ir.IntType(8).as_pointer()
            pointers = []
            for i, kind in enumerate(signature.args[0]):
                array = context.make_array(kind)(context, builder, builder.extract_value(args[0], i))
                pointers.append(builder.bitcast(array.data, byte))
            function = ir.FunctionType(ir.VoidType(), [byte] * len(pointers))
            builder.call(loaded_from(builder, name, function), pointers)
            return context.get_dummy_value()

        return signature, codegen

    called.called_by_address = lambda: f"LAPACK {name}"
    return cast(Callable[..., None], called)


dgetrf, dgetrs, zgbtrf, zgbtrs, dgbtrf, dgbtrs = (_routine(name) for name in ROUTINES)
