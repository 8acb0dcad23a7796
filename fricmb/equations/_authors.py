"""What authors state in their ``define_...`` methods, asked with symbols.  Imports SymPy: imported inside functions."""

from __future__ import annotations

from typing import Any

import sympy

from fricmb.equations._element import ElementMath, local_symbols
from fricmb.equations._law import derive_coefficient, derive_smooth
from fricmb.errors import SceneError, shown
from fricmb.laws._numeric import coefficient_expression, force_expression
from fricmb.values import in_symbols, symbolic


def element_math(element: Any, n: int) -> ElementMath:
    """Potential, dissipation and force of an element on its ``n`` local coordinates."""
    stand = symbolic(element)
    x, v, d, t = local_symbols(n)
    author = stand.standin
    label = f"{type(element).__name__} {element.name!r}"
    with in_symbols(SceneError, label, "define_potential"):
        potential = author.define_potential(x)
    with in_symbols(SceneError, label, "define_dissipation"):
        dissipation = author.define_dissipation(x, v)
    with in_symbols(SceneError, label, "define_force"):
        force = author.define_force(x, v, t)
    entries = _vector(force, n, label)
    for what, expression in (("define_potential", potential), ("define_dissipation", dissipation)):
        if isinstance(expression, list | tuple):
            raise SceneError(f"{label}: {what} must return one expression, got {shown(expression)}")
    return ElementMath(
        x=x,
        v=v,
        d=d,
        t=t,
        parameters=stand.flat,
        potential=sympy.S.Zero if potential is None else sympy.sympify(potential),
        dissipation=sympy.S.Zero if dissipation is None else sympy.sympify(dissipation),
        force=entries,
    )


def _vector(force: Any, n: int, label: str) -> tuple[Any, ...]:
    if force is None:
        return (sympy.S.Zero,) * n
    entries = tuple(force) if isinstance(force, list | tuple | sympy.MatrixBase) else (force,)
    if len(entries) != n:
        raise SceneError(f"{label}: define_force must return {n} expression(s), one a coordinate, got {len(entries)}")
    return tuple(sympy.sympify(entry) for entry in entries)


def derive_law(law: Any, d: int) -> tuple[dict[str, Any], str | None]:
    """Facts and kernel of a friction law; ``d`` = 0 for a coefficient."""
    stand = symbolic(law)
    title = type(law).__name__
    if d:
        v, N, z, force, rate = force_expression(law, stand, d)
        return derive_smooth(force, rate, v, N, z, stand.flat, title, None if z else stand.standin.define_switch(v, N))
    r, N, mu = coefficient_expression(law, stand)
    return derive_coefficient(mu, r, N, stand.flat, title)


def law_text(law: Any, d: int) -> str:
    """What a friction law states, in one string, for a key."""
    stand = symbolic(law)
    stated = force_expression(law, stand, d) if d else coefficient_expression(law, stand)
    switch = stand.standin.define_switch(stated[0], stated[1]) if d and not stated[2] else None
    return str(sympy.srepr((stand.flat, stated, *(() if switch is None else (switch,)))))
