"""Prescribed functions of time as powers of s, the velocities and forces that they prescribe."""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.template import call
from fricmb.integrate.formulas.crossing import value_at
from fricmb.integrate.problem import Floats
from fricmb.integrate.taylor.network import Net

#: What round-off leaves between a prescribed function and its powers of s.
ROUNDING = 1e-11
#: Points of a step at which accelerations are asked for, and the part of it after which errors are.
POINTS, PART = 7, 0.25


@kernel
def call_signal(net: Net, j: int, t: float) -> bool:
    """Value, rate and acceleration of function j at t into window[3:6]; whether it has them."""
    x = net.window
    x[2] = min(max(t, x[0]), x[1])
    call(net.signals.address[j], x, 2, net.signals.p, net.signals.p_start[j], x, 3)
    return bool(abs(x[3]) + abs(x[4]) + abs(x[5]) < 1e290)  # 1/t, asked for 1e-300 behind 0, is 1e300


@kernel
def integrate_series(net: Net, j: int, h: float, value: float, rate: float, start: float) -> None:
    """Powers of s of u and u' from the acceleration at the start and what it differs by at the other points.

    In short steps values and rates are lost in round-off that accelerations are free of: these are integrated.
    """
    series, rates, data = net.series[j], net.rates[j], net.fit[POINTS]
    rates[0], rates[1] = rate, start * h
    for k in range(1, series.shape[0] - 1):
        power = 0.0
        if k < POINTS:
            for a in range(1, POINTS):
                power += net.fit[k, a] * data[a]
        rates[k + 1] = power * h / (k + 1)
    series[0] = value
    for k in range(series.shape[0] - 1):
        series[k + 1] = rates[k] * h / (k + 1)


@kernel
def polynomial_error(net: Net, j: int, s: float, h: float, level: bool) -> float:
    """How far the powers of s are off what function j was last called for, at s, relative to its largest values.

    ``level``: the function stands still.  If its rate does not, its values are not known and nobody needs them.
    """
    x = net.window
    value, rate = value_at(net.series[j], s), value_at(net.rates[j], s)
    size = net.large[0, j]
    off = abs(rate - x[4]) / (net.large[1, j] + 0.01 * size / h + 1e-300)
    return float(off if level else max(off, abs(value - x[3]) / (size + 1e-300)))


@kernel
def signal_series(net: Net, t: float, h: float) -> float:
    """Powers of s of u and u' over a step h; returns how far off they are, relative to the largest values."""
    worst = 0.0
    x = net.window  # window[2], [3:6]: argument and results of a call
    for j in range(net.series.shape[0]):
        if not call_signal(net, j, t):
            return math.inf
        value, rate, start = x[3], x[4], x[5]
        level = True
        for a in range(1, POINTS):
            if not call_signal(net, j, t + a * h / (POINTS - 1)):
                return math.inf
            level = level and x[3] == value
            net.fit[POINTS, a] = x[5] - start
            net.large[0, j] = max(net.large[0, j], abs(x[3]))
            net.large[1, j] = max(net.large[1, j], abs(x[4]))
        integrate_series(net, j, h, value, rate, start)
        worst = max(worst, polynomial_error(net, j, 1.0, h, level))
        # what cancels over the whole step does not in a part of it
        call_signal(net, j, t + PART * h)
        worst = max(worst, polynomial_error(net, j, PART, h, level))
    return worst


@kernel
def belt_grain(net: Net, c: int, h: float) -> float:
    """How well powers of s follow the prescribed velocity of contact c in a step h (see signal_series)."""
    value = 0.0
    for e in range(net.wu_start[c], net.wu_start[c + 1]):
        j = net.wu_signal[e]
        value += abs(net.wu_coef[e]) * (net.large[1, j] + 0.01 * net.large[0, j] / h)
    return float(2.0 * max(0.1 * net.tol, ROUNDING) * value)


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
        value += net.wu_coef[e] * value_at(net.rates[net.wu_signal[e]], s)
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
