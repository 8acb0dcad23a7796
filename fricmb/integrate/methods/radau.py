"""Radau IIA with located transitions as an integrator: the one-step method for any scene."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from fricmb.integrate.integrator import Tolerance
from fricmb.integrate.methods.one_step import OneStepMethod
from fricmb.integrate.methods.run_setup import follows_series, stages_for
from fricmb.integrate.model.problem_structs import softness
from fricmb.integrate.problem import Floats, Problem, Start
from fricmb.integrate.run.stop import ended
from fricmb.integrate.step.tableau import radau
from fricmb.integrate.trajectory import Trajectory


def stopped_in_a_band(problem: Problem, run: Trajectory) -> bool:
    """Whether a scene without joints could not be run in a band, as where contacts are nearly redundant."""
    return problem.mechanism is None and run.failure is not None and not run.of_scene and ended() is None


def condensed_after(stopped: Trajectory, run: Trajectory) -> Trajectory:
    """The run by steps that are condensed to the contacts, which says that those in a band stopped."""
    why = f"steps in a band stopped at t = {stopped.end.t:.6g}: {stopped.failure}; condensed ones did the run"
    run.counters = replace(run.counters, notes=(*run.counters.notes, why))
    return run


def against_sharing(problem: Problem) -> str | None:
    """What stands against friction whose limit at rest differs by the sense, or None: that it is shared in a loop."""
    if not problem.contacts.lean.any():
        return None
    if problem.mechanism is None:
        shared = softness(problem) > 0.0
    else:
        from fricmb.integrate.constrained.problem_structs import leans_in_a_loop

        shared = leans_in_a_loop(problem)
    what = "friction whose limit at rest differs by the sense is not shared among contacts that are redundant"
    return what if shared else None


@dataclass(frozen=True, kw_only=True)
class Radau(OneStepMethod):
    """Radau IIA of ``stages`` stages, order 2 stages - 1, on linear and nonlinear structures.

    Parameters
    ----------
    stages : int, optional
        2 to 9; by default from the tolerance.
    """

    name: ClassVar[str] = "radau"
    order: ClassVar[str] = "2s - 1"
    takes: ClassVar[frozenset[str]] = frozenset({"linear", "ports", "nonlinear", "constraints"})
    two_limits: ClassVar[bool] = True

    stages: int | None = None

    def refuses(self, problem: Problem) -> str | None:
        """Why this integrator cannot run the problem, or None."""
        return against_sharing(problem) or super().refuses(problem)

    def nodes(self, problem: Problem, rtol: float) -> Sequence[float]:
        """Right Radau points."""
        return tuple(radau(stages_for(problem, rtol, self.stages)).c.tolist())

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
        # where measured values come thick, three stages do, and condensed steps of so few cost half
        if self.stages is None and follows_series(problem, tolerance.rtol):
            return super().integrate(
                problem, start, t_end, tolerance=tolerance, t_eval=t_eval, progress=progress, memory=memory
            )
        # slow to load
        from fricmb.integrate import constrained

        formula = radau(constrained.stages_for(problem, tolerance.rtol, self.stages))
        run = constrained.run_mechanism(problem, start, t_end, tolerance, formula, progress, memory)
        if not stopped_in_a_band(problem, run):
            return run
        options: dict[str, Any] = {"progress": progress, "memory": memory}
        return condensed_after(run, super().integrate(problem, start, t_end, tolerance=tolerance, **options))
