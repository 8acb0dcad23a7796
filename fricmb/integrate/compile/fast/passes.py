"""Numba's passes over a kernel, some of them replaced by quicker ones, and none that kernels have no use for."""

from __future__ import annotations

from typing import Any

from numba import _dynfunc
from numba.core import ir, types
from numba.core.compiler import DefaultPassBuilder, _LowerResult
from numba.core.compiler_machinery import PassManager, register_pass
from numba.core.typed_passes import InlineOverloads, NativeLowering, NopythonRewrites, NopythonTypeInference
from numba.core.untyped_passes import InlineClosureLikes, InlineInlinables, MakeFunctionToJitFunction, WithLifting

from fricmb.integrate.compile.fast.kernel_library import LinkedLibrary, MachineLibrary
from fricmb.integrate.compile.fast.quick_typing import TypeInference
from fricmb.integrate.compile.fast.short_lowering import ShortLower
from fricmb.integrate.compile.long_loops import has_long_loops


@register_pass(mutates_CFG=True, analysis_only=False)
class LowerShort(NativeLowering):  # type: ignore[misc]
    """Numba's lowering in fewer instructions."""

    _name = "lower_short"

    _library: type[MachineLibrary] = MachineLibrary

    @property
    def lowering_class(self) -> type[ShortLower]:
        """What writes the instructions."""
        return ShortLower

    def run_pass(self, state: Any) -> bool:
        """Lower into a library of ours."""
        state.library = self._library(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.long_loops = has_long_loops(state.func_id.func)
        state.library.enable_object_caching()
        return bool(super().run_pass(state))


@register_pass(mutates_CFG=True, analysis_only=False)
class LowerForLinking(LowerShort):
    """The same without the machine code at its end."""

    _name = "lower_for_linking"
    _library = LinkedLibrary

    def run_pass(self, state: Any) -> bool:
        """Lower, and make the kernel known to callers under a function that Python cannot call."""
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


@register_pass(mutates_CFG=True, analysis_only=False)
class _Rewrites(NopythonRewrites):  # type: ignore[misc]
    """Numba's rewriting of expressions of arrays, where there are any."""

    _name = "rewrites_of_arrays"

    def run_pass(self, state: Any) -> bool:
        """Rewrite, if an operator makes an array."""
        for block in state.func_ir.blocks.values():
            for made in block.find_insts(ir.Assign):
                operator = getattr(made.value, "op", "") in ("binop", "inplace_binop", "unary")
                if operator and isinstance(state.typemap[made.target.name], types.Array):
                    return bool(super().run_pass(state))
        return False


class _Passes(PassManager):  # type: ignore[misc]
    def _runPass(self, index: int, pss: Any, internal_state: Any) -> None:
        """Run a pass, and tell nobody: numba describes each to whoever may listen, and takes its time."""
        pss.analysis = self._analysis
        pss.run_initialization(internal_state)
        pss.run_pass(internal_state)
        pss.run_finalizer(internal_state)


#: Passes for what kernels do not contain: blocks of ``with``, functions within functions, functions to be inlined.
_IDLE = (WithLifting, InlineClosureLikes, MakeFunctionToJitFunction, InlineInlinables, InlineOverloads)


def lowered_by(kind: type[NativeLowering], state: Any) -> list[Any]:
    """Numba's passes, in their order, without idle ones and with others in the place of its typing and lowering."""
    others = {NativeLowering: kind, NopythonTypeInference: TypeInference, NopythonRewrites: _Rewrites}
    passes = _Passes("kernels")
    all_passes = DefaultPassBuilder.define_nopython_pipeline(state).passes
    passes.passes = [(others.get(made, made), about) for made, about in all_passes if made not in _IDLE]
    passes.finalize()
    return [passes]
