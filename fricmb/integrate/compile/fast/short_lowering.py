"""Lowering of kernels in few instructions: items of arrays are reached without building the array.

Numba makes a value of seven parts for each array that a kernel mentions, stores it, and loads from it what an item
takes: some sixty instructions for ``y.g[k]``, printed, parsed and optimised away again.  Here an array that comes out
of a room, or is a row of one, stays what its room holds, an address and lengths, until something needs all of it.  The
addresses of items, and what is done with items, are numba's.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core import ir as numba_ir
from numba.core.lowering import Lower

from fricmb.integrate.compile.fast.array_view import WORD, View, is_plain, view_of_array, view_of_field
from fricmb.integrate.compile.layout import RoomType


class ShortLower(Lower):  # type: ignore[misc]
    """Numba's lowering, but for arrays whose items alone are used."""

    def pre_lower(self) -> None:
        """See whether the function owns no array: then none of its references is counted."""
        super().pre_lower()
        self._views: dict[str, View] = {}
        self._known_counts: dict[Any, bool] = {}
        self._only_borrows = self._owns_nothing()

    def _counted(self, kind: Any) -> bool:
        known = self._known_counts.get(kind)
        if known is None:
            known = self._known_counts[kind] = bool(self.context.data_model_manager[kind].contains_nrt_meminfo())
        return known

    def _owns_nothing(self) -> bool:
        """Whether all arrays are arguments, fields of rooms, or parts of those."""
        if self._counted(self.fndesc.restype) or self._disable_sroa_like_opt:
            return False
        if any(self._counted(kind) and not isinstance(kind, types.Array) for kind in self.fndesc.typemap.values()):
            return False
        plain = (numba_ir.Arg, numba_ir.Var, numba_ir.Global, numba_ir.FreeVar)
        return all(
            isinstance(made.value, plain) or getattr(made.value, "op", "") in ("getattr", "getitem", "static_getitem")
            for block in self.blocks.values()
            for made in block.find_insts(numba_ir.Assign)
            if self._counted(self.typeof(made.target.name))
        )

    def incref(self, typ: Any, val: Any) -> None:
        """Count a reference, where the function owns arrays."""
        if not self._only_borrows:
            super().incref(typ, val)

    def decref(self, typ: Any, val: Any) -> None:
        """Give a reference back, where the function owns arrays."""
        if not self._only_borrows:
            super().decref(typ, val)

    def lower_assign(self, ty: Any, inst: Any) -> Any:
        """The value of an assignment; a :class:`View` where it is an array that need not be built."""
        value = inst.value
        if isinstance(value, numba_ir.Var) and value.name in self._views and ty == self.typeof(value.name):
            return self._views[value.name]
        if isinstance(value, numba_ir.Expr):
            found = self._field(ty, value) if value.op == "getattr" else self._part(ty, value)
            if found is not None:
                return found
        made = super().lower_assign(ty, inst)
        if self._only_borrows and isinstance(value, numba_ir.Expr) and self._counted(ty):
            super().decref(ty, made)  # numba's implementations hand out a reference of their own
        return made

    def storevar(self, value: Any, name: str, argidx: Any = None) -> None:
        """Keep a value under a name; a view of a single block as it is."""
        if isinstance(value, View):
            if name in self._singly_assigned_vars and not self._disable_sroa_like_opt:
                self._views[name] = value
                return
            value = value.built(self.context, self.builder)
        if self._only_borrows and argidx is None and name not in self._singly_assigned_vars:
            self._alloca_var(name, self.typeof(name))
            self.builder.store(value, self.getvar(name))
            return
        super().storevar(value, name, argidx)

    def loadvar(self, name: str) -> Any:
        """The value of a name, built if it was a view."""
        if name in self._views:
            if name not in self._blk_local_varmap:
                self._blk_local_varmap[name] = self._views[name].built(self.context, self.builder)
            return self._blk_local_varmap[name]
        return super().loadvar(name)

    def delvar(self, name: str) -> None:
        """Forget a name; there is nothing to do where it holds no reference."""
        known = name in self._blk_local_varmap or name in self.varmap
        if name not in self._views and not (self._only_borrows and known):
            super().delvar(name)

    def alloca_lltype(self, name: str, lltype: Any, datamodel: Any = None) -> Any:
        """Room for a variable; there is no debugger to tell of it."""
        return cgutils.alloca_once(self.builder, lltype, name=name, zfill=False)

    def lower_inst(self, inst: Any) -> Any:
        """Lower a statement; one that fills an array with another one copies."""
        fills = isinstance(inst, numba_ir.StaticSetItem) and inst.index == slice(None)
        if fills and self._copied(inst.target.name, [], inst.value.name):
            return None
        return super().lower_inst(inst)

    def lower_setitem(self, target_var: Any, index_var: Any, value_var: Any, signature: Any) -> Any:
        """Write to an item, or copy an array to where leading indices point."""
        kind, given = self.typeof(target_var.name), self.typeof(value_var.name)
        indices = self._indices(kind, index_var)
        if indices is not None and len(indices) == kind.ndim and isinstance(given, types.Number | types.Boolean):
            value = self.context.cast(self.builder, self.loadvar(value_var.name), given, signature.args[2])
            value = self.context.cast(self.builder, value, signature.args[2], kind.dtype)
            place = self._view(target_var.name).place(self.builder, indices)
            return self.context.pack_value(self.builder, kind.dtype, value, place)
        if indices is not None and self._copied(target_var.name, indices, value_var.name):
            return None
        return super().lower_setitem(target_var, index_var, value_var, signature)

    def _copied(self, target: str, indices: list[Any], source: str) -> bool:
        """Copy an array to the part of another one that leading indices choose, if both are plain and of one type."""
        into, given = self.typeof(target), self.typeof(source)
        alike = is_plain(into) and is_plain(given) and into.dtype == given.dtype
        if not alike or given.ndim == 0 or given.ndim != into.ndim - len(indices):
            return False
        self._copy(self._view(source), self._view(target), indices)
        return True

    def _copy(self, source: View, target: View, indices: list[Any]) -> None:
        builder = self.builder
        place, size = target.place(builder, indices), source.item_size(self.context)
        for length, wanted in zip(source.lengths(), target.lengths()[len(indices) :], strict=True):
            other = builder.icmp_signed("!=", length, wanted)
            with builder.if_then(other, likely=False):
                self.return_exception(ValueError, ("an array is assigned to a part of another shape",), loc=self.loc)
            size = builder.mul(size, length)
        pointer = ir.IntType(8).as_pointer()
        move = builder.module.declare_intrinsic("llvm.memmove", [pointer, pointer, WORD])
        ends = [builder.bitcast(place, pointer), builder.bitcast(source.data, pointer)]
        builder.call(move, [*ends, size, ir.IntType(1)(0)])

    def _field(self, ty: Any, expr: Any) -> Any:
        """A field of a room, or the shape of an array; None for another attribute."""
        kind, name = self.typeof(expr.value.name), expr.attr
        if isinstance(kind, RoomType) and kind.of.get(name) == ty and isinstance(ty, types.Array):
            return view_of_field(self.context, self.builder, self.loadvar(expr.value.name), ty, kind.at[name])
        if name == "shape" and is_plain(kind):
            return self.context.make_tuple(self.builder, ty, self._view(expr.value.name).lengths())
        return None

    def _part(self, ty: Any, expr: Any) -> Any:
        """An item of an array, or a view of what leading indices choose; None for another expression."""
        if expr.op not in ("getitem", "static_getitem"):
            return None
        kind = self.typeof(expr.value.name)
        indices = self._indices(kind, expr.index)
        if indices is None:
            return None
        view = self._view(expr.value.name)
        if len(indices) == kind.ndim:
            item = self.context.unpack_value(self.builder, kind.dtype, view.place(self.builder, indices))
            return self.context.cast(self.builder, item, kind.dtype, ty)
        if not self._only_borrows and expr.value.name not in self._views:
            return None
        return view.part(self.builder, ty, indices)

    def _indices(self, kind: Any, index: Any) -> list[Any] | None:
        """Indices of leading axes as words; None where they are not all integers, or the array is not a plain one."""
        if not is_plain(kind):
            return None
        if isinstance(index, numba_ir.Var):
            found = self._words(index.name)
        else:
            given = index if isinstance(index, tuple) else (index,)
            whole = all(type(i) is int for i in given)
            found = [WORD(i) for i in given] if whole else None
        return found if found is not None and 0 < len(found) <= kind.ndim else None

    def _words(self, name: str) -> list[Any] | None:
        kind = self.typeof(name)
        if isinstance(kind, types.Integer):
            parts, kinds = [self.loadvar(name)], [kind]
        elif isinstance(kind, types.BaseTuple) and all(isinstance(part, types.Integer) for part in kind):
            value, kinds = self.loadvar(name), list(kind)
            parts = [self.builder.extract_value(value, i) for i in range(len(kinds))]
        else:
            return None
        if not all(part.signed for part in kinds):
            return None
        return [self.context.cast(self.builder, x, part, types.intp) for x, part in zip(parts, kinds, strict=True)]

    def _view(self, name: str) -> View:
        """The array of a name."""
        if name in self._views:
            return self._views[name]
        kind = self.typeof(name)
        if name in self._blk_local_varmap:
            value = self._blk_local_varmap[name]
            find = lambda *at: self.builder.extract_value(value, at)  # noqa: E731
        else:
            slot, number = self.getvar(name), ir.IntType(32)
            find = lambda *at: self.builder.load(self.builder.gep(slot, [number(i) for i in (0, *at)]))  # noqa: E731
        return view_of_array(self.context, kind, find)
