"""When a contact's present mode ends: bounds that rule most of them out, and roots of the others' polynomials.

Watched is, of a contact that slips, ``y = sigma g`` (it lands at y = 0), of one that sticks ``y = F`` (it breaks away
at ``|y| = mu_s N``).
"""

from __future__ import annotations

import math

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import STICK, Floats, Ints
from fricmb.integrate.taylor.layout import N_SEARCHES, NOISE, SHIFTED, STEP, SUM, WATCH, WORK2, WORK3
from fricmb.integrate.taylor.network import Net
from fricmb.integrate.taylor.polynomials import force_row, relative_row, shift_one

#: Intervals in which a root is looked for (a step is at most about half a period of the fastest mode).
PIECES = 4
#: So near to its beginning, with a jump of acceleration and without one, a slip speed is less than round-off.
NEAR = (1e-10, 1e-7)
#: Relative excess of a holding force over its limit that is round-off: more than what settling takes for it.
AT_LIMIT = 2e-11
#: Part of the limit by which a force that grows does so in a step.
GROWS = 1e-9


@kernel
def watch_row(net: Net, c: int, k: int, h: float) -> float:
    """Coefficient k of what is watched of contact c."""
    if net.mode[c] == STICK:
        return force_row(net, c, k) if k < net.R.shape[0] else 0.0
    return float(relative_row(net, c, k, h) * net.sigma[c])


@kernel
def bounds(net: Net) -> None:
    """Distance ``slack`` (m,) that every contact keeps from its end in the whole step at least.

    From the least value of the terms of degree 0 to 2 and the magnitudes of the others.
    """
    h = net.x[STEP]
    m = net.mode.shape[0]
    total, held, moved = net.flat[SUM], net.flat[WORK2], net.flat[WORK3]
    for c in range(m):
        e = net.row_start[c]
        stuck = net.mode[c] == STICK
        plain = net.plain[c] == 1
        total[c] = 0.0
        held[c] = net.row_coef[e] / net.compliance[c] if plain and stuck else 0.0
        moved[c] = net.row_coef[e] / h if plain and not stuck else 0.0
    dof = net.first_dof
    last = net.Q.shape[0] - 2
    for k in range(3, last):
        above, row = net.Q[k + 1], net.R[k]
        rate = k + 1.0
        for c in range(m):
            j = dof[c]
            total[c] += abs(held[c] * row[j] + rate * moved[c] * above[j])
    above = net.Q[last + 1]
    for c in range(m):
        total[c] += abs((last + 1.0) * moved[c] * above[dof[c]])
    for i in range(net.grouped.shape[0]):
        c = net.grouped[i]
        for k in range(3, last + 1):
            total[c] += abs(watch_row(net, c, k, h))
    for c in range(m):
        y0, y1, y2 = watch_row(net, c, 0, h), watch_row(net, c, 1, h), watch_row(net, c, 2, h)
        s = -0.5 * y1 / y2 if y2 != 0.0 else -1.0
        dip = y0 + s * (y1 + s * y2) if 0.0 < s < 1.0 else y0
        if net.mode[c] == STICK:
            net.slack[c] = net.stick[c] - max(abs(y0), abs(y0 + y1 + y2), abs(dip)) - total[c]
        else:
            net.slack[c] = min(y0, y0 + y1 + y2, dip) - total[c]


@kernel
def value_of(y: Floats, last: int, s: float, limit: float) -> float:
    """y(s), or limit^2 - y(s)^2."""
    value = 0.0
    for k in range(last, -1, -1):
        value = value * s + y[k]
    return float(value if limit < 0.0 else (limit - value) * (limit + value))


@kernel
def slope_of(y: Floats, last: int, s: float, limit: float) -> float:
    """Its derivative."""
    value = 0.0
    rate = 0.0
    for k in range(last, -1, -1):
        rate = rate * s + value
        value = value * s + y[k]
    return float(rate if limit < 0.0 else -2.0 * value * rate)


