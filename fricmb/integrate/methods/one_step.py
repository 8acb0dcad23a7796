"""What implicit one-step methods share: the loop over steps, transitions located within them, rows."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Sequence
from functools import partial
from typing import ClassVar

from fricmb.integrate.integrator import Integrator, Tolerance
from fricmb.integrate.methods.blocks_of_run import load_stages
from fricmb.integrate.methods.run_setup import Collector, run_loop, set_accuracy
from fricmb.integrate.methods.run_workspace import run_workspace, step_workspace
from fricmb.integrate.methods.time_loop import drive
from fricmb.integrate.problem import Floats, Problem, Start
from fricmb.integrate.step.one_step_room import OneStep
from fricmb.integrate.step.tableau import Tableau, collocated
from fricmb.integrate.trajectory import Trajectory


class OneStepMethod(Integrator):
    """An implicit one-step method by its nodes: subclass, name it, and say where it collocates.

    The rest is that of ``radau``: steps condensed to the contacts and Newton there, step control from the last Legendre
    coefficient of a step, transitions located within it, dense output, the energy ledger.

    Examples
    --------
    Collocation at thirds:

    >>> from dataclasses import dataclass
    >>> import fricmb as fm
    >>> from fricmb.integrate import OneStepMethod
    >>> @dataclass(frozen=True, kw_only=True)
    ... class Thirds(OneStepMethod):
    ...     name = "thirds"
    ...     order = "3"
    ...
    ...     def nodes(self, problem, rtol):
    ...         return (1 / 3, 2 / 3, 1.0)
    >>> sol = fm.simulate(fm.models.puck_on_belt(), t_end=1.0, rtol=1e-6, method=Thirds())
    >>> sol.stats.method, round(float(sol.events[0].t), 6)  # |V|/(mu g)
    ('thirds', 0.735065)
    """

    takes: ClassVar[frozenset[str]] = frozenset({"linear", "ports", "nonlinear"})
    pauses: ClassVar[bool] = True

    @abstractmethod
    def nodes(self, problem: Problem, rtol: float) -> Sequence[float]:
        """Where in a step of length 1 the equations hold: rising in (0, 1], the last node 1 (two to nine of them)."""

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
        tableau = collocated(tuple(float(c) for c in self.nodes(problem, tolerance.rtol)))
        return run_one_step(problem, start, t_end, tableau, tolerance, memory, progress)


def run_one_step(
    problem: Problem, start: Start, t_end: float, tableau: Tableau, tolerance: Tolerance, memory: float | None,
    progress: Callable[[float], None] | None,
) -> Trajectory:  # fmt: skip
    """A run by the formula of a tableau; see ``Integrator.integrate``."""
    with run_workspace(problem) as workspace, step_workspace(problem, tableau) as (one,):
        load_stages(problem)
        run = Collector(problem, start, t_end, workspace, one)
        set_accuracy(run, tolerance)
        return run_loop(run, run.begin(), one_step_loop(run, one), memory, progress)


def one_step_loop(run: Collector, one: OneStep) -> Callable[[], int]:
    """The loop over the steps of one formula."""
    return partial(
        drive, run.packed, run.scratch, run.y, run.end, one, run.acc, run.rest, run.old, run.rows, run.clock, *run.seen,
    )  # fmt: skip
