"""The stages of a Radau IIA step on the velocity level (index 2): simplified Newton on the transformed system.

With velocities V_i, multipliers L_i and friction forces F_i at the stages, Q_i = q + h sum_j A_ij V_j:

    M V'_i = f(t_i, Q_i, V_i, L_i, F_i),   d phi/dt (t_i, Q_i, V_i) = 0,   friction(Q_i, V_i, L_i, F_i) = 0.

The position constraint drifts by the error of a step and is restored after it (Hairer and Wanner, Solving ODEs II,
VII.2).  A = T diag(lam) T^-1 splits the Newton system into one real and some complex systems of one stage's size.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.band import factor_band, length_of, solve_band
from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.constrained.forces import forces, move, pull_back
from fricmb.integrate.constrained.friction_rows import add_friction, friction_residual
from fricmb.integrate.constrained.jacobian_layers import Layers, add, add_contacts, add_joints, add_mass, add_structure
from fricmb.integrate.constrained.moving import Moving
from fricmb.integrate.constrained.problem_structs import Mech, mech_of
from fricmb.integrate.constrained.state import State
from fricmb.integrate.constrained.structure import mechanism_of
from fricmb.integrate.constrained.turning import Turns, correct_turns, spread_of_stages, turns_of
from fricmb.integrate.problem import (
    LAW_CONSTANT,
    LAW_SMOOTH,
    NORMAL_CONSTANT,
    SLIP,
    Complexes,
    Complexes2,
    Floats,
    Floats2,
    Pivots,
    Problem,
)
from fricmb.integrate.step.felt import Felt, felt_of
from fricmb.integrate.step.tableau import Tableau


class Stages(Layout):
    """Values at the stages (s, .), residuals and changes (s, size), factored matrices (l, .) and pivots.

    ``Ainv`` (s, s) inverse of the tableau; ``scale`` (n,) what counts as 1 in velocities; ``found`` the rate of
    convergence; ``turns`` for contacts in two directions; ``felt`` what forces of ports do in the step just solved;
    ``fresh`` 1 where N and g are those of the values there, but for a change that is nothing.
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
    real: Floats
    pairs: Complexes2
    pivots: Pivots
    x: Floats
    w: Complexes2
    line: Complexes
    zd: Floats2
    acc: Floats
    scale: Floats
    found: float
    turns: Turns
    felt: Felt
    fresh: int


def stages_of(problem: Problem, tab: Tableau) -> Stages:
    """Arrays for the stages of a tableau with an odd number of them."""
    m, order, s = mechanism_of(problem), mech_of(problem).order, len(tab.c)
    size, band = len(order.place), length_of(order.sizes)
    nc, rows, nz, count = problem.n_c, problem.m, problem.n_z, len(tab.lam)
    return Stages(
        tab, np.ascontiguousarray(np.linalg.inv(tab.A)), np.zeros((s, m.n)), np.zeros((s, m.n)),
        np.zeros((s, m.n_rows)), np.zeros((s, rows)), np.zeros((s, nz)), np.zeros((s, nc)), np.zeros((s, rows)),
        np.zeros((s, size)), Layers(np.zeros(band), np.zeros(band), np.zeros(band)), np.zeros(band),
        np.zeros((count, band), complex), np.zeros(count * size, np.int32), np.zeros(size),
        np.zeros((count, size), complex), np.zeros(size, complex), np.zeros((s, nz)), np.zeros(size), np.ones(m.n), 0.0,
        turns_of(problem, tab, size), felt_of(problem, s), 0,
    )  # fmt: skip


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


@block
def factor_stages(mech: Mech, st: Stages, h: float) -> bool:
    """Factor the real and the complex systems for a step h."""
    order, L, tab = mech.order, st.L, st.tab
    size = order.place.shape[0]
    for i in range(tab.lam.shape[0]):
        pivots = st.pivots[i * size : (i + 1) * size]
        if tab.lam[i].imag == 0.0:
            up, down = 1.0 / (h * tab.lam[i].real), h * tab.lam[i].real
            for j in range(st.real.shape[0]):
                st.real[j] = up * L.A0[j] + L.A1[j] + down * L.A2[j]
            if not factor_band(st.real, pivots, order.sizes):
                return False
        else:
            shift = h * tab.lam[i]
            inverse = 1.0 / shift
            pair = st.pairs[i]
            for j in range(st.real.shape[0]):
                pair[j] = inverse * L.A0[j] + L.A1[j] + shift * L.A2[j]
            if not factor_band(pair, pivots, order.sizes):
                return False
    return True


