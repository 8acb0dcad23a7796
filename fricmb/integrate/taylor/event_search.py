"""When a contact's present mode ends: bounds that rule most of them out, and roots of the others' polynomials.

Watched is, of a contact that slips, ``y = sigma g`` (it lands at y = 0), of one that sticks ``y = F`` (it breaks away
at ``|y| = mu_s N``).  In two directions sigma is the direction of slip where the step begins, and stick ends where
``y = (mu_s N)^2 - |F|^2`` is 0.
"""

from __future__ import annotations

import math

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.formulas.crossing import evaluate, lowest_between, root_between
from fricmb.integrate.problem import STICK, Floats
from fricmb.integrate.taylor.layout import LASTS, SHIFTED, WATCH, WORK2, WORK3
from fricmb.integrate.taylor.network import Net
from fricmb.integrate.taylor.plane_series import lands
from fricmb.integrate.taylor.polynomials import force_row, relative_row, shift_one

#: Intervals in which a root is looked for (a step is at most about half a period of the fastest mode).
PIECES = 4
#: So near to its beginning, with a jump of acceleration and without one, a slip speed is less than round-off.
NEAR = (1e-10, 1e-7)
#: Where the search for a root, and for a minimum, ends.
EXACT, DIP = 1e-15, 1e-9
#: Relative excess of a holding force over its limit that is round-off: more than what settling takes for it.
AT_LIMIT = 2e-11
#: Part of the limit by which a force that grows does so in a step.
GROWS = 1e-9
#: A step that is as long as a landing is so to that part of it.
LANDED = 1e-9


@kernel
def watch_row(net: Net, c: int, k: int, h: float) -> float:
    """Coefficient k of what is watched of contact c."""
    if net.mode[c] == STICK:
        return force_row(net, c, k) if k < net.R.shape[0] else 0.0
    value = relative_row(net, c, k, h) * net.sigma[c]
    if net.groups.planar[c] >= 0:
        value += relative_row(net, c + 1, k, h) * net.sigma[c + 1]
    return float(value)


@kernel
def sum_magnitudes(net: Net, held: Floats, moved: Floats) -> None:
    """Magnitudes of the terms of the accelerations, and of h times the velocities, of degree 3 and more, dof by dof."""
    n = net.q.shape[0]
    for j in range(n):
        held[j] = 0.0
        moved[j] = 0.0
    for k in range(3, net.Q.shape[0] - 1):
        rate = k + 1.0
        row = net.Q[k + 1]
        for j in range(n):
            moved[j] += rate * abs(row[j])
    for k in range(3, net.R.shape[0]):
        row = net.R[k]
        for j in range(n):
            held[j] += abs(row[j])


@kernel
def planar_slack(net: Net, c: int, h: float) -> float:
    """What contact c in two directions keeps from its end, from the magnitudes of all terms but the first."""
    rest = 0.0
    if net.mode[c] == STICK:
        for k in range(net.groups.F.shape[0]):
            rest += math.hypot(net.groups.F[k, c], net.groups.F[k, c + 1])
        return float(net.stick[c] - rest)
    if lands(net, c):
        return -1.0
    for k in range(1, net.Q.shape[0] - 1):
        rest += math.hypot(relative_row(net, c, k, h), relative_row(net, c + 1, k, h))
    return float(watch_row(net, c, 0, h) - rest)


@kernel
def bounds(net: Net) -> None:
    """Distance ``slack`` (m,) that every contact keeps from its end in the whole step at least.

    From the least value of the terms of degree 0 to 2 and the magnitudes of the others.
    """
    h = net.step
    last = net.Q.shape[0] - 2
    held, moved = net.flat[WORK2], net.flat[WORK3]
    sum_magnitudes(net, held, moved)
    q1, q2, q3, r0, r1, r2 = net.Q[1], net.Q[2], net.Q[3], net.R[0], net.R[1], net.R[2]
    for c in range(net.mode.shape[0]):
        e, j = net.row_start[c], net.first_dof[c]
        if net.groups.planar[c] != -1:
            net.slack[c] = planar_slack(net, c, h) if net.groups.planar[c] >= 0 else math.inf
            continue
        if net.plain[c] == 0:
            rest = 0.0
            for k in range(3, last + 1):
                rest += abs(watch_row(net, c, k, h))
            y0, y1, y2 = watch_row(net, c, 0, h), watch_row(net, c, 1, h), watch_row(net, c, 2, h)
        elif net.mode[c] == STICK:
            by = net.row_coef[e] / net.compliance[c]
            y0, y1, y2, rest = -by * r0[j], -by * r1[j], -by * r2[j], abs(by) * held[j]
        else:
            by = net.sigma[c] * net.row_coef[e] / h
            y0 = by * q1[j] - net.sigma[c] * net.belt[c]
            y1, y2, rest = 2.0 * by * q2[j], 3.0 * by * q3[j], abs(by) * moved[j]
        s = -0.5 * y1 / y2 if y2 != 0.0 else -1.0
        dip = y0 + s * (y1 + s * y2) if 0.0 < s < 1.0 else y0
        if net.mode[c] == STICK:
            net.slack[c] = net.stick[c] - max(abs(y0), abs(y0 + y1 + y2), abs(dip)) - rest
        else:
            net.slack[c] = min(y0, y0 + y1 + y2, dip) - rest


