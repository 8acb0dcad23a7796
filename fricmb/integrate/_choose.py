"""The integrators by name, and the choice of ``method="auto"``."""

from __future__ import annotations

from fricmb.integrate._bdf import Bdf
from fricmb.integrate._bdf2_paper import Bdf2Paper
from fricmb.integrate._exact import Exact
from fricmb.integrate._integrator import Integrator
from fricmb.integrate._problem import Problem
from fricmb.integrate._radau import Radau
from fricmb.integrate.collocation import Collocation
from fricmb.integrate.collocation._prepare import is_single
from fricmb.integrate.taylor import Taylor
from fricmb.integrate.timestepping import TimeStepping

#: Built-in integrators by the name that ``simulate(method=...)`` takes.
integrators: dict[str, type[Integrator]] = {
    kind.name: kind for kind in (Bdf, Bdf2Paper, Collocation, Radau, Taylor, TimeStepping)
}


def choose(problem: Problem) -> tuple[Integrator, str]:
    """The integrator for a problem, and why: the fastest that takes it, else the general one and what stood against."""
    if problem.mechanism is not None:
        return Radau(), "bodies that turn or joints: one-step on the index-reduced system"
    exact = Exact()
    if exact.refuses(problem) is None:
        return exact, "free vibration of a linear structure: closed form"
    fast = Collocation()
    reason: str | None = "more than one contact under constant friction and loads linear in time"
    if is_single(problem):
        reason = fast.refuses(problem)
    if reason is None:
        return fast, "linear structure with one contact under constant friction: exact structure, unknowns at the port"
    many = Taylor()
    if problem.n_c > 1 and many.refuses(problem) is None:
        return many, "many contacts under constant friction between few neighbours: Taylor steps, local corrections"
    return Bdf(), f"the general method: {reason}"