@block
def stage_residual(mech: Mech, k: Moving, y: State, st: Stages, h: float, i: int) -> None:
    """Residual of stage i into ``st.R[i]``."""
    n, m, n_c, nz = y.q.shape[0], y.lam.shape[0], y.F.shape[0], y.z.shape[0]
    r = st.R[i]
    s = st.tab.c.shape[0]
    for a in range(n):
        st.acc[a] = 0.0
        st.Q[i, a] = y.q[a]
        for j in range(s):
            st.acc[a] += st.Ainv[i, j] * (st.V[j, a] - y.v[a])
            st.Q[i, a] += h * st.tab.A[i, j] * st.V[j, a]
        st.acc[a] /= h
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
    for a in range(nz):
        rate = 0.0
        for j in range(s):
            rate += st.Ainv[i, j] * (st.z[j, a] - y.z[a])
        r[n + m + n_c + a] = rate / h - st.zd[i, a]


@kernel
def solve_system(mech: Mech, st: Stages, i: int) -> None:
    """Overwrite ``st.w[i]`` by the solution of system i, whose factors are there."""
    place, w = mech.order.place, st.w[i]
    pivots = st.pivots[i * place.shape[0] : (i + 1) * place.shape[0]]
    if st.tab.lam[i].imag == 0.0:
        for a in range(place.shape[0]):
            st.x[place[a]] = w[a].real
        solve_band(st.real, pivots, mech.order.sizes, st.x)
        for a in range(place.shape[0]):
            w[a] = st.x[place[a]]
        return
    for a in range(place.shape[0]):
        st.line[place[a]] = w[a]
    solve_band(st.pairs[i], pivots, mech.order.sizes, st.line)
    for a in range(place.shape[0]):
        w[a] = st.line[place[a]]


@block
def newton_change(mech: Mech, st: Stages) -> None:
    """Solve for the changes of all unknowns: R is overwritten."""
    tab = st.tab
    size, s = mech.order.place.shape[0], tab.c.shape[0]
    for i in range(tab.lam.shape[0]):
        for a in range(size):
            real = imaginary = 0.0
            for j in range(s):
                real += tab.Tinv[i, j].real * st.R[j, a]
                imaginary += tab.Tinv[i, j].imag * st.R[j, a]
            st.w[i, a] = complex(real, imaginary)
        solve_system(mech, st, i)
    for j in range(s):
        for a in range(size):
            total = 0.0
            for i in range(tab.lam.shape[0]):
                total += tab.T[j, i].real * st.w[i, a].real - tab.T[j, i].imag * st.w[i, a].imag
            st.R[j, a] = total


#: Newton's iterations in a step before it is given up.
ITERATIONS = 12
#: Part by which a change of a state counts beside one of a velocity: most iterations more are for states alone.
STATES = 0.1
#: Round-off of velocities in a Newton change, beside what the kinetic energy at the stages could bring.
NOISE = 1e-15


@kernel
def is_noise(mech: Mech, st: Stages) -> bool:
    """Whether the last changes of velocities are round-off: one that hardly moves has that of those it is tied to.

    A short step begins so near its solution that nothing converges any more.
    """
    energy = 0.0
    for i in range(st.V.shape[0]):
        for a in range(st.V.shape[1]):
            energy = max(energy, mech.mass[a] * st.V[i, a] ** 2)
    for i in range(st.V.shape[0]):
        for a in range(st.V.shape[1]):
            if not abs(st.R[i, a]) <= NOISE * np.sqrt(energy / mech.mass[a]):
                return False
    return True


#: Round-off of a solution with factors, where forces of the structure over a step are no more than inertia.
ROUND_OFF = 1e-14


@kernel
def is_linear(mech: Mech, y: State) -> bool:
    """Whether the equations of a step are linear: in stick, and in slip along a line under one force."""
    port, linear = mech.port, mech.elements.address.shape[0] == 0 and mech.joint.n_x.shape[0] == 0
    for c in range(y.mode.shape[0]):
        slips = y.mode[c] == SLIP and (port.law[c] != LAW_CONSTANT or port.row[c + 1] - port.row[c] > 1)
        linear = linear and not slips and port.normal[c] == NORMAL_CONSTANT and port.law[c] != LAW_SMOOTH
        linear = linear and port.soft[c] == 0.0
    return bool(linear and mech.place.address.shape[0] == 0)


