"""Values and Jacobians by the chain rule: every node of an expression becomes one statement, then its derivatives.

Differentiating node by node takes time in proportion to the expression, where SymPy's derivative of a product of
branches (Max, Piecewise) grows much faster; and it computes no subexpression twice.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

import sympy

from fricmb.equations._code import FLOOR, NOWHERE, source
from fricmb.laws._numeric import squares

#: Functions of one argument: the derivative, of the argument x and the value y.
_SLOPES = {
    sympy.exp: "{y}", sympy.log: "1.0/{x}", sympy.tanh: "1.0 - {y}*{y}", sympy.sin: "cos({x})",
    sympy.cos: "-sin({x})", sympy.atan: "1.0/(1.0 + {x}*{x})", sympy.sinh: "cosh({x})", sympy.cosh: "sinh({x})",
    sympy.asinh: "1.0/hypot(1.0, {x})", sympy.tan: "1.0 + {y}*{y}",
}  # fmt: skip
_FLAT = (sympy.sign, sympy.Heaviside, sympy.floor, sympy.ceiling, sympy.DiracDelta)


class Tape:
    """Statements for values and for their derivatives with respect to the arguments.

    ``names``: what symbols are called in the statements (to replace them in an expression would have SymPy look at
    every Max and Min of it again).
    """

    def __init__(self, arguments: Sequence[Any], names: Mapping[Any, Any] = MappingProxyType({})) -> None:
        self.lines: list[str] = []
        self._names: dict[Any, str] = {symbol: str(name) for symbol, name in names.items()}
        called = [str(names.get(symbol, symbol)) for symbol in arguments]
        self._slopes: dict[str, dict[int, str]] = {name: {i: "1.0"} for i, name in enumerate(called)}

    def outputs(self, expressions: Sequence[Any], n: int) -> list[str]:
        """Statements that put values, then derivatives row by row, into ``out``."""
        names = [self.value(expression) for expression in expressions]
        stores = [f"out[{i}] = {name}" for i, name in enumerate(names)]
        for i, name in enumerate(names):
            slopes = self._slopes.get(name, {})
            stores += [f"out[{len(names) + i * n + a}] = {slopes.get(a, '0.0')}" for a in range(n)]
        return self.lines + stores

    def value(self, node: Any) -> str:
        """Name of the value of an expression."""
        if node not in self._names:
            self._names[node] = self._make(sympy.sympify(node))
        return self._names[node]

    # -- statements ---------------------------------------------------------------------------------------------
    def _store(self, text: str, partials: Sequence[tuple[str, str]]) -> str:
        """A value, and its derivatives from those of its parts: (part, derivative by it)."""
        name = f"y{len(self._names)}_{len(self.lines)}"
        self.lines.append(f"{name} = {text}")
        terms: dict[int, list[str]] = {}
        for part, partial in partials:
            slopes = self._slopes.get(part, {})
            if len(slopes) > 1 and not partial.replace(".", "").replace("_", "").isalnum():
                held = f"h{len(self.lines)}"
                self.lines.append(f"{held} = {partial}")
                partial = held
            for a, slope in slopes.items():
                terms.setdefault(a, []).append(partial if slope == "1.0" else f"({partial})*{slope}")
        self._keep(name, {a: " + ".join(held) for a, held in terms.items()})
        return name

    def _keep(self, name: str, slopes: dict[int, str]) -> None:
        held = {}
        for a, text in slopes.items():
            held[a] = f"{name}_d{a}"
            self.lines.append(f"{held[a]} = {text}")
        if held:
            self._slopes[name] = held

    # -- nodes --------------------------------------------------------------------------------------------------
    def _make(self, node: Any) -> str:
        if node.is_Symbol:
            return str(node)
        if node.is_number:
            return f"({float(node)!r})"
        if node.is_Add:
            parts = [self.value(arg) for arg in node.args]
            return self._store(" + ".join(parts), [(part, "1.0") for part in parts])
        if node.is_Mul:
            return self._product([self.value(arg) for arg in node.args])
        if node.is_Pow:
            return self._power(node)
        if isinstance(node, sympy.Abs):
            part = self.value(node.args[0])
            return self._store(f"max(abs({part}), {FLOOR!r})", [(part, f"(1.0 if {part} > 0.0 else -1.0)")])
        if isinstance(node, sympy.Max | sympy.Min):
            return self._extreme(node)
        if isinstance(node, sympy.Piecewise):
            return self._branches(node)
        if isinstance(node, _FLAT):
            symbol = sympy.Symbol(self.value(node.args[0]), real=True)
            return self._store(source(node.func(symbol, *node.args[1:])), [])
        return self._function(node)

    def _product(self, parts: list[str]) -> str:
        partials = []
        for i, part in enumerate(parts):
            others = [other for j, other in enumerate(parts) if j != i]
            partials.append((part, "*".join(others)))
        return self._store("*".join(parts), partials)

    def _power(self, node: Any) -> str:
        base, exponent = node.args
        vector = squares(base)
        if vector is not None or (exponent.is_Rational and exponent.q == 2):
            root = self._length(vector) if vector is not None else self._root(base)
            return self._to_power(root, 2 * exponent)
        return self._to_power(self.value(base), exponent)

    def _to_power(self, base: str, exponent: Any) -> str:
        if exponent == 1:
            return base
        if exponent.is_Integer and abs(exponent) <= 4:
            count = abs(int(exponent))
            text = "*".join([base] * count)
            if exponent > 0:
                return self._store(text, [(base, f"{count}.0*" + "*".join([base] * (count - 1)))])
            inverse = self._store(f"1.0/({text})", [])
            self._keep(inverse, {a: f"-{count}.0*{inverse}/{base}*{d}" for a, d in self._slopes.get(base, {}).items()})
            return inverse
        power = self.value(exponent)
        partials = [(base, f"{power}*{base}**({power} - 1.0)")]
        if self._slopes.get(power):
            partials.append((power, f"{base}**{power}*log({base})"))
        return self._store(f"{base}**{power}", partials)

    def _length(self, vector: list[Any]) -> str:
        """Length of a vector, not below the floor; its derivative by a component is a quotient <= 1."""
        parts = [self.value(component) for component in vector]
        text = f"abs({parts[0]})"
        for part in parts[1:]:
            text = f"hypot({text}, {part})"
        root = self._store(f"max({text}, {FLOOR!r})", [])
        slopes: dict[int, list[str]] = {}
        for part in parts:
            for a, slope in self._slopes.get(part, {}).items():
                slopes.setdefault(a, []).append(f"{part}/{root}" + ("" if slope == "1.0" else f"*{slope}"))
        self._keep(root, {a: " + ".join(held) for a, held in slopes.items()})
        return root

    def _root(self, base: Any) -> str:
        part = self.value(base)
        root = self._store(f"max(sqrt({part}), {FLOOR!r})", [])
        self._keep(root, {a: f"0.5/{root}*{slope}" for a, slope in self._slopes.get(part, {}).items()})
        return root

    def _extreme(self, node: Any) -> str:
        """Max and Min of several, two by two; the derivative is that of the one taken."""
        sign = ">" if isinstance(node, sympy.Max) else "<"
        found, *rest = [self.value(arg) for arg in node.args]
        for other in rest:
            found = self._choice(f"{found} {sign} {other}", found, other)
        return found

    def _branches(self, node: Any) -> str:
        values = [(self.value(value), condition) for value, condition in node.args]
        whole = values[-1][1] == sympy.true
        found = values[-1][0] if whole else NOWHERE
        for value, condition in reversed(values[:-1] if whole else values):
            found = self._choice(self._condition(condition), value, found)
        return found

    def _choice(self, condition: str, yes: str, no: str) -> str:
        test = f"b{len(self.lines)}"
        self.lines.append(f"{test} = {condition}")
        name = self._store(f"{yes} if {test} else {no}", [])
        first, second = self._slopes.get(yes, {}), self._slopes.get(no, {})
        keys = sorted(first.keys() | second.keys())
        self._keep(name, {a: f"{first.get(a, '0.0')} if {test} else {second.get(a, '0.0')}" for a in keys})
        return name

    def _condition(self, condition: Any) -> str:
        if isinstance(condition, sympy.And | sympy.Or):
            word = " and " if isinstance(condition, sympy.And) else " or "
            return word.join(f"({self._condition(arg)})" for arg in condition.args)
        if isinstance(condition, sympy.Not):
            return f"not ({self._condition(condition.args[0])})"
        if condition in (sympy.true, sympy.false):
            return str(bool(condition))
        return f"{self.value(condition.lhs)} {condition.rel_op} {self.value(condition.rhs)}"

    def _function(self, node: Any) -> str:
        parts = [self.value(arg) for arg in node.args]
        held = zip(parts, node.args, strict=True)
        symbols = [sympy.Symbol(part, real=True) if part.isidentifier() else arg for part, arg in held]
        plain = node.func(*symbols)
        name = self._store(source(plain), [])
        slopes: dict[int, list[str]] = {}
        for part, symbol in zip(parts, symbols, strict=True):
            if not self._slopes.get(part):
                continue
            known = _SLOPES.get(node.func)
            text = known.format(x=part, y=name) if known else source(sympy.diff(plain, symbol))
            for a, slope in self._slopes[part].items():
                slopes.setdefault(a, []).append(f"({text})*{slope}")
        self._keep(name, {a: " + ".join(held) for a, held in slopes.items()})
        return name
