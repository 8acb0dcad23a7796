"""Blocks: kernels that are compiled and cached on their own, and called by name.

Numba copies the code of every function into each of its callers' compilation.  A block is called through its *cell*
instead, a word of memory that holds its address and that machine code knows by a symbol: a change of the block compiles
it alone, and what a run does not load is neither compiled nor read.  A caller's stamp holds the layouts that the block
takes (``called_by_address``), so that no caller is used with other ones.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from ctypes import CFUNCTYPE, addressof, c_int64, c_void_p, cast
from typing import Any, TypeVar
from typing import cast as typed

from llvmlite import binding, ir
from numba import njit, types
from numba.extending import intrinsic

from fricmb.integrate.compile.compilers import MachineCompiler
from fricmb.integrate.compile.content import describe_signature
from fricmb.integrate.compile.kernel_cache import cached_on_disk
from fricmb.integrate.compile.layout import annotations_of, argument_types

_Function = TypeVar("_Function", bound=Callable[..., Any])

_WORD = ir.IntType(64)
_blocks: dict[str, Any] = {}
_cells: dict[str, tuple[c_int64, Any]] = {}


def symbol_of(name: str) -> str:
    """What machine code calls the cell of a block, or of a routine of LAPACK."""
    return f"fricmb.cell.{name}"


def cell(name: str) -> c_int64:
    """The cell of this name; while it holds no address, a call of it says so and ends the process."""
    if name not in _cells:

        def missing() -> None:
            os.write(2, f"fricmb: the kernel {name!r} is called before it is loaded\n".encode())
            os.abort()

        told = CFUNCTYPE(None)(missing)
        _cells[name] = c_int64(cast(told, c_void_p).value or 0), told
        binding.add_symbol(symbol_of(name), addressof(_cells[name][0]))
    return _cells[name][0]


def loaded_from(builder: Any, name: str, kind: Any) -> Any:
    """Lower the load of a function of the type ``kind`` from a cell."""
    module, symbol = builder.module, symbol_of(name)
    held = module.globals.get(symbol)
    if held is None:
        held = ir.GlobalVariable(module, _WORD, symbol)  # defined elsewhere
    return builder.inttoptr(builder.load(held), kind.as_pointer())


def block(function: _Function) -> _Function:
    """Compile ``function`` on its own and let kernels call it through its cell.

    Argument types are read from the annotations (:func:`fricmb.integrate.compile.layout.argument_types`).
    """
    name = function.__name__
    if name in _blocks and _blocks[name][0].py_func.__module__ != function.__module__:
        raise NameError(f"a block {name!r} is defined in {block_module(name)} and in {function.__module__}")
    wrap = njit(error_model="numpy", no_cpython_wrapper=True, pipeline_class=MachineCompiler)
    _blocks[name] = cached_on_disk(wrap(function)), lambda: argument_types(function)
    return _called(name, function)


def declared(function: _Function) -> _Function:
    """A block that a floor above defines: its name, arguments and result; nothing of its body is compiled."""
    return _called(function.__name__, function)


def _called(name: str, function: _Function) -> _Function:
    """What kernels call in place of a function of these annotations: the code in the cell of this name."""
    notes = annotations_of(function)
    wanted = notes.pop("return")
    cell(name)

    def typer(typingctx: Any, *args: Any) -> Any:
        arguments, result = argument_types(function)
        signature = result(*arguments)

        def codegen(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            kinds = [context.get_value_type(kind) for kind in signature.args]
            kind = ir.FunctionType(context.get_value_type(signature.return_type), kinds)
            called = builder.call(loaded_from(builder, name, kind), values)
            return context.get_dummy_value() if result == types.void else called

        return signature, codegen

    names = ", ".join(notes)
    scope: dict[str, Any] = {"typer": typer}
    exec(f"def {name}(typingctx, {names}):\n    return typer(typingctx, {names})", scope)
    called = intrinsic(scope[name])
    called.called_by_address = lambda: f"{name} {describe_signature(argument_types(function)[0])} {wanted}"
    return typed(_Function, called)


def load_block(name: str) -> None:
    """Put the address of a block into its cell, compiled or taken from the cache at the first time."""
    compiled, signature_of = _blocks[name]
    arguments, result = signature_of()
    if tuple(arguments) not in compiled.overloads:
        compiled.compile(result(*arguments))
    overload = compiled.overloads[tuple(arguments)]
    cell(name).value = overload.library.get_pointer_to_function(overload.fndesc.llvm_cfunc_wrapper_name)


def block_names() -> list[str]:
    """Names of all blocks whose modules are imported."""
    return list(_blocks)


def was_compiled(name: str) -> bool:
    """Whether a block had to be compiled in this process, not being in the cache."""
    return bool(_blocks[name][0].stats.cache_misses)


def block_module(name: str) -> str:
    """The module that defines a block."""
    return str(_blocks[name][0].py_func.__module__)
