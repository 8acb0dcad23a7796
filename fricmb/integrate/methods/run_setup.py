"""What every run of this package's own loops needs around them: a workspace, start, rows in chunks, the trajectory."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fricmb.integrate.contact.initial_modes import begin, natural_scales
from fricmb.integrate.contact.rest_problem import fill_rest
from fricmb.integrate.integrator import Tolerance
from fricmb.integrate.methods.run_workspace import RunWorkspace
from fricmb.integrate.model.problem_structs import packed_of
from fricmb.integrate.model.state import set_out
from fricmb.integrate.model.structure import Structure
from fricmb.integrate.output.recorder import rows, widths
from fricmb.integrate.output.row_trajectory import RowTrajectory
from fricmb.integrate.problem import Problem, Start
from fricmb.integrate.run.chunks import Chunks, counters, end_of
from fricmb.integrate.run.outcomes import DONE, FAIL_INFINITE, FAIL_MODES, FAIL_REDUNDANT, FAILURES, FULL
from fricmb.integrate.run.stop import ended
from fricmb.integrate.signals.longest_steps import LongestSteps, steps_of_run
from fricmb.integrate.step.one_step_room import Accuracy, OneStep
from fricmb.integrate.step.stages import STIFF
from fricmb.integrate.step.step_control import FREE, SAMPLED, first_step

#: Rows that a kernel fills before they are taken out: so many, or so many bytes.
CHUNK, CHUNK_BYTES = 4096, 1e6


#: What is no number to go on with: functions of time are asked 1e-300 behind a start at 0, where 1/t is 1e300.
INFINITE = 1e290
#: Part of a scene's natural velocities and positions that counts as noise.
NOISE = 1e-11


def set_accuracy(run: Collector, tolerance: Tolerance) -> Accuracy:
    """Running scales at the start; ``atol``, or a trifle of what the scene's forces bring, gives floors under them."""
    start, acc = run.start, run.acc
    acc.rtol = tolerance.rtol
    given = (tolerance.atol_q, tolerance.atol_v)
    for floor, atol, natural in zip((acc.floor_q, acc.floor_v), given, (run.natural_q, run.natural_v), strict=True):
        floor[:] = NOISE * natural if atol is None else np.asarray(atol) / tolerance.rtol
    for scale, value in ((acc.q, start.q), (acc.v, start.v), (acc.z, start.z)):
        scale[:] = np.abs(value)
    for one in run.steps:
        one.w.slope[:] = 0.0
    limits = steps_of_run(run.problem, start.t, run.t_end, tolerance)
    run.seen = limits.edge, limits.longest
    return acc


