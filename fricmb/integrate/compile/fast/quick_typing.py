"""Numba's inference of types, which remembers what operators and functions make of numbers and arrays.

For each ``a + b`` numba tries, one after another, what it knows of additions, of strings and of arrays too, and writes
a text for each that does not fit.  What it finds depends on the types alone.
"""

from __future__ import annotations

from typing import Any

from numba.core import errors as numba_errors
from numba.core import types as numba_types
from numba.core.compiler_machinery import register_pass
from numba.core.typed_passes import NopythonTypeInference
from numba.core.typeinfer import TypeInferer

types: Any = numba_types
errors: Any = numba_errors
#: Types of which nothing more is found out while a kernel is typed.
_PLAIN = (types.Number, types.Boolean, types.Array, types.BaseTuple, types.SliceType)

_found: dict[Any, Any] = {}


class _Inferer(TypeInferer):  # type: ignore[misc]
    def resolve_call(self, fnty: Any, pos_args: Any, kw_args: Any) -> Any:
        """The signature of a call; of one with numbers and arrays alone as it was found before."""
        plain = isinstance(fnty, types.BaseFunction) and all(isinstance(kind, _PLAIN) for kind in pos_args)
        if kw_args or not plain:
            return super().resolve_call(fnty, pos_args, kw_args)
        call = fnty, tuple(pos_args)
        if call not in _found:
            _found[call] = super().resolve_call(fnty, pos_args, kw_args)
        return _found[call]


@register_pass(mutates_CFG=True, analysis_only=False)
class TypeInference(NopythonTypeInference):  # type: ignore[misc]
    """Types of all variables of a kernel."""

    _name = "type_inference"

    def run_pass(self, state: Any) -> bool:
        """Infer the types; as numba does, for functions that return no functions."""
        warnings = errors.WarningsFixer(errors.NumbaWarning)
        infer = _Inferer(state.typingctx, state.func_ir, warnings)
        known = state.typingctx.callstack.register(state.targetctx.target, infer, state.func_ir.func_id, state.args)
        with known, warnings:
            for i, (name, kind) in enumerate(zip(state.func_ir.arg_names, state.args, strict=True)):
                infer.seed_argument(name, i, kind)
            if state.return_type is not None:
                infer.seed_return(state.return_type)
            infer.build_constraint()
            state.typing_errors = infer.propagate(raise_errors=True)
            state.typemap, state.return_type, state.calltypes = infer.unify(raise_errors=True)
        return True
