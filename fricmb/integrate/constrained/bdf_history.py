"""The history of a BDF run of a mechanism: backward differences at equal steps of all that a step predicts."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.room import room
from fricmb.integrate.constrained.accelerations import State, state_of
from fricmb.integrate.constrained.problem_structs import mechanism_of
from fricmb.integrate.constrained.stages import Stages, stages_of
from fricmb.integrate.methods.backward_differences import rescale
from fricmb.integrate.methods.bdf_stability import MAX_ORDER
from fricmb.integrate.problem import Floats, Floats2, Ints, Problem, Start
from fricmb.integrate.step.tableau import one_stage

__all__ = ["Past", "past_of", "rescale", "start_past"]


class Past(NamedTuple):
    """Backward differences ``D`` (8, n_y) of y = [q, v, z, powers, lam, F, N, g] at step ``h`` (1,).

    ``status`` (8,): order, steps since the last change, whether BDF is on, rejections in a row, one-step steps to wait
    for before it is tried again, the last wait, steps since its start, the last wait because it was the slower.
    ``good`` (1,) last accepted step; ``usual`` (1,) what the one-step method steps; ``made`` (1,) step of the factors,
    0: none that serve.  ``new``, ``guess``, ``lag``, ``d`` (n_y,) values, prediction, psi without it, correction.
    ``gamma`` (7,) sums 1 + 1/2 + ...; ``unit`` (1,) allowed error per unit of time, relative to rtol; ``cost`` (1,) of
    a one-step step in BDF steps.  ``origin``, ``reach`` (n,) where the run began and the largest
    distance from there.  ``base`` holds psi: the step is one stage of length h/gamma from there, ``one``.
    ``U``, ``E``, ``column`` room for rescaling.
    """

    D: Floats2
    h: Floats
    status: Ints
    good: Floats
    usual: Floats
    made: Floats
    new: Floats
    guess: Floats
    lag: Floats
    d: Floats
    gamma: Floats
    unit: Floats
    cost: Floats
    origin: Floats
    reach: Floats
    base: State
    one: Stages
    U: Floats2
    E: Floats2
    column: Floats


def past_of(problem: Problem, start: Start, span: float, cost: float) -> Past:
    """Room for the history of a run over ``span``; ``cost`` of a one-step step in BDF steps."""
    m, nc = mechanism_of(problem), problem.n_c
    n_y = 2 * m.n + problem.n_z + nc + 2 + m.n_rows + 2 * problem.m + nc
    gamma = np.concatenate([[0.0], np.cumsum(1.0 / np.arange(1, 7))])
    square = np.zeros((MAX_ORDER + 1, MAX_ORDER + 1))
    # a hundredth of the error is spent on a hundredth of the run
    unit = np.array([100.0 / max(span, 1e-300)])
    return room(Past(
        np.zeros((8, n_y)), np.zeros(1), np.zeros(8, np.int64), np.zeros(1), np.zeros(1), np.zeros(1), np.zeros(n_y),
        np.zeros(n_y), np.zeros(n_y), np.zeros(n_y), gamma, unit, np.array([cost]),
        np.array(start.q, float), np.zeros(m.n),
        state_of(problem, start), stages_of(problem, one_stage()), square, square.copy(), np.zeros(8),
    ))  # fmt: skip


@kernel
def put(y: State, rate: Floats, out: Floats) -> None:
    """The values of a state in the order of the history."""
    i = 0
    for part in (y.q, y.v, y.z, rate, y.lam, y.F, y.N, y.g):
        for j in range(part.shape[0]):
            out[i] = part[j]
            i += 1


@kernel
def start_past(y: State, past: Past, h: float) -> None:
    """Order 1 at y with a step of h, from the rates there.

    The polynomial of a step of the one-step method is no start: between its stages it is far less accurate than at its
    end, and no step of BDF would pass on such a history.
    """
    n, nz = y.q.shape[0], y.z.shape[0]
    for j in range(8):
        for i in range(past.D.shape[1]):
            past.D[j, i] = 0.0
    put(y, y.rate, past.D[0])
    for i in range(n):
        past.D[1, i] = h * y.v[i]
        past.D[1, n + i] = h * y.a[i]
    for i in range(nz):
        past.D[1, 2 * n + i] = h * y.zd[i]
    past.h[0] = h
    past.status[0] = 1
    past.status[1] = 0
    past.status[2] = 1
    past.status[3] = 0
    past.status[6] = 0
    past.made[0] = 0.0
