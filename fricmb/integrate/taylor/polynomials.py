"""Polynomials of a step: values of motions and forces, coefficients of single contacts, changes of their argument."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import SLIP, Floats, Floats2
from fricmb.integrate.taylor.network import Net
from fricmb.integrate.taylor.signals import belt_at, belt_value


@kernel
def rescale(net: Net, f: float) -> None:
    """Make the polynomials those of a step f times as long."""
    n = net.q.shape[0]
    factor = f
    for k in range(1, net.Q.shape[0]):
        row = net.Q[k]
        for j in range(n):
            row[j] *= factor
        if k < net.R.shape[0]:
            row = net.R[k]
            for j in range(n):
                row[j] *= factor
        if k < net.groups.F.shape[0]:
            row = net.groups.F[k]
            for i in range(net.grouped.shape[0]):
                row[net.grouped[i]] *= factor
        for u in range(net.series.shape[0]):
            net.series[u, k] *= factor
            net.rates[u, k] *= factor
        factor *= f
    net.step *= f


@kernel
def polynomial(table: Floats2, j: int, s: float) -> float:
    """Polynomial of column j at s."""
    value = 0.0
    for k in range(table.shape[0] - 1, -1, -1):
        value = value * s + table[k, j]
    return float(value)


@kernel
def horner(table: Floats, last: int, s: float, out: Floats) -> None:
    """Polynomials of all columns up to degree ``last`` at s."""
    row = table[last]
    for j in range(out.shape[0]):
        out[j] = row[j]
    for k in range(last - 1, -1, -1):
        row = table[k]
        for j in range(out.shape[0]):
            out[j] = out[j] * s + row[j]


@kernel
def horner_rate(table: Floats, last: int, s: float, h: float, out: Floats) -> None:
    """Time derivatives of the polynomials of all columns at s."""
    row = table[last]
    for j in range(out.shape[0]):
        out[j] = last * row[j]
    for k in range(last - 1, 0, -1):
        row = table[k]
        for j in range(out.shape[0]):
            out[j] = out[j] * s + k * row[j]
    for j in range(out.shape[0]):
        out[j] /= h


@kernel
def relative(net: Net, c: int, s: float, h: float) -> float:
    """Relative velocity of contact c at s."""
    value = 0.0
    last = net.Q.shape[0] - 1
    for e in range(net.row_start[c], net.row_start[c + 1]):
        j = net.row_dof[e]
        rate = 0.0
        for k in range(last, 0, -1):
            rate = rate * s + k * net.Q[k, j]
        value += net.row_coef[e] * rate / h
    return float(value - belt_value(net, c, s))


@kernel
def slip_speed(net: Net, row: int, v: Floats, s: float) -> float:
    """Relative velocity of a row at s under the velocities ``v``."""
    g = -belt_value(net, row, s)
    for e in range(net.row_start[row], net.row_start[row + 1]):
        g += net.row_coef[e] * v[net.row_dof[e]]
    return float(g)


@kernel
def push_row(net: Net, row: int, force: float, out: Floats) -> None:
    """Add to ``out`` the accelerations that a force of a row brings about."""
    for e in range(net.row_start[row], net.row_start[row + 1]):
        out[net.row_dof[e]] += net.push[e] * force


@kernel
def shift_slip(net: Net, row: int, by: float, x: Floats) -> None:
    """Change values x (n,) of the dofs of a row, which shares them with no other, by ``by`` between its ends."""
    push_row(net, row, by / net.compliance[row], x)


@kernel
def relative_row(net: Net, c: int, k: int, h: float) -> float:
    """Coefficient k of the relative velocity of contact c."""
    value = -belt_at(net, c, k)
    for e in range(net.row_start[c], net.row_start[c + 1]):
        value += net.row_coef[e] * (k + 1) * net.Q[k + 1, net.row_dof[e]] / h
    return float(value)


@kernel
def force_row(net: Net, c: int, k: int) -> float:
    """Coefficient k of the force of contact c."""
    if net.plain[c] == 0:
        return float(net.groups.F[k, c])
    if net.mode[c] == SLIP:
        return float(-net.slip[c] * net.sigma[c]) if k == 0 else 0.0
    return held_row(net, c, k)


@kernel
def held_row(net: Net, c: int, k: int) -> float:
    """Coefficient k of the force that would hold contact c, a plain one."""
    e = net.row_start[c]
    return float(-net.row_coef[e] * net.R[k, net.row_dof[e]] / net.compliance[c])


@kernel
def hold_force(net: Net, c: int, s: float) -> float:
    """The force at s that would hold contact c, if it is plain; else the force it has."""
    if net.plain[c] == 0:
        return polynomial(net.groups.F, c, s)
    e = net.row_start[c]
    return float(-net.row_coef[e] * polynomial(net.R, net.row_dof[e], s) / net.compliance[c])


@kernel
def shift_one(y: Floats, last: int, by: float) -> None:
    """Powers of s become powers of s - by."""
    for i in range(last):
        for k in range(last - 1, i - 1, -1):
            y[k] += by * y[k + 1]


@kernel
def shift_rows(table: Floats2, last: int, count: int, by: float) -> None:
    """Powers of s become powers of s - by, column by column."""
    for i in range(last):
        above = table[last]
        for k in range(last - 1, i - 1, -1):
            row = table[k]
            for a in range(count):
                row[a] += by * above[a]
            above = row
