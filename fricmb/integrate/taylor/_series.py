"""The Taylor polynomials of all dofs under their contacts' present modes."""

from __future__ import annotations

import math

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.template import call
from fricmb.integrate.problem import SLIP, STICK, Floats, Ints
from fricmb.integrate.taylor._layout import STEP, TOL
from fricmb.integrate.taylor._net import Net


@kernel
def signal_series(net: Net, t: float, h: float) -> float:
    """Powers of s of u and u', from values, rates and accelerations at the start, the middle and the end.

    Returns how far off they are in between, relative to the largest value.
    """
    n_u = net.series.shape[0]
    P = net.series.shape[1]
    worst = 0.0
    x = net.window  # window[2], [3:6]: argument and results of a call
    for j in range(n_u):
        for a in range(9):
            net.fit[9, a] = 0.0
        for a in range(3):
            x[2] = min(max(t + 0.5 * a * h, x[0]), x[1])
            call(net.signals.address[j], x, 2, net.signals.p, net.signals.p_start[j], x, 3)
            net.fit[9, 3 * a] = x[3]
            net.fit[9, 3 * a + 1] = x[4] * h
            net.fit[9, 3 * a + 2] = x[5] * h * h
            if not abs(x[3]) + abs(x[4]) + abs(x[5]) < math.inf:
                return math.inf  # it has no value here
        for k in range(P):
            value = 0.0
            if k < 9:
                for a in range(9):
                    value += net.fit[k, a] * net.fit[9, a]
            net.series[j, k] = value
        for k in range(P - 1):
            net.rates[j, k] = (k + 1) * net.series[j, k + 1] / h
        net.rates[j, P - 1] = 0.0
        x[2] = min(max(t + 0.25 * h, x[0]), x[1])
        call(net.signals.address[j], x, 2, net.signals.p, net.signals.p_start[j], x, 3)
        value = 0.0
        rate = 0.0
        for k in range(P - 1, -1, -1):
            value = value * 0.25 + net.series[j, k]
            rate = rate * 0.25 + net.rates[j, k]
        if not abs(x[3]) + abs(x[4]) < math.inf:
            return math.inf
        net.large[0, j] = max(net.large[0, j], abs(x[3]))
        net.large[1, j] = max(net.large[1, j], abs(x[4]))
        worst = max(worst, abs(value - x[3]) / (net.large[0, j] + 1e-300))
        worst = max(worst, abs(rate - x[4]) / (net.large[1, j] + 0.01 * net.large[0, j] / h + 1e-300))
    return worst


#: What round-off leaves between a prescribed function and its powers of s.
ROUNDING = 1e-11


@kernel
def belt_grain(net: Net, c: int, h: float) -> float:
    """How well powers of s follow the prescribed velocity of contact c in a step h (see signal_series)."""
    value = 0.0
    for e in range(net.wu_start[c], net.wu_start[c + 1]):
        j = net.wu_signal[e]
        value += abs(net.wu_coef[e]) * (net.large[1, j] + 0.01 * net.large[0, j] / h)
    return float(2.0 * max(0.1 * net.x[TOL], ROUNDING) * value)


@kernel
def belt_at(net: Net, c: int, k: int) -> float:
    """Coefficient k of the prescribed velocity of contact c."""
    value = net.belt[c] if k == 0 else 0.0
    for e in range(net.wu_start[c], net.wu_start[c + 1]):
        value += net.wu_coef[e] * net.rates[net.wu_signal[e], k]
    return float(value)