class Collector:
    """State and workspace of one run; takes the rows out of the recorder chunk by chunk.

    ``workspace``: lent, all else is made; ``steps``: those of the formulas, which count their work; ``made``: what is
    made of rows in the end; ``columns``: what a method adds to a row.
    """

    made: Callable[..., RowTrajectory] = staticmethod(RowTrajectory)

    def __init__(
        self, problem: Problem, start: Start, t_end: float, workspace: RunWorkspace, *steps: OneStep,
        columns: int = 0,
    ) -> None:  # fmt: skip
        self.problem = problem
        self.start = start
        self.t_end = t_end
        self.steps = steps
        self.packed = packed_of(problem)
        self.scratch, self.y, self.end, self.rest, self.old, self.acc, self.clock = workspace
        set_out(self.y, start)
        set_out(self.end, start)
        self.chunk = int(np.clip(CHUNK_BYTES / (8 * (sum(widths(problem)) + columns)), 64, CHUNK))
        self.rows = rows(problem, self.chunk, columns)
        self.natural_v, self.natural_q = natural_scales(
            problem, self.packed, self.scratch, start.t, t_end - start.t, start.q
        )
        self.acc.noise = NOISE * np.max(self.natural_v, initial=0.0)
        fill_rest(self.rest, self.packed)
        self.rest.small[:] = 1e-4 * NOISE * np.max(self.natural_v, initial=0.0)
        self.chunks = Chunks(self.rows, "values", "kind", "mode")
        unlimited = LongestSteps.none()
        self.seen = unlimited.edge, unlimited.longest

    def begin(self) -> int:
        """Modes, forces and accelerations at the start; the first row.  Returns DONE or a code of failure."""
        given = self.start.mode is not None
        # a function of time that switches right at the start has switched
        self.scratch.window[0] = self.start.t + 4e-16 * abs(self.start.t) + 1e-300
        rooms = (self.packed, self.scratch, self.y, self.rest, self.old)
        code = begin(*rooms, given, self.rows)
        if not self._finite():
            return FAIL_INFINITE
        return (DONE, FAIL_MODES, FAIL_REDUNDANT, FAIL_INFINITE)[code]

    def _finite(self) -> bool:
        """Whether all that acts at the start has a value: no step from there ends, however short."""
        y, s = self.y, self.scratch
        return all(np.all(np.abs(x) < INFINITE) for x in (y.a, y.F, y.N, y.g, y.wd, y.zd, s.X))

    def trajectory(self, failure: str | None) -> RowTrajectory:
        """The run so far."""
        if self.rows.used[0] or not self.chunks.parts:
            self.chunks.take()
        if self.chunks.broken:
            failure = failure or FAILURES[FAIL_INFINITE]
        counts = np.sum([one.counts for one in self.steps], axis=0)
        found = self.chunks.transitions(), counters(counts), end_of(self.y), failure
        run = self.made(self.problem, self.chunks.parts, *found)
        run.rtol = float(self.acc.rtol)
        return run


def run_loop(
    run: Collector, code: int, step: Callable[[], int], memory: float | None,
    progress: Callable[[float], None] | None,
) -> RowTrajectory:  # fmt: skip
    """Let ``step`` fill the space for rows, again and again, until the end of the run, of memory, or a failure."""
    if code == DONE:
        set_clock(run)
        code = run.chunks.fill(step, run.y, memory, progress)
    if code == DONE:
        return run.trajectory(None)
    return run.trajectory(ended() or (None if code == FULL else FAILURES[code]))


#: Part of a run that a step may take with exact structure.
COLLOCATED = 0.02


def longest_step(run: Collector) -> float:
    """The longest step that is taken, whatever its error.

    Where nothing moves no error says how fast a prescribed load changes, so these are looked at a hundred times; with
    exact structure they are among what is collocated, and the error knows them.  Without loads the error knows all
    but what stiff parts leave to round-off, which grows with steps.
    """
    problem, span = run.problem, run.t_end - run.start.t
    if len(run.steps[0].exact.ladder):
        return COLLOCATED * span
    nonlinear = len(problem.elements.table.address) > 0
    short = problem.loads_bend or nonlinear or structure_is_stiff(run.packed.structure, FREE * span)
    return SAMPLED * span if short else FREE * span


def structure_is_stiff(structure: Structure, h: float) -> bool:
    """Whether forces of springs and dampers over a step h are far above those of inertia; see ``stages.stiffness``."""
    inertia = np.repeat(structure.M[structure.own], np.diff(structure.first))
    return bool(np.any(h * (np.abs(structure.C) + h * np.abs(structure.K)) > STIFF * inertia))


#: Part that a first step takes of the fastest oscillation, and of the time in which velocities change.
PART = 0.1


def set_clock(run: Collector) -> None:
    """Step control at the start of a run."""
    clock = run.clock
    omega = float(np.max(run.problem.omega, initial=0.0))
    clock.h = clock.usual = first_step(run.y.v, run.y.a, run.t_end - run.start.t, PART, omega)
    clock.span[:] = run.start.t, run.t_end
    clock.knot = -np.inf
    clock.bound = longest_step(run)
    clock.stops[:] = run.packed.breakpoints
