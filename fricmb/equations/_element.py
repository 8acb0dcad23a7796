"""Deriving an element type: stiffness and damping of its affine part, a compiled template of the rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import sympy

from fricmb.equations import _code
from fricmb.equations._graph import Graph
from fricmb.equations._split import affine, split
from fricmb.equations._statements import kernel


@dataclass(frozen=True, kw_only=True)
class ElementMath:
    """What an element type states, in symbols.

    ``x``, ``v`` local coordinates and their rates, ``d`` the part of the rates that prescribed motions bring in, ``t``
    time, ``parameters`` the numeric fields in order; potential energy, dissipation function (force -dR/dv) and force.
    """

    x: tuple[Any, ...]
    v: tuple[Any, ...]
    d: tuple[Any, ...]
    t: Any
    parameters: tuple[Any, ...]
    potential: Any
    dissipation: Any
    force: tuple[Any, ...]

    def total_force(self) -> list[Any]:
        """The whole force on the local coordinates."""
        return [
            F - sympy.diff(self.potential, x) - sympy.diff(self.dissipation, v)
            for x, v, F in zip(self.x, self.v, self.force, strict=True)
        ]

    def text(self) -> str:
        """Everything in one string, for a key."""
        return str(sympy.srepr((self.parameters, self.potential, self.dissipation, self.force)))


def local_symbols(n: int) -> tuple[tuple[Any, ...], tuple[Any, ...], tuple[Any, ...], Any]:
    """Symbols of n local coordinates, their rates, the prescribed part of the rates, and time."""
    return (
        tuple(sympy.Symbol(f"x_{i}", real=True) for i in range(n)),
        tuple(sympy.Symbol(f"v_{i}", real=True) for i in range(n)),
        tuple(sympy.Symbol(f"d_{i}", real=True) for i in range(n)),
        sympy.Symbol("t", real=True),
    )


def parameter_source(expression: Any, parameters: Sequence[Any], extra: Sequence[Any] = ()) -> str:
    """Python source in ``p[i]``, the further symbols being the entries of ``p`` after the parameters."""
    rename = {p: sympy.Symbol(f"p[{i}]", real=True) for i, p in enumerate([*parameters, *extra])}
    return _code.source(sympy.sympify(expression).xreplace(rename))


def _entries(matrix: Sequence[Sequence[Any]], parameters: Sequence[Any]) -> list[list[Any]]:
    return [
        [i, j, parameter_source(value, parameters)]
        for i, row in enumerate(matrix)
        for j, value in enumerate(row)
        if sympy.sympify(value) != 0
    ]


def derive(math: ElementMath, title: str, *, driven: bool) -> tuple[dict[str, Any], str | None]:
    """Facts of an element type and the source of its kernel, if anything nonlinear can remain.

    ``driven``: the local coordinates also depend on prescribed motions, whose power is then told apart.
    """
    x, v, p = math.x, math.v, math.parameters
    V = split(math.potential, x, [math.t], 2)
    R = split(math.dissipation, v, [*x, math.t], 2)
    linear_rate = [sympy.diff(R.low, rate).xreplace(dict.fromkeys(v, sympy.S.Zero)) for rate in v]
    rate_rest = R.rest + sum(c * rate for c, rate in zip(linear_rate, v, strict=True))
    F = [split(force, [*x, *v], [math.t], 1) for force in math.force]
    gradient = [affine(-sympy.diff(V.low, xi), x) for xi in x]
    loss = [affine(sympy.diff(R.low, vi), v) for vi in v]
    push = [affine(part.low, [*x, *v]) for part in F]
    n = len(x)
    facts: dict[str, Any] = {
        "n_x": n,
        "K": _entries([[-s for s in slopes] for slopes, _ in gradient], p),
        "f": _entries([[constant] for _, constant in gradient], p),
        "C": _entries([slopes for slopes, _ in loss], p),
        "constant": parameter_source(V.low.xreplace(dict.fromkeys(x, sympy.S.Zero)), p),
        "work_K": _entries([[-s for s in slopes[:n]] for slopes, _ in push], p),
        "work_C": _entries([[-s for s in slopes[n:]] for slopes, _ in push], p),
        "work_f": _entries([[constant] for _, constant in push], p),
    }
    factors = [*V.factors, *R.factors, *(f for part in F for f in part.factors), *(c for c in linear_rate if c != 0)]
    if not factors:
        return facts, None
    facts["rest"] = sorted({parameter_source(factor, p) for factor in factors})
    facts["arguments"], source = _remainder(math, V.rest, rate_rest, [part.rest for part in F], title, driven)
    return facts, source


def _remainder(math: ElementMath, V: Any, R: Any, F: Sequence[Any], title: str, driven: bool) -> tuple[Any, str]:
    for expression in (V, R, *F):
        _code.check(sympy.sympify(expression), title)
    graph = Graph(title)
    energy, lost, push = graph.of(V), graph.of(R), [graph.of(f) for f in F]
    by_x, by_v = graph.gradients([energy], math.x)[0], graph.gradients([lost], math.v)[0]
    force = [graph.sum([(f, 1.0), (a, -1.0), (b, -1.0)]) for f, a, b in zip(push, by_x, by_v, strict=True)]
    rates = [graph.of(v) for v in math.v]
    power = graph.dot(push, rates)
    if driven:
        power = graph.sum([(power, 1.0), (graph.dot(force, [graph.of(d) for d in math.d]), -1.0)])
    scalars = [energy, graph.dot(rates, by_v), power]
    used = graph.symbols([*force, *scalars])
    candidates = [
        *((symbol, ["x", i]) for i, symbol in enumerate(math.x)),
        *((symbol, ["v", i]) for i, symbol in enumerate(math.v)),
        *((symbol, ["d", i]) for i, symbol in enumerate(math.d)),
        (math.t, ["t", 0]),
    ]
    chosen = [(symbol, place) for symbol, place in candidates if symbol in used]
    arguments = [symbol for symbol, _ in chosen]
    jacobian = [slope for row in graph.gradients(force, arguments) for slope in row]
    source = kernel(graph, arguments, math.parameters, [*force, *jacobian, *scalars], title)
    return [place for _, place in chosen], source


def derive_bends(math: ElementMath, title: str) -> tuple[dict[str, Any], str | None]:
    """Kernel of the functions of the motion at whose sign changes an element jumps or has a kink; their arguments."""
    from fricmb.equations._expression import derive_bends as derive_of
    from fricmb.equations._expression import switching_functions

    places = [(symbol, [kind, i]) for kind, own in (("x", math.x), ("v", math.v)) for i, symbol in enumerate(own)]
    whole = sympy.Tuple(math.potential, math.dissipation, *math.force)
    used = set().union(*(f.free_symbols for f in switching_functions(whole)))
    chosen = [(symbol, place) for symbol, place in [*places, (math.t, ["t", 0])] if symbol in used]
    arguments = [symbol for symbol, _ in chosen]
    facts, source = derive_of(whole, arguments, [*math.x, *math.v], math.parameters, title)
    return facts | {"arguments": [place for _, place in chosen]}, source
