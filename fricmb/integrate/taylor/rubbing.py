"""What a run reports as friction of contacts in two directions: its powers of s, or what the velocities give."""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import SLIP
from fricmb.integrate.taylor.friction_curve import friction_at
from fricmb.integrate.taylor.network import Net
from fricmb.integrate.taylor.plane_series import lands

#: Part of friction that the last powers of s may bring, in tolerances; beyond that they are no friction any more.
HOLDS = 100.0
#: Slip speeds have no direction below that part of the largest speed.
SLOW = 1e-8


@kernel
def is_lost(net: Net, c: int) -> bool:
    """Whether the powers of s of contact c in two directions, which slips, do not tell its friction.

    Steps are as long as motion bears; friction that is weak beside all else may turn faster.
    """
    at = net.groups.planar[c]
    if at < 0 or net.mode[c] != SLIP or lands(net, c):
        return False
    F = net.groups.F
    size = 0.0
    for k in range(F.shape[0] - 2, F.shape[0]):
        size += math.hypot(F[k, c], F[k, c + 1])
    return bool(size > HOLDS * net.tol * abs(net.groups.rubbing[at, 0]))


@kernel
def rubbing_at(net: Net, c: int, x: float, y: float) -> float:
    """Friction of contact c at slip velocity (x, y), by that velocity; -1 where it has no direction."""
    speed = math.hypot(x, y)
    return friction_at(net, c, speed) / speed if speed > SLOW * net.reached else -1.0
