"""Contacts in two directions: powers of s of the direction of slip, of slip speed, and of friction along it.

With u the slip velocity, r = |u| and d = u/r, the sums

    u_k = sum_i r_i d_(k-i),    sum_i d_i . d_(k-i) = 0 for k > 0

give r_k and d_k from u_k and the orders before.  Where slip begins with the step, u = s p, and p takes the place of u:
its coefficient k contains friction of order k, ``p_k = h/(k+1) (a_k - D sum_i (mu N)_i d_(k-i))`` with a the relative
acceleration without friction, which stays linear in d_k.  That holds where mu_s = mu_k as well, and p_0 = 0.

A short time behind that, u_0 = r_0 d_0 is small, and powers of u hold over about r_0/(D mu N) alone, since d is driven
back so fast to where it has to be.  There r = r_0 + s |p| and p_k takes in ``r_0 d_(k+1)``, from a pass before.
"""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import SLIP, Floats, Floats2
from fricmb.integrate.taylor.friction_curve import friction_row
from fricmb.integrate.taylor.layout import AT_END, BEGUN, BENDS, FRESH, LASTS
from fricmb.integrate.taylor.network import Net
from fricmb.integrate.taylor.polynomials import push_row, relative_row, shift_slip, slip_speed
from fricmb.integrate.taylor.signals import belt_rate

#: Slip speeds below that, relative to the largest speed, are the round-off of none.
STILL = 1e-12
#: Slip speeds that take few steps to follow, as a part of what friction would bring in the step.
FEW = 0.1


@kernel
def is_still(net: Net, speed: float) -> bool:
    """Whether a slip speed is round-off."""
    return bool(speed <= 10.0 * net.noise + STILL * net.reached)


@kernel
def next_direction(r: Floats, d: Floats2, k: int, x: float, y: float, rubs: float) -> None:
    """Coefficient k > 0 of r and d, whose product is (x, y) less ``rubs`` times d_k."""
    ahead, aside, inner = d[0, 0], d[1, 0], 0.0
    for i in range(1, k):
        inner -= 0.5 * (d[0, i] * d[0, k - i] + d[1, i] * d[1, k - i])
        x -= r[i] * d[0, k - i]
        y -= r[i] * d[1, k - i]
    turns = r[0] + rubs
    across = (y * ahead - x * aside) / turns if turns > 0.0 else 0.0
    r[k] = x * ahead + y * aside - turns * inner
    d[0, k] = inner * ahead - across * aside
    d[1, k] = inner * aside + across * ahead


@kernel
def pushed_row(net: Net, row: int, k: int, h: float, factor: float) -> float:
    """Coefficient k of the relative acceleration of a row by all forces but its own, which Q[k+2] is still without."""
    value = -belt_rate(net, row, k, h)
    for e in range(net.row_start[row], net.row_start[row + 1]):
        value += net.row_coef[e] * net.Q[k + 2, net.row_dof[e]] / factor
    return float(value)


@kernel
def first_direction(net: Net, c: int, x: float, y: float, rubs: float) -> None:
    """Order 0 of r and d, whose product is (x, y) less ``rubs`` times d."""
    at = net.groups.planar[c]
    size = math.hypot(x, y)
    if size > 0.0:
        net.sigma[c], net.sigma[c + 1] = x / size, y / size
    net.groups.speed[at, 0] = max(size - rubs, 0.0)
    net.groups.unit[at, 0, 0], net.groups.unit[at, 1, 0] = net.sigma[c], net.sigma[c + 1]


@kernel
def set_begin(net: Net, c: int, h: float) -> None:
    """Whether slip of contact c begins with the step (1), or began a short time ago (2)."""
    groups, at = net.groups, net.groups.planar[c]
    speed = math.hypot(relative_row(net, c, 0, h), relative_row(net, c + 1, 0, h))
    groups.begins[at], groups.first_speed[at] = 0, 0.0
    if net.since[c] == AT_END or is_still(net, speed):
        groups.begins[at] = 1
        net.since[c + 1] = FRESH
    elif net.since[c + 1] == FRESH and speed <= FEW * h * net.compliance[c] * net.slip[c]:
        groups.begins[at], groups.first_speed[at] = 2, speed


