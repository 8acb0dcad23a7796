"""The integrator: chooses nodes, keeps what it prepares, turns a run into a trajectory."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np

from fricmb.errors import SceneError
from fricmb.integrate.collocation.nodes import Z_EXACT
from fricmb.integrate.collocation.one_contact.constants import structure
from fricmb.integrate.collocation.one_contact.prepare import (
    Rows,
    is_single,
    is_stiff,
    longest_step,
    set_longest_step,
    with_rows,
)  # fmt: skip
from fricmb.integrate.collocation.one_contact.room import Run
from fricmb.integrate.collocation.one_contact.run import (
    DONE,
    ENDLESS,
    FULL,
    NOT_FINITE,
    UNDERFLOW,
    UNSETTLED,
    run_single,
)  # fmt: skip
from fricmb.integrate.collocation.one_contact.trajectory import SingleRun
from fricmb.integrate.collocation.one_contact.workspace import (
    borrowed,
    filled,
    goes_back,
    lengthened,
    may_grow,
    within,
)  # fmt: skip
from fricmb.integrate.collocation.structure_blocks import NoBlocks
from fricmb.integrate.integrator import Integrator, Tolerance
from fricmb.integrate.model.problem_structs import softness
from fricmb.integrate.problem import SLIP, STICK, Floats, Problem, Start
from fricmb.integrate.run.chunks import counters
from fricmb.integrate.run.memory import KEEPS_LESS, lengthen
from fricmb.integrate.run.stop import ended, in_slices
from fricmb.integrate.trajectory import Trajectory, Transitions

_FAILURES = {
    UNDERFLOW: "the step fell to nothing: the direction of slip cannot be resolved",
    ENDLESS: "transitions without end at one instant",
    NOT_FINITE: "the state grew beyond floating-point numbers",
}

#: Bytes that twice as many rows take beside those there are, per byte of these: the others are let go, and a result is
#: made of the longer ones, of some 1.2 times their size.
GROWTH = 3.4


@dataclass(frozen=True, kw_only=True)
class Collocation(Integrator):
    """Radau IIA collocation of the force of one contact alone; the linear structure between transitions is exact.

    For one contact under constant friction, in one direction or in the plane, and loads that are linear in time.

    Attributes
    ----------
    nodes : int or None
        Number of nodes, 4 to 9; None: from the tolerance.
    safety : float
        Tolerance of a step per ``rtol``: errors of single steps come out far smaller at the end of a run.
    """

    nodes: int | None = None
    safety: float = 300.0

    name: ClassVar[str] = "collocation"
    order: ClassVar[str] = "7 to 17"
    takes: ClassVar[frozenset[str]] = frozenset({"linear", "ports"})
    pauses: ClassVar[bool] = True

    def __post_init__(self) -> None:
        """Check the fields."""
        if self.nodes is not None and self.nodes not in Z_EXACT:
            raise SceneError(f"collocation: nodes={self.nodes!r}; expected a number from 4 to 9, or None")
        if not 0.0 < self.safety < math.inf:
            raise SceneError(f"collocation: safety={self.safety!r}; expected a positive number")

    def refuses(self, problem: Problem) -> str | None:
        """Why this integrator cannot run the problem, or None."""
        against = super().refuses(problem)
        if against is not None:
            return against
        if not is_single(problem):
            return (
                "collocation takes one contact under constant friction, a constant normal force and loads that are"
                " linear in time; 'radau', 'bdf' and 'auto' take any scene"
            )
        if softness(problem) > 0.0:
            return "collocation needs a contact whose force in stick is determined; here its directions are redundant"
        try:
            structure(problem)
        except NoBlocks as error:
            return f"collocation needs the structure in blocks; here {error}"
        return None

    def creeps(self, problem: Problem, span: float, rtol: float) -> bool:
        """Whether damped parts force thousands of steps over a span that nothing else asks for."""
        return is_stiff(problem, nodes_for(rtol) if self.nodes is None else self.nodes, span)

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
        """Run from ``start`` to ``t_end`` (see :class:`Integrator`)."""
        s = nodes_for(tolerance.rtol) if self.nodes is None else self.nodes
        # where tolerances are loose a step may still not err by more than 0.5 %
        safety = min(self.safety, 0.005 / tolerance.rtol)
        with borrowed(problem, s) as held:
            return _run_in(held, problem, start, t_end, tolerance, s, safety, progress, memory)


def nodes_for(rtol: float) -> int:
    """Nodes that take the least time to a tolerance (with fewer, exact weights end at shorter steps)."""
    if rtol > 3e-5:
        return 7
    return 8 if rtol > 3e-10 else 9


def _set_state(run: Run, start: Start, tolerance: Tolerance) -> None:
    run.pos_low[:] = 0.0
    run.g[:] = run.n[:] = 0.0
    run.time_low = run.loss = 0.0
    run.used[:] = run.counts[:] = 0
    run.pos[:], run.vel[:], run.scale[:] = start.q, start.v, np.abs(start.v)
    if tolerance.atol_v is not None:
        np.maximum(run.scale, tolerance.atol_v / tolerance.rtol, out=run.scale)
    run.time, run.next_step, run.first_step = start.t, run.ladder[8], run.ladder[8]
    run.bound = tolerance.max_step
    run.searched = run.looks = 0.0  # a run that was ended may have left them
    w = run.belt
    g = run.wt @ start.v - w
    speed = math.sqrt(g @ g)
    run.mode = UNSETTLED
    if start.mode is not None and start.mode[0] == STICK:
        run.mode = STICK
    elif speed > 1e-15 * (np.abs(run.wt) @ np.abs(start.v) + np.abs(w)).max(initial=0.0):
        run.mode, run.g[:], run.n[:] = SLIP, g, g / speed
    elif start.mode is not None and start.mode[0] == SLIP and start.direction is not None:
        run.mode, run.n[:] = SLIP, start.direction


def _run_in(
    held: list[Run], problem: Problem, start: Start, t_end: float, tolerance: Tolerance, s: int, safety: float,
    progress: Callable[[float], None] | None, memory: float | None,
) -> Trajectory:  # fmt: skip
    run = within(held[0], memory)
    if t_end > start.t:
        set_longest_step(run, min(longest_step(problem, s, t_end - start.t), tolerance.max_step))
    _set_state(run, start, tolerance)
    tell = None if progress is None else lambda: progress(float(run.time))
    short = None
    while True:
        code = in_slices(run_single, run, t_end, safety * tolerance.rtol, Z_EXACT[s] * 1.0001, tell=tell)
        rows = Rows(run.steps, run.kinds, run.phases, run.events)
        if code != FULL or ended() is not None or not may_grow(rows, memory):
            break
        wanted = GROWTH * filled(rows, run.used)
        longer, short = lengthen(partial(lengthened, rows), wanted, "collocation", int(run.used[0]), KEEPS_LESS)
        if longer is None:
            break
        run = held[0] = with_rows(run, longer)
        del rows, longer  # while the next ones fill
    n_rows, phases, n_events = (int(i) for i in run.used)
    rows = Rows(run.steps[:n_rows], run.kinds[:n_rows], run.phases[:phases], run.events[:n_events])
    if goes_back(run):
        rows = Rows._make(x.copy() for x in rows)
    transitions = Transitions(
        t=rows.events[:, 0].copy(), contact=np.zeros(n_events, dtype=np.int64), kind=rows.events[:, 1].astype(np.int64)
    )
    end = Start(
        t=float(run.time + run.time_low), q=run.pos + run.pos_low, v=run.vel.copy(), z=np.zeros(0),
        mode=np.array([run.mode], np.int8), direction=run.n.copy(),
    )  # fmt: skip
    failure = None if code == DONE else ended() or short or _FAILURES.get(code)
    return SingleRun(problem, s, rows, transitions, counters(run.counts), end, failure)
