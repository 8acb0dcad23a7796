"""Straight-line kernels: assignments of float expressions, put into LLVM's form without numba's passes over Python.

Typing and lowering a law of seven hundred statements takes numba two seconds, LLVM a tenth of one.  A generated kernel
is one long row of assignments, so its text goes straight to LLVM: names are values, ``a if c else b`` is a select (both
sides are computed; division by zero follows IEEE 754), functions of ``math`` are those that numba takes.
"""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from fricmb.integrate.compile.series_call import write_series

_DOUBLE = ir.DoubleType()
#: Functions of ``math`` of one and two arguments, from numba's own library.
_ONE = (
    "acos", "acosh", "asin", "asinh", "atan", "atanh", "cos", "cosh", "erf", "erfc", "exp", "expm1", "gamma", "lgamma",
    "log", "log1p", "sin", "sinh", "sqrt", "tan", "tanh",
)  # fmt: skip
_TWO = ("atan2", "hypot")
_ROUNDED = {"floor": "llvm.floor", "ceil": "llvm.ceil"}
_BINARY: dict[type, str] = {ast.Add: "fadd", ast.Sub: "fsub", ast.Mult: "fmul", ast.Div: "fdiv"}
_COMPARED: dict[type, str] = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!="}
_FOLDED: dict[type, Callable[[float, float], float]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul,
}  # fmt: skip
_CALLS = {*_ONE, *_TWO, *_ROUNDED, "abs", "max", "min", "series"}
_NODES = (
    ast.Module, ast.Assign, ast.Name, ast.Load, ast.Store, ast.Subscript, ast.Constant, ast.BinOp, ast.UnaryOp,
    ast.USub, ast.UAdd, ast.Not, ast.Compare, ast.BoolOp, ast.And, ast.Or, ast.IfExp, ast.Call, ast.Pow,
    *_BINARY, *_COMPARED,
)  # fmt: skip
#: Whole powers up to this are products.
_LARGEST_POWER = 32


def is_straight(text: str) -> bool:
    """Whether every statement of a kernel is of the kind that :func:`straight` takes."""
    tree = ast.parse(text)
    for node in ast.walk(tree):
        if not isinstance(node, _NODES):
            return False
        if isinstance(node, ast.Call) and not (isinstance(node.func, ast.Name) and node.func.id in _CALLS):
            return False
        if isinstance(node, ast.Assign) and (len(node.targets) != 1 or isinstance(node.targets[0], ast.Tuple)):
            return False
        if isinstance(node, ast.Subscript) and not (isinstance(node.slice, ast.Constant)):
            return False
    return True


