"""The general integrator: BDF of variable step and order between transitions, Radau IIA around them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

import numpy as np

from fricmb.integrate.compile.kernel import entry
from fricmb.integrate.integrator import Integrator, Tolerance, odd_stages
from fricmb.integrate.methods.backward_differences import differences
from fricmb.integrate.methods.bdf_stability import guard_of, spectrum
from fricmb.integrate.methods.blocks_of_run import load_stages
from fricmb.integrate.methods.one_step import run_one_step
from fricmb.integrate.methods.radau import against_sharing, bdf_in_a_band, condensed_after, stopped_in_a_band
from fricmb.integrate.methods.run_setup import Collector, cost, run_loop, set_accuracy, stages_for
from fricmb.integrate.methods.run_workspace import run_workspace, step_workspace
from fricmb.integrate.methods.time_loop import drive
from fricmb.integrate.model.forces import Scratch, set_instant
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.problem import LAW_SMOOTH, Floats, Problem, Start
from fricmb.integrate.step.one_step_room import OneStep
from fricmb.integrate.step.step_matrix import jacobians
from fricmb.integrate.step.tableau import one_stage, radau
from fricmb.integrate.trajectory import Trajectory

#: First steps of the one-step method, in which its size settles.
SETTLE = 8


@entry
def jacobian_at(packed: Packed, s: Scratch, y: State, one: OneStep) -> None:
    """The Jacobian of the structure at a state, for the spectrum."""
    set_instant(packed.signals, s, y.t, y.q, y.v)
    jacobians(packed, s, one.fac)


@dataclass(frozen=True, kw_only=True)
class Bdf(Integrator):
    """BDF of order 1 to 5 for the implicit index-1 DAE of motion and contact, condensed to the contacts.

    Every transition is located; around transitions, at starts and near landing Radau IIA of ``stages`` stages
    steps, and wherever it gets on faster.
    The spectrum limits the order at a step size where a lightly damped oscillation would grow.
    Bodies that turn and joints are run on the index-reduced system, with constraints restored after every step.

    Parameters
    ----------
    stages : int, optional
        Of the one-step method, 2 to 9; by default from the tolerance (bodies that turn and joints: odd).
    """

    name: ClassVar[str] = "bdf"
    order: ClassVar[str] = "1 to 5"
    takes: ClassVar[frozenset[str]] = frozenset({"linear", "ports", "nonlinear", "constraints"})
    two_limits: ClassVar[bool] = True
    pauses: ClassVar[bool] = True

    stages: int | None = None

    def refuses(self, problem: Problem) -> str | None:
        """Why this integrator cannot run the problem, or None."""
        odd = odd_stages(self.name, problem, self.stages)
        return odd or against_sharing(problem) or super().refuses(problem)

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
        if bdf_in_a_band(problem, self.stages):
            from fricmb.integrate import constrained

            count = self.stages or constrained.stages_for(problem, tolerance.rtol)
            options: dict[str, Any] = {"progress": progress, "memory": memory}
            run = constrained.run_mechanism(problem, start, t_end, tolerance, count, **options, multistep=True)
            if not stopped_in_a_band(problem, run):
                return run
            return condensed_after(run, self._condensed(problem, start, t_end, tolerance, **options))
        return self._condensed(problem, start, t_end, tolerance, progress=progress, memory=memory)

    def _condensed(
        self, problem: Problem, start: Start, t_end: float, tolerance: Tolerance, *,
        progress: Callable[[float], None] | None, memory: float | None,
    ) -> Trajectory:  # fmt: skip
        formula = radau(stages_for(problem, tolerance.rtol, self.stages))
        if np.any(problem.contacts.law == LAW_SMOOTH):
            # a steep law turns the force within a step, and with it the power, which no error test of BDF watches:
            # as many steps of Radau are far more accurate there
            return run_one_step(problem, start, t_end, formula, tolerance, memory, progress)
        single, several = step_workspace(problem, one_stage()), step_workspace(problem, formula)
        with run_workspace(problem) as workspace, several as (one,), single as (multi,):
            load_stages(problem, "start_history", "bdf_step")
            run = Collector(problem, start, t_end, workspace, one, multi)
            set_accuracy(run, tolerance)
            code = run.begin()
            return run_loop(run, code, bdf_loop(run, one, multi), memory, progress)


def bdf_loop(run: Collector, one: OneStep, multi: OneStep) -> Callable[[], int]:
    """The loop over steps of BDF, ``multi``, with those of the one-step method between them, ``one``."""
    problem = run.problem
    jacobian_at(run.packed, run.scratch, run.y, multi)
    spectral = spectrum(problem, run.packed.structure, multi.fac.K, multi.fac.C)
    signals = 2 * problem.n + problem.n_z + problem.n_c + 2
    past = differences(signals, run.t_end - run.start.t, cost(problem, len(one.tab.c)) / cost(problem, 1))
    past.wait, past.slower = SETTLE, 1
    return partial(
        drive, run.packed, run.scratch, run.y, run.end, one, multi, run.acc, past, guard_of(problem, spectral),
        run.rest, run.old, run.rows, run.clock, *run.seen,
    )  # fmt: skip
