"""A run of any ports on a linear structure: the one-step driver with steps whose structure is exact."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from fricmb.integrate.collocation.attempt_step import exact_attempt
from fricmb.integrate.collocation.exact_room import exact_lent
from fricmb.integrate.collocation.finish_step import exact_error, exact_finish, exact_record
from fricmb.integrate.collocation.root_along_step import exact_root
from fricmb.integrate.collocation.sample import sample_exact
from fricmb.integrate.integrator import Tolerance
from fricmb.integrate.methods.blocks_of_run import load_core, where_it_bends
from fricmb.integrate.methods.run_setup import Collector, run_loop, set_accuracy
from fricmb.integrate.methods.run_workspace import exact_step_workspace, run_workspace
from fricmb.integrate.methods.time_loop import drive
from fricmb.integrate.model.instant_workspace import InstantWorkspace
from fricmb.integrate.model.problem_structs import packed_of
from fricmb.integrate.output.row_trajectory import Chunk, RowTrajectory
from fricmb.integrate.problem import LAW_CONSTANT, Codes2, Floats, Floats2, Ints, Problem, Start
from fricmb.integrate.run.workspace import empty_arrays
from fricmb.integrate.step.coulomb_newton import plain_ports
from fricmb.integrate.step.exact_structure import Exact
from fricmb.integrate.step.one_step_room import OneStep, one_step_of
from fricmb.integrate.step.stages import Stages
from fricmb.integrate.step.step_matrix import Factor
from fricmb.integrate.step.tableau import radau
from fricmb.integrate.trajectory import Counters, Trajectory, Transitions

#: Blocks of a step.
BLOCKS = (
    exact_attempt.__name__, exact_error.__name__, exact_finish.__name__, exact_record.__name__, exact_root.__name__,
    "exact_tables",
)  # fmt: skip


def exact_step(problem: Problem, exact: Exact) -> OneStep:
    """Arrays for exact steps, which have no factors, and of stages nothing but their times and the last velocities."""
    s = exact.xf.shape[1]
    last = np.zeros((1, problem.n))
    stages = Stages(**(empty_arrays(Stages) | {"t": np.zeros(s), "hA": np.zeros((s, s)), "V": last}))
    return one_step_of(problem, radau(s), Factor(**empty_arrays(Factor)), stages, exact)


class ExactRun(RowTrajectory):
    """A run kept as the rows of its steps, with the node values of their inputs.

    ``exact``: number of nodes, and up to which w h modes are exact.
    """

    integrates = False

    def __init__(
        self, problem: Problem, chunks: list[Chunk], transitions: Transitions, counters: Counters, end: Start,
        failure: str | None, *, exact: tuple[int, float | None],
    ) -> None:  # fmt: skip
        super().__init__(problem, chunks, transitions, counters, end, failure)
        self._nodes, self._exact_up_to = exact

    def _fill(
        self, workspace: InstantWorkspace, index: Ints, t: Floats, side: Floats, out: Floats2, modes: Codes2,
        energies: bool, power: Floats2,
    ) -> None:  # fmt: skip
        packed, problem = packed_of(self.problem), self.problem
        sizes, pivots = np.zeros(4, np.int32), np.zeros(max(1, problem.m, problem.n), np.int32)
        with exact_lent(problem, self._nodes, 1.0, self._exact_up_to) as exact:
            sample_exact(
                packed, workspace.s, workspace.y, exact, self._values, self._mode, packed.breakpoints, index, t, side,
                out, modes, sizes, pivots,
            )  # fmt: skip


def run_general(
    problem: Problem, start: Start, t_end: float, tolerance: Tolerance, s: int, safety: float,
    exact_up_to: float | None, progress: Callable[[float], None] | None, memory: float | None,
) -> Trajectory:  # fmt: skip
    """Run with s nodes; a step may err by ``safety`` rtol; modes are exact up to a w h of ``exact_up_to``."""
    contacts = problem.contacts
    varies = bool(np.any(contacts.normal != 0))
    plain = not varies and not np.any(contacts.law != LAW_CONSTANT)
    nonlinear = len(problem.elements.table.address) > 0 or varies
    with (
        exact_lent(problem, s, safety, exact_up_to) as exact,
        exact_step_workspace(problem, exact, lambda: exact_step(problem, exact)) as (one,),
        run_workspace(problem) as workspace,
    ):
        columns = 1 + exact.P.size + s * (problem.n_z + problem.n_c + 2)
        ports = plain_ports.__name__ if plain else "general_ports"
        load_core(*BLOCKS, ports, *(("exact_ports",) if nonlinear else ()), *where_it_bends(problem))
        run = Collector(problem, start, t_end, workspace, one, columns=columns)
        one.w.plain = run.rest.w.plain = int(plain)
        set_accuracy(run, tolerance)
        run.made = partial(ExactRun, exact=(s, exact_up_to))
        return run_loop(run, run.begin(), _loop(run, one), memory, progress)


def _loop(run: Collector, one: OneStep) -> Callable[[], int]:
    """The loop over steps."""
    return partial(
        drive, run.packed, run.scratch, run.y, run.end, one, run.acc, run.rest, run.old, run.rows, run.clock, *run.seen,
    )  # fmt: skip
