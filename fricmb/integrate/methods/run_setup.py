"""What every run of this package's own loops needs around them: rooms, start, rows in chunks, the trajectory."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from fricmb.integrate.compile.room import room
from fricmb.integrate.contact.initial_modes import begin, natural_scales
from fricmb.integrate.contact.mode_decision import rest
from fricmb.integrate.contact.transition import Before
from fricmb.integrate.integrator import Tolerance
from fricmb.integrate.methods.attempt_step import Clock
from fricmb.integrate.model.forces import scratch
from fricmb.integrate.model.problem_structs import packed_of
from fricmb.integrate.model.state import state
from fricmb.integrate.output.recorder import rows, widths
from fricmb.integrate.output.row_trajectory import RowTrajectory
from fricmb.integrate.problem import Ints, Problem, Start
from fricmb.integrate.run.chunks import Chunks, counters, end_of
from fricmb.integrate.run.outcomes import DONE, FAIL_INFINITE, FAIL_MODES, FAIL_REDUNDANT, FAILURES, FULL
from fricmb.integrate.run.stop import ended, watched
from fricmb.integrate.step.band_matrix import places_of
from fricmb.integrate.step.contact_unknowns import port_state
from fricmb.integrate.step.exact_structure import no_exact
from fricmb.integrate.step.radau_step import Accuracy, OneStep
from fricmb.integrate.step.stages import stages
from fricmb.integrate.step.step_matrix import factor
from fricmb.integrate.step.tableau import Tableau

#: Rows that a kernel fills before they are taken out: so many, or so many bytes.
CHUNK, CHUNK_BYTES = 4096, 3e7


#: Part of a scene's natural velocities and positions that counts as noise.
NOISE = 1e-11


def accuracy(run: Collector, tolerance: Tolerance) -> Accuracy:
    """Running scales at the start; ``atol``, or a trifle of what the scene's forces bring, gives floors under them."""
    problem, start = run.problem, run.start
    given = (tolerance.atol_q, tolerance.atol_v)
    floor_q, floor_v = (
        NOISE * natural if atol is None else np.array(np.broadcast_to(np.asarray(atol) / tolerance.rtol, problem.n))
        for atol, natural in zip(given, (run.natural_q, run.natural_v), strict=True)
    )
    q, v, z = (np.abs(np.asarray(x, float)) for x in (start.q, start.v, start.z))
    r, grain = np.zeros(problem.n_c), np.zeros(problem.n)
    return room(Accuracy(np.array([tolerance.rtol]), q, v, z, r, floor_q, floor_v, grain))


def one_step(problem: Problem, tableau: Tableau, counts: np.ndarray) -> OneStep:
    """Room for steps of one tableau."""
    s, nc = len(tableau.c), problem.n_c
    return room(OneStep(
        tableau, factor(problem, tableau), stages(problem, tableau), port_state(problem, s),
        np.zeros(nc + problem.n_z), np.zeros(problem.n), np.zeros(2), counts, np.zeros((s, nc + 2)),
        np.zeros(problem.n_z), np.zeros(s), np.zeros(s + 1), np.zeros((s, nc)), no_exact(),
    ))  # fmt: skip


