"""Accelerations, reactions and friction forces at one instant, found together."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.equations.forces import (
    bend,
    call_joint,
    forces,
    has_dense_rows,
    move,
    pull_back,
)
from fricmb.integrate.implicit.equations.friction_rows import friction_residual
from fricmb.integrate.implicit.equations.instant_matrix import ALL, instant_matrix, solve_instant
from fricmb.integrate.implicit.equations.jacobian_layers import place_slope
from fricmb.integrate.implicit.equations.slip_accelerations import slip_accelerations
from fricmb.integrate.implicit.equations.slip_rows import SETTING_OUT
from fricmb.integrate.implicit.modes.load_share import share_load
from fricmb.integrate.implicit.modes.loop_mobility import may_share
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.implicit.stages.held_rows import react_at_rows
from fricmb.integrate.model.forces import element_powers, evaluate
from fricmb.integrate.problem import NORMAL_LAW, STICK, Floats


@kernel
def accelerations_of_places(mech: Mech, k: Moving, a: Floats) -> None:
    """Put second derivatives of the extended coordinates into ``ddy``, that of velocities being there already."""
    place = mech.place
    for e in range(k.ddy.shape[0]):
        for i in range(place.y_start[e], place.y_start[e + 1]):
            k.ddy[e] += a[place.y_dof[i]] * place_slope(place, k, i)


@kernel
def mass_times(mech: Mech, a: Floats, r: Floats, n: int) -> None:
    """Put ``M a`` into r[:n]."""
    linear = mech.linear
    for i in range(n):
        r[i] = 0.0
    for e in range(linear.M.shape[0]):
        r[linear.Mi[e]] += linear.M[e] * a[linear.Mj[e]]


@kernel
def constraint_acceleration(mech: Mech, k: Moving, lam: Floats, r: Floats, r0: int) -> None:
    """Second derivatives of the constraints into r[r0:], those of the extended coordinates being in ``ddy``."""
    joint = mech.joint
    for j in range(joint.n_x.shape[0]):
        n_x = call_joint(mech, k, j, lam)
        m = joint.row[j + 1] - joint.row[j]
        B = m + m * n_x + n_x * n_x
        for i in range(m):
            value = 0.0
            for a in range(n_x if joint.dropped[joint.row[j] + i] == 0 else 0):
                value += k.out[m + i * n_x + a] * bend(k, joint.table, joint.table.x_start[j] + a)
                value += k.out[B + i * n_x + a] * k.x[n_x + a]
            r[r0 + joint.row[j] + i] = value


@block
def instant_residual(mech: Mech, k: Moving, w: Instant, y: State) -> None:
    """Residual of motion, constraints and friction at the instant for the present a, lam, F into ``w.r``."""
    n, m = y.q.shape[0], y.lam.shape[0]
    forces(mech, k, y.lam, y.F, y.N, y.g)
    pull_back(mech, k, w.x)
    mass_times(mech, y.a, w.r, n)
    for i in range(n):
        w.r[i] -= w.x[i]
    for e in range(k.ddy.shape[0]):
        w.ddy[e] = k.ddy[e]
    accelerations_of_places(mech, k, y.a)
    constraint_acceleration(mech, k, y.lam, w.r, n)
    slip_accelerations(mech, k, y)
    for e in range(k.ddy.shape[0]):
        k.ddy[e] = w.ddy[e]
    friction_residual(mech, k, y.mode, y.n, y.F, y.z, y.N, y.g, y.ga, y.zd, w.r, n + m, False)


@kernel
def largest_load(mech: Mech, y: State) -> float:
    """Largest force of inertia, and largest constant force."""
    linear = mech.linear
    value = 0.0
    for e in range(linear.M.shape[0]):
        value = max(value, abs(linear.M[e] * y.a[linear.Mj[e]]))
    for i in range(linear.f.shape[0]):
        value = max(value, abs(linear.f[i]))
    return value


@kernel
def largest(x: Floats) -> float:
    """Largest magnitude."""
    value = 0.0
    for i in range(x.shape[0]):
        value = max(value, abs(x[i]))
    return value


@kernel
def weighed(mech: Mech, x: Floats) -> float:
    """Largest of velocities or accelerations x (n,) by roots of masses: lengths and angles in one measure."""
    value = 0.0
    for i in range(x.shape[0]):
        value = max(value, np.sqrt(mech.mass[i]) * abs(x[i]))
    return value


#: Forces below this part of the largest so far are left with the round-off of that, once all is at rest.
HISTORY = 1e-8
#: A change of accelerations and forces, beside them, whose round-off is nothing.
SLIGHT = 1e-4
#: Newton's iterations at an instant: friction makes the problem piecewise linear, a law of the load nonlinear.
ITERATIONS = 25


@kernel
def is_linear(y: State) -> bool:
    """Whether accelerations and forces follow from linear equations: no load is a reaction, and nothing sets out."""
    linear = y.lam.shape[0] == 0
    for c in range(y.mode.shape[0]):
        linear = linear and y.mode[c] != SETTING_OUT
    return bool(linear)


@kernel
def forget_shares(mech: Mech, y: State) -> None:
    """Let forces of ports that stick in loops be sought from 0: those of least norm, whatever the steps before."""
    for c in range(y.mode.shape[0]):
        if y.mode[c] == STICK and may_share(mech, c):
            for a in range(mech.port.row[c], mech.port.row[c + 1]):
                y.F[a] = 0.0


@kernel
def find_reactions(mech: Mech, k: Moving, w: Instant, y: State, factored: bool) -> bool:
    """Newton for accelerations, reactions and friction forces at X; see ``react``."""
    n, m, n_c, nz = y.q.shape[0], y.lam.shape[0], y.F.shape[0], y.z.shape[0]
    last = np.inf
    linear = is_linear(y)
    # where everything comes to rest, round-off is that of what has been
    size0, load0 = largest(y.a), max(largest(y.lam), largest(y.F), HISTORY * k.borne_before)
    for iteration in range(ITERATIONS):
        instant_residual(mech, k, w, y)
        for i in range(nz):
            w.r[n + m + n_c + i] = 0.0
        known = (factored and n_c == 0) or (linear and iteration > 0)
        if not known and not instant_matrix(mech, k, w, y, ALL):
            return False
        solve_instant(mech, w)
        change, size, inertia = 0.0, size0, 0.0
        sound = 0.0
        for i in range(n + m + n_c):
            sound += 0.0 * w.r[i]
        if sound != 0.0:
            return False
        for i in range(n):
            y.a[i] -= w.r[i]
            inertia = max(inertia, mech.mass[i] * abs(w.r[i]))
            change, size = max(change, abs(w.r[i])), max(size, abs(y.a[i]))
        # reactions may pass through 0: what is round-off is seen from the forces of inertia and weight, too
        force = 0.0
        load = max(load0, largest_load(mech, y))
        for i in range(m):
            y.lam[i] -= w.r[n + i]
            force, load = max(force, abs(w.r[n + i])), max(load, abs(y.lam[i]))
        for c in range(n_c):
            y.F[c] -= w.r[n + m + c]
            force, load = max(force, abs(w.r[n + m + c])), max(load, abs(y.F[c]))
        if not (change < np.inf and force < np.inf):
            return False
        # what rests accelerates by round-off of the forces that hold it
        found = force <= 1e-12 * load and (change <= 1e-12 * size or inertia <= 1e-15 * load)
        if found or (n_c == 0 and (iteration > 0 or not factored)):
            break
        # one solution is all, but for the round-off of a large change
        if linear and change <= SLIGHT * size and force <= SLIGHT * load:
            break
        part = min(change / max(size, 1e-300), inertia / max(load, 1e-300))
        error = max(part, force / max(load, 1e-300))
        if error < 1e-9 and error >= 0.5 * last:
            break
        last = error
    else:
        return False
    return True


@block
def react(mech: Mech, k: Moving, w: Instant, y: State, factored: bool) -> bool:
    """Accelerations, reactions and friction forces of the given modes; False where there are none.

    ``factored``: the matrix of practically this instant is there (it serves where there is no friction).
    """
    move(mech, k, y.t, y.q, y.v)
    forget_shares(mech, y)
    found = has_dense_rows(mech) and react_at_rows(mech, k, y, w.held)
    if not found and not find_reactions(mech, k, w, y, factored):
        return False
    share_load(mech, k, w, y, y.mode, y.N, y.F, y.lam, 1.0)
    # of what has been found: iterates on the way there may be anything
    k.borne = max(k.borne_before, largest(y.lam), largest(y.F), largest_load(mech, y))
    instant_residual(mech, k, w, y)
    powers(mech, k, y.F, y.g, y.N, y.rate)
    return True


@kernel
def lost_in_dampers(mech: Mech, k: Moving, N: Floats) -> float:
    """Power that normal forces of dense rows take at X: those without damping none, being linear while they press."""
    dense, port, X = mech.dense, mech.port, k.s.X
    n, n_u, m, lost = k.ddy.shape[0], k.s.ddu.shape[0], port.row[-1], 0.0
    for c in range(N.shape[0]):
        if port.normal[c] == NORMAL_LAW and port.damped[c]:
            line, rate = dense.on[m + c], 0.0
            for i in range(n):
                rate += line[i] * X[1 + n + i]
            for b in range(n_u):
                rate += dense.by_u[m + c, b] * X[1 + 2 * n + n_u + b]
            lost -= (max(N[c], 0.0) - port.N0[c]) * rate
    return lost


@block
def powers(mech: Mech, k: Moving, F: Floats, g: Floats, N: Floats, out: Floats) -> None:
    """Powers at X with the forces of the last evaluation: friction of every port, damping, input."""
    linear, s, port = mech.linear, k.s, mech.port
    n_y, n_u = k.ddy.shape[0], s.ddu.shape[0]
    X = s.X
    damping = supply = 0.0
    n_c = N.shape[0]
    for c in range(n_c):
        out[c] = 0.0
        for a in range(port.row[c], port.row[c + 1]):
            out[c] -= F[a] * g[a]
            if port.joint[c] < 0:
                supply += F[a] * port.w[a]
        if port.joint[c] < 0 and port.normal[c] == NORMAL_LAW and not has_dense_rows(mech):
            evaluate(port.normals, c, s)
            rate = s.x[1]
            push = max(N[c], 0.0) - port.N0[c]
            # of one with damping all counts as lost here, and what is stored is taken off in the end
            damping -= (push if port.damped[c] else push + s.out[4]) * rate
    if has_dense_rows(mech):
        damping += lost_in_dampers(mech, k, N)
    for j in range(n_u):
        supply -= k.fu[j] * X[1 + 2 * n_y + n_u + j]
    for e in range(linear.C.shape[0]):
        i, j = linear.Ci[e], linear.Cj[e]
        vi = X[1 + n_y + i + (n_u if i >= n_y else 0)]
        damping += linear.C[e] * vi * X[1 + n_y + j + (n_u if j >= n_y else 0)]
    for e in range(linear.K.shape[0]):
        i, j = linear.Ki[e], linear.Kj[e]
        if i < n_y and j < n_y:
            supply -= 0.5 * linear.K[e] * (X[1 + n_y + i] * X[1 + j] - X[1 + n_y + j] * X[1 + i])
    for e in range(linear.B.shape[0]):
        supply += linear.B[e] * X[1 + 2 * n_y + linear.Bj[e]] * X[1 + n_y + linear.Bi[e]]
    lost, gained = element_powers(mech.elements, mech.spread, s)
    out[n_c] = damping + lost
    out[n_c + 1] = supply + gained
