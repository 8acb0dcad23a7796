"""Compilers of kernels: for entries and blocks, and for kernels that only other kernels call.

Numba makes machine code of every function that it compiles, also of those that are only ever linked into others, and
optimises each of them again inside each of its callers.  By the quick passes such a function is lowered to LLVM's
intermediate code and handed on; what is optimised, and becomes machine code, is the entry or block at the top, once.
"""

from __future__ import annotations

from typing import Any

from numba import config
from numba.core.compiler import Compiler

from fricmb.errors import FricmbError
from fricmb.integrate.compile.few_collections import few_collections
from fricmb.integrate.compile.plain import quick_passes

if config.DISABLE_JIT:
    raise FricmbError(
        "NUMBA_DISABLE_JIT: got 1, with which nothing can be run: kernels of fricmb work on addresses, which Python "
        "has none of; expected 0 (FRICMB_PLAIN=1 compiles them by numba's own passes)"
    )


class _Compiler(Compiler):  # type: ignore[misc]
    def compile_extra(self, func: Any) -> Any:
        """Compile a function."""
        with few_collections():
            return super().compile_extra(func)


class MachineCompiler(_Compiler):
    """Compiles entries and blocks."""

    def define_pipelines(self) -> list[Any]:
        """Passes that end with machine code."""
        quick = quick_passes()
        passes: list[Any] = (
            super().define_pipelines() if quick is None else quick.lowered_by(quick.LowerShort, self.state)
        )
        return passes


class LinkedCompiler(_Compiler):
    """Compiles kernels that only kernels call."""

    def define_pipelines(self) -> list[Any]:
        """Passes that end with code to be linked."""
        quick = quick_passes()
        passes: list[Any] = (
            super().define_pipelines() if quick is None else quick.lowered_by(quick.LowerForLinking, self.state)
        )
        return passes
