"""Banded matrices through LAPACK's addresses: factor, solve, reciprocal condition."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import get_cython_function_address, intrinsic

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import Floats, Ints, Pivots
from fricmb.integrate.step.tableau import Complexes

_NAMES = ("dgbtrf", "dgbtrs", "zgbtrf", "zgbtrs")
DTRF, DTRS, ZTRF, ZTRS = range(4)


@lru_cache(maxsize=1)
def band_addresses() -> Ints:
    """Addresses of LAPACK's banded routines, in the order of DTRF, DTRS, ZTRF, ZTRS."""
    return np.array([get_cython_function_address("scipy.linalg.cython_lapack", name) for name in _NAMES], np.int64)


def _data(context: Any, builder: Any, signature: Any, args: Any, i: int) -> Any:
    return context.make_array(signature.args[i])(context, builder, args[i]).data


@intrinsic
def _gbtrf(typingctx: Any, address: Any, sizes: Any, pivots: Any, ab: Any) -> Any:
    """Call xGBTRF: ``sizes`` int32 [n, kl, ku, ldab, nrhs, info, 'N']."""
    signature = types.void(address, sizes, pivots, ab)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        byte = ir.IntType(8).as_pointer()
        size = _data(context, builder, signature, args, 1)
        n, kl, ku, ldab, _, info, _ = [builder.gep(size, [ir.Constant(ir.IntType(64), i)]) for i in range(7)]
        ab, pivots = (_data(context, builder, signature, args, i) for i in (3, 2))
        arguments = [builder.bitcast(x, byte) for x in (n, n, kl, ku, ab, ldab, pivots, info)]
        kind = ir.FunctionType(ir.VoidType(), [byte] * 8)
        builder.call(builder.inttoptr(args[0], kind.as_pointer()), arguments)
        return context.get_dummy_value()

    return signature, codegen


@intrinsic
def _gbtrs(typingctx: Any, address: Any, sizes: Any, pivots: Any, ab: Any, b: Any) -> Any:
    """Call xGBTRS for a single right-hand side, overwritten; sizes as in _gbtrf."""
    signature = types.void(address, sizes, pivots, ab, b)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        byte = ir.IntType(8).as_pointer()
        size = _data(context, builder, signature, args, 1)
        n, kl, ku, ldab, nrhs, info, letter = [builder.gep(size, [ir.Constant(ir.IntType(64), i)]) for i in range(7)]
        ab, b, pivots = (_data(context, builder, signature, args, i) for i in (3, 4, 2))
        arguments = [builder.bitcast(x, byte) for x in (letter, n, kl, ku, nrhs, ab, ldab, pivots, b, n, info)]
        kind = ir.FunctionType(ir.VoidType(), [byte] * 11)
        builder.call(builder.inttoptr(args[0], kind.as_pointer()), arguments)
        return context.get_dummy_value()

    return signature, codegen


def band_sizes(n: int, half: int) -> Pivots:
    """The integers that the routines read, for n unknowns with ``half`` diagonals on either side."""
    return np.array([n, half, half, 3 * half + 1, 1, 0, ord("N")], np.int32)


@kernel
def factor_real(address: Ints, sizes: Pivots, pivots: Pivots, ab: Floats) -> int:
    """Factor in place; 0, or k > 0 where pivot k vanished."""
    _gbtrf(address[0], sizes, pivots, ab)
    return int(sizes[5])


@kernel
def solve_real_band(address: Ints, sizes: Pivots, pivots: Pivots, ab: Floats, b: Floats) -> None:
    """Overwrite b by the solution."""
    _gbtrs(address[1], sizes, pivots, ab, b)


@kernel
def factor_complex(address: Ints, sizes: Pivots, pivots: Pivots, ab: Complexes) -> int:
    """Factor in place; 0, or k > 0 where pivot k vanished."""
    _gbtrf(address[2], sizes, pivots, ab)
    return int(sizes[5])


@kernel
def solve_complex_band(address: Ints, sizes: Pivots, pivots: Pivots, ab: Complexes, b: Complexes) -> None:
    """Overwrite b by the solution."""
    _gbtrs(address[3], sizes, pivots, ab, b)


@kernel
def spread_of_pivots(sizes: Pivots, ab: Floats) -> float:
    """Smallest over largest pivot magnitude of a factored matrix: a cheap sign of near singularity."""
    n, ldab = sizes[0], sizes[3]
    diagonal = sizes[1] + sizes[2]
    low, high = np.inf, 0.0
    for j in range(n):
        value = abs(ab[j * ldab + diagonal])
        low = min(low, value)
        high = max(high, value)
    return low / high if high > 0.0 else 0.0
