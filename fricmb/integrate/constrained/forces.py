"""Forces and constraints of a mechanism at an instant."""

from __future__ import annotations

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.template import call
from fricmb.integrate.constrained.dense_rows import add_forces, put_path
from fricmb.integrate.constrained.moving import Moving
from fricmb.integrate.constrained.problem_structs import Mech
from fricmb.integrate.model.forces import element_forces, evaluate, gather, set_time
from fricmb.integrate.model.problem_structs import Table
from fricmb.integrate.problem import NORMAL_CONSTANT, NORMAL_LAW, Floats


@block
def move(mech: Mech, k: Moving, t: float, q: Floats, v: Floats) -> None:
    """Put time, signals, degrees of freedom and places into X; derivatives of the places; ``ddy``."""
    s, place = k.s, mech.place
    n, n_y = q.shape[0], k.ddy.shape[0]
    X, x, out = s.X, k.x, k.out
    set_time(mech.signals, s, t, n_y)
    for i in range(n):
        X[1 + i] = q[i]
        X[1 + n_y + i] = v[i]
        k.ddy[i] = 0.0
    for c in range(place.address.shape[0]):
        d0 = place.dof_start[c]
        b = place.dof_start[c + 1] - d0
        e0 = n + place.first[c]
        count = place.first[c + 1] - place.first[c]
        for i in range(b):
            x[i] = q[place.dof[d0 + i]]
        call(place.address[c], x, 0, place.p, place.p_start[c], out, 0)
        g0, h0 = place.grad_start[c], place.hess_start[c]
        for r in range(count):
            rate = 0.0
            curve = 0.0
            for i in range(b):
                g = out[count + r * b + i]
                k.grad[g0 + r * b + i] = g
                vi = v[place.dof[d0 + i]]
                rate += g * vi
                turn = 0.0
                for j in range(b):
                    h = out[count * (1 + b) + (r * b + i) * b + j]
                    k.hess[h0 + (r * b + i) * b + j] = h
                    turn += h * v[place.dof[d0 + j]]
                k.grad_rate[g0 + r * b + i] = turn
                curve += turn * vi
            X[1 + e0 + r] = out[r]
            X[1 + n_y + e0 + r] = rate
            k.ddy[e0 + r] = curve


@kernel
def scatter(k: Moving, table: Table, a: int, force: float) -> None:
    """Add a force on the form a to the extended coordinates and signals it consists of."""
    n_y = k.ddy.shape[0]
    u0 = 1 + 2 * n_y
    for j in range(table.form_start[a], table.form_start[a + 1]):
        i = table.form_index[j]
        if 1 <= i <= n_y:
            k.fy[i - 1] += force * table.form_coefficient[j]
        elif i >= u0:
            k.fu[i - u0] += force * table.form_coefficient[j]


@kernel
def value_of_form(k: Moving, table: Table, a: int) -> float:
    """Form a at X."""
    value = table.form_constant[a]
    for j in range(table.form_start[a], table.form_start[a + 1]):
        value += table.form_coefficient[j] * k.s.X[table.form_index[j]]
    return float(value)


@kernel
def bend(k: Moving, table: Table, a: int) -> float:
    """Second derivative of form a that velocities and signals bring."""
    n_y = k.ddy.shape[0]
    u0 = 1 + 2 * n_y
    value = 0.0
    for j in range(table.form_start[a], table.form_start[a + 1]):
        i = table.form_index[j]
        if 1 <= i <= n_y:
            value += table.form_coefficient[j] * k.ddy[i - 1]
        elif i >= u0:
            value += table.form_coefficient[j] * k.s.ddu[i - u0]
    return value


@kernel
def loading(mech: Mech, j: int) -> tuple[int, int]:
    """The multipliers that the load of joint j is a function of: its own, or those of the joint that presses it."""
    of = mech.joint.load_of[j]
    return int(mech.joint.row[of]), int(mech.joint.row[of + 1])


@block
def call_joint(mech: Mech, k: Moving, j: int, lam: Floats) -> int:
    """Evaluate joint j into ``k.out``; returns its number of local coordinates."""
    joint = mech.joint
    table = joint.table
    n_x = joint.n_x[j]
    gather(table, j, k.s.X, k.x)
    first, last = loading(mech, j)
    for r in range(first, last):
        k.x[2 * n_x + r - first] = lam[r]
    call(table.address[j], k.x, 0, table.p, table.p_start[j], k.out, 0)
    return int(n_x)


@kernel
def friction_at(n_x: int, m: int) -> int:
    """Where the friction part of a joint's output begins: factors of slip, direction by direction."""
    return m + 2 * m * n_x + n_x * n_x


@kernel
def slope_at(n_x: int, at: int, d: int, direction: int, a: int) -> int:
    """Where the derivatives of factor a of one of d directions begin, ``at`` being where the factors do."""
    return at + d * n_x + (direction * n_x + a) * n_x


@kernel
def load_place(n_x: int, at: int, d: int) -> int:
    """Where the load begins, with its derivatives by multipliers and coordinates, behind d directions of slip."""
    return at + d * n_x * (1 + n_x)


