"""Workspace in which a scene without joints is evaluated at single instants, found again by its sizes."""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import NamedTuple

import numpy as np

from fricmb.integrate.model.forces import Scratch, longest_call, scratch_of
from fricmb.integrate.model.problem_structs import packed_of
from fricmb.integrate.model.state import State, state_of
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import Problem
from fricmb.integrate.run.workspace import lent


class InstantWorkspace(NamedTuple):
    """For what is to be known at single instants; the state is empty."""

    s: Scratch
    y: State


def instant_workspace(problem: Problem) -> AbstractContextManager[InstantWorkspace]:
    """What to evaluate a problem in."""
    key = "at an instant", sizes_of(problem)
    return lent(key, lambda: InstantWorkspace(scratch_of(problem), state_of(problem)))


def sizes_of(problem: Problem) -> tuple[int, ...]:
    """All that the arrays of a problem's workspaces are long."""
    return once_per(problem, "sizes of workspaces", lambda: _find_sizes(problem))


def _find_sizes(problem: Problem) -> tuple[int, ...]:
    structure = packed_of(problem).structure
    states = int(np.max(np.diff(problem.contacts.z_start), initial=0))
    own = problem.n, problem.n_u, problem.n_z, problem.m, problem.n_c, problem.n_v, problem.signals.breakpoints.size
    return (*own, *longest_call(problem), states, int(structure.half), len(structure.column))
