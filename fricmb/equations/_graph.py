"""Expressions as a graph in which nothing stands twice, and derivatives of it by the chain rule, node by node.

SymPy's derivative of an expression is another expression, which is simplified, searched for what it has in common with
others and printed as a tree: that grows much faster than what was stated.  Here a derivative takes time in proportion
to the nodes it meets, can be differentiated again, and shares with all others what is the same.

A node is a number, a symbol, a sum (of a constant and nodes with factors), a product (of nodes with exponents), or one
of a few that are left as they are.  Equal bases in a product are put together and equal terms in a sum, as SymPy does:
what cancels in a formula is not there to be inf/inf in its kernel.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import sympy

from fricmb.equations import _code

#: The content of a node; its first entry tells what it is.
Content = tuple[Any, ...]
#: Functions whose derivative is 0 wherever they have one.
_FLAT = (sympy.sign, sympy.Heaviside, sympy.DiracDelta)


class Graph:
    """Nodes, known by their number: the parts of a node have smaller ones."""

    def __init__(self, title: str) -> None:
        self._title = title
        self.nodes: list[Content] = []
        self._handles: dict[int, Any] = {}
        self._found: dict[Content, int] = {}
        self._of: dict[Any, int] = {}

    def _node(self, *content: Any) -> int:
        if content not in self._found:
            self._found[content] = len(self.nodes)
            self.nodes.append(content)
        return self._found[content]

    # -- making nodes -------------------------------------------------------------------------------------------
    def number(self, value: float) -> int:
        """A number."""
        return self._node("number", float(value))

    def sum(self, terms: Iterable[tuple[int, float]], constant: float = 0.0) -> int:
        """``constant`` and nodes times factors."""
        held: dict[int, float] = {}
        left = list(terms)[::-1]
        while left:
            node, factor = left.pop()
            content = self.nodes[node]
            if content[0] == "number":
                constant += factor * content[1]
            elif content[0] == "sum":
                constant += factor * content[1]
                left += [(part, factor * own) for part, own in reversed(content[2])]
            else:
                held[node] = held.get(node, 0.0) + factor
        kept = tuple((node, factor) for node, factor in held.items() if factor)
        if not kept:
            return self.number(constant)
        if not constant and len(kept) == 1 and kept[0][1] == 1.0:
            return kept[0][0]
        return self._node("sum", constant, tuple(sorted(kept)))

    def product(self, factors: Iterable[tuple[int, float]]) -> int:
        """Nodes to powers, all multiplied."""
        coefficient, held = 1.0, dict[int, float]()
        left = list(factors)[::-1]
        while left:
            node, exponent = left.pop()
            content, whole = self.nodes[node], exponent == int(exponent)
            if content[0] == "number" and (content[1] > 0.0 or (whole and (content[1] or exponent > 0.0))):
                coefficient *= content[1] ** (int(exponent) if whole else exponent)
            elif content[0] == "product" and whole:
                left += [(part, power * exponent) for part, power in reversed(content[1])]
            elif content[0] == "sum" and whole and not content[1] and len(content[2]) == 1:
                ((part, own),) = content[2]
                coefficient *= own ** int(exponent)
                left.append((part, exponent))
            else:
                held[node] = held.get(node, 0.0) + exponent
        kept = tuple(sorted((node, exponent) for node, exponent in held.items() if exponent))
        if not kept or not coefficient:
            return self.number(coefficient)
        core = kept[0][0] if len(kept) == 1 and kept[0][1] == 1.0 else self._node("product", kept)
        return core if coefficient == 1.0 else self._node("sum", 0.0, ((core, coefficient),))

    def dot(self, one: Sequence[int], other: Sequence[int]) -> int:
        """The sum of the products."""
        return self.sum([(self.product([(a, 1.0), (b, 1.0)]), 1.0) for a, b in zip(one, other, strict=True)])

    def choice(self, condition: int, yes: int, no: int) -> int:
        """``yes`` where the condition holds, else ``no``."""
        known = self.nodes[condition][0]
        if yes == no or known in ("true", "false"):
            return no if known == "false" else yes
        return self._node("choice", condition, yes, no)

    # -- from SymPy ---------------------------------------------------------------------------------------------
    def of(self, expression: Any) -> int:
        """The node of an expression."""
        if expression not in self._of:
            self._of[expression] = self._make(sympy.sympify(expression))
        return self._of[expression]

    def _make(self, e: Any) -> int:
        if e.is_Symbol:
            return self._node("symbol", e)
        if e is sympy.nan:
            return self._node("nowhere")
        if e.is_number:
            return self.number(float(e))
        if e.is_Add:
            return self.sum([(self.of(arg), 1.0) for arg in e.args])
        if e.is_Mul:
            return self.product([(self.of(arg), 1.0) for arg in e.args])
        if e.is_Pow:
            return self._power(self.of(e.base), self.of(e.exp))
        if isinstance(e, sympy.Max | sympy.Min):
            return self._extreme([self.of(arg) for arg in e.args], ">" if isinstance(e, sympy.Max) else "<")
        if isinstance(e, sympy.Piecewise):
            found = self._node("nowhere")
            for value, condition in reversed(e.args):
                found = self.choice(self._condition(condition), self.of(value), found)
            return found
        return self._node("function", e.func, tuple(self.of(arg) for arg in e.args))

    def _power(self, base: int, exponent: int) -> int:
        content = self.nodes[exponent]
        return self.product([(base, content[1])]) if content[0] == "number" else self._node("power", base, exponent)

    def _extreme(self, parts: Sequence[int], sign: str) -> int:
        found, *rest = parts
        for other in rest:
            found = self.choice(self._node("compare", sign, found, other), found, other)
        return found

    def _condition(self, condition: Any) -> int:
        if condition in (sympy.true, sympy.false):
            return self._node(str(bool(condition)).lower())
        if isinstance(condition, sympy.core.relational.Relational):
            return self._node("compare", condition.rel_op, self.of(condition.lhs), self.of(condition.rhs))
        if isinstance(condition, sympy.And | sympy.Or | sympy.Not):
            name = type(condition).__name__.lower()
            return self._node(name, tuple(self._condition(arg) for arg in condition.args))
        return self._condition(condition.to_nnf())

    # -- looking at nodes ---------------------------------------------------------------------------------------
    def parts(self, node: int) -> tuple[int, ...]:
        """The nodes that a node is made of."""
        kind, *content = self.nodes[node]
        if kind in ("number", "symbol", "nowhere", "true", "false"):
            return ()
        if kind in ("sum", "product"):
            return tuple(part for part, _ in content[-1])
        if kind in ("function", "and", "or", "not"):
            return tuple(content[-1])
        return tuple(content[1:] if kind == "compare" else content)

    def below(self, outputs: Iterable[int]) -> list[int]:
        """All nodes that these are made of, and they themselves: parts first, and not long before they are needed."""
        found, seen = list[int](), set[int]()
        left = [(node, False) for node in reversed(list(outputs))]
        while left:
            node, ready = left.pop()
            if ready:
                found.append(node)
            elif node not in seen:
                seen.add(node)
                left += [(node, True), *((part, False) for part in reversed(self.parts(node)))]
        return found

    def symbols(self, outputs: Iterable[int]) -> set[Any]:
        """The symbols that these depend on."""
        return {self.nodes[node][1] for node in self.below(outputs) if self.nodes[node][0] == "symbol"}

    # -- derivatives --------------------------------------------------------------------------------------------
    def gradients(self, outputs: Sequence[int], arguments: Sequence[Any]) -> list[list[int]]:
        """Derivatives of each output by each argument."""
        zero, one = self.number(0.0), self.number(1.0)
        slopes: dict[int, dict[int, int]] = {}
        for place, symbol in enumerate(arguments):
            slopes[self.of(symbol)] = {place: one}
        for node in self.below(outputs):
            if node not in slopes and (found := self._slopes(node, slopes)):
                slopes[node] = found
        return [[slopes.get(node, {}).get(place, zero) for place in range(len(arguments))] for node in outputs]

    def _slopes(self, node: int, slopes: dict[int, dict[int, int]]) -> dict[int, int]:
        content = self.nodes[node]
        if content[0] == "choice":
            (condition, yes, no), zero = content[1:], self.number(0.0)
            one, other = slopes.get(yes, {}), slopes.get(no, {})
            places = sorted(one.keys() | other.keys())
            return {a: self.choice(condition, one.get(a, zero), other.get(a, zero)) for a in places}
        moving = [part for part in self.parts(node) if part in slopes]
        terms: dict[int, list[tuple[int, float]]] = {}
        for part in dict.fromkeys(moving):
            partial, factor = self._partial(node, part)
            for place, slope in slopes[part].items():
                terms.setdefault(place, []).append((self.product([(partial, 1.0), (slope, 1.0)]), factor))
        return {place: found for place, held in terms.items() if self.nodes[found := self.sum(held)] != ("number", 0.0)}

    def _partial(self, node: int, part: int) -> tuple[int, float]:
        """Derivative of a node by one of its parts, and a factor before it."""
        kind, *content = self.nodes[node]
        if kind == "sum":
            return self.number(1.0), dict(content[1])[part]
        if kind == "product":
            exponent = dict(content[0])[part]
            rest = [(other, power - (other == part)) for other, power in content[0]]
            return self.product(rest), exponent
        if kind == "power":
            base, exponent = content
            by_base = self.product([(exponent, 1.0), (self._power(base, self.sum([(exponent, 1.0)], -1.0)), 1.0)])
            by_exponent = self.product([(node, 1.0), (self._node("function", sympy.log, (base,)), 1.0)])
            if base == exponent:
                return self.sum([(by_base, 1.0), (by_exponent, 1.0)]), 1.0
            return (by_base if part == base else by_exponent), 1.0
        if kind == "function" and content[0] not in _FLAT:
            found = [self._slope(content[0], content[1], i) for i, arg in enumerate(content[1]) if arg == part]
            return self.sum([(slope, 1.0) for slope in found]), 1.0
        return self.number(0.0), 1.0

    def _slope(self, function: Any, arguments: tuple[int, ...], place: int) -> int:
        """Derivative of a function by one of its arguments, as SymPy knows it."""
        symbols = [self._handle(node) for node in arguments]
        slope = sympy.diff(function(*symbols), symbols[place])
        _code.check(slope, self._title)
        return self.of(slope)

    def _handle(self, node: int) -> Any:
        """A symbol that stands for a node."""
        if node not in self._handles:
            self._handles[node] = sympy.Dummy(real=True)
            self._of[self._handles[node]] = node
        return self._handles[node]
