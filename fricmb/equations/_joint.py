"""Deriving a joint type and the points of a body type: values, gradients and second derivatives.  Imports SymPy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import sympy

from fricmb.equations import _code
from fricmb.equations._graph import Graph
from fricmb.equations._statements import kernel
from fricmb.errors import SceneError, shown
from fricmb.values import symbolic


@dataclass(frozen=True, kw_only=True)
class JointMath:
    """What a joint type states, in symbols: constraints phi(x); with friction also slip factors s and load N.

    ``slip``: factors of the rates, one tuple for each direction of slip.
    """

    x: tuple[Any, ...]
    v: tuple[Any, ...]
    lam: tuple[Any, ...]
    parameters: tuple[Any, ...]
    phi: tuple[Any, ...]
    slip: tuple[tuple[Any, ...], ...] | None
    load: Any

    def text(self) -> str:
        """Everything in one string, for a key."""
        return str(sympy.srepr((self.parameters, self.phi, self.slip, self.load)))


def joint_math(joint: Any, n: int) -> JointMath:
    """Ask a joint type for its statements; ``n`` local coordinates, drives included."""
    stand = symbolic(joint.bare())
    x, v = (tuple(sympy.Symbol(f"{letter}_{i}", real=True) for i in range(n)) for letter in "xv")
    label = f"{type(joint).__name__} {joint.name!r}"
    phi = _vector(stand.standin.define_constraint(x), label, "define_constraint") if joint.constrains else ()
    lam = tuple(sympy.Symbol(f"l_{i}", real=True) for i in range(len(phi) or joint.load_rows))
    slip = load = None
    if joint.friction is not None:
        slip = _slip(stand.standin.define_slip(x), joint.slip_rows, n, label)
        rates = stand.standin.define_load_rates(x)
        load = sympy.sympify(stand.standin.define_load(x, lam)) + sum(d * w for d, w in zip(rates, v, strict=False))
    return JointMath(x=x, v=v, lam=lam, parameters=stand.flat, phi=phi, slip=slip, load=load)


def _slip(value: Any, count: int, n: int, label: str) -> tuple[tuple[Any, ...], ...]:
    """Factors of slip by directions, drives that come behind being 0."""
    rows = [_vector(row, label, "define_slip") for row in ([value] if count == 1 else value)]
    if len(rows) != count or any(len(row) > n for row in rows):
        raise SceneError(f"{label}: define_slip must return {count} rows of at most {n} factors, got {shown(value)}")
    return tuple((*row, *(sympy.S.Zero for _ in range(n - len(row)))) for row in rows)


def _vector(value: Any, label: str, method: str) -> tuple[Any, ...]:
    if not isinstance(value, list | tuple | sympy.MatrixBase) or not len(value):
        raise SceneError(f"{label}: {method} must return a tuple of expressions, got {shown(value)}")
    return tuple(sympy.sympify(entry) for entry in value)


def derive_joint(math: JointMath, title: str) -> tuple[dict[str, Any], str]:
    """Facts and kernel of a joint type; the layout of the output is that of ``integrate.mechanism.Joints``."""
    _check([*math.phi, *(s for row in math.slip or () for s in row), math.load], title)
    graph = Graph(title)
    x, v, lam = ([graph.of(symbol) for symbol in symbols] for symbols in (math.x, math.v, math.lam))
    phi = [graph.of(expression) for expression in math.phi]
    G = graph.gradients(phi, math.x)
    outputs = [*phi, *(g for row in G for g in row)]
    reactions = [graph.dot(lam, column) for column in zip(*G, strict=True)] if phi else [graph.number(0.0)] * len(x)
    outputs += [h for row in graph.gradients(reactions, math.x) for h in row]
    outputs += [g for row in graph.gradients([graph.dot(row, v) for row in G], math.x) for g in row]
    if math.slip is not None:
        factors, load = [graph.of(s) for row in math.slip for s in row], graph.of(math.load)
        outputs += [*factors, *(slope for row in graph.gradients(factors, math.x) for slope in row)]
        outputs += [load, *graph.gradients([load], [*math.lam, *math.x, *math.v])[0]]
    facts = {"n_x": len(x), "rows": len(phi)}
    return facts, kernel(graph, [*math.x, *math.v, *math.lam], math.parameters, outputs, title)


def _check(expressions: Sequence[Any], title: str) -> None:
    for expression in expressions:
        if expression is not None:
            _code.check(sympy.sympify(expression), title)


def derive_place(body: Any, n: int, title: str) -> tuple[dict[str, Any], str]:
    """Kernel of a point of a body type with n coordinates: position, gradient, second derivatives."""
    q = tuple(sympy.Symbol(f"q_{i}", real=True) for i in range(n))
    offset = sympy.symbols("u v", real=True)
    stated = [sympy.sympify(e) for e in body.define_point(q, offset)]
    _check(stated, title)
    graph = Graph(title)
    position = [graph.of(e) for e in stated]
    slopes = [slope for row in graph.gradients(position, q) for slope in row]
    second = [slope for row in graph.gradients(slopes, q) for slope in row]
    return {"count": len(position)}, kernel(graph, q, offset, [*position, *slopes, *second], title)
