r"""How a contact in two directions comes to rest: the last bit of its way at once, in closed form.

Close to its end slip turns into the direction of the force that drives it, ever faster: a series holds over a part of
what is left alone.  There relative acceleration a without friction and D mu N = b are as good as constant,

.. math:: \dot u = a - b\, u/|u|,

and with r = |u| the rates of :math:`b r + a \cdot u`, of :math:`r^2`, :math:`r u`, and of :math:`r^2` times powers
of the direction are linear in one another: rest comes after

.. math:: T = \frac{b r + a \cdot u}{b^2 - |a|^2},

and on the way there the contact slides, along a and across it (c = cosine of the angle between u and a),

.. math:: \frac{r^2 (2 b c + |a| (1 + c^2))}{4 (b^2 - |a|^2)}, \qquad \frac{r (2 b + |a| c)}{4 b^2 - |a|^2}\, u_\perp.

A step of T leads there along the parabola of velocity that slides as far; for times between see ``landing_path``.
"""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.event_kinds import EVENT_SLIP, EVENT_STICK
from fricmb.integrate.problem import SLIP, STICK
from fricmb.integrate.taylor.friction_curve import friction_at
from fricmb.integrate.taylor.landing_path import ways_to_rest
from fricmb.integrate.taylor.layout import AT_END, BEGUN, BENDS, EPS, LASTS, PULL, SLOWS
from fricmb.integrate.taylor.network import Net
from fricmb.integrate.taylor.plane_series import is_still, lands
from fricmb.integrate.taylor.polynomials import hold_force, relative_row
from fricmb.integrate.taylor.turning import keep_event

#: A landing takes so short, and begins at so small a slip speed, in roots of the tolerance.
SHORT, SLOW = 0.3, 0.1
#: Relative change of friction down to rest over which its mean is good enough.
EVEN = 0.01
#: What loads that change on the way may change of its length, in tolerances of the largest speed.
UNEVEN = 10.0
#: A force so close to its limit may have left it, if it grows by more than that part of it in a step.
AT_LIMIT, GROWS = 1e-9, 1e-9


@kernel
def set_planar(net: Net, c: int, mode: int) -> None:
    """Mode of contact c in two directions."""
    net.mode[c] = net.mode[c + 1] = mode
    net.since[c + 1] = -1.0
    net.groups.landing[net.groups.planar[c], LASTS] = 0.0


@kernel
def let_go(net: Net, c: int, x: float, y: float) -> None:
    """Contact c in two directions slips against the force (x, y) that has held it."""
    size = math.hypot(x, y)
    set_planar(net, c, SLIP)
    net.since[c] = AT_END
    net.sigma[c], net.sigma[c + 1] = -x / size, -y / size


@kernel
def slow_friction(net: Net, c: int, speed: float) -> float:
    """Mean friction down to rest; -1 where it changes too much for that."""
    last = friction_at(net, c, 0.0)
    if abs(friction_at(net, c, speed) - last) > EVEN * last:
        return -1.0
    return friction_at(net, c, 0.5 * speed)


@kernel
def plan_landing(net: Net, c: int, x: float, y: float, ax: float, ay: float) -> float:
    """The way to rest from slip velocity (x, y) under (ax, ay), into ``landing``; how long it takes, inf: too long."""
    speed, pull = math.hypot(x, y), math.hypot(ax, ay)
    slows = net.compliance[c] * slow_friction(net, c, speed)
    if slows <= pull:
        return math.inf
    along = (x * ax + y * ay) / pull if pull > 0.0 else 0.0
    time = (slows * speed + pull * along) / (slows * slows - pull * pull)
    if time > SHORT * math.sqrt(net.tol) * net.longest:
        return math.inf
    far = ways_to_rest(speed, along / speed, pull, slows, True)
    across = ways_to_rest(speed, along / speed, pull, slows, False)
    plan = net.groups.landing[net.groups.planar[c]]
    plan[LASTS], plan[BEGUN], plan[BEGUN + 1] = time, x, y
    plan[PULL], plan[PULL + 1], plan[SLOWS] = ax, ay, slows
    for i in range(2):
        u, e = (x, ax) if i == 0 else (y, ay)
        e = e / pull if pull > 0.0 else 0.0
        way = far * e + across * (u - along * e)
        plan[BENDS + i] = 6.0 * (way / time - 0.5 * u)
    return float(time)


