"""The unknowns of the contacts in an implicit step, and the forces that follow from them."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.law_values import coefficient, smooth_force
from fricmb.integrate.model.problem_structs import Ports, Table
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, SLIP, STICK, Codes, Floats, Floats2, Floats4, Pivots, Problem


class PortState(Layout):
    """Port unknowns of s stages and space for their Newton iteration.

    ``n``, ``F``, ``g`` (s, m), ``r``, ``N`` (s, n_c), ``z``, ``zd`` (s, n_z); ``Fo`` (s, m+n_v) and ``Fin`` likewise:
    all port inputs (F, then varying N), ``gbuf`` their last values; ``gb`` (s, m+n_v) their outputs at Fo;
    ``psi_z`` (n_z,) history of z; ``dF`` (s (m+n_v),) Fin - Fo;
    ``L`` (s, n_c, rows, columns) derivatives of (F, z') with respect to (unknowns, N, z) of one contact;
    ``plain`` 1 where they are solved for by ``coulomb_newton``, which constant coefficients and normal forces allow;
    ``slope`` (n_z,) largest force that a unit of a state has made so far, in accepted steps of this run.
    """

    n: Floats2
    F: Floats2
    g: Floats2
    r: Floats2
    N: Floats2
    z: Floats2
    zd: Floats2
    Fo: Floats2
    Fin: Floats2
    gbuf: Floats2
    gb: Floats2
    psi_z: Floats
    L: Floats4
    G: Floats2
    J: Floats2
    rhs: Floats
    dF: Floats
    sizes: Pivots
    pivots: Pivots
    plain: int
    slope: Floats


def port_state(problem: Problem, s: int) -> PortState:
    """Arrays for the ports of a problem at s stages."""
    m, nc, nz = problem.m, problem.n_c, problem.n_z
    nv = problem.n_v
    states = int(np.max(np.diff(problem.contacts.z_start), initial=0))
    unknowns = s * (m + nz + nv)
    shapes = [
        (s, m),
        (s, m),
        (s, m),
        (s, nc),
        (s, nc),
        (s, nz),
        (s, nz),
        (s, m + nv),
        (s, m + nv),
        (s, m + nv),
        (s, m + nv),
        (nz,),
    ]
    values = [np.zeros(shape) for shape in shapes]
    local = np.zeros((s, nc, 3 + states, 4 + states))
    G = np.zeros((s * (m + nv), s * (m + nv)))
    sizes, pivots = np.zeros(4, dtype=np.int32), np.zeros(max(unknowns, problem.n, 1), dtype=np.int32)
    solver = [np.zeros((unknowns, unknowns)), np.zeros(unknowns), np.zeros(s * (m + nv)), sizes, pivots, 0]
    return PortState._make([*values, local, G, *solver, np.zeros(nz)])


@kernel
def evaluate_ports(ports: Ports, laws: Table, s: Scratch, w: PortState, mode: Codes) -> None:
    """Forces, state rates and local derivatives at the present unknowns."""
    F, g, n, r, Ns, L, Fin = w.F, w.g, w.n, w.r, w.N, w.L, w.Fin
    row, law, var, z_start = ports.row, ports.law, ports.var, ports.z_start
    m = F.shape[1]
    for i in range(F.shape[0]):
        for k in range(mode.shape[0]):
            row0 = row[k]
            d = row[k + 1] - row0
            if var[k] >= 0:
                if mode[k] == OPEN:
                    Ns[i, k] = 0.0
                Fin[i, m + var[k]] = Ns[i, k]
            if law[k] == LAW_SMOOTH:
                z0 = z_start[k]
                nz = z_start[k + 1] - z0
                smooth_force(laws, k, s, g[i], row0, d, Ns[i, k] if mode[k] != OPEN else 0.0, w.z[i], z0, nz)
                for a in range(d):
                    F[i, row0 + a] = s.out[a]
                for a in range(nz):
                    w.zd[i, z0 + a] = s.out[d + a]
                for a in range(d + nz):
                    for b in range(d + 1 + nz):
                        L[i, k, a, b] = s.out[d + nz + a * (d + 1 + nz) + b]
            elif mode[k] == STICK:
                for a in range(d):
                    g[i, row0 + a] = 0.0
                    for b in range(d + 1):
                        L[i, k, a, b] = 1.0 if a == b else 0.0
            elif mode[k] == SLIP:
                N = Ns[i, k]
                mu, slope, load = coefficient(ports, laws, k, s, r[i, k], N)
                for a in range(d):
                    unit = n[i, row0 + a]
                    F[i, row0 + a] = -mu * N * unit
                    g[i, row0 + a] = r[i, k] * unit
                    L[i, k, a, d - 1] = -slope * N * unit
                    L[i, k, a, d] = -(mu + N * load) * unit
                if d == 2:
                    L[i, k, 0, 0] = mu * N * n[i, row0 + 1]
                    L[i, k, 1, 0] = -mu * N * n[i, row0]
            else:
                for a in range(d):
                    F[i, row0 + a] = 0.0
                    g[i, row0 + a] = 0.0
            for a in range(d):
                Fin[i, row0 + a] = F[i, row0 + a]
