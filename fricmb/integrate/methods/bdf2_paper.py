"""The published scheme of Kinkaid, O'Reilly and Papadopoulos (2005), Eqs. (12) to (14), for comparison and teaching.

    Y_{n+1} = a1 Y_{n-1} + a2 Y_n + b h G_{n+1},   g(Y_{n+1}) = 0,
    a1 = -h^2/(h0 (h0+2h)),  a2 = (h0+h)^2/(h0 (h0+2h)),  b = (h0+h)/(h0+2h),   h0 the last and h the present step.

Each step first assumes stick; where the multiplier exceeds mu_s N the step is done again in slip.  BDF2 is used where
the last step had the same mode, else backward Euler.  With several contacts: where all of them had.  Transitions are
not located: they fall on steps.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np

from fricmb.integrate.compile.room import room
from fricmb.integrate.integrator import Integrator, Tolerance
from fricmb.integrate.methods.bdf2_paper_step import Last, drive_paper
from fricmb.integrate.methods.blocks_of_run import load_stages
from fricmb.integrate.methods.run_setup import Collector, run_loop, set_accuracy
from fricmb.integrate.methods.run_workspace import run_workspace, step_workspace
from fricmb.integrate.problem import Floats, Problem, Start
from fricmb.integrate.step.tableau import one_stage
from fricmb.integrate.trajectory import Trajectory


@dataclass(frozen=True, kw_only=True)
class Bdf2Paper(Integrator):
    """The published fixed-step scheme: BDF2 inside a mode, backward Euler where it changes; needs ``step=``."""

    name: ClassVar[str] = "bdf2-paper"
    adaptive: ClassVar[bool] = False
    order: ClassVar[str] = "2"
    takes: ClassVar[frozenset[str]] = frozenset({"linear", "ports", "nonlinear"})

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
        """See :class:`Integrator`; ``step`` is required.

        Raises
        ------
        ValueError
            Where ``step`` is not given or not positive.
        """
        if step is None or not step > 0.0:
            raise ValueError(f"bdf2-paper needs a step > 0, got {step!r}")
        with run_workspace(problem) as workspace, step_workspace(problem, one_stage()) as (one,):
            load_stages(problem, "solve_with")
            run = Collector(problem, start, t_end, workspace, one)
            # its equations are solved to round-off: their error is not to be seen beside that of the formula
            acc = set_accuracy(run, Tolerance(rtol=1e-8))
            code, y = run.begin(), run.y
            values = np.zeros(2 * problem.n + problem.n_z)
            last = room(Last(values, 0.0, y.mode.copy(), y.n.copy(), y.mode.copy()))
            given = (run.packed, run.scratch, y, run.end, one, acc, last, run.rows, step, t_end)
            found = run_loop(run, code, partial(drive_paper, *given), None, progress)
            found.integrates = False  # its energies are those of its formula
            return found
