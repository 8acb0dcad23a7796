"""The general integrator: BDF of variable step and order between transitions, Radau IIA around them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

from fricmb.integrate.integrator import Integrator, Tolerance
from fricmb.integrate.methods.one_step import run_one_step
from fricmb.integrate.methods.radau import against_sharing, condensed_after, stopped_in_a_band
from fricmb.integrate.methods.run_setup import stages_for
from fricmb.integrate.problem import LAW_SMOOTH, Floats, Problem, Start
from fricmb.integrate.step.tableau import radau
from fricmb.integrate.trajectory import Trajectory


@dataclass(frozen=True, kw_only=True)
class Bdf(Integrator):
    """BDF of order 1 to 5 for the implicit index-1 DAE of motion and contact.

    Every transition is located; around transitions, at starts and near landing Radau IIA of ``stages`` stages
    steps, and wherever it gets on faster.  Radau IIA takes every step where a law is smooth and there are no joints.
    The spectrum limits the order at a step size where a lightly damped oscillation would grow.
    Bodies that turn and joints are run on the index-reduced system, with constraints restored after every step.

    Parameters
    ----------
    stages : int, optional
        Of the one-step method, 2 to 9; by default from the tolerance.
    """

    name: ClassVar[str] = "bdf"
    order: ClassVar[str] = "1 to 5"
    takes: ClassVar[frozenset[str]] = frozenset({"linear", "ports", "nonlinear", "constraints"})
    two_limits: ClassVar[bool] = True
    pauses: ClassVar[bool] = True

    stages: int | None = None

    def refuses(self, problem: Problem) -> str | None:
        """Why this integrator cannot run the problem, or None."""
        return against_sharing(problem) or super().refuses(problem)

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
        options: dict[str, Any] = {"progress": progress, "memory": memory}
        # slow to load
        from fricmb.integrate import constrained

        # without joints a steep law turns the force within a step, and with it the power, which no error test of BDF
        # watches: as many steps of Radau are far more accurate there
        steep = problem.mechanism is None and bool((problem.contacts.law == LAW_SMOOTH).any())
        around = radau(constrained.stages_for(problem, tolerance.rtol, self.stages))
        run = constrained.run_mechanism(problem, start, t_end, tolerance, around, **options, multistep=not steep)
        if not stopped_in_a_band(problem, run):
            return run
        condensed = radau(stages_for(problem, tolerance.rtol, self.stages))
        return condensed_after(run, run_one_step(problem, start, t_end, condensed, tolerance, memory, progress))
