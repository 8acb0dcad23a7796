"""Energy lost in dampers and brought in by what is prescribed, by Gauss's formula on the polynomials.

At a transition the rest of the step is counted again, for the dofs alone that its correction touches.
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.formulas.crossing import value_at
from fricmb.integrate.problem import SLIP, STICK
from fricmb.integrate.taylor.layout import WORK, WORK2
from fricmb.integrate.taylor.network import Net
from fricmb.integrate.taylor.polynomials import horner, horner_rate, polynomial


@kernel
def signal_at(net: Net, u: int, s: float, rate: bool) -> float:
    """Signal u, or its rate, at s."""
    return float(value_at(net.rates[u] if rate else net.series[u], s))


@kernel
def speed(net: Net, j: int, s: float) -> float:
    """Velocity of dof j at s."""
    value = 0.0
    for k in range(net.Q.shape[0] - 1, 0, -1):
        value = value * s + k * net.Q[k, j]
    return float(value / net.step)


@kernel
def driven_power(net: Net, j: int, q: float, v: float, s: float, weight: float) -> None:
    """Power that signals bring to dof j, and take through dampers between them and it."""
    for e in range(net.in_start[j], net.in_start[j + 1]):
        u = net.in_signal[e]
        rate = signal_at(net, u, s, True)
        viscous = -net.mass[j] * net.in_du[e]
        stiff = net.in_b[e] - net.mass[j] * net.in_u[e]
        net.supply += weight * (v * net.in_b[e] * signal_at(net, u, s, False) + rate * (stiff * q + viscous * v))
        net.damping += weight * 2.0 * viscous * v * rate


@kernel
def signal_power(net: Net, s: float, weight: float) -> None:
    """Power between signals alone."""
    for a in range(net.series.shape[0]):
        rate = signal_at(net, a, s, True)
        net.supply -= weight * rate * net.drivers[2, a, 0]
        for b in range(net.series.shape[0]):
            other = signal_at(net, b, s, True)
            dashpot = net.drivers[1, a, b] * other
            net.supply += weight * rate * (net.drivers[0, a, b] * signal_at(net, b, s, False) + dashpot)
            net.damping += weight * rate * dashpot


@kernel
def count_rest(net: Net, s0: float, sign: float) -> None:
    """Add ``sign`` times what dampers and prescribed motions do from s0 to where the step ends, contacts apart."""
    if net.damped == 0 and net.series.shape[0] == 0:
        return
    n = net.q.shape[0]
    h = net.step
    q, v = net.flat[WORK], net.flat[WORK2]
    last = net.Q.shape[0] - 1
    length = net.until - s0
    for g in range(net.gauss.shape[1]):
        s = s0 + length * net.gauss[0, g]
        weight = sign * h * length * net.gauss[1, g]
        horner_rate(net.Q, last, s, h, v)
        if net.damped == 1:
            lost = 0.0
            for j in range(n):
                force = 0.0
                for e in range(net.start[j], net.start[j + 1]):
                    force += net.c[e] * v[net.neighbour[e]]
                lost += net.mass[j] * v[j] * force
            net.damping += weight * lost
        if net.series.shape[0] > 0:
            horner(net.Q, last, s, q)
            for j in range(n):
                driven_power(net, j, q[j], v[j], s, weight)
            signal_power(net, s, weight)


@kernel
def count_local(net: Net, count: int, s0: float, sign: float) -> None:
    """The part of :func:`count_rest` that the motion of the local dofs decides."""
    if net.damped == 0 and net.series.shape[0] == 0:
        return
    h = net.step
    length = net.until - s0
    for g in range(net.gauss.shape[1]):
        s = s0 + length * net.gauss[0, g]
        weight = sign * h * length * net.gauss[1, g]
        for a in range(count):
            j = net.local[a]
            v = speed(net, j, s)
            if net.damped == 1:
                force = 0.0
                for e in range(net.start[j], net.start[j + 1]):
                    i = net.neighbour[e]
                    # a damper to a dof outside is counted from both sides
                    force += net.c[e] * speed(net, i, s) * (1.0 if net.place[i] >= 0 else 2.0)
                net.damping += weight * net.mass[j] * v * force
            if net.in_start[j] < net.in_start[j + 1]:
                driven_power(net, j, polynomial(net.Q, j, s), v, s, weight)


@kernel
def belt_work(net: Net, s: float) -> float:
    """Work that belts bring in through plain contacts from s to where the step ends, as the polynomials now are."""
    until = net.until
    held = net.flat[WORK]
    for j in range(net.q.shape[0]):
        held[j] = 0.0
    power, beyond = s, until
    for k in range(net.R.shape[0]):
        row = net.R[k]
        weight = (beyond - power) / (k + 1)
        for j in range(net.q.shape[0]):
            held[j] += weight * row[j]
        power *= s
        beyond *= until
    total = 0.0
    for c in range(net.mode.shape[0]):
        if net.plain[c] == 0:
            continue
        if net.mode[c] == STICK:
            total -= net.belt[c] * net.row_coef[net.row_start[c]] / net.compliance[c] * held[net.first_dof[c]]
        elif net.mode[c] == SLIP:
            total -= net.belt[c] * net.slip[c] * net.sigma[c] * (until - s)
    return float(total * net.step)


@kernel
def shorten_account(net: Net, until: float) -> None:
    """Let the step end at ``until``; behind it corrections that come are no good, so nothing is counted there."""
    net.supply -= belt_work(net, until)
    count_rest(net, until, -1.0)
    net.until = until