@kernel
def slip_row(net: Net, c: int, k: int, h: float, factor: float) -> None:
    """Coefficient k of direction, slip speed and friction of contact c, which slips, and of its force."""
    groups, at = net.groups, net.groups.planar[c]
    d, r, rubbing = groups.unit[at], groups.speed[at], groups.rubbing[at]
    if k == 0:
        set_begin(net, c, h)
    begins, first = groups.begins[at] > 0, groups.first_speed[at]
    before_x, before_y = d[0, k], d[1, k]
    if begins:
        rubbing[k] = friction_row(net, c, k, r[k - 1] if k > 0 else first, h)
        x, y = pushed_row(net, c, k, h, factor), pushed_row(net, c + 1, k, h, factor)
        for i in range(1, k + 1):
            x -= net.compliance[c] * rubbing[i] * d[0, k - i]
            y -= net.compliance[c] * rubbing[i] * d[1, k - i]
        by = h / (k + 1)
        x, y, rubs = by * x - first * d[0, k + 1], by * y - first * d[1, k + 1], by * net.compliance[c] * rubbing[0]
    else:
        x, y, rubs = relative_row(net, c, k, h), relative_row(net, c + 1, k, h), 0.0
    if k == 0:
        first_direction(net, c, x, y, rubs)
    else:
        next_direction(r, d, k, x, y, rubs)
    if begins:
        groups.turned[at, k] = math.hypot(d[0, k] - before_x, d[1, k] - before_y)
    else:
        rubbing[k] = friction_row(net, c, k, r[k], h)
    x, y = 0.0, 0.0
    for i in range(k + 1):
        x -= rubbing[i] * d[0, k - i]
        y -= rubbing[i] * d[1, k - i]
    groups.F[k, c], groups.F[k, c + 1] = x, y


@kernel
def landing_row(net: Net, c: int, k: int, h: float, factor: float) -> None:
    """Coefficient k of the force that brings contact c to rest along its landing (see ``landing``)."""
    plan = net.groups.landing[net.groups.planar[c]]
    time = plan[LASTS]
    for i in range(2):
        wanted = 0.0
        if k == 0:
            wanted = (plan[BENDS + i] - plan[BEGUN + i]) / time
        elif k == 1:
            wanted = -2.0 * plan[BENDS + i] * h / (time * time)
        net.groups.F[k, c + i] = (wanted - pushed_row(net, c + i, k, h, factor)) / net.compliance[c]


@kernel
def start_from_belts(net: Net) -> None:
    """Contacts that have just broken away move as their belts do, which powers of s have followed to the tolerance."""
    for c in range(net.mode.shape[0]):
        if net.groups.planar[c] >= 0 and net.mode[c] == SLIP and net.since[c] == AT_END:
            for row in range(c, c + 2):
                shift_slip(net, row, -slip_speed(net, row, net.v, 0.0), net.v)


@kernel
def lands(net: Net, c: int) -> bool:
    """Whether contact c has two directions, and comes to rest along its landing."""
    at = net.groups.planar[c]
    return bool(at >= 0 and net.groups.landing[at, LASTS] > 0.0)


@kernel
def push_planar(net: Net, c: int, k: int, h: float, factor: float) -> None:
    """Coefficient k of the force of contact c in two directions, which does not stick, into the displacements."""
    if lands(net, c):
        landing_row(net, c, k, h, factor)
    else:
        slip_row(net, c, k, h, factor)
    for row in range(c, c + 2):
        push_row(net, row, factor * net.groups.F[k, row], net.Q[k + 2])
