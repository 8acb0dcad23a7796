r"""Where a contact in two directions is on the way to rest that ``landing`` plans: for samples, and steps that end.

With the angle :math:`\varphi` between slip and relative acceleration a, :math:`\dot u = a - b\,u/|u|` gives

.. math:: r \sin\varphi \sim \tan(\varphi/2)^{b/|a|}, \qquad (b + |a| \cos\varphi)\, r = (b^2 - |a|^2)\, (T - t),

of which :math:`\varphi` is the root at any time.
"""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import SLIP, Floats
from fricmb.integrate.taylor.layout import AT, BEGUN, BENDS, LASTS, PULL, SLOWS, UNIT, WAY
from fricmb.integrate.taylor.network import Net, has_planes
from fricmb.integrate.taylor.plane_series import lands
from fricmb.integrate.taylor.polynomials import relative, shift_slip

#: Parts of an acceleration, and sines of angles, that are none; most steps towards a root, and the last of them.
STRAIGHT, MOST, CLOSE = 1e-12, 100, 1e-14


@kernel
def ways_to_rest(speed: float, cosine: float, pull: float, slows: float, along: bool) -> float:
    """How far slip goes along a, or across it (as a part of its velocity across) until it comes to rest."""
    if along:
        bent = 2.0 * slows * cosine + pull * (1.0 + cosine * cosine)
        return float(speed * speed * bent / (4.0 * (slows * slows - pull * pull)))
    return float(speed * (2.0 * slows + pull * cosine) / (4.0 * slows * slows - pull * pull))


@kernel
def half_tangent(first: float, left: float, pull: float, slows: float) -> float:
    """Tangent of half the angle that was ``first`` when all the time was left, of which a part ``left`` is now."""
    # powers of exp(y) = tangent/first; convex, so that Newton's steps from 0 on stay on one side of the root
    own, more = slows + pull, (slows - pull) * first * first
    y, wanted = 0.0, math.log(left)
    for _ in range(MOST):
        grown = more * math.exp(2.0 * y)
        value = (slows / pull - 1.0) * y + math.log((own + grown) / (own + more)) - wanted
        step = value / (slows / pull - 1.0 + 2.0 * grown / (own + grown))
        y -= step
        if abs(step) <= CLOSE * (1.0 + abs(y)):
            break
    return float(first * math.exp(y))


@kernel
def follow_landing(plan: Floats, t: float) -> None:
    """Slip velocity, way and direction a time t behind the beginning, into the plan."""
    speed, pull = math.hypot(plan[BEGUN], plan[BEGUN + 1]), math.hypot(plan[PULL], plan[PULL + 1])
    slows, left = plan[SLOWS], max(0.0, 1.0 - t / plan[LASTS])
    ux, uy = plan[BEGUN] / speed, plan[BEGUN + 1] / speed
    ex, ey = (plan[PULL] / pull, plan[PULL + 1] / pull) if pull > STRAIGHT * slows else (ux, uy)
    cosine = ux * ex + uy * ey
    # across a, to that side on which slip is
    sine = abs(ex * uy - ey * ux)
    side = math.copysign(1.0, ex * uy - ey * ux)
    now_c, now_s = cosine, sine
    if pull > STRAIGHT * slows and sine > STRAIGHT:
        first = sine / (1.0 + cosine) if cosine > 0.0 else (1.0 - cosine) / sine
        w = half_tangent(first, left, pull, slows) if left > 0.0 else 0.0
        now_c, now_s = (1.0 - w * w) / (1.0 + w * w), 2.0 * w / (1.0 + w * w)
    if pull <= STRAIGHT * slows:
        pull = 0.0
    now = left * speed * (slows + pull * cosine) / (slows + pull * now_c)
    far = ways_to_rest(speed, cosine, pull, slows, True) - ways_to_rest(now, now_c, pull, slows, True)
    aside = ways_to_rest(speed, cosine, pull, slows, False) * speed * sine
    aside -= ways_to_rest(now, now_c, pull, slows, False) * now * now_s
    for i in range(2):
        e, across = (ex, -side * ey) if i == 0 else (ey, side * ex)
        plan[UNIT + i] = now_c * e + now_s * across
        plan[AT + i] = now * plan[UNIT + i]
        plan[WAY + i] = far * e + aside * across


@kernel
def leave_landings(net: Net) -> None:
    """The state where a step ends before contacts have come to rest, to which their polynomials lead as a whole."""
    h = net.step
    for c in range(net.mode.shape[0] if has_planes(net) else 0):
        if net.mode[c] != SLIP or not lands(net, c):
            continue
        plan = net.groups.landing[net.groups.planar[c]]
        follow_landing(plan, h)
        part = h / plan[LASTS]
        for i in range(2):
            gone = plan[BEGUN + i] * (1.0 - 0.5 * part) + plan[BENDS + i] * part * (0.5 - part / 3.0)
            shift_slip(net, c + i, plan[WAY + i] - h * gone, net.q)
            shift_slip(net, c + i, plan[AT + i] - relative(net, c + i, 1.0, h), net.v)
