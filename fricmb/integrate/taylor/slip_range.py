"""Over which slip speeds friction curves have to hold behind a transition, and where a correction ceases to be good."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.taylor.curve_check import curve_part, within
from fricmb.integrate.taylor.friction_curve import coefficient_at, fit_around, slip_law
from fricmb.integrate.taylor.layout import EPS, WORK
from fricmb.integrate.taylor.network import Net
from fricmb.integrate.taylor.polynomials import relative_row


@kernel
def first_curve(net: Net, c: int, held: float, tau: float, h: float) -> None:
    """A curve for a contact that begins to slip, over the speeds that it may reach in the rest of the step."""
    if slip_law(net, c) < 0:
        return
    rest = (1.0 - tau) * h
    jump = abs(abs(held) - net.groups.N[c] * coefficient_at(net, c, 0.0))
    slope = 0.0
    for k in range(net.groups.F.shape[0] - 1, 0, -1):
        slope = slope * tau + k * net.groups.F[k, c]
    reach = net.compliance[c] * rest * (jump + abs(slope) * (1.0 - tau)) + abs(relative_row(net, c, 1, h)) * (1.0 - tau)
    fit_around(net, c, 0.0, 0.0, 1.5 * reach + 0.01 * net.fastest)


@kernel
def widen(net: Net, tau: float) -> bool:
    """Fit anew what left the range of its curve behind tau; returns whether anything did."""
    groups = net.groups
    again = False
    last = groups.F.shape[0] - 1
    for slot in range(net.n_touched):
        c = groups.here[slot]
        at = slip_law(net, c)
        if at < 0:
            continue
        b = groups.local_b[slot]
        x = b[b.shape[0] - 1]
        if within(net, at, x, last, 1.0 - tau) < 1.0:
            middle, half = groups.middle[at], groups.half[at]
            high, low = x[0], x[0]
            for i in range(groups.along.shape[1]):
                high, low = max(high, groups.along[1, i]), min(low, groups.along[1, i])
            above, below = min(8.0, 1.2 * high - x[0]), min(8.0, x[0] - 1.2 * low)
            fit_around(net, c, middle + x[0] * half, max(0.1, below) * half, max(0.1, above) * half)
            again = again or groups.half[at] > 1.05 * half
    return again


@kernel
def good_until(net: Net, count: int, tau: float, h: float) -> float:
    """Where the correction is no longer good: by its last coefficients and by the curves' ranges."""
    groups = net.groups
    last = net.Q.shape[0] - 1
    reach = (1.0 - tau) ** (last - 1)
    error = 0.0
    for a in range(count):
        tail = last * abs(net.dQ[last, a]) + (last - 1) * abs(net.dQ[last - 1, a])
        error = max(error, tail * reach / (h * (net.top[net.local[a]] + 0.01 * net.fastest)))
    error /= net.tol
    part = 1.0 if error <= 1.0 else 0.9 * error ** (-1.0 / (last - 1.0))
    for slot in range(net.n_touched):
        c = groups.here[slot]
        at = slip_law(net, c)
        if at < 0:
            continue
        part = min(part, curve_part(net, c, groups.local_b[slot], 1.0 - tau))
    return float(min(net.until, tau + (1.0 - tau) * part))


@kernel
def correction_noise(net: Net, count: int, tau: float, until: float, h: float) -> float:
    """Round-off of the velocities at ``until`` once the correction is in powers of s, in units of the tolerance.

    A steep law's correction has coefficients that grow from order to order.  In powers of s - tau the terms are small
    up to ``until``; in powers of s they cancel from magnitudes of ``|d_k| (until + tau)^k``.
    """
    total = net.flat[WORK]
    for a in range(count):
        total[a] = 0.0
    for k in range(net.Q.shape[0] - 1, 0, -1):
        row = net.dQ[k]
        for a in range(count):
            total[a] = total[a] * (until + tau) + k * abs(row[a])
    worst = 0.0
    for a in range(count):
        worst = max(worst, total[a] / (net.top[net.local[a]] + 0.01 * net.fastest))
    return float(EPS * worst / (h * net.tol))
