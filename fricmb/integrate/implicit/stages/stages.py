"""The stages of a one-step formula on the velocity level (index 2): simplified Newton on the transformed system.

With velocities V_i, multipliers L_i and friction forces F_i at the stages, Q_i = q + h sum_j A_ij V_j:

    M V'_i = f(t_i, Q_i, V_i, L_i, F_i),   d phi/dt (t_i, Q_i, V_i) = 0,   friction(Q_i, V_i, L_i, F_i) = 0.

The position constraint drifts by the error of a step and is restored after it (Hairer and Wanner, Solving ODEs II,
VII.2).  A = T diag(lam) T^-1 splits the Newton system into real and complex systems of one stage's size.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.integrate.compile.band import factor_band, length_of, solve_band
from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.formulas.tableau import Tableau
from fricmb.integrate.implicit.between.felt import Felt, felt_of
from fricmb.integrate.implicit.equations.forces import forces, move, pull_back
from fricmb.integrate.implicit.equations.friction_rows import add_friction, friction_residual
from fricmb.integrate.implicit.equations.jacobian_layers import (
    Layers,
    add,
    add_contacts,
    add_joints,
    add_mass,
    add_structure,
)
from fricmb.integrate.implicit.scene.dense_rows import has_dense_rows
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech, mech_of
from fricmb.integrate.implicit.scene.state import Held, State, held_of
from fricmb.integrate.implicit.scene.structure import mechanism_of
from fricmb.integrate.implicit.stages.steep_laws import Steep, ask_at_tried, set_base, steep_laws_of
from fricmb.integrate.implicit.stages.turning import Turns, turns_of
from fricmb.integrate.problem import (
    LAW_SMOOTH,
    NORMAL_CONSTANT,
    Complexes,
    Complexes2,
    Complexes3,
    Floats,
    Floats2,
    Floats3,
    Pivots,
    Problem,
)


class Series(Layout):
    """Terms of a Taylor series over ``length`` from ``begin`` on, ``terms`` of them (0: there is none), in t/length.

    ``bent`` 1 where signals are no straight lines.  ``x`` (., n) of positions, ``path`` (., r) of rows (see
    ``dense_rows``), ``N``, ``F``, ``g`` of loads, friction and slip velocities, in a plane ``speed`` and ``unit`` of
    their sizes and directions; ``u`` (s+1, 2 n_u) of signals and their rates, by values ``signal`` at 0, c.
    ``along`` (n_c,) modes as numbers, ``mu`` coefficients; ``held`` what sticks;
    ``force`` (r,) along rows; ``f``, ``acc`` (n,) space.
    """

    begin: float
    length: float
    terms: int
    bent: int
    x: Floats2
    path: Floats2
    N: Floats2
    F: Floats2
    g: Floats2
    speed: Floats2
    unit: Floats2
    u: Floats2
    signal: Floats2
    along: Floats
    mu: Floats
    held: Held
    force: Floats
    f: Floats
    acc: Floats


#: Terms of a series at most.
TERMS = 40


def series_of(problem: Problem, stages: int) -> Series:
    """Space for the series of a problem with dense rows; of any other one none."""
    some = has_dense_rows(problem, mechanism_of(problem))
    n, rows, n_u, n_c = (problem.n, problem.m, problem.n_u, problem.n_c) if some else (0, 0, 0, 0)
    terms = TERMS if some else 0
    return Series(
        0.0, 0.0, 0, 0, np.zeros((terms + 2, n)), np.zeros((terms + 2, rows + n_c)), np.zeros((terms, n_c)),
        np.zeros((terms, rows)), np.zeros((terms, rows)), np.zeros((terms, n_c)), np.zeros((terms, rows)),
        np.zeros((stages + 1, 2 * n_u)), np.zeros((stages + 1, 2 * n_u)), np.zeros(n_c), np.zeros(n_c), held_of(rows),
        np.zeros(rows + n_c), np.zeros(n), np.zeros(n),
    )  # fmt: skip


class Stages(Layout):
    """Values at the stages (s, .), residuals and changes (s, size), factored matrices and pivots.

    Factors are kept for several steps, ``lengths`` (slots,), 0 where there are none: ``real`` and
    ``pairs`` (slots, l, .), each for eigenvalues of its kind; those in use are of ``slot``.

    ``Ainv`` (s, s) inverse of the tableau; ``scale`` (n,) what counts as 1 in velocities; ``found`` the rate of
    convergence; ``turns`` for contacts in two directions; ``steep`` for smooth laws; ``felt`` what forces of
    ports do in the step just solved; ``fresh`` 1 where N and g are those of the values there, but for a change that is
    nothing; ``plain`` 1 where friction alone is not linear, and its loads are given; ``series`` where steps have one.
    """

    tab: Tableau
    Ainv: Floats2
    Q: Floats2
    V: Floats2
    lam: Floats2
    F: Floats2
    z: Floats2
    N: Floats2
    g: Floats2
    R: Floats2
    L: Layers
    real: Floats3
    pairs: Complexes3
    pivots: Pivots
    lengths: Floats
    slot: int
    x: Floats
    w: Complexes2
    line: Complexes
    zd: Floats2
    acc: Floats
    scale: Floats
    found: float
    turns: Turns
    steep: Steep
    felt: Felt
    fresh: int
    plain: int
    series: Series


#: Steps whose factors are kept at most, and bytes for them: without joints a ladder of steps comes back to the same.
SLOTS, SLOT_BYTES = 16, 2e6


def stages_of(problem: Problem, tab: Tableau, *, turning: bool = True) -> Stages:
    """Arrays for the stages of a tableau; not ``turning``: steps near rest are left to another formula."""
    m, order, s = mechanism_of(problem), mech_of(problem).order, len(tab.c)
    size, band = len(order.place), length_of(order.sizes)
    nc, rows, nz, count = problem.n_c, problem.m, problem.n_z, len(tab.lam)
    slots = 1
    if problem.mechanism is None and s > 1:
        slots = int(np.clip(SLOT_BYTES / max(16.0 * (count + 1) * band, 1.0), 1, SLOTS))
    return Stages(
        tab, np.ascontiguousarray(np.linalg.inv(tab.A)), np.zeros((s, m.n)), np.zeros((s, m.n)),
        np.zeros((s, m.n_rows)), np.zeros((s, rows)), np.zeros((s, nz)), np.zeros((s, nc)), np.zeros((s, rows)),
        np.zeros((s, size)), Layers(np.zeros(band), np.zeros(band), np.zeros(band)), np.zeros((slots, count, band)),
        np.zeros((slots, count, band), complex), np.zeros(slots * count * size, np.int32), np.zeros(slots), 0,
        np.zeros(size),
        np.zeros((count, size), complex), np.zeros(size, complex), np.zeros((s, nz)), np.zeros(size), np.ones(m.n), 0.0,
        turns_of(problem, tab, size, turning), steep_laws_of(problem, tab, m.n, size), felt_of(problem, s), 0,
        int(is_plain(problem)), series_of(problem, s),
    )  # fmt: skip


def is_plain(problem: Problem) -> bool:
    """Whether the equations of a step are linear but for friction, under loads that do not follow the motion."""
    given = bool((problem.contacts.normal == NORMAL_CONSTANT).all())
    if problem.mechanism is not None or not given or problem.elements.table.address.size:
        return False
    slip = mechanism_of(problem).slip
    of_rate = np.repeat(np.arange(len(slip.form_start) - 1) % 2 == 1, np.diff(slip.form_start))
    return not (of_rate & (slip.form_index >= 1) & (slip.form_index <= problem.n)).any()


def facts_of(problem: Problem) -> tuple[Any, ...]:
    """What stages say of a problem beside the lengths of their arrays: they serve none of which it differs."""
    contacts = problem.contacts
    rows = (contacts.law == LAW_SMOOTH).tobytes(), contacts.row.tobytes(), contacts.z_start.tobytes()
    return is_plain(problem), has_dense_rows(problem, mechanism_of(problem)), *rows


@block
def linearise(mech: Mech, k: Moving, y: State, st: Stages) -> None:
    """The three layers of the Jacobian at the state."""
    L = st.L
    L.A0[:] = 0.0
    L.A1[:] = 0.0
    L.A2[:] = 0.0
    move(mech, k, y.t, y.q, y.v)
    forces(mech, k, y.lam, y.F, y.N, y.g)
    add_mass(mech, L)
    add_structure(mech, k, L)
    add_joints(mech, k, y.lam, y.F, L, True)
    add_contacts(mech, k, y.mode, L, True)
    add_friction(mech, k, y.mode, y.n, y.F, y.lam, y.z, y.N, y.g, y.ga, L, True)
    size = mech.order.place.shape[0]
    for i in range(size - y.z.shape[0], size):
        add(mech.order, L.A0, i, i, 1.0)
    set_base(mech, k, st.steep, y.mode, y.g, y.z, y.N, y.lam)


@kernel
def slot_for(st: Stages, h: float, apart: float) -> bool:
    """Choose the slot whose factors are of the step nearest to h; whether that is no further than ``apart``."""
    nearest = st.slot
    for k in range(st.lengths.shape[0]):
        if abs(st.lengths[k] - h) < abs(st.lengths[nearest] - h):
            nearest = k
    if st.lengths[nearest] > 0.0 and abs(st.lengths[nearest] - h) <= apart:
        st.slot = nearest
        return True
    return False


@kernel
def empty_slot(st: Stages) -> None:
    """Choose the slot after the one in use, whose factors are the oldest."""
    st.slot = (st.slot + 1) % st.lengths.shape[0]


@block
def factor_stages(mech: Mech, st: Stages, h: float) -> bool:
    """Factor the real and the complex systems for a step h, into the slot in use."""
    order, L, tab, slot = mech.order, st.L, st.tab, st.slot
    size = order.place.shape[0]
    st.lengths[slot] = 0.0
    for i in range(tab.lam.shape[0]):
        first = (slot * tab.lam.shape[0] + i) * size
        pivots = st.pivots[first : first + size]
        if tab.lam[i].imag == 0.0:
            up, down, real = 1.0 / (h * tab.lam[i].real), h * tab.lam[i].real, st.real[slot, i]
            for j in range(real.shape[0]):
                real[j] = up * L.A0[j] + L.A1[j] + down * L.A2[j]
            if not factor_band(real, pivots, order.sizes):
                return False
        else:
            shift = h * tab.lam[i]
            inverse = 1.0 / shift
            pair = st.pairs[slot, i]
            for j in range(pair.shape[0]):
                pair[j] = inverse * L.A0[j] + L.A1[j] + shift * L.A2[j]
            if not factor_band(pair, pivots, order.sizes):
                return False
    st.lengths[slot] = h
    return True


@kernel
def accelerations_at(y: State, st: Stages, h: float, i: int) -> None:
    """Accelerations of stage i from the velocities, into ``st.acc``."""
    acc = st.acc
    acc[:] = 0.0
    for j in range(st.tab.c.shape[0]):
        rate, V = st.Ainv[i, j], st.V[j]
        for a in range(y.v.shape[0]):
            acc[a] += rate * (V[a] - y.v[a])
    for a in range(y.v.shape[0]):
        acc[a] /= h


@block
def stage_residual(mech: Mech, k: Moving, y: State, st: Stages, h: float, i: int) -> None:
    """Residual of stage i into ``st.R[i]``."""
    n, m, n_c, nz = y.q.shape[0], y.lam.shape[0], y.F.shape[0], y.z.shape[0]
    r = st.R[i]
    s = st.tab.c.shape[0]
    accelerations_at(y, st, h, i)
    Q = st.Q[i]
    for a in range(n):
        Q[a] = y.q[a]
    for j in range(s):
        share, V = h * st.tab.A[i, j], st.V[j]
        for a in range(n):
            Q[a] += share * V[a]
    move(mech, k, y.t + st.tab.c[i] * h, st.Q[i], st.V[i])
    forces(mech, k, st.lam[i], st.F[i], st.N[i], st.g[i])
    pull_back(mech, k, st.x)
    for a in range(n):
        r[a] = -st.x[a]
    linear = mech.linear
    for e in range(linear.M.shape[0]):
        r[linear.Mi[e]] += linear.M[e] * st.acc[linear.Mj[e]]
    for a in range(m):
        r[n + a] = k.phi_rate[a]
    friction_residual(mech, k, y.mode, y.n, st.F[i], st.z[i], st.N[i], st.g[i], st.g[i], st.zd[i], r, n + m, True)
    if st.steep.on == 1:
        ask_at_tried(mech, k, st.steep, y.mode, i, st.F[i], st.z[i], st.N[i], st.g[i], st.zd[i], r, n + m)
    for a in range(nz):
        rate = 0.0
        for j in range(s):
            rate += st.Ainv[i, j] * (st.z[j, a] - y.z[a])
        r[n + m + n_c + a] = rate / h - st.zd[i, a]


@kernel
def solve_system(mech: Mech, st: Stages, i: int, alone: bool) -> None:
    """Overwrite ``st.w[i]`` by the solution of system i, whose factors are there; ``alone``: rows of motion are 0."""
    place, w, slot = mech.order.place, st.w[i], st.slot
    first = (slot * st.w.shape[0] + i) * place.shape[0]
    pivots = st.pivots[first : first + place.shape[0]]
    if st.tab.lam[i].imag == 0.0:
        for a in range(place.shape[0]):
            st.x[place[a]] = w[a].real
        solve_band(st.real[slot, i], pivots, mech.order.sizes, st.x, alone)
        for a in range(place.shape[0]):
            w[a] = st.x[place[a]]
        return
    for a in range(place.shape[0]):
        st.line[place[a]] = w[a]
    solve_band(st.pairs[slot, i], pivots, mech.order.sizes, st.line, alone)
    for a in range(place.shape[0]):
        w[a] = st.line[place[a]]


@kernel
def stage_positions(y: State, st: Stages, h: float, i: int) -> None:
    """Q of stage i from the velocities."""
    Q = st.Q[i]
    for a in range(y.q.shape[0]):
        Q[a] = 0.0
    for j in range(st.tab.c.shape[0]):
        share, V = st.tab.A[i, j], st.V[j]
        for a in range(y.q.shape[0]):
            Q[a] += share * V[a]
    for a in range(y.q.shape[0]):
        Q[a] = y.q[a] + h * Q[a]


@kernel
def bring_up_to_date(mech: Mech, k: Moving, y: State, st: Stages, h: float) -> None:
    """Slip velocities and loads at the stages after the last of Newton's changes."""
    if st.fresh == 1:
        return
    st.fresh = 1
    for i in range(st.tab.c.shape[0]):
        move(mech, k, y.t + st.tab.c[i] * h, st.Q[i], st.V[i])
        forces(mech, k, st.lam[i], st.F[i], st.N[i], st.g[i])
