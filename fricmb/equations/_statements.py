"""The statements of a kernel from the nodes of a graph: what is used more than once has a name."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

import sympy

from fricmb.equations import _code
from fricmb.equations._graph import Graph
from fricmb.equations._sharing import Sharing
from fricmb.errors import SceneError

#: How tightly a text holds together: a name or a call, a product, anything else.
_ATOM, _PRODUCT, _SUM = range(3)
#: What is used once stands where it is used, up to this length.
_LONGEST = 400


def kernel(
    graph: Graph, arguments: Sequence[Any], parameters: Sequence[Any], outputs: Sequence[int], title: str
) -> str:
    """Source of a module with ``kernel(x, p, out)``: ``out[i] = outputs[i]``."""
    names = {symbol: f"x{i}" for i, symbol in enumerate(arguments)}
    names |= {symbol: f"p{i}" for i, symbol in enumerate(parameters)}
    used = graph.symbols(outputs)
    if not used <= names.keys():
        left = ", ".join(sorted(map(str, used - names.keys())))
        raise SceneError(f"undefined symbols in a derived expression: {left}")
    reads = [f"{name} = {name[0]}[{name[1:]}]" for symbol, name in names.items() if symbol in used]
    return _code.module(title, [*reads, *_Writer(graph, names).outputs(outputs)])


class _Writer:
    """Texts of nodes, parts before what they are parts of."""

    def __init__(self, graph: Graph, names: dict[Any, str]) -> None:
        self._graph, self._names = graph, names
        self._texts: dict[int, tuple[str, int]] = {}
        self._roots: dict[int, str] = {}
        self._held: dict[int, tuple[str, bool]] = {}
        self._lines: list[str] = []

    def outputs(self, outputs: Sequence[int]) -> list[str]:
        """Statements that put nodes into ``out``."""
        nodes = self._graph.below(outputs)
        self._share([node for node in nodes if self._graph.nodes[node][0] == "product"])
        uses = Counter(outputs)
        for node in nodes:
            uses.update(self._graph.parts(node))
        for node in nodes:
            text, hold = getattr(self, f"_{self._graph.nodes[node][0]}")(node)
            if text.isidentifier():
                hold = _ATOM
            elif hold != _ATOM and (uses[node] > 1 or len(text) > _LONGEST):
                text, hold = self._named("c", text), _ATOM
            self._texts[node] = text, hold
        return [*self._lines, *(f"out[{i}] = {self._texts[node][0]}" for i, node in enumerate(outputs))]

    def _named(self, letter: str, text: str) -> str:
        name = f"{letter}{len(self._lines)}"
        self._lines.append(f"{name} = {text}")
        return name

    def _text(self, node: int, most: int = _ATOM) -> str:
        text, hold = self._texts[node]
        return text if hold <= most else f"({text})"

    # -- kinds of nodes -----------------------------------------------------------------------------------------
    def _number(self, node: int) -> tuple[str, int]:
        value = self._graph.nodes[node][1]
        return (repr(value) if value >= 0.0 else f"({value!r})"), _ATOM

    def _symbol(self, node: int) -> tuple[str, int]:
        return self._names[self._graph.nodes[node][1]], _ATOM

    def _nowhere(self, _: int) -> tuple[str, int]:
        return _code.NOWHERE, _ATOM

    def _true(self, _: int) -> tuple[str, int]:
        return "True", _ATOM

    def _false(self, _: int) -> tuple[str, int]:
        return "False", _ATOM

    def _sum(self, node: int) -> tuple[str, int]:
        _, constant, terms = self._graph.nodes[node]
        text = ""
        for part, factor in terms:
            held = self._text(part, _PRODUCT)
            held = held if abs(factor) == 1.0 else f"{abs(factor)!r}*{held}"
            text += (" - " if factor < 0.0 else " + ") + held
        if constant:
            text += f" {'-' if constant < 0.0 else '+'} {abs(constant)!r}"
        alone = len(terms) == 1 and not constant
        return text[3:] if text.startswith(" + ") else f"-{text[3:]}", _PRODUCT if alone else _SUM

    def _share(self, products: Sequence[int]) -> None:
        """Find what products have in common, and how often each factor is used."""
        self._shared = Sharing(self._graph.nodes[node][1] for node in products)
        self._rows = dict(zip(products, map(sorted, self._shared.rows), strict=True))
        self._uses = Counter(place for row in [*self._shared.rows, *self._shared.pairs] for place in row)

    def _product(self, node: int) -> tuple[str, int]:
        return self._quotient([self._factor(place) for place in self._rows[node]]), _PRODUCT

    def _quotient(self, factors: Sequence[tuple[str, bool]]) -> str:
        above = "*".join(text for text, divides in factors if not divides) or "1.0"
        below = [text for text, divides in factors if divides]
        return above if not below else f"{above}/{below[0]}" if len(below) == 1 else f"{above}/({'*'.join(below)})"

    def _factor(self, place: int) -> tuple[str, bool]:
        """Text of a factor, and whether it divides."""
        if place not in self._held:
            behind = place - len(self._shared.given)
            if behind < 0:
                self._held[place] = self._given(place)
            else:
                text = self._quotient([self._factor(part) for part in self._shared.pairs[behind]])
                self._held[place] = self._named("c", text), False
        return self._held[place]

    def _given(self, place: int) -> tuple[str, bool]:
        """The same of a node and its exponent; a power that is used more than once has a name."""
        text, power = self._base(*self._shared.given[place])
        size = abs(power)
        if size != 1.0:
            text += f"**{int(size) if size == int(size) else size!r}"
        if self._uses[place] > 1 and power != 1.0:
            return self._named("c", self._quotient([(text, power < 0.0)])), False
        return text, power < 0.0

    def _base(self, base: int, exponent: float) -> tuple[str, float]:
        """What is raised to which power: roots are floored, and raised to whole ones."""
        guarded, twice = _is_guarded(self._graph.nodes[base]), 2.0 * exponent
        if exponent == 1.0 or not (guarded or (twice == int(twice) and twice % 2.0)):
            return self._text(base), exponent
        if base not in self._roots:
            self._roots[base] = self._named("s", f"max({self._root(base)}, {_code.FLOOR!r})")
        return self._roots[base], twice

    def _root(self, base: int) -> str:
        """Square root; of a sum of squares the length, which neither overflows nor underflows."""
        content = self._graph.nodes[base]
        if content[0] == "sum" and (not content[1] or _is_guarded(content)):
            squares = [self._square(part) for part, factor in content[2] if factor == 1.0]
            if len(squares) == len(content[2]) and all(squares):
                text = f"abs({squares[0]})"
                for square in squares[1:]:
                    text = f"hypot({text}, {square})"
                return text
        return f"sqrt({self._text(base, _SUM)})"

    def _square(self, node: int) -> str | None:
        """The base of a square."""
        content = self._graph.nodes[node]
        if content[0] != "product" or len(content[1]) != 1 or content[1][0][1] != 2.0:
            return None
        return self._text(content[1][0][0], _SUM)

    def _power(self, node: int) -> tuple[str, int]:
        _, base, exponent = self._graph.nodes[node]
        return f"{self._text(base)}**{self._text(exponent)}", _PRODUCT

    def _choice(self, node: int) -> tuple[str, int]:
        _, condition, yes, no = self._graph.nodes[node]
        return f"{self._text(yes)} if {self._text(condition)} else {self._text(no)}", _SUM

    def _compare(self, node: int) -> tuple[str, int]:
        _, sign, one, other = self._graph.nodes[node]
        return f"{self._text(one)} {sign} {self._text(other)}", _SUM

    def _and(self, node: int) -> tuple[str, int]:
        return " and ".join(self._text(part) for part in self._graph.nodes[node][1]), _SUM

    def _or(self, node: int) -> tuple[str, int]:
        return " or ".join(self._text(part) for part in self._graph.nodes[node][1]), _SUM

    def _not(self, node: int) -> tuple[str, int]:
        return f"not {self._text(self._graph.nodes[node][1][0])}", _SUM

    def _function(self, node: int) -> tuple[str, int]:
        _, function, parts = self._graph.nodes[node]
        names = [self._text(part, _SUM) for part in parts]
        if function is sympy.Abs:
            return self._named("s", f"max(abs({names[0]}), {_code.FLOOR!r})"), _ATOM
        plain = [name if name.isidentifier() else self._named("c", name) for name in map(str, names)]
        return f"({_code.source(function(*(sympy.Symbol(name, real=True) for name in plain)))})", _ATOM


def _is_guarded(content: tuple[Any, ...]) -> bool:
    """Whether a sum holds the tiny constant that keeps a norm differentiable at 0."""
    return bool(content[0] == "sum" and 0.0 < content[1] < 1e-150)
