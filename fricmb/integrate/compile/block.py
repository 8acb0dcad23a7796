"""Blocks: kernels that are compiled and cached on their own, and called through a table of addresses.

Numba copies the code of every function into each of its callers' compilation.  A block is called by address instead
(run-time data, as for laws), so that a change of it compiles it alone.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

from llvmlite import ir
from numba import config, njit, types
from numba.extending import intrinsic

from fricmb.integrate.compile.block_places import PLACES
from fricmb.integrate.compile.compilers import MachineCompiler
from fricmb.integrate.compile.content import describe_signature
from fricmb.integrate.compile.kernel_cache import cached_on_disk
from fricmb.integrate.compile.room import annotations_of, argument_types

_Function = TypeVar("_Function", bound=Callable[..., Any])

_blocks: dict[str, Any] = {}


def block(function: _Function) -> _Function:
    """Compile ``function`` on its own and let kernels call it through the table of addresses, its last argument.

    Argument types are read from the annotations (:func:`fricmb.integrate.compile.room.argument_types`).
    """
    if config.DISABLE_JIT:
        return function
    index = PLACES.index(function.__name__)
    notes = annotations_of(function)
    wanted = notes.pop("return")
    wrap = njit(error_model="numpy", no_cpython_wrapper=True, pipeline_class=MachineCompiler)
    compiled = cached_on_disk(wrap(function))
    signature_of = lambda: argument_types(function)  # noqa: E731
    _blocks[function.__name__] = (compiled, signature_of)

    def typer(typingctx: Any, *args: Any) -> Any:
        arguments, result = signature_of()
        signature = result(*arguments)

        def codegen(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            address = context.make_array(signature.args[-1])(context, builder, values[-1])
            place = builder.load(builder.gep(address.data, [ir.Constant(ir.IntType(64), index)]))
            kinds = [context.get_value_type(kind) for kind in signature.args]
            kind = ir.FunctionType(context.get_value_type(signature.return_type), kinds)
            called = builder.call(builder.inttoptr(place, kind.as_pointer()), values)
            return context.get_dummy_value() if result == types.void else called

        return signature, codegen

    names = ", ".join(notes)
    scope: dict[str, Any] = {"typer": typer}
    exec(f"def {function.__name__}(typingctx, {names}):\n    return typer(typingctx, {names})", scope)
    called = intrinsic(scope[function.__name__])
    called.called_by_address = lambda: f"{function.__name__} {index} {describe_signature(signature_of()[0])} {wanted}"
    return cast(_Function, called)


def block_address(name: str) -> int:
    """Address of a block, compiled or loaded from the cache on the first call."""
    compiled, signature_of = _blocks[name]
    arguments, result = signature_of()
    if tuple(arguments) not in compiled.overloads:
        compiled.compile(result(*arguments))
    overload = compiled.overloads[tuple(arguments)]
    return int(overload.library.get_pointer_to_function(overload.fndesc.llvm_cfunc_wrapper_name))


def block_names() -> list[str]:
    """Names of all blocks whose modules are imported."""
    return list(_blocks)


def was_compiled(name: str) -> bool:
    """Whether a block had to be compiled in this process, not being in the cache."""
    return bool(_blocks[name][0].stats.cache_misses)


def block_module(name: str) -> str:
    """The module that defines a block."""
    return str(_blocks[name][0].py_func.__module__)
