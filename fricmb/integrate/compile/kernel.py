"""Compilation of kernels: decorators, so that every kernel is compiled alike and keeps its Python type."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

from numba import njit
from numba.core import types
from numba.core.imputils import lower_constant
from numba.core.registry import CPUDispatcher
from numba.extending import models, register_model

from fricmb.integrate.compile.compilers import LinkedCompiler, MachineCompiler
from fricmb.integrate.compile.kernel_cache import cached_on_disk
from fricmb.integrate.compile.layout import argument_types

_Function = TypeVar("_Function", bound=Callable[..., Any])
_entries: dict[str, Any] = {}


class KernelType(types.Dispatcher):  # type: ignore[misc]
    """Type of a kernel, which says all that a call of it needs: handed to another kernel, its value is nothing.

    Numba's own type hands on the address of the Python object.  What contains an address is of this process alone, and
    is not kept on disk.
    """

    def __init__(self, dispatcher: Any) -> None:
        super().__init__(dispatcher)
        self.name = f"kernel {dispatcher.py_func.__module__}.{dispatcher.py_func.__qualname__}"


class Kernel(CPUDispatcher):  # type: ignore[misc]
    """Numba's dispatcher, with the type above."""

    @property
    def _numba_type_(self) -> KernelType:
        return KernelType(self)


register_model(KernelType)(models.OpaqueModel)


@lower_constant(KernelType)  # type: ignore[untyped-decorator]
def _nothing(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    return context.get_dummy_value()


def kernel(function: _Function) -> _Function:
    """Compile ``function`` for calls from other kernels; division by zero gives inf, as in numpy.

    Neither cached by itself nor callable from Python, where it would end the process: what is optimised, made machine
    code and cached is the entry or block that calls it (:mod:`fricmb.integrate.compile.compilers`).
    """
    inner = njit(error_model="numpy", no_cfunc_wrapper=True, no_cpython_wrapper=True, pipeline_class=LinkedCompiler)
    compiled = inner(function)
    if isinstance(compiled, CPUDispatcher):  # not where numba is told to compile nothing
        compiled.__class__ = Kernel
    return cast(_Function, compiled)


def entry(function: _Function) -> _Function:
    """Compile ``function`` on its first call from Python; kept in the disk cache with all that it calls."""
    return _entry(function, nogil=False)


def run_entry(function: _Function) -> _Function:
    """Compile an entry that may take long: other threads of Python go on meanwhile.

    Arrays that it writes to must be those of one run, never kept where another thread finds them.
    """
    return _entry(function, nogil=True)


def _entry(function: _Function, *, nogil: bool) -> _Function:
    wrap = njit(error_model="numpy", no_cfunc_wrapper=True, nogil=nogil, pipeline_class=MachineCompiler)
    compiled = cached_on_disk(wrap(function))
    _entries[f"{function.__module__}:{function.__name__}"] = compiled
    return cast(_Function, compiled)


def entry_names() -> list[str]:
    """Module and name of all entries whose modules are imported."""
    return list(_entries)


def compile_entry(name: str) -> None:
    """Compile an entry, or load it from the cache, for the types that its annotations name."""
    compiled = _entries[name]
    compiled.compile(argument_types(compiled.py_func)[0])
