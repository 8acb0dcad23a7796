"""Friction of joints and contacts as equations: one row for the force of every port, and rates of internal states."""

from __future__ import annotations

from fricmb.integrate._call import call
from fricmb.integrate._field import gather
from fricmb.integrate._kernel import kernel
from fricmb.integrate._laws import coefficient, smooth_force
from fricmb.integrate._problem import LAW_SMOOTH, NORMAL_CONSTANT, OPEN, STICK, Codes, Floats, Ints
from fricmb.integrate._room import block
from fricmb.integrate.constrained._field import call_joint, friction_at
from fricmb.integrate.constrained._matrix import Layers, add, add_form, add_row
from fricmb.integrate.constrained._pack import Mech, Moving


@kernel
def load_of(mech: Mech, c: int, N: Floats) -> float:
    """Normal force of port c: not below 0, but for a joint's (where it passes through 0 is a transition)."""
    return float(N[c]) if mech.port.joint[c] >= 0 else max(N[c], 0.0)


@block
def friction_residual(
    mech: Mech, k: Moving, mode: Codes, n: Floats, F: Floats, f0: int, z: Floats, z0: int, N: Floats, g: Floats,
    rate: Floats, zd: Floats, r: Floats, r0: int, address: Ints,
) -> None:  # fmt: skip
    """Residuals r[r0:] of the friction forces and rates zd (n_z,) of the states.

    A port that sticks: its slip quantity ``rate`` (slip velocity, or its derivative) is 0; one that slips: the force
    is ``-mu N n`` or what a smooth law says; an open one has none.
    """
    port = mech.port
    for c in range(mode.shape[0]):
        force = F[f0 + c]
        load = load_of(mech, c, N)
        if port.law[c] == LAW_SMOOTH:
            a0, a1 = port.z_start[c], port.z_start[c + 1]
            smooth_force(port.laws, c, k.s, g, c, 1, load, z, z0 + a0, a1 - a0)
            r[r0 + c] = force - (0.0 if mode[c] == OPEN else k.s.out[0])
            for i in range(a1 - a0):
                zd[a0 + i] = k.s.out[1 + i]
        elif mode[c] == STICK:
            r[r0 + c] = rate[c]
        elif mode[c] == OPEN:
            r[r0 + c] = force
        else:
            mu, _, _ = coefficient(port, port.laws, c, k.s, n[c] * g[c], load)  # type: ignore[arg-type]
            r[r0 + c] = force + n[c] * mu * load


@block
def add_slip(
    mech: Mech, k: Moving, c: int, lam: Floats, l0: int, L: Layers, row: int, value: float, full: bool, address: Ints
) -> None:
    """Add ``value dg`` of port c to a row (``full``: by velocity and position; else the derivative of g' by v')."""
    port, table = mech.port, mech.joint.table
    j = port.joint[c]
    if j < 0:
        a0 = port.slip.x_start[c]
        if full:
            add_form(mech, k, L, row, port.slip, a0 + 1, value, mech.address)
        else:
            add_row(mech, k, L.A1, row, port.slip, a0, value, mech.address)
        return
    n_x = call_joint(mech, k, j, lam, l0, mech.address)
    at = friction_at(n_x, mech.joint.row[j + 1] - mech.joint.row[j])
    a0 = table.x_start[j]
    for a in range(n_x):
        if not full:
            add_row(mech, k, L.A1, row, table, a0 + a, value * k.out[at + a], mech.address)
            continue
        add_form(mech, k, L, row, table, a0 + n_x + a, value * k.out[at + a], mech.address)
        turn = 0.0
        for b in range(n_x):
            turn += k.out[at + n_x + b * n_x + a] * k.x[n_x + b]
        add_form(mech, k, L, row, table, a0 + a, value * turn, mech.address)