@kernel
def multiply(y: Floats, by: float) -> None:
    """Multiply in place."""
    for k in range(y.shape[0]):
        y[k] *= by


@kernel
def first_root(y: Floats, limit: float, low: float, high: float) -> float:
    """The first s in [low, high] at which y(s) is no longer positive; inf if there is none.

    Where ``limit`` is not negative: at which ``|y(s)|`` reaches it.  Changes y.
    """
    width = (high - low) / PIECES
    s0, d0 = low, 0.0
    for i in range(PIECES + 1):
        s = high if i == PIECES else low + i * width
        f, d, _ = evaluate(y, s)
        sign = math.copysign(1.0, f)
        if limit >= 0.0:
            f = limit - sign * f
            d *= -sign
        if f <= 0.0 and i == 0:
            return low
        dips = i > 0 and d0 < 0.0 and d > 0.0
        if f <= 0.0 or dips:
            if limit >= 0.0:
                multiply(y, -sign)
                y[0] += limit
            if f <= 0.0:
                return root_between(y, s0, s, EXACT)
            dip = lowest_between(y, s0, s, DIP)
            if dip > 0.0:
                return root_between(y, s0, dip, EXACT)
            if limit >= 0.0:
                y[0] -= limit
                multiply(y, -sign)
        s0, d0 = s, d
    return math.inf


@kernel
def end_of_hold(net: Net, c: int, low: float) -> float:
    """When, from ``low`` on, contact c in two directions breaks away (s), or inf."""
    F, y = net.groups.F, net.groups.square
    last = F.shape[0] - 1
    limit = net.stick[c]
    for k in range(2 * last + 1):
        y[k] = 0.0
        for i in range(max(0, k - last), min(k, last) + 1):
            y[k] -= F[i, c] * F[k - i, c] + F[i, c + 1] * F[k - i, c + 1]
    here, rise, _ = evaluate(y[: 2 * last + 1], low)
    if -here >= limit * limit * (1.0 - 2.0 * AT_LIMIT) and -rise <= 2.0 * GROWS * limit * limit:
        limit *= 1.0 + AT_LIMIT
    y[0] += limit * limit
    return first_root(y[: 2 * last + 1], -1.0, low, 1.0)


@block
def taylor_search(net: Net, c: int, low: float) -> float:
    """When, from ``low`` on, the present mode of contact c ends in this step (s), or inf."""
    h = net.step
    net.n_searches += 1
    y = net.old[WATCH]
    last = net.Q.shape[0] - 2
    planar = net.groups.planar[c]
    if planar >= 0 and net.mode[c] == STICK:
        return end_of_hold(net, c, low)
    if planar >= 0 and lands(net, c):
        # rest comes where the landing ends: behind this step, or where it ends
        part = net.groups.landing[planar, LASTS] / h
        return min(part, 1.0) if part < 1.0 + LANDED else math.inf
    if net.mode[c] == STICK:
        last -= 1
        for k in range(last + 1):
            y[k] = force_row(net, c, k)
        limit = net.stick[c]
        here, rise, _ = evaluate(y[: last + 1], low)
        # what is held at its limit, by a force that does not grow, stays there to round-off
        if abs(here) >= limit * (1.0 - AT_LIMIT) and here * rise <= GROWS * limit * limit:
            limit *= 1.0 + AT_LIMIT
        return first_root(y[: last + 1], limit, low, 1.0)
    size = 0.0
    for k in range(last + 1):
        y[k] = watch_row(net, c, k, h)
        size += abs(y[k])
    since = net.since[c]
    begins = planar >= 0 and net.groups.begins[planar] == 1
    if since < 0.0 and (begins or (y[0] <= net.noise and y[1] > 0.0)):
        # it began to slip at the end of the step before
        net.since[c] = since = 0.0
    if since < 0.0:
        return first_root(y[: last + 1], -1.0, low, 1.0)
    z = net.old[SHIFTED]
    for k in range(last + 1):
        z[k] = y[k]
    shift_one(z, last, since)
    # without a jump of the force the acceleration begins at 0, up to round-off of the forces
    rounding = max(1e-11 * size, 1e-12 * net.compliance[c] * net.stick[c] * h)
    # one that broke away where the last step ended did so at a force that was known to the tolerance
    start = 2 if (abs(z[1]) <= rounding or (since == 0.0 and z[1] < 0.0)) and last > 1 else 1
    if low - since > NEAR[start - 1]:
        # corrections since then have changed the polynomial where it began: what is left there is no root
        return first_root(y[: last + 1], -1.0, low, 1.0)
    for k in range(start, last + 1):
        z[k - start] = z[k]
    return float(since) + first_root(z[: last - start + 1], -1.0, low - since, 1.0 - since)
