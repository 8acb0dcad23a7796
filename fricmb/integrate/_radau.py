"""Radau IIA with located transitions as an integrator: the one-step method for any scene."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

from fricmb.integrate._advance import DONE, FAILURES, FULL
from fricmb.integrate._collect import Collector, accuracy, clock_of, one_step
from fricmb.integrate._drive import drive
from fricmb.integrate._integrator import Integrator, Tolerance
from fricmb.integrate._problem import Floats, Problem, Start
from fricmb.integrate._tableau import radau
from fricmb.integrate._trajectory import Trajectory


@dataclass(frozen=True, kw_only=True)
class Radau(Integrator):
    """Radau IIA of ``stages`` stages, order 2 stages - 1, on linear and nonlinear structures.

    Parameters
    ----------
    stages : int, optional
        2 to 9; by default from the tolerance.
    """

    name: ClassVar[str] = "radau"
    order: ClassVar[str] = "2s - 1"
    takes: ClassVar[frozenset[str]] = frozenset({"linear", "ports", "nonlinear", "constraints"})
    pauses: ClassVar[bool] = True

    stages: int | None = None

    def refuses(self, problem: Problem) -> str | None:
        """Why this integrator cannot run the problem, or None."""
        if problem.mechanism is not None and self.stages is not None and self.stages % 2 == 0:
            return f"radau takes bodies that turn and joints with an odd number of stages, got stages={self.stages}"
        return super().refuses(problem)

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
        if problem.mechanism is not None:
            from fricmb.integrate.constrained import run_mechanism, stages_for

            count = self.stages or stages_for(tolerance.rtol)
            return run_mechanism(problem, start, t_end, tolerance, count, progress, memory)
        s = self.stages or (3 if tolerance.rtol > 1e-4 else 5 if tolerance.rtol > 1e-9 else 7)
        run = Collector(problem, start, t_end)
        acc = accuracy(run, tolerance)
        one = one_step(problem, radau(s), run.counts)
        code = run.begin()
        if code == DONE:
            clock = clock_of(run)
            code = FULL
            while code == FULL and not run.is_full(memory):
                code = drive(
                    run.packed, run.scratch, run.y, run.end, one, acc, run.rest, run.old, run.rows, clock, run.address
                )
                run.collect()
                if progress is not None:
                    progress(float(run.y.t[0]))
        return run.trajectory(None if code in (DONE, FULL) else FAILURES[code])
