"""The Taylor polynomials of all dofs under their contacts' present modes."""

from __future__ import annotations

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.long_loops import long_loops
from fricmb.integrate.problem import SLIP, Floats
from fricmb.integrate.taylor.curve_check import curve_part
from fricmb.integrate.taylor.friction_curve import friction_row, slip_law
from fricmb.integrate.taylor.group_forces import factor_group, is_held, solve_group, stuck_contact
from fricmb.integrate.taylor.groups import SECOND
from fricmb.integrate.taylor.network import Net, has_planes
from fricmb.integrate.taylor.plane_series import lands, push_planar, start_from_belts
from fricmb.integrate.taylor.polynomials import push_row, relative_row, slip_speed
from fricmb.integrate.taylor.signals import add_signals, belt_rate


@kernel
def three_diagonals(table: Floats, x: Floats, factor: float, out: Floats) -> None:
    """Subtract factor times a tridiagonal matrix times x."""
    n = table.shape[1]
    under, middle, over = table[0], table[1], table[2]
    out[0] -= factor * (middle[0] * x[0] + over[0] * x[1])
    for j in range(1, n - 1):
        out[j] -= factor * (under[j] * x[j - 1] + middle[j] * x[j] + over[j] * x[j + 1])
    out[n - 1] -= factor * (under[n - 1] * x[n - 2] + middle[n - 1] * x[n - 1])


@kernel
def structure_row(net: Net, k: int, h: float, out: Floats) -> None:
    """Coefficient k of M^-1 (f - K q - C v) into out (n,)."""
    n = net.q.shape[0]
    q = net.Q[k]
    p = net.Q[k + 1]
    rate = (k + 1) / h
    if k == 0:
        for j in range(n):
            out[j] = net.load[j]
    else:
        for j in range(n):
            out[j] = 0.0
    damped = net.visc.shape[0] > 0
    if net.tridiagonal == 1:
        three_diagonals(net.stiff, q, 1.0, out)
        if damped:
            three_diagonals(net.visc, p, rate, out)
        add_signals(net, k, out)
        return
    for d in range(net.offset.shape[0]):
        off = net.offset[d]
        low = max(0, -off)
        high = min(n, n - off)
        a = net.stiff[d]
        shifted = q[low + off : high + off]
        part = a[low:high]
        target = out[low:high]
        for j in range(high - low):
            target[j] -= part[j] * shifted[j]
        if damped:
            shifted = p[low + off : high + off]
            part = net.visc[d][low:high]
            for j in range(high - low):
                target[j] -= part[j] * shifted[j] * rate
    if net.offset.shape[0] == 0:
        for j in range(n):
            value = out[j]
            for e in range(net.start[j], net.start[j + 1]):
                value -= net.k[e] * q[net.neighbour[e]] + net.c[e] * p[net.neighbour[e]] * rate
            out[j] = value
    add_signals(net, k, out)


@kernel
def slip_force(net: Net, c: int, k: int, h: float) -> float:
    """Coefficient k of the force of contact c of a group, which slips; its motion is known up to order k + 1."""
    if net.groups.lawful[c] < 0:
        return float(-net.slip[c] * net.sigma[c]) if k == 0 else 0.0
    return float(-net.sigma[c] * friction_row(net, c, k, net.sigma[c] * relative_row(net, c, k, h), h))


@kernel
def push_slipping(net: Net, k: int, h: float, factor: float) -> None:
    """Coefficient k of the forces of all contacts that slip into the displacements."""
    target = net.Q[k + 2]
    if k == 0:
        for c in range(net.mode.shape[0]):
            if net.plain[c] == 1 and net.mode[c] == SLIP:
                e = net.row_start[c]
                target[net.row_dof[e]] += factor * net.push[e] * (-net.slip[c] * net.sigma[c])
    for i in range(net.grouped.shape[0]):
        c = net.grouped[i]
        if net.mode[c] != SLIP or net.groups.planar[c] == SECOND:
            continue
        if net.groups.planar[c] >= 0:
            push_planar(net, c, k, h, factor)
            continue
        force = slip_force(net, c, k, h)
        net.groups.F[k, c] = force
        if force != 0.0:
            push_row(net, c, factor * force, target)


