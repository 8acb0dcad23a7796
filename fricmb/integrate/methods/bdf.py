"""The general integrator: BDF of variable step and order between transitions, Radau IIA around them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np

from fricmb.integrate.compile.kernel import entry, kernel
from fricmb.integrate.contact.mode_decision import Rest
from fricmb.integrate.contact.transition import Before
from fricmb.integrate.integrator import Integrator, Tolerance, odd_stages
from fricmb.integrate.methods.attempt_step import Clock, advance
from fricmb.integrate.methods.backward_differences import (
    ON,
    SLOWER,
    WAIT,
    Differences,
    differences,
    hand_over,
    is_slower,
    may_begin,
    start_history,
)
from fricmb.integrate.methods.bdf_stability import Guard, guard_of, spectrum
from fricmb.integrate.methods.bdf_step import bdf_step
from fricmb.integrate.methods.bdf_transitions import note_loads
from fricmb.integrate.methods.one_step import run_one_step
from fricmb.integrate.methods.run_setup import Collector, cost, run_loop, set_accuracy, stages_for
from fricmb.integrate.methods.run_workspace import run_workspace, step_workspace
from fricmb.integrate.methods.time_loop import arrive, crowded
from fricmb.integrate.model.accelerations import slip_rate
from fricmb.integrate.model.forces import Scratch, set_instant
from fricmb.integrate.model.law_values import along
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.output.recorder import Rows
from fricmb.integrate.problem import LAW_SMOOTH, SLIP, Floats, Ints, Problem, Start
from fricmb.integrate.run.breakpoints import reached, set_window
from fricmb.integrate.run.outcomes import ACCEPTED, CHANGED, FULL, HANDOVER
from fricmb.integrate.run.stop import stopped
from fricmb.integrate.step.radau_step import Accuracy, OneStep
from fricmb.integrate.step.step_matrix import forget, jacobians
from fricmb.integrate.step.tableau import one_stage, radau
from fricmb.integrate.trajectory import Trajectory


@kernel
def calm(packed: Packed, y: State, h: float) -> bool:
    """Whether no slipping contact lands within a few steps h, nor has only begun to slip."""
    for k in range(y.mode.shape[0]):
        if y.mode[k] != SLIP or packed.ports.law[k] == LAW_SMOOTH:
            continue
        if along(packed.ports.row, k, y.n, y.g) < 3.0 * h * max(0.0, -slip_rate(packed, y, k)):
            return False
    return True


#: First steps of the one-step method, in which its size settles.
SETTLE = 8


@entry
def drive_bdf(
    packed: Packed, s: Scratch, y: State, end: State, one: OneStep, multi: OneStep, acc: Accuracy,
    past: Differences, guard: Guard, r: Rest, old: Before, out: Rows, clock: Clock, address: Ints,
) -> int:  # fmt: skip
    """Step from y until the end of the span, or until the space for rows is used up."""
    stop = set_window(clock, s.window, y.t[0])
    while True:
        if stopped() or crowded(out, one.tab.c.shape[0], y.mode.shape[0]):
            return FULL
        left = stop - y.t[0]
        if reached(y.t[0], stop):
            code = arrive(packed, s, y, r, old, out, clock, stop, address)
            stop = set_window(clock, s.window, y.t[0])
            one.last[1] = 0.0
            past.status[ON] = 0
        elif past.status[ON] == 1:
            code = bdf_step(packed, s, y, end, multi, acc, past, guard, out, left, address)
            if code == ACCEPTED and is_slower(past, clock.usual[0]):
                clock.h[0] = clock.usual[0]
            if code == HANDOVER:
                clock.h[0] = max(clock.h[0], past.h[0])
                hand_over(past)
        else:
            code = advance(packed, s, y, end, one, acc, r, old, out, clock, left, address)
            h = y.t[0] - end.t[0]
            if may_begin(past, code) and calm(packed, y, h):
                usual = past.good[0] if past.good[0] > 0.0 else h
                start_history(packed, s, end, y, one, past, min(usual, 0.25 * h), address)
                note_loads(packed, s, end, y, guard)
                if packed.elements.address.shape[0] > 0:
                    forget(multi.fac)
        if code > CHANGED:
            return code


@entry
def jacobian_at(packed: Packed, s: Scratch, y: State, one: OneStep) -> None:
    """The Jacobian of the structure at a state, for the spectrum."""
    set_instant(packed.signals, s, y.t[0], y.q, y.v)
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
        Of the one-step method, 2 to 9; by default from the tolerance (bodies that turn and joints: odd, 5).
    """

    name: ClassVar[str] = "bdf"
    order: ClassVar[str] = "1 to 5"
    takes: ClassVar[frozenset[str]] = frozenset({"linear", "ports", "nonlinear", "constraints"})
    pauses: ClassVar[bool] = True

    stages: int | None = None

    def refuses(self, problem: Problem) -> str | None:
        """Why this integrator cannot run the problem, or None."""
        return odd_stages(self.name, problem, self.stages) or super().refuses(problem)

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
            from fricmb.integrate import constrained

            count = self.stages or constrained.MULTISTEP_STAGES
            return constrained.run_mechanism(
                problem, start, t_end, tolerance, count, progress, memory, multistep=True
            )
        formula = radau(stages_for(problem, tolerance.rtol, self.stages))
        if np.any(problem.contacts.law == LAW_SMOOTH):
            # a steep law turns the force within a step, and with it the power, which no error test of BDF watches:
            # as many steps of Radau are far more accurate there
            return run_one_step(problem, start, t_end, formula, tolerance, memory, progress)
        single, several = step_workspace(problem, one_stage()), step_workspace(problem, formula)
        with run_workspace(problem) as workspace, several as (one,), single as (multi,):
            run = Collector(problem, start, t_end, workspace, one, multi, further=("start_history", "bdf_step"))
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
    past.status[WAIT], past.status[SLOWER] = SETTLE, 1
    return partial(
        drive_bdf, run.packed, run.scratch, run.y, run.end, one, multi, run.acc, past, guard_of(problem, spectral),
        run.rest, run.old, run.rows, run.clock, run.address,
    )  # fmt: skip
