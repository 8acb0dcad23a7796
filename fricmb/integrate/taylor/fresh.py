"""Slip in two directions that has begun a short time ago: passes of series, and how long they are good for."""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import SLIP
from fricmb.integrate.taylor.layout import FASTEST, FRESH, MADE, STEP, TOL
from fricmb.integrate.taylor.network import Net
from fricmb.integrate.taylor.polynomials import relative_row
from fricmb.integrate.taylor.series import taylor_series

#: Passes: each makes what is left over smaller by slip speed over what friction brings in the time scale of loads.
PASSES = 4


@kernel
def any_fresh(net: Net) -> bool:
    """Whether slip has begun a short time ago; nothing is known of such directions then."""
    found = False
    for c in range(net.mode.shape[0]):
        at = net.groups.planar[c]
        if at >= 0 and net.mode[c] == SLIP and net.since[c + 1] == FRESH:
            net.groups.unit[at, :, :] = 0.0
            found = True
    return found


@kernel
def all_series(net: Net, h: float) -> bool:
    """Polynomials for a step h, by as many passes as they take; whether anything accelerates."""
    net.x[MADE] = h
    more = PASSES - 1 if any_fresh(net) else 0
    busy = taylor_series(net, h, net.places)
    for _ in range(more):
        busy = taylor_series(net, h, net.places)
    return bool(busy)


@kernel
def lose_fresh(net: Net) -> bool:
    """Contacts whose slip the last pass of the step has changed too much slip as others do; whether there are any."""
    lost = False
    h = net.x[STEP]
    part = h / net.x[MADE]
    for c in range(net.mode.shape[0]):
        at = net.groups.planar[c]
        if at < 0 or net.mode[c] != SLIP or net.groups.begins[at] != 2:
            continue
        turned, d, first = net.groups.turned[at], net.groups.unit[at], net.groups.first_speed[at]
        off, power = 0.0, 1.0
        for k in range(net.groups.F.shape[0]):
            off += turned[k] * power
            power *= part
        off *= h * net.compliance[c] * abs(net.groups.rubbing[at, 0])
        off += math.hypot(
            relative_row(net, c, 0, h) - first * d[0, 0], relative_row(net, c + 1, 0, h) - first * d[1, 0]
        )
        if not off <= net.x[TOL] * net.x[FASTEST]:
            net.since[c + 1] = -1.0
            lost = True
    return lost
