"""Steps in which nothing accelerates: forces are linear in s, and the first break-away is known."""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import SLIP
from fricmb.integrate.taylor.network import Net
from fricmb.integrate.taylor.polynomials import hold_force

#: Part of the time a force in two directions is held after which its end is looked for.
NEARLY = 0.99


@kernel
def planar_hold(net: Net, c: int) -> float:
    """How long contact c in two directions holds a force that is linear in s, a little less (s)."""
    if net.groups.planar[c] < 0:
        return math.inf
    if net.mode[c] == SLIP:
        return 0.0
    x, y = hold_force(net, c, 0.0), hold_force(net, c + 1, 0.0)
    dx, dy = hold_force(net, c, 1.0) - x, hold_force(net, c + 1, 1.0) - y
    a, b = dx * dx + dy * dy, x * dx + y * dy
    left = net.stick[c] * net.stick[c] - x * x - y * y
    if a == 0.0:
        return math.inf
    return float(NEARLY * max(0.0, (math.sqrt(max(b * b + a * left, 0.0)) - b) / a))


@kernel
def idle_step(net: Net, left: float) -> float:
    """Where nothing accelerates: how long until the first contact breaks away, at most ``left``."""
    h = net.step
    found = left
    for c in range(net.mode.shape[0]):
        if net.groups.planar[c] != -1:
            found = min(found, h * planar_hold(net, c))
            continue
        force = hold_force(net, c, 0.0)
        rate = (hold_force(net, c, 1.0) - force) / h
        if rate != 0.0:
            found = min(found, max(0.0, (math.copysign(net.stick[c], rate) - force) / rate))
    return float(found)
