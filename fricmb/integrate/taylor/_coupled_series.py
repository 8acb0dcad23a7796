"""The Taylor polynomials of all dofs where contacts are coupled or their friction depends on slip speed."""

from __future__ import annotations

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import SLIP, Floats, Ints
from fricmb.integrate.taylor._curve import coefficient_at, compose, fit_around, within
from fricmb.integrate.taylor._groups import factor_group, solve_group, stuck_contact
from fricmb.integrate.taylor._layout import ALLOWED, FASTEST, PAID
from fricmb.integrate.taylor._net import Net
from fricmb.integrate.taylor._series import belt_at, belt_rate, belt_value, structure_row

#: Speeds below this part of what friction may bring in the step are those of slip that begins.
UNMOVED = 1e-3


@kernel
def relative_row(net: Net, c: int, k: int, h: float) -> float:
    """Coefficient k of the relative velocity of contact c."""
    value = -belt_at(net, c, k)
    for e in range(net.row_start[c], net.row_start[c + 1]):
        value += net.row_coef[e] * (k + 1) * net.Q[k + 1, net.row_dof[e]] / h
    return float(value)


@kernel
def slip_force(net: Net, c: int, k: int, h: float) -> float:
    """Coefficient k of the force of contact c, which slips; its motion is known up to order k + 1."""
    at = net.coupled.lawful[c]
    if at < 0:
        return float(-net.slip[c] * net.sigma[c]) if k == 0 else 0.0
    b = net.coupled.b[at]
    x = b[b.shape[0] - 1]
    x[k] = net.sigma[c] * relative_row(net, c, k, h)
    if k == 0:
        mu = coefficient_at(net, c, x[0])
    else:
        if k == 1:
            pad = 0.3 * abs(x[1]) + 0.05 * abs(x[0]) + 0.01 * net.x[FASTEST]
            reach = net.compliance[c] * net.coupled.N[c] * coefficient_at(net, c, x[0]) * h
            if pad < UNMOVED * reach:
                # slip that begins does not tell yet where it goes: as far as friction may bring it
                pad = reach
            fit_around(net, c, x[0], pad - min(0.0, x[1]), pad + max(0.0, x[1]))
            x[0] = (x[0] - net.coupled.middle[at]) / net.coupled.half[at]
            compose(net.coupled.curve[at], net.coupled.terms[at], x, b, 0)
        x[k] /= net.coupled.half[at]
        mu = compose(net.coupled.curve[at], net.coupled.terms[at], x, b, k)
    return float(-net.sigma[c] * net.coupled.N[c] * mu)


@kernel
def hold(net: Net, k: int, h: float, acceleration: Floats) -> None:
    """Coefficient k of the forces of all contacts that stick, and what they add to the accelerations."""
    F, rhs, n_stuck = net.coupled.F, net.coupled.rhs, net.coupled.n_stuck
    for gi in range(n_stuck.shape[0]):
        first = net.coupled.group_start[gi]
        for i in range(n_stuck[gi]):
            c = stuck_contact(net, gi, i)
            value = belt_rate(net, c, k, h)
            for e in range(net.row_start[c], net.row_start[c + 1]):
                value -= net.row_coef[e] * acceleration[net.row_dof[e]]
            rhs[first + i] = value
        solve_group(net, gi)
        for i in range(n_stuck[gi]):
            c = stuck_contact(net, gi, i)
            F[k, c] = rhs[first + i]
            for e in range(net.row_start[c], net.row_start[c + 1]):
                acceleration[net.row_dof[e]] += net.push[e] * rhs[first + i]


@kernel
def hold_velocities(net: Net) -> None:
    """Take out of the velocities what round-off and the powers of s of belts have left of slip where contacts stick."""
    rhs, n_stuck = net.coupled.rhs, net.coupled.n_stuck
    for gi in range(n_stuck.shape[0]):
        first = net.coupled.group_start[gi]
        for i in range(n_stuck[gi]):
            c = stuck_contact(net, gi, i)
            value = belt_value(net, c, 0.0)
            for e in range(net.row_start[c], net.row_start[c + 1]):
                value -= net.row_coef[e] * net.v[net.row_dof[e]]
            rhs[first + i] = value
        solve_group(net, gi)
        for i in range(n_stuck[gi]):
            c = stuck_contact(net, gi, i)
            for e in range(net.row_start[c], net.row_start[c + 1]):
                net.v[net.row_dof[e]] += net.push[e] * rhs[first + i]


@kernel
def curves_hold(net: Net) -> float:
    """The part of the step in which all slip speeds stay where their curves hold, and these are good enough."""
    allowed = 1.0
    lawful = net.coupled.lawful
    for c in range(lawful.shape[0]):
        at = lawful[c]
        if at < 0 or net.mode[c] != SLIP:
            continue
        b = net.coupled.b[at]
        last = net.coupled.F.shape[0] - 1
        allowed = min(allowed, within(net, at, b[b.shape[0] - 1], last, 1.0))
        if net.coupled.rough[at] > 1.0:
            allowed = min(allowed, 0.7 * net.coupled.rough[at] ** (-1.0 / (net.coupled.nodes.shape[0] - 1.0)))
    return float(allowed)


@block
def coupled_series(net: Net, h: float, places: Ints) -> bool:
    """Fill Q, R and F for a step h from the state; returns whether anything accelerates."""
    n = net.q.shape[0]
    F = net.coupled.F
    for gi in range(net.coupled.n_stuck.shape[0]):
        factor_group(net, gi)
    hold_velocities(net)
    fastest = 1e-300
    for j in range(n):
        net.Q[0, j] = net.q[j]
        net.Q[1, j] = net.v[j] * h
        fastest = max(fastest, net.top[j])
        net.coupled.paid_dof[j] = 0.0
    net.x[FASTEST] = fastest
    net.x[PAID] = 0.0
    busy = False
    for k in range(net.Q.shape[0] - 2):
        row, target = net.R[k], net.Q[k + 2]
        structure_row(net, k, h, row)
        for j in range(n):
            target[j] = row[j]
        for c in range(net.mode.shape[0]):
            net.coupled.paid[c] = 0.0
            if net.mode[c] != SLIP:
                continue
            force = slip_force(net, c, k, h)
            F[k, c] = force
            if force != 0.0:
                for e in range(net.row_start[c], net.row_start[c + 1]):
                    target[net.row_dof[e]] += net.push[e] * force
        hold(net, k, h, target)
        factor = h * h / ((k + 1) * (k + 2))
        for j in range(n):
            target[j] *= factor
            busy = busy or target[j] != 0.0
    net.x[ALLOWED] = curves_hold(net)
    return busy
