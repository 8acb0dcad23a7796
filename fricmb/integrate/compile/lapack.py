"""LAPACK's general solvers inside kernels, through the addresses that scipy publishes."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any, cast

from llvmlite import ir
from numba import types
from numba.extending import get_cython_function_address, intrinsic

from fricmb.integrate.compile.block import cell, loaded_from
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import Floats

#: The routines that kernels call.
ROUTINES = ("dgesv", "zgesv", "dgetrf", "dgetrs", "zgbtrf", "zgbtrs", "dgbtrf", "dgbtrs")


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


dgesv, zgesv, dgetrf, dgetrs, zgbtrf, zgbtrs, dgbtrf, dgbtrs = (_routine(name) for name in ROUTINES)


@kernel
def solve_complex(a: Any, b: Any, sizes: Any, pivots: Any) -> int:
    """Overwrite each row of b (nrhs, n) by the solution of ``a.T x = row``; a (n, n) is overwritten too."""
    sizes[0] = a.shape[0]
    sizes[1] = b.shape[0]
    sizes[2] = 0
    zgesv((sizes[:1], sizes[1:], a, sizes[:1], pivots, b, sizes[:1], sizes[2:]))
    return int(sizes[2])


@kernel
def solve_real(a: Floats, b: Floats, n: int, sizes: Any, pivots: Any) -> int:
    """Solve ``a x = b`` in place for the leading n rows of a contiguous (n*n,) row-major a and (n,) b.

    Small systems by elimination with row pivoting here (a call of LAPACK costs more than the work), others by dgesv.
    Returns 0, or k > 0 where pivot k vanished.
    """
    if n > 24:
        for i in range(n):
            for j in range(i):
                x = a[i * n + j]
                a[i * n + j] = a[j * n + i]
                a[j * n + i] = x
        sizes[0] = n
        sizes[1] = 1
        sizes[2] = 0
        dgesv((sizes[:1], sizes[1:], a, sizes[:1], pivots, b, sizes[:1], sizes[2:]))
        return int(sizes[2])
    for k in range(n):
        best, top = k, abs(a[k * n + k])
        for i in range(k + 1, n):
            if abs(a[i * n + k]) > top:
                best, top = i, abs(a[i * n + k])
        if top == 0.0:
            return k + 1
        if best != k:
            for j in range(k, n):
                x = a[k * n + j]
                a[k * n + j] = a[best * n + j]
                a[best * n + j] = x
            x = b[k]
            b[k] = b[best]
            b[best] = x
        pivot = a[k * n + k]
        line = a[k * n + k + 1 : k * n + n]
        for i in range(k + 1, n):
            x = a[i * n + k] / pivot
            if x != 0.0:
                row = a[i * n + k + 1 : i * n + n]
                for j in range(line.shape[0]):
                    row[j] -= x * line[j]
                b[i] -= x * b[k]
    for i in range(n - 1, -1, -1):
        x = b[i]
        for j in range(i + 1, n):
            x -= a[i * n + j] * b[j]
        b[i] = x / a[i * n + i]
    return 0


@kernel
def solve_rows(a: Floats, b: Any, n: int, sizes: Any, pivots: Any) -> bool:
    """Overwrite each row of b (nrhs, n) by the solution of ``a x = row``; a (n*n,) row-major is overwritten too."""
    for i in range(n):
        for j in range(i):
            x = a[i * n + j]
            a[i * n + j] = a[j * n + i]
            a[j * n + i] = x
    sizes[0] = n
    sizes[1] = b.shape[0]
    sizes[2] = 0
    dgesv((sizes[:1], sizes[1:], a, sizes[:1], pivots, b, sizes[:1], sizes[2:]))
    return bool(sizes[2] == 0)
