"""The history of a BDF run: backward differences at equal steps of all that a step predicts."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.band import place_of
from fricmb.integrate.compile.kernel import entry, kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.compile.room import room
from fricmb.integrate.formulas.tableau import one_stage
from fricmb.integrate.implicit.bdf.bdf_stability import (
    WHOLE,
    BdfGuard,
    guard_of,
    no_guard,
    spectrum,
    spectrum_within,
)
from fricmb.integrate.implicit.bdf.turns import Differences, begin_at
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import State, set_out, state_of
from fricmb.integrate.implicit.scene.structure import mechanism_of
from fricmb.integrate.implicit.stages.stages import Stages, linearise, stages_of
from fricmb.integrate.problem import Floats, Floats2, Problem, Start


class Formula(Layout):
    """What a BDF step needs beside the differences of y = [q, v, z, powers, lam, F, N, g].

    ``base`` holds psi: the step is one stage of length h/gamma from there, ``one``; ``made`` step of the factors,
    0: none that serve.  ``usual`` what the one-step method would step; ``origin``, ``reach`` (n,) where the run began
    and the largest distance from there; ``guard`` which orders may be used.
    """

    base: State
    one: Stages
    made: float
    usual: float
    origin: Floats
    reach: Floats
    guard: BdfGuard


def formula_of(problem: Problem, start: Start, guard: BdfGuard) -> Formula:
    """Space for the steps of a run."""
    base, one = room(state_of(problem)), room(stages_of(problem, one_stage(), turning=False))
    set_out(base, start)
    q = np.array(start.q, float)
    return room(Formula(base, one, 0.0, 0.0, q, np.zeros_like(q), room(guard)))


def no_formula(base: State, one: Stages) -> Formula:
    """Of a run in which no step is one of BDF; ``base``, ``one``: any state and stages."""
    return room(Formula(base, one, 0.0, 0.0, np.zeros(0), np.zeros(0), room(no_guard())))


def signals(problem: Problem) -> int:
    """Number of signals whose differences are kept."""
    m, nc = mechanism_of(problem), problem.n_c
    return 2 * m.n + problem.n_z + nc + 2 + m.n_rows + 2 * problem.m + nc


@kernel
def put(y: State, rate: Floats, out: Floats) -> None:
    """The values of a state in the order of the history."""
    i = 0
    for part in (y.q, y.v, y.z, rate, y.lam, y.F, y.N, y.g):
        for j in range(part.shape[0]):
            out[i] = part[j]
            i += 1


@kernel
def start_past(y: State, past: Differences, formula: Formula, h: float) -> None:
    """Order 1 at y with a step of h, from the rates there.

    The polynomial of a step of the one-step method is no start: between its stages it is far less accurate than at its
    end, and no step of BDF would pass on such a history.
    """
    n = y.q.shape[0]
    past.D[:, :] = 0.0
    put(y, y.rate, past.D[0])
    for i in range(n):
        past.D[1, i] = h * y.v[i]
        past.D[1, n + i] = h * y.a[i]
    for i in range(y.z.shape[0]):
        past.D[1, 2 * n + i] = h * y.zd[i]
    begin_at(past, 1, h)
    formula.made = 0.0


@entry
def motion_layers(mech: Mech, k: Moving, y: State, st: Stages, M: Floats2, C: Floats2, K: Floats2) -> None:
    """Masses, and slopes of the structure's forces by velocities and positions, at a state: (n, n) each."""
    linearise(mech, k, y, st)
    L, sizes, place = st.L, mech.order.sizes, mech.order.place
    for i in range(M.shape[0]):
        for j in range(M.shape[0]):
            row, column = place[i], place[j]
            if max(row, column) >= sizes[0] or abs(row - column) <= sizes[1]:
                at = place_of(sizes, row, column)
                M[i, j], C[i, j], K[i, j] = L.A0[at], L.A1[at], L.A2[at]


@entry
def motion_bounds(mech: Mech, k: Moving, y: State, st: Stages, M: Floats, K: Floats) -> None:
    """Masses, and sums of the magnitudes of slopes by positions, (n,) each: of many bodies no matrix fits."""
    linearise(mech, k, y, st)
    L, sizes, place = st.L, mech.order.sizes, mech.order.place
    is_motion = np.zeros(place.shape[0], np.int8)
    is_motion[place[: M.shape[0]]] = 1
    for i in range(M.shape[0]):
        row = place[i]
        M[i] = L.A0[place_of(sizes, row, row)]
        K[i] = 0.0
        inside = row < sizes[0]
        first = max(row - sizes[1], 0) if inside else 0
        last = min(row + sizes[1] + 1, sizes[0]) if inside else sizes[0]
        for column in range(first, place.shape[0]):
            if (column < last or column >= sizes[0]) and is_motion[column] == 1:
                K[i] += abs(L.A2[place_of(sizes, row, column)])


def guard_at(problem: Problem, mech: Mech, k: Moving, y: State, st: Stages) -> BdfGuard:
    """The guard by the spectrum at a state.  With joints there is none: motion is not that of the bodies alone."""
    n = problem.n
    if problem.mechanism is not None:
        return no_guard()
    if n <= WHOLE:
        M, C, K = (np.zeros((n, n)) for _ in range(3))
        motion_layers(mech, k, y, st, M, C, K)
        return guard_of(spectrum(M, C, K))
    if len(problem.omega) == n:
        return guard_of((problem.omega, problem.omega * problem.zeta))
    mass, stiffness = np.zeros(n), np.zeros(n)
    motion_bounds(mech, k, y, st, mass, stiffness)
    return guard_of(spectrum_within(mass, stiffness))
