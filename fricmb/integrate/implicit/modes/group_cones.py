"""The cones of a group of dry joints and contacts that hold together: what shares of their forces do to each.

Shares are forces that together do nothing to the motion, joints holding; reactions answer them, and with these the
loads of dry joints and what may not pull.  Loads of what slips on must not change: friction there would.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.equations.forces import call_joint, directions, friction_at, is_open, load_place, loading
from fricmb.integrate.implicit.modes.loop_mobility import DEPENDENT, holds
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.model.cone_shares import Cones
from fricmb.integrate.model.friction_cone import friction_size, stick_limit
from fricmb.integrate.problem import STICK, Codes, Floats, Floats2

#: Least size of a cone, beside what tells in its group, and load under which a coefficient is taken then.
LEAST = 1e-6
#: What a share changes in a cone, in its size, that is round-off.
NOTHING = 1e-9


@kernel
def load_slopes(mech: Mech, k: Moving, c: int, lam: Floats, answers: Floats2, slope: Floats) -> None:
    """Change of the load of dry joint c by unit forces (m_p,), whose reactions are ``answers`` (m_p, m)."""
    j = mech.port.joint[c]
    n_x = call_joint(mech, k, j, lam)
    rows = mech.joint.row[j + 1] - mech.joint.row[j]
    at = load_place(n_x, friction_at(n_x, rows), directions(mech, c))
    first, last = loading(mech, j)
    for a in range(slope.shape[0]):
        slope[a] = 0.0
        for i in range(first, last):
            slope[a] += k.out[at + 1 + i - first] * answers[a, i]


@kernel
def load_of(mech: Mech, k: Moving, c: int, lam: Floats) -> float:
    """Load of dry joint c under reactions."""
    j = mech.port.joint[c]
    n_x = call_joint(mech, k, j, lam)
    return float(
        k.out[load_place(n_x, friction_at(n_x, mech.joint.row[j + 1] - mech.joint.row[j]), directions(mech, c))]
    )


@kernel
def keep_loads(mech: Mech, k: Moving, held: Codes, lam: Floats, answers: Floats2, D: Floats2) -> None:
    """Count changes of the loads of dry joints that are not ``held`` as motion in D (m_p, m_p).

    Forces and torques each in their own unit, that of 1 / sqrt(D[a, a]): the load that changes most changes by 1.
    """
    m = D.shape[0]
    slope, root = np.zeros(m), np.zeros(m)
    for a in range(m):
        root[a] = np.sqrt(max(D[a, a], 0.0))
    for c in range(held.shape[0]):
        if held[c] == STICK or not holds(mech, c):
            continue
        load_slopes(mech, k, c, lam, answers, slope)
        top = 0.0
        for a in range(m):
            slope[a] = slope[a] / root[a] if root[a] > 0.0 else 0.0
            top = max(top, abs(slope[a]))
        for a in range(m if top > 0.0 else 0):
            for b in range(m):
                D[a, b] += root[a] * root[b] * (slope[a] / top) * (slope[b] / top)


@kernel
def shares_of(D: Floats2) -> Floats2:
    """Forces (m_p, r) that together do nothing: a basis of the null space of a Gram matrix, by elimination.

    The largest of each, by the roots of D[a, a], is 1, whether it is a force or a torque.
    """
    m = D.shape[0]
    size, A = np.zeros(m), D.copy()
    for a in range(m):
        size[a] = 1.0 / np.sqrt(D[a, a]) if D[a, a] > 0.0 else 0.0
    for a in range(m):
        for b in range(m):
            A[a, b] *= size[a] * size[b]
    pivots, taken, count = np.full(m, -1), np.zeros(m, np.bool_), 0
    for _ in range(m):
        best, most = -1, DEPENDENT
        for a in range(m):
            if size[a] > 0.0 and not taken[a] and A[a, a] > most:
                best, most = a, A[a, a]
        if best < 0:
            break
        taken[best] = True
        pivots[count] = best
        count += 1
        line = A[best] / A[best, best]
        for a in range(m):
            factor = A[a, best]
            if a != best:
                for b in range(m):
                    A[a, b] -= factor * line[b]
        A[best] = line
    free = 0
    for a in range(m):
        free += 1 if size[a] > 0.0 and not taken[a] else 0
    Z, j = np.zeros((m, free)), 0
    for a in range(m):
        if size[a] == 0.0 or taken[a]:
            continue
        Z[a, j] = size[a]
        for i in range(count):
            Z[pivots[i], j] = -A[pivots[i], a] * size[pivots[i]]
        top = 0.0
        for b in range(m):
            top = max(top, abs(Z[b, j]) / size[b] if size[b] > 0.0 else 0.0)
        Z[:, j] /= top
        j += 1
    return Z


@kernel
def units_of(mech: Mech, k: Moving, held: Codes, N: Floats, F: Floats, D: Floats2, unit: Floats) -> float:
    """Forces and torques (m_p,) that tell in a group as its largest does; returns their common unit, ``F sqrt(D)``."""
    port, common = mech.port, 0.0
    for c in range(held.shape[0]):
        if held[c] != STICK:
            continue
        limit = abs(stick_limit(port, port.laws, c, k.s, max(N[c], 0.0)))
        for a in range(port.row[c], port.row[c + 1]):
            common = max(common, max(limit, abs(F[a])) * np.sqrt(max(D[a, a], 0.0)))
    for a in range(unit.shape[0]):
        unit[a] = common / np.sqrt(D[a, a]) if D[a, a] > 0.0 else 0.0
    return float(common)


@kernel
def told(by_force: Floats, unit: Floats) -> float:
    """The most that forces of their units change what changes ``by_force``."""
    value = 0.0
    for a in range(unit.shape[0]):
        value = max(value, abs(by_force[a]) * unit[a])
    return value


@kernel
def idle(mech: Mech, k: Moving, c: int, N: float, by_force: Floats, unit: Floats) -> bool:
    """Whether dry joint c has no load but round-off, whatever the shares (``by_force``: its load by the group)."""
    load, common = max(abs(N), told(by_force, unit)), 0.0
    for a in range(mech.port.row[c], mech.port.row[c + 1]):
        common = max(common, unit[a])
    return bool(stick_limit(mech.port, mech.port.laws, c, k.s, load) <= NOTHING * common)


@kernel
def without_idle(
    mech: Mech, k: Moving, held: Codes, N: Floats, F: Floats, lam: Floats, answers: Floats2, unit: Floats, Z: Floats2
) -> tuple[Floats, Floats2]:  # fmt: skip
    """Forces (m_p,) that relieve dry joints without load of theirs, the others bearing them, and shares that do not.

    Such a joint can bear nothing: left among the cones it would be the tightest whatever the others do.
    """
    Z, relief, by_force, taken = Z.copy(), np.zeros(F.shape[0]), np.zeros(F.shape[0]), 0
    for c in range(held.shape[0]):
        if held[c] != STICK or not holds(mech, c):
            continue
        load_slopes(mech, k, c, lam, answers, by_force)
        if not idle(mech, k, c, N[c], by_force, unit):
            continue
        for a in range(mech.port.row[c], mech.port.row[c + 1]):
            best = taken
            for i in range(taken, Z.shape[1]):
                best = i if abs(Z[a, i]) > abs(Z[a, best]) else best
            if taken == Z.shape[1] or abs(Z[a, best]) <= NOTHING * unit[a]:
                continue
            share = Z[:, best] / Z[a, best]
            for i in range(Z.shape[0]):
                Z[i, best] = Z[i, taken]
            taken += 1
            relief -= share * (F[a] + relief[a])
            for i in range(taken, Z.shape[1]):
                Z[:, i] -= share * Z[a, i]
                Z[a, i] = 0.0
    return relief, Z[:, taken:].copy()


@kernel
def cones_of(
    mech: Mech, k: Moving, held: Codes, N: Floats, F: Floats, lam: Floats, part: float, answers: Floats2, unit: Floats,
    Z: Floats2,
) -> Cones:  # fmt: skip
    """Cones of the held ports, to ``part``, then of joints that may not pull; ``unit``: see ``units_of``."""
    port, joint, n_c, n_j, r = mech.port, mech.joint, held.shape[0], mech.joint.port.shape[0], Z.shape[1]
    row, some = np.full(n_c + n_j + 1, port.row[n_c]), np.zeros(n_c + n_j, np.int8)
    limit, slope, size = np.zeros(n_c + n_j), np.zeros((n_c + n_j, r)), np.ones(n_c + n_j)
    by_force = np.zeros(F.shape[0])
    for c in range(n_c):
        row[c] = port.row[c]
        if held[c] != STICK:
            continue
        some[c] = 1
        load = abs(N[c])
        if holds(mech, c):
            load_slopes(mech, k, c, lam, answers, by_force)
            load = max(load, LEAST * told(by_force, unit))
        per_load = part * stick_limit(port, port.laws, c, k.s, load) / load if load > 0.0 else 0.0
        limit[c] = per_load * N[c] if holds(mech, c) else part * stick_limit(port, port.laws, c, k.s, max(N[c], 0.0))
        for i in range(r if holds(mech, c) else 0):
            for a in range(F.shape[0]):
                slope[c, i] += per_load * by_force[a] * Z[a, i]
        size[c] = max(abs(limit[c]), friction_size(port.row, c, F))
        for a in range(port.row[c], port.row[c + 1]):
            size[c] = max(size[c], LEAST * unit[a])
        some[c] = 0 if holds(mech, c) and idle(mech, k, c, N[c], by_force, unit) else 1
    for j in range(n_j):
        if joint.one_sided[j] == 0 or is_open(mech, j):
            continue
        some[n_c + j] = 1
        limit[n_c + j] = lam[joint.row[j]]
        by_force[:] = answers[:, joint.row[j]]
        for i in range(r):
            for a in range(F.shape[0]):
                slope[n_c + j, i] += by_force[a] * Z[a, i]
        size[n_c + j] = max(abs(limit[n_c + j]), LEAST * told(by_force, unit), 1e-300)
    cones = Cones(row, some, F, Z, limit, slope, size)
    for c in range(n_c + n_j):
        some[c] = 1 if some[c] != 0 and follows(cones, c) else 0
    return cones


@kernel
def follows(cones: Cones, c: int) -> bool:
    """Whether shares of size 1 change anything in cone c."""
    most = 0.0
    for j in range(cones.Z.shape[1]):
        most = max(most, abs(cones.slope[c, j]))
        for a in range(cones.row[c], cones.row[c + 1]):
            most = max(most, abs(cones.Z[a, j]))
    return bool(most > NOTHING * cones.size[c])
