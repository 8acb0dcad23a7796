"""Integrators as ``method="auto"`` takes them: with another one in reserve."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from fricmb.integrate.collocation import Collocation
from fricmb.integrate.integrator import Integrator, Tolerance
from fricmb.integrate.methods.radau import Radau
from fricmb.integrate.problem import Floats, Problem, Start
from fricmb.integrate.run.stop import ended
from fricmb.integrate.trajectory import Trajectory


class Guard(Integrator):
    """An integrator as ``auto`` takes it: a run that it cannot finish is done by another, and says so."""

    #: Who does such a run.
    reserve: ClassVar[type[Integrator]] = Radau

    def leaves(self, problem: Problem, span: float, rtol: float) -> str | None:
        """Why a run over a span is left to the reserve before it begins, or None."""
        return None

    def integrate(
        self,
        problem: Problem,
        start: Start,
        t_end: float,
        *,
        tolerance: Tolerance,
        step: float | None = None,
        t_eval: Floats | None = None,
        progress: Callable[[float], None] | None = None,
        memory: float | None = None,
    ) -> Trajectory:
        """See :class:`Integrator`."""
        options: dict[str, Any] = {"tolerance": tolerance, "t_eval": t_eval, "progress": progress, "memory": memory}
        other, why = self.reserve(), self.leaves(problem, t_end - start.t, tolerance.rtol)
        notes: tuple[str, ...] = ()
        if why is None:
            run = super().integrate(problem, start, t_end, **options)  # type: ignore[safe-super]  # the class behind
            if run.failure is None or run.of_scene or ended() is not None:
                return run
            why = f"{self.name} stopped at t = {run.end.t:.6g}: {run.failure}; {other.name} did the run"
            notes = (why,)
            del run  # where it found no room for its rows
        instead = other.integrate(problem, start, t_end, **options)
        instead.counters = replace(instead.counters, notes=(*instead.counters.notes, *notes))
        instead.instead = (other.name, why)
        return instead


@dataclass(frozen=True, kw_only=True)
class Guarded(Guard, Collocation):
    """Collocation; in reserve the general method, which also does what exact steps would creep through."""

    def leaves(self, problem: Problem, span: float, rtol: float) -> str | None:
        """See :class:`Guard`."""
        creeps = self.creeps(problem, span, rtol)
        return "damped parts far faster than all that rings: exact steps would follow them" if creeps else None
