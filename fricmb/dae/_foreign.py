"""Calling by address from compiled code, so that kernels stay in the cache: the user's functions and LAPACK."""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba.extending import get_cython_function_address, intrinsic

from fricmb.integrate.problem import Floats

_numba: Any = numba  # its types are incomplete
types = _numba.types
_double = types.CPointer(types.float64)
_long = types.CPointer(types.int64)
#: void(t*, y*, yp*, out*, p*, n*)
RESIDUAL = types.void(_double, _double, _double, _double, _double, _long)
#: void(t*, y*, yp*, dy*, dyp*, p*, n*); both matrices by columns
JACOBIAN = types.void(_double, _double, _double, _double, _double, _double, _long)


def _call(typingctx: Any, address: Any, arrays: Any) -> Any:
    """Call ``void f(...)`` at an address with pointers to the data of a tuple of arrays."""
    signature = types.void(address, arrays)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        kinds = signature.args[1]
        byte = ir.IntType(8).as_pointer()
        pointers = []
        for i, kind in enumerate(kinds):
            array = builder.extract_value(args[1], i)
            pointers.append(builder.bitcast(context.make_array(kind)(context, builder, array).data, byte))
        kind = ir.FunctionType(ir.VoidType(), [byte] * len(pointers))
        builder.call(builder.inttoptr(args[0], kind.as_pointer()), pointers)
        return context.get_dummy_value()

    return signature, codegen


call: Any = intrinsic(_call)


def lapack() -> Any:
    """Addresses of dgetrf, dgetrs, dgbtrf, dgbtrs."""
    names = ("dgetrf", "dgetrs", "dgbtrf", "dgbtrs")
    return np.array([get_cython_function_address("scipy.linalg.cython_lapack", name) for name in names], dtype=np.int64)


class Compiled:
    """A numba function made callable by address; ``parameters``: its numeric arguments, read at every call."""

    def __init__(self, function: Any, args: tuple[Any, ...], *, in_place: bool = False, jacobian: bool = False) -> None:
        kinds = tuple(_kind(a) for a in args)
        constants = tuple(None if kind else a for kind, a in zip(kinds, args, strict=True))
        self.parameters: Floats = np.array([float(a) if k else 0.0 for k, a in zip(kinds, args, strict=True)] + [0.0])
        make = _jacobian if jacobian else _residual
        key = (function, in_place, jacobian, kinds)
        if all(kinds):
            if key not in _made:
                if len(_made) >= _KEPT:
                    _made.pop(next(iter(_made)))
                _made[key] = make(function, in_place, kinds, constants)
            self.code = _made[key]
        else:
            self.code = make(function, in_place, kinds, constants)
        self.address = self.code.address


_KEPT = 128
_made: dict[Any, Any] = {}


def _kind(argument: Any) -> str:
    if isinstance(argument, (bool, np.bool_)):
        return "bool"
    if isinstance(argument, (int, np.integer)):
        return "int"
    return "float" if isinstance(argument, (float, np.floating)) else ""


def _body(text: str, names: dict[str, Any], kinds: tuple[str, ...], constants: tuple[Any, ...]) -> Any:
    """A function from source: numba cannot unroll arguments of several types in any other way."""
    listed = [f"{kind}(p[{i}])" if kind else f"constant_{i}" for i, kind in enumerate(kinds)]
    scope = {f"constant_{i}": value for i, value in enumerate(constants)}
    scope |= names | {"carray": _numba.carray, "nan": np.nan}
    exec(text.replace("ARGS", "".join(f", {a}" for a in listed)).replace("COUNT", str(len(kinds) + 1)), scope)
    return scope["body"]


def _residual(function: Any, in_place: bool, kinds: tuple[str, ...], constants: tuple[Any, ...]) -> Any:
    text = """
def body(t, y_, yp_, out_, p_, n_):
    n = n_[0]
    y = carray(y_, (n,))
    yp = carray(yp_, (n,))
    out = carray(out_, (n,))
    p = carray(p_, (COUNT,))
    for i in range(n):
        out[i] = nan
    try:
        CALL
    except Exception:
        out[0] = nan
"""
    if in_place:
        text = text.replace("CALL", "function(t[0], y, yp, outARGS)")
    else:
        text = text.replace(
            "CALL", "value = function(t[0], y, ypARGS)\n        for i in range(n):\n            out[i] = value[i]"
        )
    return _numba.cfunc(RESIDUAL)(_body(text, {"function": function}, kinds, constants))


def _jacobian(function: Any, in_place: bool, kinds: tuple[str, ...], constants: tuple[Any, ...]) -> Any:
    text = """
def body(t, y_, yp_, dy_, dyp_, p_, n_):
    n = n_[0]
    y = carray(y_, (n,))
    yp = carray(yp_, (n,))
    dy = carray(dy_, (n, n))
    dyp = carray(dyp_, (n, n))
    p = carray(p_, (COUNT,))
    try:
        first, second = function(t[0], y, ypARGS)
        for i in range(n):
            for j in range(n):
                dy[j, i] = first[i, j]
                dyp[j, i] = second[i, j]
    except Exception:
        dy[0, 0] = nan
"""
    return _numba.cfunc(JACOBIAN)(_body(text, {"function": function}, kinds, constants))
