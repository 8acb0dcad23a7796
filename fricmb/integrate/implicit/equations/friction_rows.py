"""Friction of joints and contacts as equations: a row for every direction of every port, and rates of states."""

from __future__ import annotations

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.equations.jacobian_layers import Layers, add
from fricmb.integrate.implicit.equations.plane_slip import add_along, add_found, plane_residual
from fricmb.integrate.implicit.equations.slip_rows import (
    SETTING_OUT,
    add_load,
    add_slip,
    add_stick,
    carried,
    friction_coefficient,
    guided,
)
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.model.law_values import magnitude, smooth_force
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, STICK, Codes, Floats


@block
def friction_residual(
    mech: Mech, k: Moving, mode: Codes, n: Floats, F: Floats, z: Floats, N: Floats, g: Floats,
    rate: Floats, zd: Floats, r: Floats, r0: int, full: bool,
) -> None:  # fmt: skip
    """Residuals r[r0:] of the friction forces and rates zd (n_z,) of the states.

    A port that sticks: its slip quantity ``rate`` (slip velocity, or its derivative) is 0; one that slips: the force
    is ``-mu N n`` or what a smooth law says; an open one has none.  ``full``: of a stage, not of an instant.
    """
    port = mech.port
    for c in range(mode.shape[0]):
        load = carried(mech, c, N[c])
        first = port.row[c]
        d = port.row[c + 1] - first
        if port.law[c] == LAW_SMOOTH:
            a0, a1 = port.z_start[c], port.z_start[c + 1]
            smooth_force(port.laws, c, k.s, g, first, d, load, z, a0, a1 - a0)
            for a in range(d):
                r[r0 + first + a] = F[first + a] - (0.0 if mode[c] == OPEN else k.share * k.s.out[a])
            for i in range(a1 - a0):
                zd[a0 + i] = k.s.out[d + i]
        elif mode[c] == STICK:
            for a in range(first, first + d):
                r[r0 + a] = F[a] if guided(mech, c, a - first) else rate[a]
        elif mode[c] == OPEN:
            for a in range(first, first + d):
                r[r0 + a] = F[a]
        elif d == 1:
            mu, _, _ = friction_coefficient(mech, k, c, n[first] * g[first], load)
            r[r0 + first] = F[first] + n[first] * mu * load
        else:
            plane_residual(mech, k, c, mode, n, F, g, rate, load, r, r0, full)


@block
def add_friction(
    mech: Mech, k: Moving, mode: Codes, n: Floats, F: Floats, lam: Floats, z: Floats, N: Floats, g: Floats, ga: Floats,
    L: Layers, full: bool,
) -> None:  # fmt: skip
    """Rows of the friction forces and of internal states."""
    port, order = mech.port, mech.order
    force0 = order.place.shape[0] - port.z_start[-1] - port.row[-1]
    for c in range(mode.shape[0]):
        first, last = port.row[c], port.row[c + 1]
        row = force0 + first
        load = carried(mech, c, N[c])
        if port.law[c] == LAW_SMOOTH:
            add_smooth(mech, k, c, mode[c] == OPEN, lam, z, load, g, L, full)
        elif mode[c] == STICK:
            add_stick(mech, k, c, lam, L, row, full)
        elif mode[c] == OPEN:
            for a in range(last - first):
                add(order, L.A1, row + a, row + a, 1.0)
        elif last - first == 1:
            add(order, L.A1, row, row, 1.0)
            mu, by_speed, by_load = friction_coefficient(mech, k, c, n[first] * g[first], load)
            if full and by_speed != 0.0:
                add_slip(mech, k, c, 0, lam, L, row, by_speed * load, full)
            add_load(mech, k, c, lam, L, row, n[first] * (mu + by_load * load), full)
        elif ((full and k.form[c] == 1) or mode[c] == SETTING_OUT) and load > 0.0 and magnitude(port.row, c, F) > 0.0:
            add_found(mech, k, c, n, F, lam, load, g if full else ga, L, row, full)
        else:
            add_along(mech, k, c, n, lam, load, g, L, row, full)


@kernel
def add_smooth(
    mech: Mech, k: Moving, c: int, opened: bool, lam: Floats, z: Floats, load: float, g: Floats, L: Layers, full: bool
) -> None:
    """The forces and the rates of a law with a smooth force."""
    port, order = mech.port, mech.order
    first, a0 = port.row[c], port.z_start[c]
    d, nz = port.row[c + 1] - first, port.z_start[c + 1] - a0
    state0 = order.place.shape[0] - port.z_start[-1]
    force0 = state0 - port.row[-1]
    width = d + 1 + nz
    for i in range(d + nz):
        row = force0 + first + i if i < d else state0 + a0 + i - d
        if i < d:
            add(order, L.A1, row, row, 1.0)
            if opened:
                continue
        for j in range(width):
            # add_slip and add_load call templates: evaluated anew for every entry
            smooth_force(port.laws, c, k.s, g, first, d, load, z, a0, nz)
            slope = k.s.out[d + nz + i * width + j] * (k.share if i < d else 1.0)
            if slope == 0.0:
                continue
            if j < d and full:
                add_slip(mech, k, c, j, lam, L, row, -slope, full)
            elif j == d and (full or i < d) and (load > 0.0 or port.joint[c] >= 0):
                add_load(mech, k, c, lam, L, row, -slope, full)
            elif j > d and full:
                add(order, L.A1, row, state0 + a0 + j - d - 1, -slope)