@kernel
def belt_rate(net: Net, c: int, k: int, h: float) -> float:
    """Coefficient k of its rate."""
    if net.wu_start[c] == net.wu_start[c + 1]:
        return 0.0
    return float((k + 1) * belt_at(net, c, k + 1) / h)


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
def add_signals(net: Net, k: int, out: Floats) -> None:
    """Coefficient k of the accelerations by signals."""
    if net.series.shape[0] == 0:
        return
    for j in range(net.q.shape[0]):
        for e in range(net.in_start[j], net.in_start[j + 1]):
            u = net.in_signal[e]
            out[j] += net.in_u[e] * net.series[u, k] + net.in_du[e] * net.rates[u, k]


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
    if net.tridiagonal[0] == 1:
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
def force_row(net: Net, c: int, k: int, h: float) -> float:
    """Coefficient k of the force of contact c."""
    if net.coupled.F.shape[0] > 0:
        return float(net.coupled.F[k, c])
    if net.mode[c] == SLIP:
        return float(-net.slip[c] * net.sigma[c]) if k == 0 else 0.0
    value = -belt_rate(net, c, k, h)
    for e in range(net.row_start[c], net.row_start[c + 1]):
        value += net.row_coef[e] * net.R[k, net.row_dof[e]]
    return float(-value / net.compliance[c])


@block
def taylor_series(net: Net, h: float, places: Ints) -> bool:
    """Fill Q and R for a step h from the state; returns whether anything accelerates."""
    n = net.q.shape[0]
    P = net.Q.shape[0] - 1
    free = net.free
    for j in range(n):
        net.Q[0, j] = net.q[j]
        net.Q[1, j] = net.v[j] * h
    busy = False
    for k in range(P - 1):
        row = net.R[k]
        structure_row(net, k, h, row)
        factor = h * h / ((k + 1) * (k + 2))
        target = net.Q[k + 2]
        for j in range(n):
            target[j] = factor * row[j] * free[j]
        if k == 0:
            for c in range(net.mode.shape[0]):
                if net.mode[c] == SLIP:
                    add_force(net, c, 0, h, factor)
        for i in range(net.special.shape[0]):
            c = net.special[i]
            if net.mode[c] == STICK:
                add_force(net, c, k, h, factor)
        if not busy:
            for j in range(n):
                if target[j] != 0.0:
                    busy = True
                    break
    return busy


@kernel
def add_force(net: Net, c: int, k: int, h: float, factor: float) -> None:
    """Coefficient k of the force of contact c into the displacements."""
    force = force_row(net, c, k, h)
    for e in range(net.row_start[c], net.row_start[c + 1]):
        net.Q[k + 2, net.row_dof[e]] += factor * net.push[e] * force


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
        if k < net.coupled.F.shape[0]:
            row = net.coupled.F[k]
            for c in range(row.shape[0]):
                row[c] *= factor
        for u in range(net.series.shape[0]):
            net.series[u, k] *= factor
            net.rates[u, k] *= factor
        factor *= f
    net.x[STEP] *= f


@kernel
def polynomial(net: Net, rows: int, j: int, s: float) -> float:
    """q_j(s) (rows 0) or R_j(s) (rows 1)."""
    value = 0.0
    if rows == 0:
        for k in range(net.Q.shape[0] - 1, -1, -1):
            value = value * s + net.Q[k, j]
    else:
        for k in range(net.R.shape[0] - 1, -1, -1):
            value = value * s + net.R[k, j]
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
def belt_value(net: Net, c: int, s: float) -> float:
    """Prescribed velocity of contact c at s."""
    value = net.belt[c]
    for e in range(net.wu_start[c], net.wu_start[c + 1]):
        rate = 0.0
        for k in range(net.rates.shape[1] - 1, -1, -1):
            rate = rate * s + net.rates[net.wu_signal[e], k]
        value += net.wu_coef[e] * rate
    return float(value)


@kernel
def displacement(net: Net, c: int, s: float, h: float) -> float:
    """Relative displacement of contact c at s: the integral of its relative velocity, up to a constant."""
    value = -net.belt[c] * (net.x[0] + s * h)
    for e in range(net.row_start[c], net.row_start[c + 1]):
        value += net.row_coef[e] * polynomial(net, 0, net.row_dof[e], s)
    for e in range(net.wu_start[c], net.wu_start[c + 1]):
        u = net.wu_signal[e]
        travel = 0.0
        for k in range(net.rates.shape[1] - 1, -1, -1):
            travel = (travel + net.rates[u, k] / (k + 1)) * s
        value -= net.wu_coef[e] * (net.travel[u] + travel * h)
    return float(value)
