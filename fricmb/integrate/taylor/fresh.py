"""Slip in two directions that has begun a short time ago: passes of series, and how long they are good for."""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import SLIP
from fricmb.integrate.taylor.layout import FRESH
from fricmb.integrate.taylor.network import Net, has_planes
from fricmb.integrate.taylor.polynomials import relative_row
from fricmb.integrate.taylor.series import taylor_series

#: Passes: each makes what is left over smaller by slip speed over what friction brings in the time scale of loads.
PASSES = 4
#: Part of the tolerance that a pass may change for the next one to be left out.
ENOUGH = 0.1


@kernel
def forget_directions(net: Net) -> None:
    """Nothing is known yet in a step of the directions of slip that began a short time ago."""
    for c in range(net.mode.shape[0]):
        at = net.groups.planar[c]
        if at >= 0 and net.mode[c] == SLIP and net.since[c + 1] == FRESH:
            net.groups.unit[at, :, :] = 0.0


@kernel
def is_fresh(net: Net, c: int) -> bool:
    """Whether the series just made took slip of contact c for one that began a short time ago."""
    at = net.groups.planar[c]
    return bool(at >= 0 and net.mode[c] == SLIP and net.groups.begins[at] == 2)


@kernel
def slip_off(net: Net, c: int, part: float) -> float:
    """How far slip of contact c, which began a short time ago, may be off over a part of what was asked for.

    By what the last pass has changed, and by what its direction is not the one that slip has had.
    """
    at, h = net.groups.planar[c], net.made
    turned, d, first = net.groups.turned[at], net.groups.unit[at], net.groups.first_speed[at]
    off, power = 0.0, part * h * net.compliance[c] * abs(net.groups.rubbing[at, 0])
    for k in range(net.groups.F.shape[0]):
        off += turned[k] * power
        power *= part
    x, y = relative_row(net, c, 0, net.step), relative_row(net, c + 1, 0, net.step)
    return float(off + math.hypot(x - first * d[0, 0], y - first * d[1, 0]))


@kernel
def largest_off(net: Net) -> float:
    """The largest of these; -1 where there are none."""
    worst = -1.0
    for c in range(net.mode.shape[0]):
        if is_fresh(net, c):
            worst = max(worst, slip_off(net, c, 1.0))
    return float(worst)


@kernel
def all_series(net: Net, h: float) -> bool:
    """Polynomials for a step h, by as many passes as they take; whether anything accelerates."""
    net.made = h
    if not has_planes(net):
        return taylor_series(net, h)
    forget_directions(net)
    busy = taylor_series(net, h)
    for _ in range(PASSES - 1 if largest_off(net) >= 0.0 else 0):
        busy = taylor_series(net, h)
        if largest_off(net) <= ENOUGH * net.tol * net.fastest:
            break
    return busy


@kernel
def lose_fresh(net: Net) -> bool:
    """Contacts whose slip the last pass of the step has changed too much slip as others do; whether there are any."""
    lost = False
    part = net.step / net.made
    for c in range(net.mode.shape[0] if has_planes(net) else 0):
        if is_fresh(net, c) and not slip_off(net, c, part) <= net.tol * net.fastest:
            net.since[c + 1] = -1.0
            lost = True
    return lost
