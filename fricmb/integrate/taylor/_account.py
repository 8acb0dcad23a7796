"""Losses and work where contacts are coupled, contact by contact and dof by dof, from the polynomials.

Each counts up to a point of the step: what lies behind it may be given up (a step can end early).
"""

from __future__ import annotations

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import SLIP, Ints
from fricmb.integrate.taylor._layout import DAMPING, INPUT, N_TOUCHED, PAID, STEP
from fricmb.integrate.taylor._ledger import driven_power, signal_power, speed
from fricmb.integrate.taylor._net import Net
from fricmb.integrate.taylor._series import belt_value, polynomial, relative


@kernel
def force_at(net: Net, c: int, s: float) -> float:
    """Force of contact c at s."""
    value = 0.0
    for k in range(net.coupled.F.shape[0] - 1, -1, -1):
        value = value * s + net.coupled.F[k, c]
    return float(value)


@kernel
def pay(net: Net, c: int, s: float) -> None:
    """Count what contact c has done up to s, with the polynomials as they are."""
    before = net.coupled.paid[c]
    if s <= before:
        return
    net.coupled.paid[c] = s
    steady = net.wu_start[c] == net.wu_start[c + 1]
    slips = net.mode[c] == SLIP
    if steady and not slips and net.belt[c] == 0.0:
        return
    h = net.x[STEP]
    rule = net.coupled.rule
    for g in range(rule.shape[1]):
        at = before + (s - before) * rule[0, g]
        work = (s - before) * h * rule[1, g] * force_at(net, c, at)
        net.x[INPUT] += work * belt_value(net, c, at)
        if slips:
            net.loss[c] -= work * relative(net, c, at, h)


@kernel
def pay_dof(net: Net, j: int, s: float) -> None:
    """Count what dampers and signals have done at dof j up to s."""
    before = net.coupled.paid_dof[j]
    if s <= before:
        return
    net.coupled.paid_dof[j] = s
    rule = net.coupled.rule
    for g in range(rule.shape[1]):
        at = before + (s - before) * rule[0, g]
        weight = (s - before) * net.x[STEP] * rule[1, g]
        v = speed(net, j, at)
        if net.damped[0] == 1:
            force = 0.0
            for e in range(net.start[j], net.start[j + 1]):
                if net.c[e] != 0.0:
                    force += net.c[e] * speed(net, net.neighbour[e], at)
            net.x[DAMPING] += weight * net.mass[j] * v * force
        if net.in_start[j] < net.in_start[j + 1]:
            driven_power(net, j, polynomial(net, 0, j, at), v, at, weight)


@kernel
def pay_touched(net: Net, count: int, tau: float) -> None:
    """Count, up to tau, what depends on the motion of the dofs that a correction touches."""
    for slot in range(net.i[N_TOUCHED]):
        pay(net, net.coupled.here[slot], tau)
    if net.damped[0] == 0 and net.series.shape[0] == 0:
        return
    for a in range(count):
        j = net.local[a]
        pay_dof(net, j, tau)
        for e in range(net.start[j], net.start[j + 1]):
            if net.c[e] != 0.0:
                pay_dof(net, net.neighbour[e], tau)


@block
def coupled_pay(net: Net, s: float, places: Ints) -> None:
    """Count all that has been done up to s."""
    for c in range(net.mode.shape[0]):
        pay(net, c, s)
    if net.damped[0] == 0 and net.series.shape[0] == 0:
        return
    for j in range(net.q.shape[0]):
        pay_dof(net, j, s)
    before = net.x[PAID]
    if net.series.shape[0] == 0 or s <= before:
        return
    net.x[PAID] = s
    for g in range(net.coupled.rule.shape[1]):
        at = before + (s - before) * net.coupled.rule[0, g]
        signal_power(net, at, (s - before) * net.x[STEP] * net.coupled.rule[1, g])
