"""What LLVM makes of the code of kernels: less than numba asks for by default, and code that runs no slower.

Loops in kernels go over the rows of a scene, which are few: unrolled and vectorised they are code that is made,
optimised and stepped over before it ends.  Where eight numbers at once pay, kernels say so (``lanes``).
"""

from __future__ import annotations

from typing import Any

from llvmlite import binding
from numba.core.codegen import JITCodeLibrary

#: Levels of optimisation, of 3: of each function by itself, of all that is called from a block, with it.
ALONE, WHOLE = 1, 3


class MachineLibrary(JITCodeLibrary):  # type: ignore[misc]
    """The code of a block or an entry with that of all kernels it calls, which becomes machine code.

    ``long_loops``: loops are vectorised.
    """

    long_loops = False

    def _passes(self, level: int) -> Any:
        """LLVM's builder of passes at a level."""
        options = binding.create_pipeline_tuning_options(speed_level=level)
        options.loop_unrolling = False
        options.loop_vectorization = self.long_loops
        options.slp_vectorization = False
        return binding.create_pass_builder(self._codegen._tm, options)

    def _optimize_functions(self, ll_module: Any) -> None:
        """Tidy functions one by one, so that there is less to link."""
        ll_module.data_layout = self._codegen._data_layout
        passes = self._passes(ALONE)
        manager = passes.getFunctionPassManager()
        manager.add_refprune_pass()
        for function in ll_module.functions:
            if not function.is_declaration:
                manager.run(function, passes)

    def _optimize_final_module(self) -> None:
        """Inline, and prune what counts references, then optimise."""
        for level in (0, WHOLE):
            passes = self._passes(level)
            manager = passes.getModulePassManager()
            if level == 0:
                manager.add_loop_rotate_pass()
                manager.add_instruction_combine_pass()
                manager.add_jump_threading_pass()
            manager.add_refprune_pass()
            manager.run(self._final_module, passes)


class LinkedLibrary(MachineLibrary):
    """The code of one kernel with that of the kernels it calls, to be linked into callers."""

    def finalize(self) -> None:
        """Gather the code; leave it as it is, since the caller's is optimised with it."""
        self._raise_if_finalized()
        for library in dict.fromkeys(self._linking_libraries):
            self._reload_init.update(library._reload_init)
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        self._finalize_dynamic_globals()
        for function in self._final_module.functions:
            if function.linkage == binding.Linkage.external and not function.is_declaration:
                function.linkage = "linkonce_odr"
        self._shared_module = self._final_module
        self._finalized = True
