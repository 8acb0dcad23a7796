"""What ports in loops do to one another's slip: D = W^T M^-1 W, joints holding."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.constrained.forces import has_dense_rows
from fricmb.integrate.constrained.instant_matrix import NONE, instant_matrix, solve_instant
from fricmb.integrate.constrained.moving import Moving
from fricmb.integrate.constrained.problem_structs import Mech
from fricmb.integrate.constrained.slip_rows import lightness
from fricmb.integrate.constrained.state import Instant, State
from fricmb.integrate.problem import STICK, Codes, Floats2

#: What is left of a row, of its own size, once it has been told by the others: no more than round-off.
DEPENDENT = 1e-9
#: Mobility of a direction that joints block, beside that without joints: round-off.
BLOCKED = 1e-12


@kernel
def may_share(mech: Mech, c: int) -> bool:
    """Whether port c is in a loop, so that others may bear its share."""
    return bool(mech.port.soft[c] > 0.0)


@kernel
def holds(mech: Mech, c: int) -> bool:
    """Whether port c is a joint whose load is a reaction (a pad rubs without holding)."""
    j = mech.port.joint[c]
    return bool(j >= 0 and mech.joint.row[j] < mech.joint.row[j + 1])


@kernel
def mobility(mech: Mech, k: Moving, w: Instant, y: State, held: Codes, answers: Floats2) -> Floats2:
    """D (m_p, m_p) of the ports that are STICK in ``held``, joints holding; rows that joints block are 0.

    ``answers`` (m_p, m) become the changes of reactions by unit forces of these ports.
    """
    port, linear, n, m = mech.port, mech.linear, y.q.shape[0], y.lam.shape[0]
    rows = port.row[held.shape[0]]
    D = np.zeros((rows, rows))
    if has_dense_rows(mech):
        for c in range(held.shape[0]):
            for a in range(port.row[c], port.row[c + 1] if held[c] == STICK else port.row[c]):
                D[a] = mech.dense.mobility[a]
        for c in range(held.shape[0]):
            for a in range(port.row[c], port.row[c + 1] if held[c] != STICK else port.row[c]):
                D[:, a] = 0.0
        return D
    V = np.zeros((rows, n))
    if not instant_matrix(mech, k, w, y, NONE):
        return D
    for c in range(held.shape[0]):
        for a in range(port.row[c], port.row[c + 1] if held[c] == STICK else port.row[c]):
            w.r[:] = 0.0
            w.r[n + m + a] = 1.0
            solve_instant(mech, w)
            V[a] = w.r[:n]
            answers[a] = w.r[n : n + m]
    for e in range(linear.M.shape[0]):
        for a in range(rows):
            for b in range(rows):
                D[a, b] += linear.M[e] * V[a, linear.Mi[e]] * V[b, linear.Mj[e]]
    for c in range(held.shape[0]):
        for a in range(port.row[c], port.row[c + 1] if held[c] == STICK else port.row[c]):
            if D[a, a] <= BLOCKED * lightness(mech, k, c, a - port.row[c], y.lam, mech.mass):
                D[a, :] = 0.0
                D[:, a] = 0.0
    return D


@kernel
def is_independent(D: Floats2) -> bool:
    """Whether none of the rows that count follows from others."""
    count = 0
    for a in range(D.shape[0]):
        count += 1 if D[a, a] > 0.0 else 0
    return bool(rank(D) == count)


@kernel
def rank(D: Floats2) -> int:
    """Rank of a Gram matrix whose rows are 0 where they do not count: elimination, the largest left first."""
    A, m, found = D.copy(), D.shape[0], 0
    for _ in range(m):
        best, most = -1, DEPENDENT
        for a in range(m):
            if D[a, a] > 0.0 and A[a, a] > most * D[a, a]:
                best, most = a, A[a, a] / D[a, a]
        if best < 0:
            break
        found += 1
        pivot = A[best].copy()
        for a in range(m):
            factor = pivot[a] / pivot[best]
            for b in range(m):
                A[a, b] -= factor * pivot[b]
    return found