@kernel
def is_open(mech: Mech, j: int) -> bool:
    """Whether joint j may open, and is open; False beyond the joints."""
    joint = mech.joint
    return bool(0 <= j < joint.port.shape[0] and joint.hands_over[j] != 0 and joint.dropped[joint.row[j]] == 2)


@kernel
def is_unloaded(mech: Mech, j: int) -> bool:
    """Whether the joint that presses on the friction of joint j is open."""
    return bool(j >= 0 and is_open(mech, mech.joint.load_of[j]))


@kernel
def directions(mech: Mech, c: int) -> int:
    """Number of directions in which port c slips."""
    return int(mech.port.row[c + 1] - mech.port.row[c])


@kernel
def load_at(mech: Mech, k: Moving, c: int) -> float:
    """Normal force (before max with 0) at X of a contact that is no joint."""
    port = mech.port
    if port.normal[c] == NORMAL_CONSTANT:
        return float(port.N[c])
    normals = port.normals
    evaluate(normals, c, k.s)
    return float(k.s.out[0])


@block
def forces(mech: Mech, k: Moving, lam: Floats, F: Floats, N: Floats, g: Floats) -> None:
    """All forces on extended coordinates (``k.fy``) and signals (``k.fu``); slip velocities and loads of the ports.

    ``lam``, ``F``: multipliers and friction forces; N (n_c,) before max with 0.
    """
    linear, s = mech.linear, k.s
    n_y, n_u = k.ddy.shape[0], s.ddu.shape[0]
    X, fy = s.X, k.fy
    for i in range(n_y):
        fy[i] = linear.f[i]
    tied = linear.tie.shape[0] > 0
    for e in range(linear.K.shape[0]):
        i, j = linear.Ki[e], linear.Kj[e]
        if i < n_y:
            x = X[1 + j + (n_y if j >= n_y else 0)]
            if tied:
                # stiff springs by the difference of their ends: what they do to both is equal to the last digit
                x -= linear.tie[e] * X[1 + i]
            fy[i] -= linear.K[e] * x
    for i in range(min(n_y, linear.alone.shape[0])):
        fy[i] -= linear.alone[i] * X[1 + i]
    for e in range(linear.C.shape[0]):
        i, j = linear.Ci[e], linear.Cj[e]
        if i < n_y:
            fy[i] -= linear.C[e] * X[1 + n_y + j + (n_u if j >= n_y else 0)]
    if n_u > 0:
        structure_on_signals(mech, k)
    for e in range(linear.B.shape[0]):
        fy[linear.Bi[e]] += linear.B[e] * X[1 + 2 * n_y + linear.Bj[e]]
    element_forces(mech.elements, mech.spread, s, fy)
    joint_forces(mech, k, lam, F, N, g)
    contact_forces(mech, k, F, N, g)


@kernel
def structure_on_signals(mech: Mech, k: Moving) -> None:
    """Forces of the linear structure on signals, ``k.fu``, at X; see :func:`forces`."""
    linear = mech.linear
    n_y, n_u = k.ddy.shape[0], k.s.ddu.shape[0]
    X, fu = k.s.X, k.fu
    for i in range(n_u):
        fu[i] = linear.f[n_y + i]
    for e in range(linear.K.shape[0]):
        if linear.Ki[e] >= n_y:
            i, j = linear.Ki[e], linear.Kj[e]
            x = X[1 + j + (n_y if j >= n_y else 0)]
            if linear.tie.shape[0] > 0:
                x -= linear.tie[e] * X[1 + i + n_y]
            fu[i - n_y] -= linear.K[e] * x
    for i in range(n_y, linear.alone.shape[0]):
        fu[i - n_y] -= linear.alone[i] * X[1 + i + n_y]
    for e in range(linear.C.shape[0]):
        if linear.Ci[e] >= n_y:
            j = linear.Cj[e]
            fu[linear.Ci[e] - n_y] -= linear.C[e] * X[1 + n_y + j + (n_u if j >= n_y else 0)]


@kernel
def forces_on_signals(mech: Mech, k: Moving, F: Floats) -> None:
    """All forces on signals, ``k.fu``, at X, of a linear structure and contacts under given loads alone."""
    port, fu, n_y = mech.port, k.fu, k.ddy.shape[0]
    structure_on_signals(mech, k)
    for c in range(port.joint.shape[0]):
        for a in range(port.row[c], port.row[c + 1]):
            form = port.slip.x_start[c] + 2 * (a - port.row[c])
            for j in range(port.slip.form_start[form], port.slip.form_start[form + 1]):
                i = port.slip.form_index[j] - 1 - 2 * n_y
                if i >= 0:
                    fu[i] += F[a] * port.slip.form_coefficient[j]