class _Writer:
    """LLVM instructions of the statements of one kernel."""

    def __init__(self, context: Any, builder: Any, pointers: dict[str, Any]) -> None:
        self._context, self._builder, self._pointers = context, builder, pointers
        self._values: dict[str, Any] = {}

    def write(self, text: str) -> None:
        """Every assignment in turn."""
        stores = []
        for statement in ast.parse(text).body:
            assert isinstance(statement, ast.Assign)
            target, value = statement.targets[0], self._value(statement.value)
            if isinstance(target, ast.Name):
                self._values[target.id] = value
            else:
                stores.append((self._place(target), value))
        for place, value in stores:  # arguments are read before anything is written
            self._builder.store(value, place)

    def _place(self, node: Any) -> Any:
        return self._builder.gep(self._pointers[node.value.id], [ir.Constant(ir.IntType(64), node.slice.value)])

    def _value(self, node: Any) -> Any:
        method: Any = getattr(self, f"_{type(node).__name__.lower()}")
        return method(node)

    def _name(self, node: ast.Name) -> Any:
        return self._values[node.id]

    def _constant(self, node: ast.Constant) -> Any:
        if isinstance(node.value, bool):
            return ir.Constant(ir.IntType(1), int(node.value))
        return _DOUBLE(float(node.value))  # type: ignore[arg-type]

    def _subscript(self, node: ast.Subscript) -> Any:
        return self._builder.load(self._place(node))

    def _unaryop(self, node: ast.UnaryOp) -> Any:
        value = self._value(node.operand)
        if isinstance(node.op, ast.Not):
            return self._builder.not_(value)
        return self._builder.fneg(value) if isinstance(node.op, ast.USub) else value

    def _binop(self, node: ast.BinOp) -> Any:
        if isinstance(node.op, ast.Pow):
            return self._power(self._value(node.left), node.right)
        left, right = self._value(node.left), self._value(node.right)
        return getattr(self._builder, _BINARY[type(node.op)])(left, right)

    def _power(self, base: Any, exponent: ast.expr) -> Any:
        whole = _number(exponent)
        if whole is not None and whole == int(whole) and 0 < whole <= _LARGEST_POWER:
            value = None
            for bit in bin(int(whole))[2:]:
                value = base if value is None else self._builder.fmul(value, value)
                if bit == "1" and value is not base:
                    value = self._builder.fmul(value, base)
            return value
        if whole == 0.5:
            return self._library("sqrt", [base])
        return self._intrinsic("llvm.pow", [base, self._value(exponent)])

    def _compare(self, node: ast.Compare) -> Any:
        found, left = None, self._value(node.left)
        for op, other in zip(node.ops, node.comparators, strict=True):
            right = self._value(other)
            compare = self._builder.fcmp_unordered if isinstance(op, ast.NotEq) else self._builder.fcmp_ordered
            holds = compare(_COMPARED[type(op)], left, right)
            found, left = holds if found is None else self._builder.and_(found, holds), right
        return found

    def _boolop(self, node: ast.BoolOp) -> Any:
        join = self._builder.and_ if isinstance(node.op, ast.And) else self._builder.or_
        found, *rest = [self._value(value) for value in node.values]
        for value in rest:
            found = join(found, value)
        return found

    def _ifexp(self, node: ast.IfExp) -> Any:
        return self._builder.select(self._value(node.test), self._value(node.body), self._value(node.orelse))

    def _call(self, node: ast.Call) -> Any:
        assert isinstance(node.func, ast.Name)
        name, parts = node.func.id, [self._value(arg) for arg in node.args]
        if name == "abs":
            return self._intrinsic("llvm.fabs", parts)
        if name == "series":
            return write_series(self._builder, *parts)
        if name in _ROUNDED:
            return self._intrinsic(_ROUNDED[name], parts)
        if name not in ("max", "min"):
            return self._library(name, parts)
        found, *rest = parts
        for part in rest:  # as Python: the first, unless a later one is beyond it
            beyond = self._builder.fcmp_ordered(">" if name == "max" else "<", part, found)
            found = self._builder.select(beyond, part, found)
        return found

    def _library(self, name: str, parts: list[Any]) -> Any:
        signature = types.float64(*[types.float64] * len(parts))
        return self._context.get_function(getattr(math, name), signature)(self._builder, parts)

    def _intrinsic(self, name: str, parts: list[Any]) -> Any:
        kind = ir.FunctionType(_DOUBLE, [_DOUBLE] * len(parts))
        return self._builder.call(self._builder.module.declare_intrinsic(name, (_DOUBLE,), kind), parts)


def _number(node: ast.expr) -> float | None:
    """Of a constant expression its value."""
    if isinstance(node, ast.Constant):
        return float(node.value)  # type: ignore[arg-type]
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
        value = _number(node.operand)
        return None if value is None else (-value if isinstance(node.op, ast.USub) else value)
    if isinstance(node, ast.BinOp) and type(node.op) in (*_FOLDED, ast.Div):
        left, right = _number(node.left), _number(node.right)
        if left is None or right is None:
            return None
        if isinstance(node.op, ast.Div):
            return left / right if right else None
        return _FOLDED[type(node.op)](left, right)
    return None


def straight(text: str) -> Any:
    """What a compiled kernel calls as ``statements(x, p, out)``: the assignments in ``text``.

    Parameters
    ----------
    text : str
        Lines of the form ``name = expression`` and ``out[i] = expression`` in floats, other names, ``x[i]``, ``p[i]``,
        ``+ - * / **``, comparisons, ``and or not``, ``a if c else b``, ``abs``, ``max``, ``min``, ``series``, ``math``.
    """

    def statements(typingctx: Any, x: Any, p: Any, out: Any) -> Any:
        def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            _Writer(context, builder, dict(zip(("x", "p", "out"), args, strict=True))).write(text)
            return context.get_dummy_value()

        return types.void(x, p, out), codegen

    return intrinsic(statements)
