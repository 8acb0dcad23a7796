"""What contacts in loops do to one another's slip: D = W^T M^-1 W, with joints holding or as if there were none."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.constrained.forces import call_joint, friction_at
from fricmb.integrate.constrained.instant_matrix import NONE, instant_matrix, solve_instant
from fricmb.integrate.constrained.jacobian_layers import place_slope
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
    """Whether port c is a contact in a loop, or rubs in one without holding (as a pad does)."""
    j = mech.port.joint[c]
    return bool(mech.port.soft[c] > 0.0 and (j < 0 or mech.joint.row[j] == mech.joint.row[j + 1]))


@kernel
def reactions_are_free(mech: Mech) -> bool:
    """Whether no load and no mode hangs on reactions within loops: nothing that may open, no dry joint in a loop."""
    joint = mech.joint
    for j in range(joint.port.shape[0]):
        c = joint.port[j]
        holds = joint.row[j] < joint.row[j + 1]
        if holds and (joint.one_sided[j] != 0 or (c >= 0 and mech.port.soft[c] > 0.0)):
            return False
    return True


@kernel
def slopes_of_slip(mech: Mech, k: Moving, c: int, y: State, W: Floats2) -> None:
    """Slopes of the slip of port c by the degrees of freedom into its rows of W, by the root of the masses."""
    port, place, j = mech.port, mech.place, mech.port.joint[c]
    table, n_x, at = port.slip, 1, 0
    if j >= 0:
        n_x = call_joint(mech, k, j, y.lam)
        table, at = mech.joint.table, friction_at(n_x, mech.joint.row[j + 1] - mech.joint.row[j])
    for a in range(port.row[c], port.row[c + 1]):
        d = a - port.row[c]
        first = table.x_start[j] if j >= 0 else table.x_start[c] + 2 * d
        for form in range(first, first + n_x):
            factor = k.out[at + d * n_x + form - first] if j >= 0 else 1.0
            for i in range(table.form_start[form], table.form_start[form + 1]):
                e = table.form_index[i] - 1
                if not 0 <= e < k.ddy.shape[0]:
                    continue
                for b in range(place.y_start[e], place.y_start[e + 1]):
                    dof = place.y_dof[b]
                    slope = factor * table.form_coefficient[i] * place_slope(place, k, b)
                    W[a, dof] += slope / np.sqrt(mech.mass[dof])


@kernel
def as_if_free(mech: Mech, k: Moving, y: State, held: Codes) -> Floats2:
    """D (m_p, m_p) of the ports that are STICK in ``held``, by the diagonal of M and without joints."""
    m = mech.port.row[held.shape[0]]
    W = np.zeros((m, mech.mass.shape[0]))
    for c in range(held.shape[0]):
        if held[c] == STICK:
            slopes_of_slip(mech, k, c, y, W)
    D = np.zeros((m, m))
    for a in range(m):
        for b in range(m):
            for i in range(W.shape[1]):
                D[a, b] += W[a, i] * W[b, i]
    return D


@kernel
def with_joints(mech: Mech, k: Moving, w: Instant, y: State, held: Codes, answers: Floats2) -> Floats2:
    """D (m_p, m_p) of the ports that are STICK in ``held``, joints holding; rows that joints block are 0.

    ``answers`` (m_p, m) become the changes of reactions by unit forces of these ports.
    """
    port, linear, n, m = mech.port, mech.linear, y.q.shape[0], y.lam.shape[0]
    rows = port.row[held.shape[0]]
    D, V = np.zeros((rows, rows)), np.zeros((rows, n))
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
