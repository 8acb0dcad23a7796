"""Compilers of kernels: for entries and blocks, and for kernels that only other kernels call.

Numba makes machine code of every function that it compiles, also of those that are only ever linked into others, and
optimises each of them again inside each of its callers.  Here such a function is lowered to LLVM's intermediate code
and handed on; what is optimised, and becomes machine code, is the entry or block at the top, once.
"""

from __future__ import annotations

from typing import Any

from numba.core.compiler import CompilerBase

from fricmb.integrate.compile.few_collections import few_collections
from fricmb.integrate.compile.passes import LowerForLinking, LowerShort, lowered_by


class _Compiler(CompilerBase):  # type: ignore[misc]
    def _compile_core(self) -> Any:
        with few_collections():
            return super()._compile_core()


class MachineCompiler(_Compiler):
    """Compiles entries and blocks."""

    def define_pipelines(self) -> list[Any]:
        """Passes that end with machine code."""
        return lowered_by(LowerShort, self.state)


class LinkedCompiler(_Compiler):
    """Compiles kernels that only kernels call."""

    def define_pipelines(self) -> list[Any]:
        """Passes that end with code to be linked."""
        return lowered_by(LowerForLinking, self.state)
