"""Workspaces of runs of scenes without joints, lent by their sizes."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import NamedTuple

import numpy as np

from fricmb.integrate.contact.rest_problem import Rest, rest_of
from fricmb.integrate.contact.transition import Before
from fricmb.integrate.methods.attempt_step import Clock
from fricmb.integrate.model.forces import Scratch, scratch_of
from fricmb.integrate.model.instant_workspace import sizes_of
from fricmb.integrate.model.state import State, state_of
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import Problem
from fricmb.integrate.run.workspace import Store, lent
from fricmb.integrate.step.exact_structure import Exact, no_exact
from fricmb.integrate.step.one_step_room import Accuracy, OneStep, one_step_of
from fricmb.integrate.step.stages import stages
from fricmb.integrate.step.step_matrix import changes, factor
from fricmb.integrate.step.tableau import Tableau


class RunWorkspace(NamedTuple):
    """Evaluation, the present state and the end of a step, contacts at rest, modes before, scales, step control."""

    s: Scratch
    y: State
    end: State
    rest: Rest
    old: Before
    acc: Accuracy
    clock: Clock


class StepWorkspace(NamedTuple):
    """For steps of one formula."""

    one: OneStep


def run_workspace(problem: Problem) -> AbstractContextManager[RunWorkspace]:
    """Workspace for a run by any method; states are empty."""
    return lent(("run", sizes_of(problem)), lambda: made(problem))


def step_workspace(problem: Problem, tableau: Tableau) -> AbstractContextManager[StepWorkspace]:
    """Workspace for implicit steps of a formula."""
    key = "steps", sizes_of(problem), changes(problem), tuple(tableau.c.tolist()), len(tableau.lam)
    return lent(key, lambda: StepWorkspace(implicit_step(problem, tableau)))


def exact_step_workspace(
    problem: Problem, exact: Exact, make: Callable[[], OneStep]
) -> AbstractContextManager[StepWorkspace]:
    """Workspace for steps with an exact structure, which is the scene's own and lives as long as it."""
    among: Store = once_per(problem, "workspaces of exact steps", dict)
    return lent(id(exact), lambda: StepWorkspace(make()), among)


def implicit_step(problem: Problem, tableau: Tableau) -> OneStep:
    """Empty arrays for implicit steps."""
    return one_step_of(problem, tableau, factor(problem, tableau), stages(problem, tableau), no_exact())


def made(problem: Problem) -> RunWorkspace:
    """Empty arrays for a run."""
    n, nc, nz = problem.n, problem.n_c, problem.n_z
    floats = [np.zeros(size) for size in (n, n, nz, nc, n, n, n)]
    stops = np.zeros(problem.signals.breakpoints.size)
    clock = Clock(
        h=0.0, usual=0.0, span=np.zeros(2), longest=0.0, bound=0.0, stops=stops, at_once=0, since_mark=0,
        found=np.zeros(2), mark=0.0, retry=np.zeros(1), growth=np.inf, wanted=0.0,
        knot=-np.inf,
    )  # fmt: skip
    return RunWorkspace(
        scratch_of(problem), state_of(problem), state_of(problem), rest_of(problem),
        Before(np.zeros(nc, np.int8), np.zeros(problem.m)), Accuracy._make([0.0, *floats, 0.0]), clock,
    )  # fmt: skip
