"""Calling compiled templates through their address: laws, elements, signals and LAPACK inside a compiled step.

A template is ``void(float64* x, float64* p, float64* out)``.  An address is run-time data, so one compiled integrator
serves every scene and law, and stays in the disk cache (a first-class function would make each law a new type).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

from llvmlite import ir
from numba import types
from numba.core.ccallback import CFunc
from numba.extending import intrinsic

from fricmb.integrate.compile.kernel_cache import cached_on_disk

#: Signature of every template.
TEMPLATE = types.void(types.CPointer(types.float64), types.CPointer(types.float64), types.CPointer(types.float64))


def template(function: Any) -> Any:
    """Compile ``function(x, p, out)`` as a template, kept in numba's disk cache; division by zero follows IEEE 754."""
    made = CFunc(function, (TEMPLATE.args, TEMPLATE.return_type), locals={}, options={"error_model": "numpy"})
    cached_on_disk(made).compile()
    return made


def _pointer(context: Any, builder: Any, array_type: Any, array: Any, offset: Any) -> Any:
    data = context.make_array(array_type)(context, builder, array).data
    return builder.gep(data, [offset])


@intrinsic
def _call(typingctx: Any, address: Any, x: Any, x0: Any, p: Any, p0: Any, out: Any, out0: Any) -> Any:
    """Call the template at ``address`` with pointers to ``x[x0]``, ``p[p0]``, ``out[out0]`` (contiguous float64)."""
    signature = types.void(address, x, types.intp, p, types.intp, out, types.intp)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        pointers = [_pointer(context, builder, signature.args[i], args[i], args[i + 1]) for i in (1, 3, 5)]
        double = ir.DoubleType().as_pointer()
        kind = ir.FunctionType(ir.VoidType(), [double, double, double])
        function = builder.inttoptr(args[0], kind.as_pointer())
        builder.call(function, pointers)
        return context.get_dummy_value()

    return signature, codegen


#: ``call(address, x, x0, p, p0, out, out0)``, inside kernels.
call = cast(Callable[..., None], _call)
