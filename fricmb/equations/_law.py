"""Deriving a friction law: its kernel, the limit of its coefficient at rest, and when it is constant."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy

from fricmb.equations import _code
from fricmb.equations._element import parameter_source
from fricmb.equations._expression import switches
from fricmb.equations._split import split
from fricmb.equations._tape import Tape
from fricmb.laws._numeric import FASTEST

#: Slip speeds in a kernel of a coefficient start here, so that r**n/r has its limit instead of 0/0.
_TINY = _code.FLOOR


def derive_coefficient(
    mu: Any, r: Any, N: Any, parameters: Sequence[Any], title: str
) -> tuple[dict[str, Any], str | None]:
    """Facts and kernel of a coefficient ``mu(r, N)``: out = [mu, dmu/dr, dmu/dN].

    ``constant`` lists conditions under which the coefficient does not depend on r and N: every expression of the
    first group 0, or any single one of the second.  ``switches``: by what slip speed the formula goes over to another;
    ``switches_by_load``: the same where that speed depends on N, which stands behind the parameters.
    """
    mu = sympy.sympify(mu)
    at_rest = _at_rest(mu, r)
    facts: dict[str, Any] = {
        "kind": "coefficient",
        "load_dependent": bool(sympy.diff(mu, N) != 0),
        "mu_0": None if at_rest is None else parameter_source(at_rest, parameters, extra=(N,)),
    }
    if not mu.free_symbols & {r, N}:
        return facts | {"kind": "constant"}, None
    facts["switches"] = switches(mu, r, parameters)
    facts["switches_by_load"] = [s for s in switches(mu, r, [*parameters, N]) if s not in facts["switches"]]
    facts["all_zero"] = [parameter_source(f, parameters) for f in split(mu, [], [r, N], 0).factors]
    slopes = [sympy.diff(mu, r), sympy.diff(mu, N)]
    facts["any_zero"] = [
        parameter_source(p, parameters) for p in parameters if all(_vanishes(slope, p) for slope in slopes)
    ]
    outputs = [mu, *slopes]
    for expression in outputs:
        _code.check(expression, title)
    return facts, _coefficient_kernel(r, N, parameters, outputs, title)


def _vanishes(slope: Any, parameter: Any) -> bool:
    try:
        return bool(slope.subs(parameter, 0) == 0)
    except (ZeroDivisionError, ValueError, TypeError):
        return False


def _at_rest(mu: Any, r: Any) -> Any | None:
    """Limit of the coefficient for r -> 0, or None where only the kernel can tell."""
    try:
        value = mu.subs(r, 0)
        if value.has(sympy.nan, sympy.zoo, sympy.oo, -sympy.oo):
            value = sympy.limit(mu, r, 0, "+")
        if value.has(sympy.nan, sympy.zoo, sympy.oo, -sympy.oo, sympy.Limit, sympy.AccumBounds):
            return None
        _code.check(value, "limit of a friction coefficient at rest")
        return value
    except (NotImplementedError, ValueError, TypeError):
        return None


def _coefficient_kernel(r: Any, N: Any, parameters: Sequence[Any], outputs: Sequence[Any], title: str) -> str:
    """The kernel tries again at a smaller speed where a product of huge and tiny numbers is not finite."""
    rename, reads = _code.read_arguments([r, N], parameters, outputs)
    reads = [line for line in reads if not line.startswith("x0 ")]
    names = ["value", "by_speed", "by_load"]
    lines = [
        *reads,
        f"x0 = max(x[0], {_TINY!r})",
        "missing_0, missing_1, missing_2 = True, True, True",
        "for _ in range(10):",
        *("    " + line for line in _code.body([sympy.sympify(e).xreplace(rename) for e in outputs], names)),
    ]
    for i, name in enumerate(names):
        lines += [f"    if missing_{i}:", f"        out[{i}] = {name}", f"        missing_{i} = not isfinite({name})"]
    lines += ["    if not (missing_0 or missing_1 or missing_2):", "        break", "    x0 = sqrt(x0)"]
    return _code.module(title, lines)


def derive_smooth(
    force: Sequence[Any],
    rate: Sequence[Any],
    v: Sequence[Any],
    N: Any,
    z: Sequence[Any],
    parameters: Sequence[Any],
    title: str,
    switch: Any | None = None,
) -> tuple[dict[str, Any], str]:
    """Facts and kernel of a smooth law: x = [v, N, z], out = [F, z', Jacobian by rows, switch where there is one]."""
    values = [sympy.sympify(e) for e in (*force, *rate)]
    arguments = [*v, N, *z]
    for expression in values:
        _code.check(expression, title)
    facts = {"kind": "smooth", "n_z": len(z), **({} if switch is None else {"switch": True})}
    more = [] if switch is None else [sympy.sympify(switch)]
    rename, reads = _code.read_arguments(arguments, parameters, [*values, *more])
    # no product of velocities overflows
    cut = [f"x{i} = min(max(x[{i}], {-FASTEST!r}), {FASTEST!r})" for i in range(len(v))]
    taken = tuple(f"x{i} =" for i in range(len(v)))
    lines = [*(line for line in reads if not line.startswith(taken)), *cut]
    tape = Tape(arguments, rename)
    told = [f"out[{len(values) * (1 + len(arguments))}] = {tape.value(e)}" for e in more]
    lines += [*tape.outputs(values, len(arguments)), *told]
    return facts, _code.module(title, lines)