@kernel
def pushed_slope(net: Net, row: int, k: int, h: float) -> float:
    """Coefficient k of the relative acceleration of a row without its own friction."""
    return float((k + 1) * relative_row(net, row, k + 1, h) / h - net.compliance[row] * net.groups.F[k, row])


@kernel
def is_even(net: Net, c: int, h: float) -> bool:
    """Whether relative acceleration without friction is as good as constant on the way to rest that is planned."""
    plan = net.groups.landing[net.groups.planar[c]]
    time, slows = plan[LASTS], plan[SLOWS]
    part = time / h
    changes = part * math.hypot(pushed_slope(net, c, 1, h), pushed_slope(net, c + 1, 1, h))
    changes += part * part * math.hypot(pushed_slope(net, c, 2, h), pushed_slope(net, c + 1, 2, h))
    longer = time * changes * slows * slows / (slows * slows - plan[PULL] ** 2 - plan[PULL + 1] ** 2)
    return bool(longer <= UNEVEN * net.tol * net.reached)


@kernel
def land(net: Net, c: int, h: float) -> float:
    """Whether contact c comes to rest: how long that takes, 0 where it is at rest and sticks from now on, else inf."""
    if net.since[c] == AT_END:
        # it has just broken away, at a force that was known to the tolerance
        return math.inf
    x, y = relative_row(net, c, 0, h), relative_row(net, c + 1, 0, h)
    speed = math.hypot(x, y)
    if speed > SLOW * math.sqrt(net.tol) * net.reached:
        return math.inf
    ax, ay = pushed_slope(net, c, 0, h), pushed_slope(net, c + 1, 0, h)
    holds = net.stick[c] * net.compliance[c]
    grows = ax * pushed_slope(net, c, 1, h) + ay * pushed_slope(net, c + 1, 1, h) > GROWS * holds * holds
    if math.hypot(ax, ay) > holds * (1.0 - AT_LIMIT if grows else 1.0):
        return math.inf
    time = 0.0 if is_still(net, speed) else plan_landing(net, c, x, y, ax, ay)
    if 0.0 < time < math.inf and not is_even(net, c, h):
        net.groups.landing[net.groups.planar[c], LASTS] = 0.0
        return math.inf
    if time > 4.0 * EPS * abs(net.time):
        return time
    set_planar(net, c, STICK)
    keep_event(net, net.time, c, EVENT_STICK)
    return 0.0


@kernel
def land_all(net: Net, h: float) -> float:
    """Contacts that come to rest: how long a step may be for that; inf where there are none, and all is as it was."""
    found = math.inf
    for c in range(net.mode.shape[0]):
        if net.groups.planar[c] >= 0 and net.mode[c] == SLIP:
            time = land(net, c, h)
            if time < math.inf:
                found = min(found, time if time > 0.0 else h)
    return float(found)


@kernel
def take_off(net: Net) -> None:
    """No contact comes to rest for now."""
    for at in range(net.groups.landing.shape[0]):
        net.groups.landing[at, LASTS] = 0.0


@kernel
def turn_planar(net: Net, c: int, tau: float) -> int:
    """Give contact c in two directions its new mode; the kind of transition, -1 where slip is to be looked at again."""
    if net.mode[c] == STICK:
        let_go(net, c, hold_force(net, c, tau), hold_force(net, c + 1, tau))
        return int(EVENT_SLIP)
    net.since[c] = -1.0
    if lands(net, c):
        set_planar(net, c, STICK)
        return int(EVENT_STICK)
    return -1