class Collector:
    """State and rooms of one run; takes the rows out of the kernels' room chunk by chunk.

    ``made``: what is made of them in the end; ``columns``: what a method adds to a row.
    """

    made: Callable[..., RowTrajectory] = staticmethod(RowTrajectory)

    def __init__(
        self, problem: Problem, start: Start, t_end: float, *further: str, places: Ints | None = None, columns: int = 0
    ) -> None:
        self.problem = problem
        self.start = start
        self.t_end = t_end
        self.packed = packed_of(problem)
        self.scratch = scratch(problem)
        self.y = state(problem, start)
        self.end = state(problem, start)
        self.chunk = int(np.clip(CHUNK_BYTES / (8 * sum(widths(problem))), 64, CHUNK))
        self.rest = rest(problem, self.packed)
        self.old = room(Before(np.zeros(problem.n_c, np.int8), np.zeros(problem.m)))
        self.rows = rows(problem, self.chunk, columns)
        self.counts = np.zeros(8, np.int64)
        half = int(self.packed.structure.half[0])
        self.address = places_of(half, "step_error", *further) if places is None else places
        self.natural_v, self.natural_q = natural_scales(
            problem, self.packed, self.scratch, start.t, t_end - start.t, start.q
        )
        self.packed.ports.noise[:] = NOISE * np.max(self.natural_v, initial=0.0)
        self.rest.small[:] = 1e-4 * NOISE * np.max(self.natural_v, initial=0.0)
        self.chunks = Chunks(self.rows, "values", "kind", "mode")

    def begin(self) -> int:
        """Modes, forces and accelerations at the start; the first row.  Returns DONE or a code of failure."""
        given = self.start.mode is not None
        # a function of time that switches right at the start has switched
        self.scratch.window[0] = self.start.t + 4e-16 * abs(self.start.t) + 1e-300
        rooms = (self.packed, self.scratch, self.y, self.rest, self.old)
        code = watched(begin, *rooms, given, self.rows, self.address)
        return (DONE, FAIL_MODES, FAIL_REDUNDANT, FAIL_INFINITE)[code]

    def trajectory(self, failure: str | None) -> RowTrajectory:
        """The run so far."""
        if self.rows.used[0] or not self.chunks.parts:
            self.chunks.take()
        if self.chunks.broken:
            failure = failure or FAILURES[FAIL_INFINITE]
        found = self.chunks.transitions(), counters(self.counts), end_of(self.y), failure
        return self.made(self.problem, self.chunks.parts, *found)


def stages_for(problem: Problem, rtol: float, wanted: int | None) -> int:
    """Stages of the one-step method that are fastest at a tolerance (measured); many contacts make stages dear."""
    if wanted is not None:
        return wanted
    if problem.m + problem.n_z > 6:
        return 3 if rtol > 1e-4 else 5 if rtol > 1e-9 else 7
    return 3 if rtol > 1e-3 else 5 if rtol > 1e-5 else 6 if rtol > 1e-7 else 7


def cost(problem: Problem, stages: int) -> float:
    """Cost of a step of so many stages, about in microseconds (measured; only ratios are used)."""
    u = stages * (problem.m + problem.n_z + problem.n_v)
    ports = 0.02 * u**2 + 0.0005 * u**3
    if packed_of(problem).structure.half[0] >= 0:  # vectors count, not matrices
        return 1.5 + 0.1 * (stages + 1.5) * problem.n + ports
    return 1.5 + 0.5 * stages + 0.002 * stages * problem.n**2 + ports


def run_loop(
    run: Collector, code: int, step: Callable[[Clock], int], memory: float | None,
    progress: Callable[[float], None] | None,
) -> RowTrajectory:  # fmt: skip
    """Let ``step`` fill the room for rows, again and again, until the end of the run, of memory, or a failure."""
    if code == DONE:
        code = run.chunks.fill(partial(step, clock_of(run)), run.y.t, memory, progress)
    if code == DONE:
        return run.trajectory(None)
    return run.trajectory(ended() or (None if code == FULL else FAILURES[code]))


def first_step(run: Collector) -> float:
    """A careful first step: a small part of the fastest oscillation and of the time in which velocities change."""
    span = run.t_end - run.start.t
    h = 0.01 * span
    if len(run.problem.omega):
        h = min(h, 0.1 / max(float(np.max(run.problem.omega)), 1e-300))
    v, a = np.max(np.abs(run.y.v), initial=0.0), np.max(np.abs(run.y.a), initial=0.0)
    if a > 0.0 and v > 0.0:
        h = min(h, 0.1 * v / a)
    return float(max(h, 1e-12 * span))


def clock_of(run: Collector) -> Clock:
    """Step control at the start of a run."""
    h = np.array([first_step(run)])
    span = np.array([run.start.t, run.t_end])
    return room(Clock(h, h.copy(), span, run.packed.breakpoints, np.zeros(2, np.int64), np.zeros(2), np.zeros(2)))
