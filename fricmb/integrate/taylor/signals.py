"""Prescribed functions of time as powers of s, the velocities and forces that they prescribe."""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.template import call
from fricmb.integrate.problem import Floats
from fricmb.integrate.taylor.layout import TOL
from fricmb.integrate.taylor.network import Net

#: What round-off leaves between a prescribed function and its powers of s.
ROUNDING = 1e-11


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
def add_signals(net: Net, k: int, out: Floats) -> None:
    """Coefficient k of the accelerations by signals."""
    if net.series.shape[0] == 0:
        return
    for j in range(net.q.shape[0]):
        for e in range(net.in_start[j], net.in_start[j + 1]):
            u = net.in_signal[e]
            out[j] += net.in_u[e] * net.series[u, k] + net.in_du[e] * net.rates[u, k]
