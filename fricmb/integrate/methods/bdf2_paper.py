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
from typing import TYPE_CHECKING, ClassVar

from fricmb.integrate.formulas.tableau import one_stage
from fricmb.integrate.integrator import Integrator, Tolerance
from fricmb.integrate.problem import Floats, Problem, Start
from fricmb.integrate.trajectory import Trajectory

if TYPE_CHECKING:
    from fricmb.integrate.implicit.run import Setting


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
        # slow to load
        from fricmb.integrate.implicit import run_mechanism
        from fricmb.integrate.implicit.paper.paper_trajectory import PaperTrajectory

        if step is None or not step > 0.0:
            raise ValueError(f"bdf2-paper needs a step > 0, got {step!r}")
        loop, tight = partial(_loop, step=step), Tolerance(rtol=1e-8)
        return run_mechanism(
            problem, start, t_end, tight, one_stage(), progress, None, loop=loop, made=PaperTrajectory
        )


def _loop(setting: Setting, step: float) -> partial[int]:
    """The loop over steps of a length."""
    # slow to load
    from fricmb.integrate.compile.parallel_compile import load_blocks
    from fricmb.integrate.implicit.paper.paper_step import drive_paper, last_of

    load_blocks("solve_with", "find_modes")
    k, w, y, end, before, st, out, control = setting.workspace
    rooms = setting.mech, k, w, y, end, before, st, control, out, setting.record
    return partial(drive_paper, *rooms, last_of(setting.problem), step)
