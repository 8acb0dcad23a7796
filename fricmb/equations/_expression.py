"""Deriving expressions of a scene: prescribed signals, normal forces, forces that depend on the motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import sympy

from fricmb.equations import _code
from fricmb.equations._element import parameter_source
from fricmb.equations._inputs import series_in, time_inputs, whole_tape
from fricmb.equations._place import integrate, quadrature_kernel
from fricmb.equations._split import affine, split
from fricmb.signal._symbols import Series


def derive_value(
    value: Any, arguments: Sequence[Any], parameters: Sequence[Any], title: str
) -> tuple[dict[str, Any], str]:
    """Kernel of one expression and its gradient: out = [value, dvalue/darguments]."""
    outputs = [sympy.sympify(value), *(sympy.diff(value, a) for a in arguments)]
    for expression in outputs:
        _code.check(expression, title)
    return _timed_facts(value, parameters), _code.kernel(arguments, parameters, outputs, title)


def derive_force(
    value: Any, arguments: Sequence[Any], parameters: Sequence[Any], title: str
) -> tuple[dict[str, Any], str]:
    """Kernel of a force on one motion: out = [f, df/darguments, 0, 0, f v], v the last argument."""
    v = sympy.Dummy("v", real=True)
    force = sympy.sympify(value)
    outputs = [force, *(sympy.diff(force, a) for a in [*arguments, v]), sympy.S.Zero, sympy.S.Zero, force * v]
    for expression in outputs:
        _code.check(expression, title)
    return _timed_facts(value, parameters), _code.kernel([*arguments, v], parameters, outputs, title)


def _timed_facts(value: Any, parameters: Sequence[Any]) -> dict[str, Any]:
    """When an expression switches in time, and its parts that depend on time alone."""
    plain, t = without_mod(sympy.sympify(value)), sympy.Symbol("t", real=True)
    inputs, series = time_inputs(plain, t, parameters), series_in(plain, t, parameters)
    return {"switches": time_switches(value, parameters), "inputs": inputs, "series": series}


def derive_bends(
    value: Any, arguments: Sequence[Any], motions: Sequence[Any], parameters: Sequence[Any], title: str
) -> tuple[dict[str, Any], str | None]:
    """Kernel of the functions of the ``motions`` at whose sign changes an expression jumps or has a kink."""
    found = [f for f in switching_functions(value) if f.free_symbols & set(motions)]
    for expression in found:
        _code.check(expression, title)
    return {"count": len(found)}, _code.kernel(arguments, parameters, found, title) if found else None


def derive_signal(value: Any, given: str, t: Any, parameters: Sequence[Any], title: str) -> tuple[dict[str, Any], str]:
    """Kernel of a prescribed signal: x = [t], out = [u, u', u''].

    ``given`` is what the expression states: "value" (u itself), "force" (the same of what acts by its value alone) or
    "rate" (u'; then u is its integral from t = 0, by
    quadrature in the kernel where it has no closed form and does not switch).  One parameter more than the expression
    has is added to u: where the motion stood when a run went on from another.
    """
    value = without_mod(sympy.sympify(value))
    offset = sympy.Dummy("offset", real=True)
    closed = True
    if given != "rate":
        outputs = [value + offset, slope(value, t), slope(slope(value, t), t)]
    else:
        integral = integrate(value, t, switching_functions(value))
        if integral is None and not switches(value, t, parameters) and not value.has(Series):
            facts = {"closed": True, "switches": [], "inputs": time_inputs(value, t, parameters)}
            return facts, quadrature_kernel(value, t, [*parameters, offset], title)
        closed = integral is not None
        outputs = [offset if integral is None else integral + offset, value, slope(value, t)]
    for expression in outputs:
        _code.check(expression, title)
    # of a motion that is given by its position the speed acts, too
    inputs = time_inputs(value, t, parameters, rates=0 if given == "rate" else 1)
    series = series_in(value, t, parameters, rates={"value": 2, "rate": 1, "force": 0}[given])
    uniform = bool(outputs[2] == 0)
    facts = {"closed": closed, "switches": switches(value, t, parameters), "uniform": uniform, "inputs": inputs}
    facts["series"] = series
    if given == "force":
        facts["whole"] = whole_tape(value, t, parameters)
    return facts, _code.kernel([t], [*parameters, offset], outputs, title)


def without_mod(value: Any) -> Any:
    """An expression in whose remainders steps are written as such."""
    return value.replace(sympy.Mod, lambda a, b: a - b * sympy.floor(a / b))


def slope(value: Any, t: Any) -> Any:
    """Derivative by t between jumps: steps are level."""
    steps = {step: sympy.Dummy(real=True) for step in value.atoms(sympy.floor, sympy.ceiling)}
    return sympy.diff(value.xreplace(steps), t).xreplace({dummy: step for step, dummy in steps.items()})


def time_switches(value: Any, parameters: Sequence[Any]) -> list[dict[str, Any]]:
    """:func:`switches` in the canonical symbol of time."""
    return switches(value, sympy.Symbol("t", real=True), parameters)


def switching_functions(value: Any) -> list[Any]:
    """What an expression switches on: functions at whose sign changes it has a jump or a kink."""
    functions: list[Any] = []
    for node in sympy.preorder_traversal(sympy.sympify(value)):
        if isinstance(node, sympy.Heaviside | sympy.Abs | sympy.sign):
            functions.append(node.args[0])
        elif isinstance(node, sympy.Piecewise):
            for _, condition in node.args:
                functions += [r.lhs - r.rhs for r in condition.atoms(sympy.core.relational.Relational)]
        elif isinstance(node, sympy.Max | sympy.Min):
            functions += [a - b for i, a in enumerate(node.args) for b in node.args[:i]]
        elif isinstance(node, sympy.floor | sympy.ceiling | sympy.Mod):
            argument = node.args[0] if len(node.args) == 1 else node.args[0] / node.args[1]
            functions.append(sympy.sin(sympy.pi * argument))
    return list(dict.fromkeys(functions))


def switches(value: Any, t: Any, parameters: Sequence[Any]) -> list[dict[str, Any]]:
    """Where an expression of t (time or slip speed) switches: what changes sign, and the place or a tape to search by.

    Functions of anything else than t and the parameters are left out.
    """
    found: list[dict[str, Any]] = []
    for function in switching_functions(value):
        if t not in function.free_symbols or function.free_symbols - {t, *parameters}:
            continue
        entry: dict[str, Any] = {"function": parameter_source(function, parameters, (t,)), "instant": None}
        slopes, constant = affine(function, [t]) if function.is_polynomial(t) else ([t], 0)
        if t not in sympy.sympify(slopes[0]).free_symbols:
            entry["instant"] = parameter_source(-constant / slopes[0], parameters)
        else:
            entry["tape"] = whole_tape(without_mod(function), t, parameters)
        if entry not in found:
            found.append(entry)
    return found


@dataclass(frozen=True, kw_only=True)
class ForceParts:
    """A force expression, term by term: affine in the motion, of time alone, and the rest."""

    affine: Any
    signal: Any
    rest: Any


def split_force(value: Any, motions: Sequence[Any], prescribed: Sequence[Any], t: Any) -> ForceParts:
    """Sort the terms of a force expression."""
    parts = split(value, motions, [t, *prescribed], 1)
    signal, rest = sympy.S.Zero, sympy.S.Zero
    for term in sympy.Add.make_args(sympy.expand_mul(parts.rest)):
        if term.free_symbols & {*motions, *prescribed}:
            rest += term
        else:
            signal += term
    return ForceParts(affine=parts.low, signal=signal, rest=rest)