@kernel
def root_between(y: Floats, last: int, limit: float, low: float, high: float) -> float:
    """The root between low, where the function is positive, and high, where it is not: Newton within the bracket."""
    s = 0.5 * (low + high)
    for _ in range(60):
        f = value_of(y, last, s, limit)
        if f > 0.0:
            low = s
        else:
            high = s
        d = slope_of(y, last, s, limit)
        t = s - f / d if d != 0.0 else 0.5 * (low + high)
        if not low < t < high:
            t = 0.5 * (low + high)
        if abs(t - s) <= 1e-15 or high - low <= 1e-15:
            return float(t)
        s = t
    return float(s)


@kernel
def lowest_between(y: Floats, last: int, limit: float, low: float, high: float) -> float:
    """Where a function that falls at low and rises at high is lowest, or where it is found not to be positive."""
    for _ in range(40):
        s = 0.5 * (low + high)
        if value_of(y, last, s, limit) <= 0.0 or high - low < 1e-9:
            return float(s)
        if slope_of(y, last, s, limit) < 0.0:
            low = s
        else:
            high = s
    return float(0.5 * (low + high))


@kernel
def first_root(y: Floats, last: int, limit: float, low: float, high: float) -> float:
    """The first s in [low, high] at which the function is no longer positive; inf if there is none."""
    width = (high - low) / PIECES
    s0 = low
    d0 = 0.0
    for i in range(PIECES + 1):
        s = high if i == PIECES else low + i * width
        f = 0.0
        d = 0.0
        for k in range(last, -1, -1):
            d = d * s + f
            f = f * s + y[k]
        if limit >= 0.0:
            d *= -2.0 * f
            f = (limit - f) * (limit + f)
        if f <= 0.0:
            return root_between(y, last, limit, s0, s) if i > 0 else low
        if i > 0 and d0 < 0.0 and d > 0.0:
            dip = lowest_between(y, last, limit, s0, s)
            if value_of(y, last, dip, limit) <= 0.0:
                return root_between(y, last, limit, s0, dip)
        s0, d0 = s, d
    return math.inf


@block
def taylor_search(net: Net, c: int, low: float, places: Ints) -> float:
    """When, from ``low`` on, the present mode of contact c ends in this step (s), or inf."""
    h = net.x[STEP]
    net.i[N_SEARCHES] += 1
    y = net.old[WATCH]
    last = net.Q.shape[0] - 2
    if net.mode[c] == STICK:
        last -= 1
        for k in range(last + 1):
            y[k] = force_row(net, c, k)
        limit = net.stick[c]
        here, rise = 0.0, 0.0
        for k in range(last, -1, -1):
            rise = rise * low + here
            here = here * low + y[k]
        # what is held at its limit, by a force that does not grow, stays there to round-off
        if abs(here) >= limit * (1.0 - AT_LIMIT) and here * rise <= GROWS * limit * limit:
            limit *= 1.0 + AT_LIMIT
        return first_root(y, last, limit, low, 1.0)
    size = 0.0
    for k in range(last + 1):
        y[k] = watch_row(net, c, k, h)
        size += abs(y[k])
    since = net.since[c]
    if since < 0.0 and y[0] <= net.x[NOISE] and y[1] > 0.0:
        # it began to slip at the end of the step before
        net.since[c] = since = 0.0
    if since < 0.0:
        return first_root(y, last, -1.0, low, 1.0)
    z = net.old[SHIFTED]
    for k in range(last + 1):
        z[k] = y[k]
    shift_one(z, last, since)
    # without a jump of the force the acceleration begins at 0, up to round-off of the forces
    rounding = max(1e-11 * size, 1e-12 * net.compliance[c] * net.stick[c] * h)
    start = 2 if abs(z[1]) <= rounding and last > 1 else 1
    if low - since > NEAR[start - 1]:
        # corrections since then have changed the polynomial where it began: what is left there is no root
        return first_root(y, last, -1.0, low, 1.0)
    for k in range(start, last + 1):
        z[k - start] = z[k]
    return float(since) + first_root(z, last - start, -1.0, low - since, 1.0 - since)
