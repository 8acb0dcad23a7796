"""What authors state in their ``define_...`` methods, asked with symbols.  Imports SymPy: imported inside functions."""

from __future__ import annotations

from typing import Any

import sympy

from fricmb.equations._element import ElementMath, local_symbols
from fricmb.equations._law import derive_coefficient, derive_smooth
from fricmb.errors import SceneError
from fricmb.laws._numeric import coefficient_expression, force_expression
from fricmb.values import ask, expressions, one_expression, symbolic


def element_math(element: Any, n: int) -> ElementMath:
    """Potential, dissipation and force of an element on its ``n`` local coordinates."""
    stand = symbolic(element)
    x, v, d, t = local_symbols(n)
    author = stand.standin
    label = f"{type(element).__name__} {element.name!r}"
    said, known = (SceneError, label), {*x, *v, t, *stand.flat}
    energy = ask(*said, "define_potential", author.define_potential, x=x)
    loss = ask(*said, "define_dissipation", author.define_dissipation, x=x, x_dot=v)
    force = ask(*said, "define_force", author.define_force, x=x, x_dot=v, t=t)
    nothing = (sympy.S.Zero,) * n
    what = "expression(s), one a coordinate"
    entries = nothing if force is None else expressions(*said, "define_force", force, n, known, what)
    potential, dissipation = (
        sympy.S.Zero if value is None else one_expression(*said, method, value, known)
        for method, value in (("define_potential", energy), ("define_dissipation", loss))
    )
    return ElementMath(
        x=x,
        v=v,
        d=d,
        t=t,
        parameters=stand.flat,
        potential=potential,
        dissipation=dissipation,
        force=entries,
    )


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
