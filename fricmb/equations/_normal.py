"""Deriving a normal-force law: force, gradient and the potential that goes with it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy

from fricmb.equations import _code
from fricmb.errors import LawError
from fricmb.values import ask, one_expression, symbolic

#: A force below this is none: kernels floor roots (``_code.FLOOR``).
NOTHING = 1e-50


def normal_expression(law: Any) -> tuple[Any, Any, Any, tuple[Any, ...]]:
    """Symbols e and e', the normal force before the cut at 0, and the symbols of the parameters."""
    e, rate = sympy.Symbol("e", real=True), sympy.Symbol("w", real=True)
    stand = symbolic(law)
    said = LawError, type(law).__name__, "define_normal"
    force = ask(*said, stand.standin.define_normal, e=e, e_dot=rate)
    force = one_expression(*said, force, {e, rate, *stand.flat})
    if isinstance(force, sympy.Max) and sympy.S.Zero in force.args:
        # it is cut at 0 anyway, and what is left changes its sign where the contact opens
        force = sympy.Max(*(part for part in force.args if part != 0))
    return e, rate, force, stand.flat


def _mirrored(N: Any, e: Any, rate: Any) -> list[tuple[Any, Any]]:
    """For every function that a law switches on: how far away that is, and the force as far on its other side.

    Only a change of sign is found as a transition, and a force of ``Max(0, -e)`` has none: minus the force on the other
    side of the nearest switch stands for one that is 0 beyond its opening, so that it passes 0 without a bend.
    """
    from fricmb.equations._expression import switching_functions

    found = []
    for f in switching_functions(N):
        slope = sympy.diff(f, e)
        if f.free_symbols & {e, rate}:
            known = slope != 0 and not slope.has(e, rate, sympy.Heaviside, sympy.Piecewise)
            found.append((f / slope, N.xreplace({e: e - 2 * f / slope})) if known else (f, f))
    return found


def normal_text(law: Any) -> str:
    """What a normal-force law states, in one string, for a key."""
    return str(sympy.srepr(normal_expression(law)))


def derive_normal_bends(law: Any) -> tuple[dict[str, Any], str | None]:
    """Kernel of the functions of e and e' at whose sign changes a law jumps or has a kink; their arguments."""
    from fricmb.equations._expression import derive_bends, switching_functions

    e, rate, N, parameters = normal_expression(law)
    used: set[Any] = set().union(*(f.free_symbols for f in switching_functions(N)))
    chosen = [i for i, symbol in enumerate((e, rate)) if symbol in used]
    arguments = [(e, rate)[i] for i in chosen]
    facts, source = derive_bends(N, arguments, [e, rate], parameters, type(law).__name__)
    return facts | {"arguments": chosen}, source


def _open_lines(mirrored: Sequence[Any]) -> list[str]:
    """What makes a force that is 0 (but for the floor of roots) negative, see :func:`_mirrored`."""
    if not mirrored:
        return []
    lines = [f"if max(abs(out[0]), abs(out[1]), abs(out[2])) < {NOTHING}:", "    nearest = 1e308"]
    for away, force in zip(mirrored[::2], mirrored[1::2], strict=True):
        lines += ["    " + line for line in _code.body([away], ["away"])]
        lines += ["    if abs(away) < nearest:", "        nearest = abs(away)"]
        lines += ["        " + line for line in _code.body([force], ["there"])]
    return [*lines, "    if nearest < 1e308:", "        out[0] = -max(abs(there), 1e-30*nearest)"]


def derive_normal(law: Any) -> tuple[dict[str, Any], str]:
    """Facts and kernel: x = [e, e'], out = [N, dN/de, dN/de', V, dV/de]; where N is 0, what stands for it is below 0.

    V is the potential of N - N(0, 0) on both bodies at e' = 0, with N cut at 0: an antiderivative up to the opening, a
    constant force from there on.  The opening is found by bisection between 0 and e.  Fact "linear": whether N is.
    """
    title = type(law).__name__
    e, rate, N, parameters = normal_expression(law)
    still = N.xreplace({rate: sympy.S.Zero})
    stored = symbolic(law).standin.define_stored(e)
    stored = sympy.integrate(still, e) if stored is None else sympy.sympify(stored)
    if stored.has(sympy.Integral):
        raise LawError(
            f"{title}: SymPy finds no closed form of the integral of define_normal(e, 0) over e; define_stored(self, e)"
            " gives it"
        )
    mirrored = [expression for pair in _mirrored(N, e, rate) for expression in pair]
    outputs = [N, sympy.diff(N, e), sympy.diff(N, rate), still, stored, *mirrored]
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
        *_open_lines(plain[5:]),
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
    return {"linear": is_linear(N, e, rate)}, _code.module(title, lines)


def is_linear(N: Any, e: Any, rate: Any) -> bool:
    """Whether a force is a polynomial of degree 1 at most: slopes alone would not tell of one that jumps."""
    return bool(N.is_polynomial(e, rate)) and sympy.Poly(N, e, rate).total_degree() <= 1