@kernel
def hold_groups(net: Net, k: int, h: float, factor: float) -> None:
    """Coefficient k of the forces of all contacts of groups that stick, and of what they add to the displacements.

    These are ``factor`` times the accelerations.
    """
    F, rhs, n_stuck, target = net.groups.F, net.groups.rhs, net.groups.n_stuck, net.Q[k + 2]
    for gi in range(n_stuck.shape[0]):
        first = net.groups.group_start[gi]
        still = is_held(net, gi)
        for i in range(n_stuck[gi]):
            c = stuck_contact(net, gi, i)
            value = factor * belt_rate(net, c, k, h)
            still = still and value == 0.0
            for e in range(net.row_start[c], net.row_start[c + 1]):
                value -= net.row_coef[e] * target[net.row_dof[e]]
            rhs[first + i] = value
        solve_group(net, gi)
        for i in range(n_stuck[gi]):
            c = stuck_contact(net, gi, i)
            F[k, c] = rhs[first + i] / factor
            for e in range(net.row_start[c], net.row_start[c + 1]):
                j = net.row_dof[e]
                target[j] = 0.0 if still else target[j] + net.push[e] * rhs[first + i]


@kernel
def hold_velocities(net: Net) -> None:
    """Take out of the velocities what round-off and the powers of s of belts have left of slip where contacts stick."""
    rhs, n_stuck = net.groups.rhs, net.groups.n_stuck
    for gi in range(n_stuck.shape[0]):
        first = net.groups.group_start[gi]
        for i in range(n_stuck[gi]):
            c = stuck_contact(net, gi, i)
            rhs[first + i] = -slip_speed(net, c, net.v, 0.0)
        solve_group(net, gi)
        for i in range(n_stuck[gi]):
            push_row(net, stuck_contact(net, gi, i), rhs[first + i], net.v)


@kernel
def begin_groups(net: Net) -> None:
    """Factors under the present modes, velocities that keep to them, the account at its beginning."""
    for gi in range(net.groups.n_stuck.shape[0]):
        factor_group(net, gi)
    hold_velocities(net)
    if has_planes(net):
        start_from_belts(net)
    for i in range(net.grouped.shape[0]):
        net.groups.paid[net.grouped[i]] = 0.0


@kernel
def fastest_speed(net: Net, h: float) -> float:
    """The largest speed so far, or that to which the accelerations at the beginning of a step h lead in it."""
    fastest = 1e-300
    rise = net.Q[2]
    for j in range(net.top.shape[0]):
        fastest = max(fastest, net.top[j], abs(rise[j]) / h)
    return float(fastest)


@kernel
def speed_from_rest(net: Net, h: float) -> float:
    """The same, or the speed to which rates of accelerations lead: all there is where slip begins from rest."""
    fastest = net.fastest
    for j in range(net.top.shape[0]):
        fastest = max(fastest, 3.0 * abs(net.Q[3, j]) / h)
    return float(fastest)


@kernel
def curves_hold(net: Net) -> float:
    """The part of the step in which all slip speeds stay where their curves hold, and these are good enough."""
    allowed = 1.0
    for i in range(net.grouped.shape[0]):
        c = net.grouped[i]
        at = slip_law(net, c)
        if at < 0 or lands(net, c):
            continue
        allowed = min(allowed, curve_part(net, c, net.groups.b[at], 1.0))
    return float(allowed)


@block
@long_loops
def taylor_series(net: Net, h: float) -> bool:
    """Fill Q, R and the groups' forces for a step h from the state; returns whether anything accelerates."""
    n = net.q.shape[0]
    free = net.free
    begin_groups(net)
    for j in range(n):
        net.Q[0, j] = net.q[j]
        net.Q[1, j] = net.v[j] * h
    busy = False
    for k in range(net.Q.shape[0] - 2):
        row, target = net.R[k], net.Q[k + 2]
        structure_row(net, k, h, row)
        factor = h * h / ((k + 1) * (k + 2))
        for j in range(n):
            target[j] = factor * row[j] * free[j]
        push_slipping(net, k, h, factor)
        hold_groups(net, k, h, factor)
        if k == 0:
            net.fastest = net.reached = fastest_speed(net, h)
        if k == 1:
            net.fastest = speed_from_rest(net, h)
        if not busy:
            for j in range(n):
                if target[j] != 0.0:
                    busy = True
                    break
    net.allowed = curves_hold(net)
    return busy
