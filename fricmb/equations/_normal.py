"""Deriving a normal-force law: force, gradient and the potential that goes with it."""

from __future__ import annotations

from typing import Any

import sympy

from fricmb.equations import _code
from fricmb.errors import LawError
from fricmb.values import ask, one_expression, symbolic


def normal_expression(law: Any) -> tuple[Any, Any, Any, tuple[Any, ...]]:
    """Symbols e and e', the normal force before the cut at 0, and the symbols of the parameters."""
    e, rate = sympy.Symbol("e", real=True), sympy.Symbol("w", real=True)
    stand = symbolic(law)
    said = LawError, type(law).__name__, "define_normal"
    force = ask(*said, stand.standin.define_normal, e=e, e_dot=rate)
    return e, rate, one_expression(*said, force, {e, rate, *stand.flat}), stand.flat


def normal_text(law: Any) -> str:
    """What a normal-force law states, in one string, for a key."""
    return str(sympy.srepr(normal_expression(law)))


def derive_normal(law: Any) -> tuple[dict[str, Any], str]:
    """Facts and kernel: x = [e, e'], out = [N, dN/de, dN/de', V, dV/de].

    V is the potential of N - N(0, 0) on both bodies at e' = 0, with N cut at 0: an antiderivative up to the opening, a
    constant force from there on.  The opening is found by bisection between 0 and e.
    """
    title = type(law).__name__
    e, rate, N, parameters = normal_expression(law)
    still = N.xreplace({rate: sympy.S.Zero})
    stored = symbolic(law).standin.define_stored(e)
    stored = sympy.integrate(still, e) if stored is None else sympy.sympify(stored)
    if stored.has(sympy.Integral):
        raise LawError(f"{title}: the integral of define_normal(e, 0) over e has no closed form")
    outputs = [N, sympy.diff(N, e), sympy.diff(N, rate), still, stored]
    for expression in outputs:
        _code.check(expression, title)
    rename, reads = _code.read_arguments([e, rate], parameters, outputs)
    plain = [expression.xreplace(rename) for expression in outputs]
    x0 = sympy.Symbol("x0", real=True)
    at = {name: sympy.Symbol(name, real=True) for name in ("zero", "turn", "middle")}
    lines = [
        *(line for line in reads if not line.startswith(("x0 ", "x1 "))),
        "x0, x1 = x[0], x[1]",
        *_code.body(plain[:4], ["out[0]", "out[1]", "out[2]", "force"]),
        "zero = 0.0",
        *_code.body([plain[3].xreplace({x0: at["zero"]})], ["at_zero"]),
        "turn = x0",
        "if force < 0.0:",
        "    inside, outside = 0.0, x0",
        "    for _ in range(200):",
        "        middle = 0.5*(inside + outside)",
        "        if middle == inside or middle == outside:",
        "            break",
        *("        " + line for line in _code.body([plain[3].xreplace({x0: at["middle"]})], ["force_there"])),
        "        if force_there > 0.0:",
        "            inside = middle",
        "        else:",
        "            outside = middle",
        "    turn = inside",
        *_code.body([plain[4].xreplace({x0: at["turn"]})], ["stored"]),
        *_code.body([plain[4].xreplace({x0: at["zero"]})], ["stored_at_zero"]),
        "out[3] = at_zero*x0 - (stored - stored_at_zero)",
        "out[4] = at_zero - max(force, 0.0)",
    ]
    return {}, _code.module(title, lines)