@block
def add_load(
    mech: Mech, k: Moving, c: int, lam: Floats, l0: int, L: Layers, row: int, value: float, full: bool, address: Ints
) -> None:
    """Add ``value dN`` of port c to a row; without ``full`` by the multipliers alone."""
    port, joint = mech.port, mech.joint
    j = port.joint[c]
    if j < 0:
        if full and port.normal[c] != NORMAL_CONSTANT:
            normals, s = port.normals, k.s
            n_x = gather(normals, c, s.X, s.x)
            call(normals.address[c], s.x, 0, normals.p, normals.p_start[c], s.out, 0)
            for i in range(n_x):
                add_form(mech, k, L, row, normals, normals.x_start[c] + i, value * s.out[1 + i], mech.address)
        return
    n_x = call_joint(mech, k, j, lam, l0, mech.address)
    m = joint.row[j + 1] - joint.row[j]
    at = friction_at(n_x, m) + n_x + n_x * n_x + 1
    first = mech.order.place.shape[0] - port.z_start[-1] - port.joint.shape[0] - joint.row[-1]
    for i in range(m):
        add(mech.order, L.A1, row, first + joint.row[j] + i, value * k.out[at + i])
    if full:
        for a in range(n_x):
            add_form(mech, k, L, row, joint.table, joint.table.x_start[j] + a, value * k.out[at + m + a], mech.address)


@block
def add_friction(
    mech: Mech, k: Moving, mode: Codes, n: Floats, lam: Floats, l0: int, z: Floats, z0: int, N: Floats, g: Floats,
    L: Layers, full: bool, address: Ints,
) -> None:  # fmt: skip
    """Rows of the friction forces and of internal states."""
    port, order = mech.port, mech.order
    n_c = mode.shape[0]
    nz = port.z_start[n_c]
    state0 = order.place.shape[0] - nz
    force0 = state0 - n_c
    for c in range(n_c):
        row = force0 + c
        load = load_of(mech, c, N)
        if port.law[c] == LAW_SMOOTH:
            add(order, L.A1, row, row, 1.0)
            add_smooth(mech, k, c, mode[c] == OPEN, lam, l0, z, z0, load, g, L, full)
        elif mode[c] == STICK:
            add_slip(mech, k, c, lam, l0, L, row, 1.0, full, mech.address)
        elif mode[c] == OPEN:
            add(order, L.A1, row, row, 1.0)
        else:
            add(order, L.A1, row, row, 1.0)
            mu, by_speed, by_load = coefficient(port, port.laws, c, k.s, n[c] * g[c], load)  # type: ignore[arg-type]
            if full and by_speed != 0.0:
                add_slip(mech, k, c, lam, l0, L, row, by_speed * load, full, mech.address)
            if N[c] > 0.0 or port.joint[c] >= 0:
                add_load(mech, k, c, lam, l0, L, row, n[c] * (mu + by_load * load), full, mech.address)


@kernel
def add_smooth(
    mech: Mech, k: Moving, c: int, opened: bool, lam: Floats, l0: int, z: Floats, z0: int, load: float, g: Floats,
    L: Layers, full: bool,
) -> None:  # fmt: skip
    """The force and the rates of a law with a smooth force."""
    port, order = mech.port, mech.order
    n_c = port.joint.shape[0]
    a0, nz = port.z_start[c], port.z_start[c + 1] - port.z_start[c]
    state0 = order.place.shape[0] - port.z_start[n_c]
    width = 2 + nz
    for i in range(1 + nz):
        if i == 0 and opened:
            continue
        row = state0 - n_c + c if i == 0 else state0 + a0 + i - 1
        # add_slip and add_load may call templates: evaluated anew for every row
        smooth_force(port.laws, c, k.s, g, c, 1, load, z, z0 + a0, nz)
        by_slip, by_load = k.s.out[1 + nz + i * width], k.s.out[1 + nz + i * width + 1]
        if full:
            for b in range(nz):
                add(order, L.A1, row, state0 + a0 + b, -k.s.out[1 + nz + i * width + 2 + b])
            add_slip(mech, k, c, lam, l0, L, row, -by_slip, full, mech.address)
        if (full or i == 0) and (load > 0.0 or port.joint[c] >= 0):
            add_load(mech, k, c, lam, l0, L, row, -by_load, full, mech.address)
