"""LAPACK's general solvers inside kernels, through the addresses that scipy publishes."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import get_cython_function_address, intrinsic

from fricmb.integrate.compile.block_places import LAPACK, PLACES
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.parallel_compile import shared_addresses
from fricmb.integrate.problem import Floats

#: Routines that came later and stand at the end of the table; their places.
LATER = ("dgetrf", "dgetrs", "zgbtrf", "zgbtrs", "dgbtrf", "dgbtrs")
FACTOR, SOLVE, BAND_FACTOR, BAND_SOLVE, REAL_BAND_FACTOR, REAL_BAND_SOLVE = (PLACES.index(name) for name in LATER)


@lru_cache(maxsize=8)
def addresses(*blocks: str) -> np.ndarray[Any, np.dtype[np.int64]]:
    """Table of addresses: LAPACK and the named blocks; the rest stays 0 and uncompiled."""
    table = np.zeros(len(PLACES), dtype=np.int64)
    for name in (*LAPACK, *LATER):
        table[PLACES.index(name)] = get_cython_function_address("scipy.linalg.cython_lapack", name)
    for name, address in zip(blocks, shared_addresses(blocks), strict=True):
        table[PLACES.index(name)] = address
    return table


@intrinsic
def _gesv(typingctx: Any, address: Any, sizes: Any, pivots: Any, a: Any, b: Any) -> Any:
    """Call xGESV: ``sizes`` int32 [n, nrhs, info]; a, b Fortran-ordered memory, overwritten."""
    signature = types.void(address, sizes, pivots, a, b)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        def data(i: int) -> Any:
            return context.make_array(signature.args[i])(context, builder, args[i]).data

        byte = ir.IntType(8).as_pointer()
        size = data(1)
        at = [builder.gep(size, [ir.Constant(ir.IntType(64), i)]) for i in range(3)]
        n, nrhs, info = at
        arguments = [builder.bitcast(x, byte) for x in (n, nrhs, data(3), n, data(2), data(4), n, info)]
        kind = ir.FunctionType(ir.VoidType(), [byte] * 8)
        builder.call(builder.inttoptr(args[0], kind.as_pointer()), arguments)
        return context.get_dummy_value()

    return signature, codegen


@intrinsic
def call_lapack(typingctx: Any, address: Any, arguments: Any) -> Any:
    """Call the routine at ``address`` with pointers to the data of a tuple of arrays, Fortran's way."""
    signature = types.void(address, arguments)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        byte = ir.IntType(8).as_pointer()
        pointers = []
        for i, kind in enumerate(signature.args[1]):
            array = context.make_array(kind)(context, builder, builder.extract_value(args[1], i))
            pointers.append(builder.bitcast(array.data, byte))
        function = ir.FunctionType(ir.VoidType(), [byte] * len(pointers))
        builder.call(builder.inttoptr(args[0], function.as_pointer()), pointers)
        return context.get_dummy_value()

    return signature, codegen


@kernel
def solve_complex(address: int, a: Any, b: Any, sizes: Any, pivots: Any) -> int:
    """Overwrite each row of b (nrhs, n) by the solution of ``a.T x = row``; a (n, n) is overwritten too."""
    sizes[0] = a.shape[0]
    sizes[1] = b.shape[0]
    sizes[2] = 0
    _gesv(address, sizes, pivots, a, b)
    return int(sizes[2])


@kernel
def solve_real(address: int, a: Floats, b: Floats, n: int, sizes: Any, pivots: Any) -> int:
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
        _gesv(address, sizes, pivots, a, b)
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
def solve_rows(address: int, a: Floats, b: Any, n: int, sizes: Any, pivots: Any) -> bool:
    """Overwrite each row of b (nrhs, n) by the solution of ``a x = row``; a (n*n,) row-major is overwritten too."""
    for i in range(n):
        for j in range(i):
            x = a[i * n + j]
            a[i * n + j] = a[j * n + i]
            a[j * n + i] = x
    sizes[0] = n
    sizes[1] = b.shape[0]
    sizes[2] = 0
    _gesv(address, sizes, pivots, a, b)
    return bool(sizes[2] == 0)