@kernel
def left_by_factors(mech: Mech, y: State, h: float, made: float) -> float:
    """Part of a change that its solution by factors may leave in a step h; 1 where equations are not linear.

    Stiff springs and dampers, whose forces over a step are far above those of inertia, take digits from soft motion.
    Those made for a step of another length leave what the matrices differ by: powers of h up to the second.
    """
    if not is_linear(mech, y):
        return 1.0
    linear, stiff = mech.linear, 1.0
    n = mech.mass.shape[0]
    for e in range(linear.K.shape[0]):
        i = linear.Ki[e]
        stiff = max(stiff, h * h * abs(linear.K[e]) / mech.mass[i] if i < n else 0.0)
    for e in range(linear.C.shape[0]):
        i = linear.Ci[e]
        stiff = max(stiff, h * abs(linear.C[e]) / mech.mass[i] if i < n else 0.0)
    return ROUND_OFF * stiff + 4.0 * abs(1.0 - made / h)


@block
def iterate_stages(mech: Mech, k: Moving, y: State, st: Stages, h: float, made: float, accuracy: float) -> int:
    """Newton from the values in ``st`` until changes of velocities and states are below ``accuracy`` of their sizes.

    Returns the number of iterations, or 0 where they do not converge.  ``made``: length of the step of the factors.
    """
    tab = st.tab
    s = tab.c.shape[0]
    last = np.inf
    exact = left_by_factors(mech, y, h, made)
    st.found, st.fresh = 1.0, 0
    for iteration in range(ITERATIONS):
        for i in range(s):
            stage_residual(mech, k, y, st, h, i)
        if st.turns.near > 0:
            spread_of_stages(mech, st.turns, st.F, st.g)
        newton_change(mech, st)
        if st.turns.near > 0:
            correct_turns(mech, st.turns, tab, st.R, st.w)
        change, sound = 0.0, 0.0
        for i in range(s):
            for a in range(st.R.shape[1]):
                sound += 0.0 * st.R[i, a]
            for a in range(st.scale.shape[0]):
                change = max(change, abs(st.R[i, a]) / st.scale[a])
            for a in range(st.z.shape[1]):
                off = abs(st.R[i, st.R.shape[1] - st.z.shape[1] + a])
                change = max(change, STATES * off / st.felt.size[a])
            at = 0
            for part in (st.V, st.lam, st.F, st.z):
                for a in range(part.shape[1]):
                    part[i, a] -= st.R[i, at + a]
                at += part.shape[1]
        if not (change < 1e30 and sound == 0.0):
            return 0
        rate = change / last if iteration > 0 else exact
        if iteration > 0 or exact < 1.0:
            st.found = rate
        if change <= 1e-15 or (rate < 1.0 and change * rate / (1.0 - rate) <= accuracy):
            st.fresh = 1 if change <= accuracy else 0
            for i in range(s):
                stage_positions(y, st, h, i)
            return iteration + 1
        if iteration > 0 and (rate >= 2.0 or (iteration > 2 and rate >= 0.95)):
            if not is_noise(mech, st):
                return 0
            for i in range(s):
                stage_positions(y, st, h, i)
            return iteration + 1
        last = change
    return 0


@kernel
def stage_positions(y: State, st: Stages, h: float, i: int) -> None:
    """Q of stage i from the velocities."""
    for a in range(y.q.shape[0]):
        value = 0.0
        for j in range(st.tab.c.shape[0]):
            value += st.tab.A[i, j] * st.V[j, a]
        st.Q[i, a] = y.q[a] + h * value


@kernel
def bring_up_to_date(mech: Mech, k: Moving, y: State, st: Stages, h: float) -> None:
    """Slip velocities and loads at the stages after the last of Newton's changes."""
    if st.fresh == 1:
        return
    st.fresh = 1
    for i in range(st.tab.c.shape[0]):
        move(mech, k, y.t + st.tab.c[i] * h, st.Q[i], st.V[i])
        forces(mech, k, st.lam[i], st.F[i], st.N[i], st.g[i])
