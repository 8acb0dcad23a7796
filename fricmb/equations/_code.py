"""From SymPy expressions to the source of a compiled kernel: common subexpressions, roots that stay finite at 0."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy
from sympy.printing.pycode import PythonCodePrinter

from fricmb.errors import SceneError
from fricmb.signal._symbols import Series

#: Norms and absolute values never fall below this in a kernel: v/|v| is 0 at v = 0 and |v|**5 does not underflow.
FLOOR = 1e-60

_FUNCTIONS = (
    "acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "ceil", "cos", "cosh", "erf", "erfc", "exp", "expm1",
    "floor", "gamma", "hypot", "isfinite", "lgamma", "log", "log1p", "sin", "sinh", "sqrt", "tan", "tanh",
)  # fmt: skip
_KNOWN = (
    sympy.acos, sympy.acosh, sympy.asin, sympy.asinh, sympy.atan, sympy.atan2, sympy.atanh, sympy.ceiling, sympy.cos,
    sympy.cosh, sympy.erf, sympy.erfc, sympy.exp, sympy.floor, sympy.gamma, sympy.loggamma, sympy.log, sympy.sin,
    sympy.sinh, sympy.tan, sympy.tanh, sympy.Abs, sympy.sign, sympy.Heaviside, sympy.DiracDelta, sympy.Max, sympy.Min,
    sympy.Mod, sympy.Piecewise, Series,
)  # fmt: skip


#: Pieces that follow one another in a chain; more of them are halved.
CHAIN = 24
#: The value of a Piecewise where none of its conditions holds: no number, as in SymPy.
NOWHERE = "(1e308*10.0 - 1e308*10.0)"


class _Printer(PythonCodePrinter):  # type: ignore[misc]
    """Scalar Python that numba compiles; only the chosen branch of a Piecewise counts."""

    def __init__(self) -> None:
        super().__init__({"fully_qualified_modules": False, "precision": 17})

    def _print_Rational(self, expr: Any) -> str:
        return f"({expr.p}.0/{expr.q}.0)"

    def _print_Integer(self, expr: Any) -> str:
        return f"{int(expr)}.0" if abs(int(expr)) > 2**31 else str(int(expr))

    def _print_Pow(self, expr: Any, **options: Any) -> str:
        # numba's integer powers raise on 0**-n, a division follows IEEE 754
        if expr.exp.is_Integer and expr.exp < 0:
            return f"(1.0/({self._print(expr.base**-expr.exp)}))"
        return str(super()._print_Pow(expr, **options))

    def _print_Pi(self, expr: Any) -> str:
        return repr(float(sympy.pi))

    def _print_Exp1(self, expr: Any) -> str:
        return repr(float(sympy.E))

    def _print_sign(self, expr: Any) -> str:
        text = self._print(expr.args[0])
        return f"(1.0 if ({text}) > 0.0 else (-1.0 if ({text}) < 0.0 else 0.0))"

    def _print_Heaviside(self, expr: Any) -> str:
        return f"(1.0 if ({self._print(expr.args[0])}) >= 0.0 else 0.0)"

    def _print_DiracDelta(self, expr: Any) -> str:
        return "0.0"

    def _print_Max(self, expr: Any) -> str:
        return "max(" + ", ".join(f"1.0*({self._print(arg)})" for arg in expr.args) + ")"

    def _print_Min(self, expr: Any) -> str:
        return "min(" + ", ".join(f"1.0*({self._print(arg)})" for arg in expr.args) + ")"

    def _print_Series(self, expr: Any) -> str:
        x, table, order = (self._print(arg) for arg in expr.args)
        return f"series(1.0*({x}), {table}, {order})"

    def _print_loggamma(self, expr: Any) -> str:
        return f"lgamma({self._print(expr.args[0])})"

    def _print_Piecewise(self, expr: Any) -> str:
        if len(expr.args) > CHAIN:
            return self._halved(expr.args, certain=False)
        text = NOWHERE
        for value, condition in reversed(expr.args):
            value_text = f"1.0*({self._print(value)})"
            text = value_text if condition == sympy.true else f"({value_text} if {self._print(condition)} else {text})"
        return text

    def _halved(self, pieces: Sequence[Any], *, certain: bool) -> str:
        """The same of many pieces, a measured record, say: halves of halves, for Python reads no chain of hundreds.

        ``certain``: whether one of the conditions holds.
        """
        if len(pieces) == 1:
            value, condition = pieces[0]
            text = f"1.0*({self._print(value)})"
            sure = certain or condition == sympy.true
            return text if sure else f"({text} if {self._print(condition)} else {NOWHERE})"
        middle = len(pieces) // 2
        first = " or ".join(f"({self._print(condition)})" for _, condition in pieces[:middle])
        one, other = self._halved(pieces[:middle], certain=True), self._halved(pieces[middle:], certain=certain)
        return f"({one} if {first} else {other})"


_PRINTER = _Printer()


def source(expression: Any) -> str:
    """One expression as Python source."""
    return str(_PRINTER.doprint(sympy.sympify(expression)))


def check(expression: Any, what: str) -> None:
    """Refuse what no kernel can compute: unknown functions, integrals without closed form, complex numbers."""
    for node in sympy.preorder_traversal(expression):
        if isinstance(node, sympy.Function) and not isinstance(node, _KNOWN):
            raise SceneError(f"{what}: the function {node.func}({', '.join(map(str, node.args))}) cannot be compiled")
        if isinstance(node, sympy.Integral | sympy.Sum | sympy.Derivative | sympy.Limit | sympy.Subs):
            raise SceneError(f"{what}: {node} has no closed form")
        if node in (sympy.I, sympy.nan, sympy.zoo, sympy.oo, -sympy.oo):
            raise SceneError(f"{what}: {expression} is not a finite real expression ({node})")


def _is_guarded(base: Any) -> bool:
    """Whether a sum of squares holds the tiny constant that keeps a norm differentiable at 0."""
    return bool(base.is_Add and any(term.is_Float and 0 < term < 1e-150 for term in base.args))


def _tame(expressions: Sequence[Any]) -> tuple[list[Any], list[tuple[Any, Any]]]:
    """Replace roots and absolute values by symbols that are floored; innermost first."""
    roots: list[tuple[Any, Any]] = []

    def even_root(node: Any) -> bool:
        if isinstance(node, sympy.Abs):
            return not node.args[0].is_number
        if not (node.is_Pow and node.exp.is_Rational) or node.base.is_number:
            return False
        return bool(node.exp.q == 2 or _is_guarded(node.base))

    current = [sympy.sympify(e) for e in expressions]
    while True:
        found = {node for e in current for node in sympy.preorder_traversal(e) if even_root(node)}
        inner = sorted(
            (n for n in found if not any(even_root(m) for m in sympy.preorder_traversal(n.args[0]))),
            key=sympy.default_sort_key,
        )
        if not inner:
            return current, roots
        replacement: dict[Any, Any] = {}
        symbols: dict[Any, Any] = {}
        for node in inner:
            argument = node.args[0]
            base = node if isinstance(node, sympy.Abs) else sympy.sqrt(argument)
            if base not in symbols:
                symbols[base] = sympy.Symbol(f"s{len(roots)}", positive=True)
                roots.append((symbols[base], base))
            power = 1 if isinstance(node, sympy.Abs) else 2 * node.exp
            replacement[node] = symbols[base] ** power
        current = [e.xreplace(replacement) for e in current]


def _root(base: Any) -> str:
    if isinstance(base, sympy.Abs):
        return f"abs({source(base.args[0])})"
    radicand = base.args[0]
    # the guard of a norm is far below the floor that a kernel gives every root
    terms = [t for t in sympy.Add.make_args(radicand) if not (_is_guarded(radicand) and t.is_Float)]
    if terms and all(term.is_Pow and term.exp == 2 for term in terms):
        text = f"abs({source(terms[0].base)})"
        for term in terms[1:]:
            text = f"hypot({text}, {source(term.base)})"
        return text
    return f"sqrt({source(radicand)})"


def body(expressions: Sequence[Any], names: Sequence[str]) -> list[str]:
    """Statements that assign every expression to the name beside it."""
    tamed, roots = _tame(expressions)
    lines = [f"{symbol} = max({_root(base)}, {FLOOR!r})" for symbol, base in roots]
    shared, reduced = sympy.cse(tamed, symbols=sympy.numbered_symbols("c", cls=sympy.Dummy), order="none")
    plain = {symbol: sympy.Symbol(f"c{i}", real=True) for i, (symbol, _) in enumerate(shared)}
    for symbol, value in shared:
        lines.append(f"{plain[symbol]} = {source(value.xreplace(plain))}")
    for name, value in zip(names, reduced, strict=True):
        lines.append(f"{name} = {source(value.xreplace(plain))}")
    return lines


def kernel(arguments: Sequence[Any], parameters: Sequence[Any], outputs: Sequence[Any], title: str) -> str:
    """Source of a module with ``kernel(x, p, out)``: ``out[i] = outputs[i]``."""
    rename, lines = read_arguments(arguments, parameters, outputs)
    names = [f"out[{i}]" for i in range(len(outputs))]
    lines += body([sympy.sympify(e).xreplace(rename) for e in outputs], names)
    return module(title, lines)


def read_arguments(
    arguments: Sequence[Any], parameters: Sequence[Any], outputs: Sequence[Any]
) -> tuple[dict[Any, Any], list[str]]:
    """Plain symbols for arguments and parameters, and the statements that read those in use."""
    used: set[Any] = set().union(*(sympy.sympify(e).free_symbols for e in outputs))
    rename: dict[Any, Any] = {}
    lines: list[str] = []
    for letter, symbols in (("x", arguments), ("p", parameters)):
        for i, symbol in enumerate(symbols):
            rename[symbol] = sympy.Symbol(f"{letter}{i}", real=True)
            if symbol in used:
                lines.append(f"{letter}{i} = {letter}[{i}]")
    left = used - set(rename)
    if left:
        raise SceneError(f"undefined symbols in a derived expression: {', '.join(sorted(map(str, left)))}")
    return rename, lines


def module(title: str, lines: Sequence[str]) -> str:
    """A generated module around the statements of its kernel."""
    from fricmb.integrate.compile.straight_line_codegen import is_straight

    head = f'"""{title}: derived by fricmb, do not edit."""\n\n'
    statements = "\n".join(lines)
    if lines and is_straight(statements):
        return (
            f"{head}from fricmb.integrate.compile.template import template\n"
            "from fricmb.integrate.compile.straight_line_codegen import straight\n\n"
            f'statements = straight("""\n{statements}\n""")\n\n\n'
            "@template\ndef kernel(x, p, out):\n    statements(x, p, out)\n"
        )
    text = "\n    ".join(lines) or "pass"
    used = [f for f in _FUNCTIONS if any(f"{f}(" in line for line in lines)]
    imports = f"from math import {', '.join(used)}\n\n" if used else ""
    if any("series(" in line for line in lines):
        imports += "from fricmb.integrate.compile.series_call import series\n"
    return (
        f"{head}{imports}"
        f"from fricmb.integrate.compile.template import template\n\n\n@template\ndef kernel(x, p, out):\n    {text}\n"
    )
