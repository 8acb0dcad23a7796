"""Which part of a scene has no value where a run has stopped: for the message of its error."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmb.integrate import Start, Trajectory
from fricmb.integrate.problem import Floats
from fricmb.scene import Contact
from fricmb.values import Declaration, is_expression

if TYPE_CHECKING:
    from fricmb._simulate._mechanics import SceneMechanics

#: Parts of the time behind the end of the run at which values are asked for: a run stops before what it cannot follow.
AHEAD = (0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-4, 1e-2)


def blame(mechanics: SceneMechanics, trajectory: Trajectory, t: float) -> str:
    """What of the scene has no finite value at t or at once behind it, as the end of a sentence; "" where all have."""
    state = trajectory.motion(np.array([t]))
    if not np.isfinite(state.q).all():
        return ""
    span = max(abs(t), t - float(trajectory.t[0]))
    found = _formula_without_value(mechanics, t, state.q[:, 0], state.v[:, 0], span)
    return found or _law_without_value(mechanics, state.g[:, 0], state.N[:, 0])


def blame_end(mechanics: SceneMechanics, end: Start) -> str:
    """As :func:`blame`, for a run that has not made its first row: what has no value where it starts."""
    return _formula_without_value(mechanics, end.t, end.q, end.v, abs(end.t))


def _formula_without_value(mechanics: SceneMechanics, t: float, q: Floats, v: Floats, span: float) -> str:
    """The first formula without a finite value at t or at once behind it, in parts of ``span``."""
    values = dict(zip(mechanics.names.dofs, q.tolist(), strict=True))
    rates = dict(zip(mechanics.names.dofs, v.tolist(), strict=True))
    for part in mechanics.scene.parts:
        for path, expression in _expressions(part):
            for ahead in AHEAD:
                at = t + ahead * span
                found = _value(expression, at, ahead * span, values, rates)
                if found is not None and not math.isfinite(found):
                    return f"; {part.name}.{path} = {expression} is {found} at t = {at:.10g}"
    return ""


def jumping_rate(mechanics: SceneMechanics) -> str:
    """A law whose states change at a rate in steps, as the end of a sentence; "" where there is none.

    Where such a state is driven back to where its rate jumps, steps get shorter without end.
    """
    for contact in mechanics.scene.frictional:
        law = contact.law
        if law is None or not law.states or law.kind != "smooth" or contact.name not in mechanics.names.contacts:
            continue
        import sympy

        from fricmb.laws._numeric import force_expression
        from fricmb.values import symbolic

        d = len(mechanics.names.directions[mechanics.names.contacts.index(contact.name)])
        rates = force_expression(law, symbolic(law), d)[4]
        steps = sorted({str(step) for rate in rates for step in rate.atoms(sympy.floor, sympy.ceiling)})
        if steps:
            return f"; the rate of {law._label()} of {contact._label()} jumps ({steps[0]}), which no step looks for"
    return ""


def undefined(mechanics: SceneMechanics, trajectory: Trajectory, t: float) -> str:
    """Why a joint has no meaning where the run has come to; "" where all have."""
    q = trajectory.motion(np.array([t])).q[:, 0]
    if not np.isfinite(q).all():
        return ""
    values = dict(zip(mechanics.names.dofs, q.tolist(), strict=True))
    return next(filter(None, (joint.undefined(values) for joint in mechanics.scene.joints)), "")


def _expressions(part: Declaration) -> Iterator[tuple[str, Any]]:
    """The formulas of a part, with the names of their places."""
    for path, value in part.slots().items():
        if is_expression(value):
            yield path, value


def _value(
    expression: Any, t: float, ahead: float, values: dict[str, float], rates: dict[str, float]
) -> float | None:
    """A formula at t, motions going on as they are for the time ``ahead``; None where it needs what is not known."""
    import sympy

    from fricmb.values._symbols import TIME, CoordinateSymbol, ParameterSymbol, SpeedSymbol

    known: dict[Any, float] = {}
    for symbol in expression.free_symbols:
        if symbol == TIME:
            known[symbol] = t
        elif isinstance(symbol, ParameterSymbol):
            known[symbol] = symbol.value
        elif isinstance(symbol, CoordinateSymbol) and symbol.motion in values:
            known[symbol] = values[symbol.motion] + ahead * rates[symbol.motion]
        elif isinstance(symbol, SpeedSymbol) and symbol.motion in rates:
            known[symbol] = rates[symbol.motion]
        else:
            return None
    symbols = list(known)
    with np.errstate(all="ignore"):
        found = sympy.lambdify(symbols, expression, "numpy")(*(np.float64(known[s]) for s in symbols))
    return float(found) if np.ndim(found) == 0 and not np.iscomplexobj(found) else None


def _law_without_value(mechanics: SceneMechanics, g: Floats, N: Floats) -> str:
    """A friction law whose coefficient is no finite number at the slip speed reached."""
    row = mechanics.names.row
    parts = {part.name: part for part in mechanics.scene.parts}
    for i, name in enumerate(mechanics.names.contacts):
        part = parts.get(name)
        if not isinstance(part, Contact) or part.law.states or not math.isfinite(N[i]):
            continue
        speed = float(np.linalg.norm(g[row[i] : row[i + 1]]))
        for r in (speed, speed * (1.0 + 1e-9), speed * (1.0 + 1e-3)):
            try:
                found = float(part.law.coefficient(r))
            except Exception:  # a law of the user's own may raise what it likes; this is but a message
                break
            if not math.isfinite(found):
                return f"; {name}.law = {part.law} has the coefficient {found} at slip speed {r:.10g}"
    return ""
