"""Implicit stages of a structure with ports: one solver for Radau IIA and for every BDF step.

    V_i = psi_v + sum_j hA_ij V'_j,   Q_i = psi_q + sum_j hA_ij V_j,   M V'_j = f(t_j, Q_j, V_j) + W F_j + Wn (N_j - N0)

The matrix of the structure depends on h alone, not on modes and not on friction.  It is diagonalised over the stages;
``Sinv`` are the inverses of M + sigma C + sigma^2 K, sigma = h lam.  They multiply corrections only, so that their
round-off is relative to the correction.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block, declared
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.model.forces import Scratch, belt_velocity, normal_force, set_instant, structure_force
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.problem import LAW_SMOOTH, Codes, Complexes2, Floats, Floats2, Problem
from fricmb.integrate.step.contact_convergence import share_noise
from fricmb.integrate.step.contact_newton import solve_ports
from fricmb.integrate.step.contact_unknowns import PortState
from fricmb.integrate.step.step_matrix import Factor
from fricmb.integrate.step.tableau import Tableau


class Stages(Layout):
    """Stage values V, Q (s, n), forces f, residuals; ``psi_v``, ``psi_q`` (n,), times ``t`` (s,).

    ``weight`` (s, s), ``line`` (s,): space for starting values.
    """

    V: Floats2
    Q: Floats2
    f: Floats2
    res: Floats2
    dV: Floats2
    t: Floats
    psi_v: Floats
    psi_q: Floats
    hA: Floats2
    y: Complexes2
    weight: Floats2
    line: Floats


def stages(problem: Problem, tableau: Tableau) -> Stages:
    """Arrays for the stages of one step."""
    n, s = problem.n, len(tableau.c)
    values = [np.zeros((s, n)) for _ in range(5)]
    levels = len(tableau.lam)
    history = [np.zeros(s), np.zeros(n), np.zeros(n), np.zeros((s, s)), np.zeros((levels, n), complex)]
    history += [np.zeros((s, s)), np.zeros(s)]
    return Stages._make([*values, *history])


@kernel
def stage_residual(packed: Packed, s: Scratch, st: Stages, w: PortState, mode: Codes) -> None:
    """Residual of the stages at V and the port forces; outputs of the ports there into ``w.gb``."""
    n = st.V.shape[1]
    ports = packed.ports
    m = ports.row[-1]
    for i in range(st.V.shape[0]):
        for a in range(n):
            value = st.psi_q[a]
            for j in range(st.V.shape[0]):
                value += st.hA[i, j] * st.V[j, a]
            st.Q[i, a] = value
        set_instant(packed.signals, s, st.t[i], st.Q[i], st.V[i])
        structure_force(packed.structure, packed.elements, packed.spread, s, st.f[i])
        for a in range(n):
            for c in range(m):
                st.f[i, a] += ports.W[a, c] * w.F[i, c]
        for k in range(mode.shape[0]):
            if ports.acts[k]:
                for a in range(n):
                    st.f[i, a] += ports.Wn[a, k] * (w.N[i, k] - ports.N0[k])
            if ports.var[k] >= 0:
                w.gb[i, m + ports.var[k]] = normal_force(ports, packed.normals, k, s)
        for a in range(m):
            value = -belt_velocity(ports, s, n, a)
            for b in range(n):
                value += ports.W[b, a] * st.V[i, b]
            w.gb[i, a] = value
    start, index, M = packed.structure.first, packed.structure.column, packed.structure.M
    V, hA, f = st.V, st.hA, st.f
    for i in range(V.shape[0]):
        for a in range(n):
            value = 0.0
            for e in range(start[a], start[a + 1]):
                value += M[e] * (V[i, index[e]] - st.psi_v[index[e]])
            for j in range(V.shape[0]):
                value -= hA[i, j] * f[j, a]
            st.res[i, a] = value


@declared
def correct_band(packed: Packed, tab: Tableau, fac: Factor, st: Stages) -> None:
    """:func:`structure_correction` of a narrow structure; see ``band_matrix``."""
    raise NotImplementedError


@kernel
def structure_correction(packed: Packed, tab: Tableau, fac: Factor, st: Stages) -> None:
    """DV = -S^-1 res over all stages."""
    if packed.structure.half < 0:
        correct_dense(packed, tab, fac, st)
    else:
        correct_band(packed, tab, fac, st)


@block
def correct_dense(packed: Packed, tab: Tableau, fac: Factor, st: Stages) -> None:
    """:func:`structure_correction` by the inverses."""
    n = st.V.shape[1]
    s = st.V.shape[0]
    T, Tinv, res, y, dV = tab.T, tab.Tinv, st.res, st.y, st.dV
    levels = tab.lam.shape[0]
    dV[:, :] = 0.0
    for x in range(levels):
        inverse = fac.Sinv[fac.slot * levels + x]
        for a in range(n):
            value = 0.0 + 0.0j
            for j in range(s):
                value += Tinv[x, j] * res[j, a]
            y[x, a] = value
        for a in range(n):
            value = 0.0 + 0.0j
            for b in range(n):
                value += inverse[a, b] * y[x, b]
            for i in range(s):
                dV[i, a] -= (T[i, x] * value).real


#: What two iterations in turn may change, in units of ``scale``, where nothing is left to be gained.
SETTLED = 0.1
#: Forces of the structure beside inertia over a step from which on one solution with the inverses is not enough, how
#: often it is refined then, and what the last time may change, in units of ``scale``: inverses that have lost all
#: digits of what is soft refine nothing, and a shorter step is to be taken.
STIFF, REFINEMENTS, UNSETTLED = 1e4, 4, 100.0


@kernel
def stiffness(packed: Packed, fac: Factor, hA: Floats2) -> float:
    """Forces of the structure beside inertia over a step, by the stiffest entry, in units of STIFF.

    Above 1 rounding (of M + sigma C + sigma^2 K, of starts far from stiff motion) takes digits from soft motion.
    """
    h = 0.0
    for j in range(hA.shape[0]):
        h += hA[hA.shape[0] - 1, j]
    structure, K, C = packed.structure, fac.K, fac.C
    most = 0.0
    for i in range(structure.f.shape[0]):
        inertia = structure.M[structure.own[i]]
        for e in range(structure.first[i], structure.first[i + 1]):
            force = h * (abs(C[e]) + h * abs(K[e]))
            if force > most * inertia:
                most = force / inertia
    return most / STIFF


@kernel
def follow_slip(packed: Packed, s: Scratch, st: Stages, w: PortState, mode: Codes) -> None:
    """Velocities of what smooth laws hold more firmly than inertia does, by the slip that has been solved for.

    By the sum of forces they are known to the round-off of forces times h/m, which such a law would turn into a force
    that is quite wrong: the balance of 3e7 N tells 1e-9 m/s, at which rock creeps, only of what is heavy.  The bodies
    of a contact take their parts of the difference by how easily they move.
    """
    ports, mobility = packed.ports, packed.structure.mobility
    mi, n = w.Fin.shape[1], mobility.shape[0]
    for k in range(mode.shape[0]):
        if ports.law[k] != LAW_SMOOTH:
            continue
        for a in range(ports.row[k], ports.row[k + 1]):
            ease, own = 0.0, a - ports.row[k]
            for b in range(n):
                ease += mobility[b] * ports.W[b, a] ** 2
            for i in range(st.V.shape[0]):
                if ease == 0.0 or w.G[i * mi + a, i * mi + a] * w.L[i, k, own, own] > -1.0:
                    continue
                set_instant(packed.signals, s, st.t[i], st.Q[i], st.V[i])
                off = w.g[i, a] + belt_velocity(ports, s, n, a)
                for b in range(n):
                    off -= ports.W[b, a] * st.V[i, b]
                for b in range(n):
                    st.V[i, b] += mobility[b] * ports.W[b, a] * off / ease


@block
def solve_stages(
    packed: Packed,
    tab: Tableau,
    s: Scratch,
    fac: Factor,
    st: Stages,
    w: PortState,
    mode: Codes,
    tol: Floats,
    scale: Floats,
) -> int:
    """Solve for V and the port unknowns from their present values (tol (n_c,), scale (n,): accuracy of velocities).

    Returns the number of outer iterations (1 where the structure is linear), or -1 without convergence.
    """
    n = st.V.shape[1]
    n_s = st.V.shape[0]
    ports = packed.ports
    m = ports.row[-1]
    mi = w.Fin.shape[1]
    linear = packed.elements.address.shape[0] == 0 and mi == m
    stiff = stiffness(packed, fac, st.hA) if linear else 0.0
    once = linear and stiff <= 1.0
    # what velocities leave unsolved is a force of stiff springs, by which contacts let go: it has to be as small
    done = 1e-3 / max(1.0, stiff)
    shared = ports.soft > 0.0
    last = np.inf
    P, V, dV, Fo, gb = fac.P[fac.slot], st.V, st.dV, w.Fo, w.gb
    w.G[:] = fac.G[fac.slot]
    for iteration in range(12):
        stage_residual(packed, s, st, w, mode)
        structure_correction(packed, tab, fac, st)
        for i in range(n_s):
            for c in range(m):
                Fo[i, c] = w.F[i, c]
                for a in range(n):
                    gb[i, c] += ports.W[a, c] * dV[i, a]
            for k in range(mode.shape[0]):
                c = ports.var[k]
                if c >= 0:
                    Fo[i, m + c] = w.N[i, k]
                    for a in range(n):
                        gb[i, m + c] += fac.Nv[c, a] * dV[i, a]
                        for j in range(n_s):
                            gb[i, m + c] += st.hA[i, j] * fac.Nq[c, a] * dV[j, a]
        if solve_ports(ports, packed.laws, s, w, st.hA, mode, tol) < 0:
            return -1
        change = 0.0
        for j in range(n_s):
            for c in range(mi):
                w.dF[j * mi + c] = w.Fin[j, c] - Fo[j, c]
        for i in range(n_s):
            for a in range(n):
                value = dV[i, a]
                line = P[i * n + a]
                for c in range(line.shape[0]):
                    value += line[c] * w.dF[c]
                V[i, a] += value
                if not (shared and abs(value) <= share_noise(line, w.Fin)):
                    change = max(change, abs(value) / scale[a])
        if not change < np.inf:
            return -1
        if once:
            break
        if linear and (iteration == REFINEMENTS or change > 0.1 * last):
            if change > UNSETTLED:
                return -1
            break
        rate = change / last
        if change < done or (not linear and iteration > 0 and rate < 0.9 and change * rate / (1.0 - rate) < 0.1):
            break
        if not linear and max(change, last) < SETTLED:  # a start that was right but for round-off has no rate
            break
        if iteration > 1 and rate > 2.0:
            return -1
        last = change
        if iteration == 11:
            return -1
    follow_slip(packed, s, st, w, mode)
    sound = 0.0
    for i in range(n_s):
        for a in range(n):
            value = st.psi_q[a]
            for j in range(n_s):
                value += st.hA[i, j] * st.V[j, a]
            st.Q[i, a] = value
            sound += 0.0 * value
    # comparisons pass over what is no number
    return iteration + 1 if sound == 0.0 else -1
