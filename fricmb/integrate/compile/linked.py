"""Compilation of kernels that only other kernels call: to LLVM's intermediate code, and no further.

Numba makes machine code of every function that it compiles, also of those that are only ever linked into others, and
optimises each of them again inside each of its callers.  Here such a function is lowered and handed on; what is
optimised, and becomes machine code, is the entry or block at the top, once.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from numba import _dynfunc
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder, _LowerResult
from numba.core.compiler_machinery import register_pass
from numba.core.typed_passes import NativeLowering

from fricmb.integrate.compile.short_lowering import ShortLower


class _LinkedLibrary(JITCodeLibrary):  # type: ignore[misc]
    """The code of one kernel with that of the kernels it calls, to be linked into callers."""

    def finalize(self) -> None:
        """Gather the code; leave it as it is, since the caller's is optimised with it."""
        self._raise_if_finalized()
        for library in dict.fromkeys(self._linking_libraries):
            self._reload_init.update(library._reload_init)
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        self._finalize_dynamic_globals()
        self._finalized = True


@register_pass(mutates_CFG=True, analysis_only=False)
class _LowerShort(NativeLowering):  # type: ignore[misc]
    """Numba's lowering in fewer instructions."""

    _name = "lower_short"

    @property
    def lowering_class(self) -> type[ShortLower]:
        """What writes the instructions."""
        return ShortLower


@register_pass(mutates_CFG=True, analysis_only=False)
class _LowerForLinking(_LowerShort):
    """The same without the machine code at its end."""

    _name = "lower_for_linking"

    def run_pass(self, state: Any) -> bool:
        """Lower, and make the kernel known to callers under a function that Python cannot call."""
        state.library = _LinkedLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        state.flags.no_compile = True
        super().run_pass(state)
        made = state["cr"]
        known = made.fndesc
        name = known.qualname.split(".")[-1]
        handle = _dynfunc.make_function(known.lookup_module(), name, "kernel", 0, made.env, (state.library,))
        state.targetctx.insert_user_function(handle, known, [state.library])
        state.reload_init.extend(state.library._reload_init)
        state["cr"] = _LowerResult(known, made.call_helper, cfunc=handle, env=made.env)
        return True


@contextmanager
def _few_collections() -> Iterator[None]:
    """Let Python look for unreachable objects less often: compilation makes millions that stay, a fifth of its time."""
    before = gc.get_threshold()
    gc.set_threshold(200_000, 20, 50)
    try:
        yield
    finally:
        gc.set_threshold(*before)


class _Compiler(CompilerBase):  # type: ignore[misc]
    def _compile_core(self) -> Any:
        with _few_collections():
            return super()._compile_core()


def _lowered_by(kind: type[NativeLowering], state: Any) -> list[Any]:
    """Numba's passes, in their order, with another one in the place of its lowering."""
    passes = DefaultPassBuilder.define_nopython_pipeline(state)
    passes.passes = [(kind if made is NativeLowering else made, about) for made, about in passes.passes]
    passes.finalize()
    return [passes]


class MachineCompiler(_Compiler):
    """Compiles entries and blocks."""

    def define_pipelines(self) -> list[Any]:
        """Numba's passes, with :class:`_LowerShort`."""
        return _lowered_by(_LowerShort, self.state)


class LinkedCompiler(_Compiler):
    """Compiles kernels that only kernels call."""

    def define_pipelines(self) -> list[Any]:
        """Numba's passes, with :class:`_LowerForLinking`."""
        return _lowered_by(_LowerForLinking, self.state)
