"""Workspaces of evaluations and runs of a mechanism, lent by their sizes."""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import NamedTuple

from fricmb.integrate.constrained.dense_rows import has_dense_rows
from fricmb.integrate.constrained.moving import Moving, lengths, moving_of
from fricmb.integrate.constrained.pattern import of_pattern
from fricmb.integrate.constrained.problem_structs import mech_of
from fricmb.integrate.constrained.radau_step import Control, control_of
from fricmb.integrate.constrained.stages import Stages, facts_of, stages_of
from fricmb.integrate.constrained.state import Instant, State, instant_of, state_of
from fricmb.integrate.constrained.structure import mechanism_of
from fricmb.integrate.constrained.turning import turning_rows
from fricmb.integrate.constrained.watch import Watch, watch_of
from fricmb.integrate.model.forces import longest_call
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import Problem
from fricmb.integrate.run.workspace import lent
from fricmb.integrate.step.tableau import Tableau


class Evaluation(NamedTuple):
    """For what is to be known at single instants."""

    k: Moving
    w: Instant
    y: State


class RunWorkspace(NamedTuple):
    """For a run: evaluation, the state, the end and the start of a step, stages, what is watched, step control."""

    k: Moving
    w: Instant
    y: State
    end: State
    before: State
    st: Stages
    out: Watch
    control: Control


def evaluation(problem: Problem) -> AbstractContextManager[Evaluation]:
    """Workspace for evaluating a problem; the state is empty."""
    key = "mechanism at an instant", _sizes(problem), has_dense_rows(problem, mechanism_of(problem))
    return lent(key, lambda: Evaluation(moving_of(problem), instant_of(problem), state_of(problem)))


def run_workspace(problem: Problem, tab: Tableau) -> AbstractContextManager[RunWorkspace]:
    """Workspace for a run by a formula; states are empty."""
    facts = once_per(problem, "facts of stages", lambda: facts_of(problem))
    return lent(("run of a mechanism", tab.c.tobytes(), _sizes(problem), facts), lambda: _made(problem, tab))


def _made(problem: Problem, tab: Tableau) -> RunWorkspace:
    y, end, before = (state_of(problem) for _ in range(3))
    st = stages_of(problem, tab)
    out = watch_of(problem, len(tab.c))
    return RunWorkspace(moving_of(problem), instant_of(problem), y, end, before, st, out, control_of(problem, st))


def _sizes(problem: Problem) -> tuple[int, ...]:
    """All that the arrays of a problem's workspaces are long."""
    return of_pattern(problem, "sizes of workspaces", lambda: _find_sizes(problem))


def _find_sizes(problem: Problem) -> tuple[int, ...]:
    m, order = mechanism_of(problem), mech_of(problem).order
    own = problem.n, problem.n_u, problem.n_z, problem.m, problem.n_c, problem.signals.breakpoints.size
    joints = m.n_y, m.n_rows, len(m.joints.port), turning_rows(problem)
    return (*lengths(problem), *longest_call(problem), *own, *joints, *order.sizes.tolist())
