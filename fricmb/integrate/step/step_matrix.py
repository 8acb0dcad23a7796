"""The part of an implicit step that depends on its size alone: inverses of the structure and responses of the ports.

The matrix of the structure depends neither on modes nor on friction.  It is diagonalised over the stages; ``Sinv`` are
the inverses of M + sigma C + sigma^2 K, sigma = h lam.  They multiply corrections only, so that their round-off is
relative to the correction.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.band import band_sizes
from fricmb.integrate.compile.block import block, declared
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.lapack import solve_complex
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.model.forces import Scratch, normal_gradient, structure_jacobian
from fricmb.integrate.model.problem_structs import Packed, packed_of
from fricmb.integrate.problem import Complexes, Complexes2, Complexes3, Floats, Floats2, Floats3, Ints, Pivots, Problem
from fricmb.integrate.step.contact_unknowns import PortState
from fricmb.integrate.step.tableau import Tableau


class Factor(Layout):
    """What depends on the step size alone, for several step sizes (slots, k).

    ``Sinv`` (k l, n, n) inverses, or (k l, n, 3 half + 1) factors in LAPACK's form of a band with their ``pivots``
    (k l n,) and ``sizes`` [n, half, half, 3 half + 1, 1, info, 'N'].  ``P`` (k, s n, s m_i) response of V to
    port inputs, ``G`` (k, s m_i, s m_i) of their outputs.  ``made`` (k,) step sizes of the slots (0: none); ``slot``
    the present one, ``filled`` the one filled last.
    ``Nq``, ``Nv`` (n_v, n) gradients of varying normal forces; ``K``, ``C`` the Jacobian they were made with, on the
    structure's pattern.
    """

    Sinv: Complexes3
    P: Floats3
    G: Floats3
    made: Floats
    slot: int
    filled: int
    K: Floats
    C: Floats
    Nq: Floats2
    Nv: Floats2
    S: Complexes2
    X: Complexes3
    pivots: Pivots
    sizes: Pivots
    line: Complexes


#: Most step sizes whose factors are kept, and bytes for them: a ladder of steps comes back to the same ones.
SLOTS, SLOT_BYTES = 24, 6.4e7


def factor(problem: Problem, tableau: Tableau) -> Factor:
    """Arrays for factors."""
    n, s, levels = problem.n, len(tableau.c), len(tableau.lam)
    nv = problem.n_v
    mi = problem.m + nv
    structure = packed_of(problem).structure
    half, entries = int(structure.half), len(structure.column)
    width = n if half < 0 else 3 * half + 1
    each = 16.0 * levels * n * width + 8.0 * s * s * mi * (n + mi)
    k = 2 if changes(problem) else int(np.clip(SLOT_BYTES / max(each, 1.0), 2, SLOTS))
    return Factor(
        np.zeros((k * levels, n, width), complex), np.zeros((k, s * n, s * mi)), np.zeros((k, s * mi, s * mi)),
        np.zeros(k), 0, 0, np.zeros(entries), np.zeros(entries), np.zeros((nv, n)), np.zeros((nv, n)),
        np.zeros((n, n) if half < 0 else (0, 0), complex), np.zeros((levels, mi, n), complex),
        np.zeros(0 if half < 0 else k * levels * n, np.int32),
        band_sizes(n, half), np.zeros(n, complex),
    )  # fmt: skip


def changes(problem: Problem) -> bool:
    """Whether the Jacobian changes with the state: nonlinear elements or varying normal forces."""
    return len(problem.elements.table.address) > 0 or problem.n_v > 0


@kernel
def prepare(
    packed: Packed, tab: Tableau, s: Scratch, fac: Factor, w: PortState, counts: Ints, h: float, again: bool,
    keep: bool,
) -> bool:  # fmt: skip
    """Make the factor for step h the present one; False where the matrix is singular.

    ``again``: the Jacobian is made anew, at X, before that; else only the first time.  Steps that are met once, in
    searches (not ``keep``), share slot 0.
    """
    made = fac.made
    slots = made.shape[0]
    if again or fac.filled == 0:
        jacobians(packed, s, fac)
        counts[3] += 1
        made[:] = 0.0
        fac.filled = slots - 1
    for k in range(slots):
        if made[k] == h:
            fac.slot = k
            return True
    k = 0
    if keep:
        k = fac.filled % (slots - 1) + 1
        fac.filled = k
    fac.slot = k
    counts[4] += 1
    made[k] = h if factorise(packed, tab, h, fac, w) else 0.0
    return bool(made[k] == h)


@kernel
def jacobians(packed: Packed, s: Scratch, fac: Factor) -> None:
    """Jacobian of the structure and gradients of the normal forces at X."""
    structure_jacobian(packed.structure, packed.elements, packed.spread, s, fac.K, fac.C)
    for k in range(packed.ports.var.shape[0]):
        a = packed.ports.var[k]
        if a >= 0:
            normal_gradient(packed.normals, k, s, fac.Nq[a], fac.Nv[a])


@declared
def factorise_band(packed: Packed, tab: Tableau, h: float, fac: Factor, w: PortState) -> bool:
    """:func:`factorise` of a narrow structure; see ``band_matrix``."""
    raise NotImplementedError


@kernel
def factorise(packed: Packed, tab: Tableau, h: float, fac: Factor, w: PortState) -> bool:
    """Fill the present slot for h from the Jacobian.  False where the matrix is singular."""
    if packed.structure.half < 0:
        return factorise_dense(packed, tab, h, fac, w)
    return factorise_band(packed, tab, h, fac, w)


@block
def factorise_dense(packed: Packed, tab: Tableau, h: float, fac: Factor, w: PortState) -> bool:
    """:func:`factorise` by inverses."""
    start, index, M = packed.structure.first, packed.structure.column, packed.structure.M
    K, C, S, X = fac.K, fac.C, fac.S, fac.X
    W, Wn, var = packed.ports.W, packed.ports.Wn, packed.ports.var
    n = S.shape[0]
    m = W.shape[1]
    levels = tab.lam.shape[0]
    X[:, :, :] = 0.0
    for x in range(levels):
        sigma = h * tab.lam[x]
        inverse = fac.Sinv[fac.slot * levels + x]
        for i in range(n):
            for j in range(n):
                S[i, j] = 0.0
                inverse[i, j] = 1.0 if i == j else 0.0
        for i in range(n):
            for e in range(start[i], start[i + 1]):
                # transposed: LAPACK reads by columns
                S[index[e], i] = M[e] + sigma * (C[e] + sigma * K[e])
        if n > 0 and solve_complex(S, inverse, w.sizes, w.pivots) != 0:
            return False
        # right-hand sides were columns for LAPACK, rows for us: transpose back
        for i in range(n):
            for j in range(i):
                value = inverse[i, j]
                inverse[i, j] = inverse[j, i]
                inverse[j, i] = value
        for j in range(n):
            for c in range(m):
                if W[j, c] != 0.0:
                    spread_column(X[x, c], inverse, j, sigma * W[j, c])
            for k in range(var.shape[0]):
                if var[k] >= 0 and Wn[j, k] != 0.0:
                    spread_column(X[x, m + var[k]], inverse, j, sigma * Wn[j, k])
    port_inputs(tab, fac)
    port_outputs(W, tab.A, h, fac)
    return True


@kernel
def spread_column(line: Complexes, inverse: Complexes2, j: int, weight: complex) -> None:
    """Add weight times column j of the inverse."""
    for i in range(line.shape[0]):
        line[i] += weight * inverse[i, j]


@kernel
def port_inputs(tab: Tableau, fac: Factor) -> None:
    """P: velocities that follow from unit port inputs, over all stages."""
    X = fac.X
    P = fac.P[fac.slot]
    mi = X.shape[1]
    n = X.shape[2]
    P[:, :] = 0.0
    for i in range(tab.c.shape[0]):
        for j in range(tab.c.shape[0]):
            for x in range(X.shape[0]):
                weight = tab.T[i, x] * tab.Tinv[x, j]
                for a in range(n):
                    for c in range(mi):
                        P[i * n + a, j * mi + c] += (weight * X[x, c, a]).real


@kernel
def port_outputs(W: Floats2, A: Floats2, h: float, fac: Factor) -> None:
    """G: relative velocities and varying normal forces that follow from unit port inputs."""
    P, G, Nq, Nv = fac.P[fac.slot], fac.G[fac.slot], fac.Nq, fac.Nv
    s = A.shape[0]
    n = W.shape[0]
    m = W.shape[1]
    mi = fac.X.shape[1]
    G[:, :] = 0.0
    for i in range(s):
        for a in range(m):
            for b in range(n):
                add_row(G[i * mi + a], P[i * n + b], W[b, a])
        for a in range(mi - m):
            for b in range(n):
                add_row(G[i * mi + m + a], P[i * n + b], Nv[a, b])
                for x in range(s):
                    add_row(G[i * mi + m + a], P[x * n + b], h * A[i, x] * Nq[a, b])


@kernel
def add_row(line: Floats, other: Floats, weight: float) -> None:
    """Add weight times the other row."""
    if weight != 0.0:
        for c in range(line.shape[0]):
            line[c] += weight * other[c]
