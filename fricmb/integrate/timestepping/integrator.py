"""The integrator: options, step from the tolerance, the run, what is kept."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from fricmb.errors import SceneError, shown
from fricmb.integrate.compile.exchange import with_arrays
from fricmb.integrate.integrator import Integrator, Tolerance
from fricmb.integrate.problem import Floats, Problem, Start
from fricmb.integrate.run.chunks import telling
from fricmb.integrate.run.outcomes import FAIL_INFINITE
from fricmb.integrate.run.outcomes import FAILURES as OUTCOMES
from fricmb.integrate.run.stop import ended, watched
from fricmb.integrate.step.step_control import SAMPLED
from fricmb.integrate.timestepping.doubts import kinks, short_phases
from fricmb.integrate.timestepping.layout import HERE
from fricmb.integrate.timestepping.prepare import refusal, run_of
from fricmb.integrate.timestepping.room import Run
from fricmb.integrate.timestepping.scales import add_floors, with_parts
from fricmb.integrate.timestepping.start import begin
from fricmb.integrate.timestepping.time_loop import DONE, FULL, NEGATIVE, NOT_FINITE, drive
from fricmb.integrate.timestepping.trajectory import SteppedRun, SteppedStart
from fricmb.integrate.trajectory import Counters, Transitions

#: A start at which a load or a belt has no value.
NO_START = -1
FAILURES = {
    NOT_FINITE: "the state grew beyond what numbers hold",
    NEGATIVE: "the coefficient of a friction law is negative at the slip speed reached: friction would drive",
    NO_START: OUTCOMES[FAIL_INFINITE],
}
#: What is no number to go on with: functions of time are asked 1e-300 behind a start at 0, where 1/t is 1e300.
INFINITE = 1e290
#: Errors of a step: TIGHT rtol^(3/2) in smooth motion (third order, so that their sum goes with rtol), LOOSE rtol where
#: a transition falls into it.
TIGHT, LOOSE = 3.0, 1.0
#: Numbers in the space for rows.
ROWS = 2e6


@dataclass(frozen=True, kw_only=True)
class TimeStepping(Integrator):
    """Implicit steps of second order over all transitions, all contacts solved together over their cones.

    For scenes with more transitions than can be located one by one, and for large scenes of any kind: any linear
    structure, contacts of one or two directions, constant or speed-dependent coefficients, varying normal forces.

    Attributes
    ----------
    fixed_step : float or None
        Length of all steps, without control of the error; None: from the tolerance.
    residual : float
        Of the contact problem of a step, |F - P(F - g/d)| over the largest mu N; 1e-14 to 1e-3.
    contacts : str or None
        "band": in the band of the structure; "condensed": by their responses; None: the cheaper.
    """

    fixed_step: float | None = None
    residual: float = 1e-10
    contacts: str | None = None

    name: ClassVar[str] = "timestepping"
    order: ClassVar[str] = "2"
    takes: ClassVar[frozenset[str]] = frozenset({"linear", "ports"})
    pauses: ClassVar[bool] = True
    steps_over: ClassVar[bool] = True

    def __post_init__(self) -> None:
        h = self.fixed_step
        if h is not None and not (isinstance(h, int | float) and 0.0 < h < np.inf):
            raise SceneError(f"TimeStepping: fixed_step: got {shown(h)}; expected a positive time or None")
        if not (isinstance(self.residual, float) and 1e-14 <= self.residual <= 1e-3):
            raise SceneError(
                f"TimeStepping: residual: got {shown(self.residual)};"
                " expected a number from 1e-14 to 1e-3"
            )
        if self.contacts not in (None, "band", "condensed"):
            raise SceneError(
                f"TimeStepping: contacts: got {shown(self.contacts)};"
                " expected 'band', 'condensed' or None"
            )

    def refuses(self, problem: Problem) -> str | None:
        """Why this integrator cannot run the problem, or None."""
        general = super().refuses(problem)
        if general is not None:
            return general
        reason = refusal(problem)
        return None if reason is None else f"timestepping: {reason}"

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
    ) -> SteppedRun:
        """Run from ``start`` to ``t_end`` (see :class:`Integrator`)."""
        width = 2 * problem.n + 2 * problem.m + 2 * problem.n_c + 4
        capacity = int(np.clip(ROWS / width, 8, 1024))
        run = run_of(problem, self.contacts, capacity)
        run = self._set_start(problem, run, start, t_end, tolerance)
        watched(begin, run, start.mode is not None)
        chunks: list[dict[str, Any]] = []
        held = 0
        code = FULL if _has_values(run) else NO_START
        while code == FULL and (memory is None or held < memory) and ended() is None:
            with telling(progress, lambda: float(run.time)):
                code = watched(drive, run)
            chunks.append(_emptied(run))
            held += 8 * width * len(chunks[-1]["row_t"])
            if progress is not None:
                progress(run.time)
        if held == 0:  # ended before its first step
            chunks.append(_start_alone(run))
        failure = None if code == DONE else ended() or FAILURES.get(code)
        promised = np.inf if self.fixed_step else tolerance.rtol
        return _trajectory(problem, run, chunks, failure, promised)

    def _set_start(self, problem: Problem, run: Run, start: Start, t_end: float, tolerance: Tolerance) -> Run:
        run.q[HERE], run.v[HERE] = start.q, start.v
        if start.mode is not None:
            run.mode[HERE] = start.mode
        if isinstance(start, SteppedStart):
            for name in _HELD:
                getattr(run, name)[HERE] = getattr(start, name)
        run.top_q[:], run.top_v[:] = np.abs(start.q), np.abs(start.v)
        if tolerance.atol_q is not None:
            run.floor_q[:] = tolerance.atol_q / tolerance.rtol
        if tolerance.atol_v is not None:
            run.floor_v[:] = tolerance.atol_v / tolerance.rtol
        run = with_parts(run, tolerance.parts)
        add_floors(run, t_end - start.t)
        breaks = problem.signals.breakpoints
        inside = np.unique(breaks[(breaks > start.t) & (breaks < t_end)])
        span = t_end - start.t
        fastest = float(np.max(problem.omega, initial=0.0))
        run.time, run.end, run.residual = start.t, t_end, self.residual
        run.tol, run.leeway = TIGHT * tolerance.rtol**1.5, LOOSE / (TIGHT * tolerance.rtol**0.5)
        run.longest = SAMPLED * span if problem.loads_bend else span
        run.shortest, run.fixed_step = 1e-9 * span, self.fixed_step or 0.0
        run.step = min(0.01 * span, 0.3 / fastest) if fastest > 0.0 else 0.01 * span
        run.settled = 1e-10 if self.fixed_step else min(1e-4, 0.01 * tolerance.rtol)
        run.goes_on = int(isinstance(start, SteppedStart))
        run.varying = int(run.var.any())
        return with_arrays(run, stops=np.append(inside, t_end))


def _has_values(run: Run) -> bool:
    """Whether prescribed functions have values where the run starts: behind a pole there are steps, but no motion."""
    return bool(np.all(np.abs(run.u[HERE]) < INFINITE) and np.all(np.abs(run.w[HERE]) < INFINITE))


_HELD = ("F", "ends", "hold", "grip", "when", "known")
_ROWS = ("row_t", "row_q", "row_v", "row_F", "row_g", "row_N", "row_mode", "row_loss", "row_x")


def _emptied(run: Run) -> dict[str, Any]:
    """What the space for rows and transitions holds, taken out of it."""
    rows, events = int(run.n_rows), int(run.n_events)
    taken = {name: getattr(run, name)[:rows].copy() for name in _ROWS}
    taken["event"] = run.event[:events].copy()
    run.n_rows, run.n_events = 0, 0
    return taken


def _start_alone(run: Run) -> dict[str, Any]:
    """The start as the one row of a run."""
    run.row_t[0], run.row_F[0] = run.time, run.ends[HERE]
    for name in ("q", "v", "g", "mode"):
        getattr(run, f"row_{name}")[0] = getattr(run, name)[HERE]
    run.row_N[0], run.row_loss[0], run.row_x[0] = np.where(run.var == 1, 0.0, run.N), 0.0, 0.0
    run.n_rows = 1
    return _emptied(run)


def _trajectory(
    problem: Problem, run: Run, chunks: list[dict[str, Any]], failure: str | None, rtol: float
) -> SteppedRun:
    event = np.concatenate([chunk.pop("event") for chunk in chunks])
    event = event[np.argsort(event[:, 0], kind="stable")]
    transitions = Transitions(t=event[:, 0].copy(), contact=event[:, 1].astype(int), kind=event[:, 2].astype(int))
    notes: tuple[str, ...] = ()
    if run.n_unsettled:
        unsettled = f"{run.n_unsettled} of {run.n_steps} steps"
        notes = (f"{unsettled} were taken though their error or lag is above the tolerance",)
    notes += short_phases(problem, np.concatenate([chunk["row_t"] for chunk in chunks]), transitions)
    notes += kinks(problem, chunks, transitions, rtol)
    counters = Counters(
        n_steps=run.n_steps, n_rejected=run.n_rejected, n_rhs=run.n_rounds, n_jac=run.n_newton,
        n_lu=run.n_factor, notes=notes,
    )  # fmt: skip
    direction = np.zeros(problem.m)
    row = problem.contacts.row
    for k in range(problem.n_c):
        part = run.g[HERE, row[k] : row[k + 1]]
        direction[row[k] : row[k + 1]] = part / (np.hypot.reduce(part) or 1.0)
    end = SteppedStart(
        t=float(run.time), q=run.q[HERE].copy(), v=run.v[HERE].copy(), z=np.zeros(0), mode=run.mode[HERE].copy(),
        direction=direction, **{name: getattr(run, name)[HERE].copy() for name in _HELD},
    )  # fmt: skip
    return SteppedRun(problem, chunks, transitions, counters, end, failure)