@kernel
def joint_forces(mech: Mech, k: Moving, lam: Floats, F: Floats, N: Floats, g: Floats) -> None:
    """Reactions and friction of joints; also the constraints and their rates, ``k.phi`` and ``k.phi_rate``."""
    joint = mech.joint
    table = joint.table
    for j in range(joint.n_x.shape[0]):
        n_x = call_joint(mech, k, j, lam)
        m = joint.row[j + 1] - joint.row[j]
        a0 = table.x_start[j]
        c = joint.port[j]
        at = friction_at(n_x, m)
        for r in range(m):
            rate = 0.0
            for a in range(n_x):
                rate += k.out[m + r * n_x + a] * k.x[n_x + a]
            dropped = joint.dropped[joint.row[j] + r] != 0
            k.phi[joint.row[j] + r] = 0.0 if dropped else k.out[r]
            k.phi_rate[joint.row[j] + r] = 0.0 if dropped else rate
        first = mech.port.row[c] if c >= 0 else 0
        d = directions(mech, c) if c >= 0 else 0
        for i in range(d):
            rate = 0.0
            for a in range(n_x):
                rate += k.out[at + i * n_x + a] * k.x[n_x + a]
            g[first + i] = rate
        if c >= 0:
            N[c] = k.out[load_place(n_x, at, d)]
        for a in range(n_x):
            force = 0.0
            for r in range(m):
                force += k.out[m + r * n_x + a] * lam[joint.row[j] + r]
            for i in range(d):
                force += k.out[at + i * n_x + a] * F[first + i]
            if force != 0.0:
                scatter(k, table, a0 + a, force)


@kernel
def slip_at(mech: Mech, k: Moving, c: int, a: int) -> float:
    """Slip velocity of a contact that is no joint, in its row a, at X."""
    slip = mech.port.slip
    form = slip.x_start[c] + 2 * (a - mech.port.row[c]) + 1
    return float(value_of_form(k, slip, form) - mech.port.w[a])


@kernel
def contact_slip(mech: Mech, k: Moving, g: Floats) -> None:
    """Slip velocities of contacts that are no joints."""
    port = mech.port
    for c in range(port.joint.shape[0]):
        for a in range(port.row[c], port.row[c + 1] if port.joint[c] < 0 else port.row[c]):
            g[a] = slip_at(mech, k, c, a)


@kernel
def has_dense_rows(mech: Mech) -> bool:
    """Whether the scene is one of many dense rows."""
    return bool(mech.dense.inverse.shape[0] > 0)


@kernel
def dense_contact_forces(mech: Mech, k: Moving, F: Floats, N: Floats, g: Floats) -> None:
    """The same by dense rows."""
    dense, port, X = mech.dense, mech.port, k.s.X
    n, n_u, m = k.ddy.shape[0], k.s.ddu.shape[0], F.shape[0]
    put_path(dense.of, X[1 : 1 + n], k.rows[0])
    put_path(dense.of, X[1 + n : 1 + 2 * n], k.rows[1])
    for a in range(m):
        slip = k.rows[1, a] + dense.offset[a]
        for b in range(n_u):
            slip += dense.by_u[a, b] * X[1 + 2 * n + n_u + b]
            k.fu[b] += F[a] * dense.by_u[a, b]
        g[a] = slip
        k.rows[0, a] = F[a]
    for c in range(N.shape[0]):
        e, rate = k.rows[0, m + c], k.rows[1, m + c]
        for b in range(n_u):
            e += dense.by_u[m + c, b] * X[1 + 2 * n + b]
            rate += dense.by_u[m + c, b] * X[1 + 2 * n + n_u + b]
        N[c] = dense.offset[m + c] + dense.stiff[c] * e + dense.damp[c] * rate
        push = max(N[c], 0.0) - port.N0[c] if port.normal[c] == NORMAL_LAW else 0.0
        for b in range(n_u):
            k.fu[b] += push * dense.by_u[m + c, b]
        k.rows[0, m + c] = push
    add_forces(dense.on, k.rows[0], k.fy)


@kernel
def contact_forces(mech: Mech, k: Moving, F: Floats, N: Floats, g: Floats) -> None:
    """Friction of contacts that are no joints, and what normal-force laws press with."""
    port = mech.port
    if has_dense_rows(mech):
        dense_contact_forces(mech, k, F, N, g)
        return
    for c in range(port.joint.shape[0]):
        if port.joint[c] >= 0:
            continue
        for a in range(port.row[c], port.row[c + 1]):
            g[a] = slip_at(mech, k, c, a)
            scatter(k, port.slip, port.slip.x_start[c] + 2 * (a - port.row[c]), F[a])
        N[c] = load_at(mech, k, c)
        if port.normal[c] == NORMAL_LAW:
            scatter(k, port.normals, port.normals.x_start[c], max(N[c], 0.0) - port.N0[c])


@kernel
def pull_back(mech: Mech, k: Moving, f: Floats) -> None:
    """Forces on the degrees of freedom, f[:n], from those on extended coordinates."""
    place = mech.place
    for e in range(k.ddy.shape[0]):
        force = k.fy[e]
        for i in range(place.y_start[e], place.y_start[e + 1]):
            at = place.y_at[i]
            if at < 0:
                f[place.y_dof[i]] = force
            elif force != 0.0:
                f[place.y_dof[i]] += force * k.grad[at]
