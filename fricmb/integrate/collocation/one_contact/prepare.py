"""A problem made ready for collocation: structures, ports and step-size tables, kept for the next run."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from fricmb.integrate.collocation.nodes import RUNGS, Z_EXACT, nodes
from fricmb.integrate.collocation.one_contact.constants import load_pattern, put_constants, structure, structure_pattern
from fricmb.integrate.collocation.one_contact.room import Run
from fricmb.integrate.collocation.one_contact.signals import linear_signals
from fricmb.integrate.compile.exchange import with_arrays
from fricmb.integrate.compile.room import room
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import LAW_CONSTANT, NORMAL_CONSTANT, Floats, Ints, Problem
from fricmb.integrate.run.workspace import empty_arrays


def is_single(problem: Problem) -> bool:
    """Whether the problem is one contact under constant friction with at most linear loads."""

    def find() -> bool:
        contacts = problem.contacts
        return bool(
            problem.n_c == 1
            and contacts.law[0] == LAW_CONSTANT
            and contacts.normal[0] == NORMAL_CONSTANT
            and contacts.N[0] > 0
            and contacts.mu_0[0] > 0
            and problem.n_z == 0
            and len(problem.elements.table.address) == 0
            and once_per(problem, "linear signals", lambda: linear_signals(problem)) is not None
        )

    return once_per(problem, "is single", find)


class Rows(NamedTuple):
    """What is kept of a run: steps, their mode and phase, phases, and events (time, kind)."""

    steps: Floats
    kinds: Ints
    phases: Floats
    events: Floats


def longest_step(problem: Problem, s: int, span: float) -> float:
    """The top of the ladder: every block takes exact weights, on which the dense output relies too.

    A step that ``span`` does not hold is none; runs of about the same span share their tables.
    """
    fastest = structure(problem).quickest
    within = 2.0 ** math.ceil(math.log2(span))
    return Z_EXACT[s] / fastest if fastest * within > Z_EXACT[s] else within


#: Steps below which nothing is gained by looking for longer ones, and by how much longer they have to be.
MANY_STEPS, FAR_LONGER = 2000.0, 10.0


def is_stiff(problem: Problem, s: int, span: float) -> bool:
    """Whether blocks that are damped out would force short steps on the kernels for one contact."""
    held = structure(problem)
    return bool(span * held.quickest / Z_EXACT[s] > MANY_STEPS and held.quickest > FAR_LONGER * held.ringing)


def set_longest_step(run: Run, longest: float) -> None:
    """Let the ladder begin at this step; tables of another ladder are forgotten."""
    if run.ladder[0] != longest:
        run.ladder[:] = longest * 2.0 ** (-0.25 * np.arange(RUNGS + 1))
        run.slots[:-1] = -1
        run.slots[-1] = 0


def rows(n: int, m: int, s: int, size: int) -> Rows:
    """Space for ``size`` steps, phases and events."""
    width = 4 + 3 * n + m * s + s + 1
    kinds = np.zeros((size, 2), dtype=np.int64)
    return Rows(np.zeros((size, width)), kinds, np.zeros((size, 5 * n + 2)), np.zeros((size, 2)))


@lru_cache(maxsize=64)
def _nothing(n: int, m: int, s: int) -> Run:
    """Empty arrays and the tables for s nodes; constants of n dofs and m rows are zeros."""
    arrays = empty_arrays(Run) | nodes(s)._asdict()
    for pattern in (structure_pattern(n, m), load_pattern(n, m)):
        arrays |= pattern.zeros().arrays
    return room(Run(**arrays))


def run_of(problem: Problem, s: int) -> Run:
    """The constants of a one-contact problem with s nodes, to look at rows with: there is nothing to work in."""

    def make() -> Run:
        run = with_arrays(_nothing(problem.n, problem.m, s))
        put_constants(run, problem)
        return run

    return once_per(problem, ("run", s), make)


def with_rows(run: Run, new: Rows) -> Run:
    """The same run with other rows."""
    return with_arrays(run, **new._asdict())
