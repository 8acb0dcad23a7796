"""Which integrator runs a problem."""

from __future__ import annotations

from typing import Any

from fricmb.errors import SceneError, shown, unknown_name
from fricmb.integrate import Integrator, Problem

#: Methods that there were, and what is taken in place of each.
GONE = {
    "timestepping": "implicit steps over transitions are gone, for they were wrong where others are right;"
    " take 'auto', or 'radau', which locates every transition, or 'taylor' for long chains",
}


def find_integrator(method: Any, problem: Problem, rtol: float) -> tuple[Integrator, str]:
    """The integrator for ``method=`` (a name, "auto", or a configured instance), and why it is taken.

    The choice of "auto" depends on the tolerance, too.

    Raises
    ------
    UnknownNameError
        For a name that is no integrator.
    SceneError
        For something else than a name or an instance, or an integrator that refuses the problem.
    """
    integrator = method if isinstance(method, Integrator) else _named(method)
    if integrator is None:
        from fricmb.integrate import choose

        integrator, why = choose(problem, rtol)
        refusal = integrator.refuses(problem) if problem.contacts.lean.any() else None
        if refusal is not None:
            raise SceneError(refusal)
        return integrator, why
    refusal = integrator.refuses(problem)
    if refusal is not None:
        raise SceneError(f"method: {refusal}")
    return integrator, "given by method="


def _named(method: Any) -> Integrator | None:
    """The integrator of that name; None for "auto"."""
    if isinstance(method, str) and method == "auto":
        return None
    from fricmb.integrate import integrators

    if not isinstance(method, str):
        names = ", ".join(repr(name) for name in ("auto", *integrators))
        raise SceneError(f"method: got {shown(method)}; expected one of {names}, or an instance of an integrator")
    if method in GONE:
        raise SceneError(f"method: {method!r}: {GONE[method]}")
    if method not in integrators:
        raise unknown_name("method", method, ["auto", *integrators])
    return integrators[method]()
