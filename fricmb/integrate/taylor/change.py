"""A contact changes its mode inside a step: the transition, its correction, and who has to be looked at again."""

from __future__ import annotations

import math

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.long_loops import long_loops
from fricmb.integrate.event_kinds import EVENT_SLIP
from fricmb.integrate.problem import SLIP, STICK
from fricmb.integrate.taylor.account import lose_sliding, pay, pay_touched
from fricmb.integrate.taylor.correction import add_correction, correct, plain_force_change, plain_source
from fricmb.integrate.taylor.event_heap import push_due
from fricmb.integrate.taylor.event_search import taylor_search
from fricmb.integrate.taylor.group_correction import relative_change
from fricmb.integrate.taylor.landing import turn_planar
from fricmb.integrate.taylor.layout import AT_END, BEFORE, EPS, WATCH
from fricmb.integrate.taylor.ledger import count_local, shorten_account
from fricmb.integrate.taylor.network import Net, has_planes
from fricmb.integrate.taylor.polynomials import polynomial
from fricmb.integrate.taylor.slip_range import correction_noise, good_until, widen
from fricmb.integrate.taylor.touched import forget
from fricmb.integrate.taylor.turning import ask_again, keep_event, keep_group_event, turn

#: How often a correction is made again on a wider range of slip speeds.
TRIES = 4
#: Part of the rest of a step for which a correction has to be good.
BRIEF = 1e-3


@kernel
def weigh_plain(net: Net, count: int, changed: int, tau: float, h: float) -> None:
    """What the correction takes from the slack of the plain contacts it touches, and adds to their belts' work."""
    P = net.Q.shape[0] - 1
    powers, weights = net.old[WATCH], net.old[BEFORE]
    power = 1.0
    for k in range(P):
        powers[k] = power
        power *= net.until - tau
        weights[k] = power / (k + 1)
    for a in range(count):
        c = net.owner[net.local[a]]
        if c < 0:
            continue
        total = 0.0
        if net.mode[c] == STICK or c == changed:
            work = 0.0
            for k in range(P - 1):
                force = plain_force_change(net, c, k, changed)
                work += force * weights[k]
                total += abs(force) * powers[k]
            net.supply += net.belt[c] * h * work
        elif net.slack[c] >= 0.0:
            for k in range(P):
                total += abs(net.dQ[k + 1, a]) * (k + 1) * powers[k]
            total *= abs(net.row_coef[net.row_start[c]]) / h
        net.slack[c] -= total


@kernel
def weigh_groups(net: Net, tau: float, h: float) -> None:
    """What the correction takes from the slack of the contacts of groups it touches."""
    rest = net.until - tau
    for slot in range(net.n_touched):
        c = net.groups.here[slot]
        total = 0.0
        power = 1.0
        for k in range(net.groups.F.shape[0]):
            change = net.groups.dF[k, slot] if net.mode[c] == STICK else relative_change(net, c, k, h)
            total += abs(change) * power
            power *= rest
        if net.mode[c] == SLIP:
            total += abs(relative_change(net, c, net.groups.F.shape[0], h)) * power
        net.slack[c] -= total


@kernel
def search_touched(net: Net, count: int, changed: int, tau: float) -> None:
    """When the modes of the changed contact and of those end that the correction may bring to their end."""
    push_due(net, changed, taylor_search(net, changed, tau))
    for a in range(count):
        other = net.owner[net.local[a]]
        if other >= 0 and other != changed and net.slack[other] < 0.0:
            push_due(net, other, taylor_search(net, other, tau))
    for slot in range(net.n_touched):
        other = net.groups.here[slot]
        if other != changed and net.slack[other] < 0.0:
            push_due(net, other, taylor_search(net, other, tau))


@kernel
def correct_in_range(net: Net, c: int, tau: float, h: float) -> int:
    """The correction, with friction curves that hold over the slip speeds it brings."""
    count = correct(net, c, tau, h)
    for _ in range(TRIES if net.n_touched > 0 else 0):
        if count >= net.local.shape[0] or not widen(net, tau):
            break
        forget(net, count)
        count = correct(net, c, tau, h)
    return int(count)


@kernel
def apply_correction(net: Net, count: int, c: int, tau: float, h: float) -> None:
    """Add the correction; account and slack follow."""
    weigh_plain(net, count, c, tau, h)
    weigh_groups(net, tau, h)
    count_local(net, count, tau, -1.0)
    add_correction(net, count, tau)
    count_local(net, count, tau, 1.0)


@kernel
def end_step(net: Net, c: int, until: float, was: int, before: float) -> None:
    """Let the step end at ``until``, unless it ends before; what was counted behind was so under the mode before."""
    if until < net.until:
        now, direction = net.mode[c], net.sigma[c]
        net.mode[c], net.sigma[c] = was, before
        shorten_account(net, until)
        net.mode[c], net.sigma[c] = now, direction


@kernel
def pay_slip(net: Net, c: int, tau: float) -> None:
    """Losses of contact c in one direction up to tau, before its mode changes."""
    if net.plain[c] == 1:
        lose_sliding(net, c, polynomial(net.Q, net.first_dof[c], tau), tau)
    else:
        pay(net, c, tau)


@kernel
def await_end(net: Net, c: int, kind: int) -> None:
    """Contact c, which has changed its mode by ``kind``, is looked at again in the next step."""
    net.due[c] = math.inf
    net.since[c] = AT_END if kind == EVENT_SLIP else -1.0


@kernel
def change_at_end(net: Net, c: int, tau: float) -> None:
    """Contact c changes its mode at tau in a scene with contacts in two directions: there the step ends.

    A correction of the direction of slip is as much work as a step.
    """
    h, was, before = net.step, net.mode[c], net.sigma[c]
    if net.groups.planar[c] >= 0:
        pay(net, c, tau)
        pay(net, c + 1, tau)
        kind = turn_planar(net, c, tau)
        net.due[c] = math.inf
    else:
        pay_slip(net, c, tau)
        kind = turn(net, c, tau, h)
        await_end(net, c, kind)
    if kind >= 0:
        keep_event(net, net.time + tau * h, c, kind)
        # what made steps short ends here; a step that is too long costs little, a short one at the beginning of slip
        # leaves so small a speed that the direction can turn at once, and many steps to follow that
        net.next_step = net.longest
    # a step of no length is none: it begins anew under the new modes
    at_once = tau * h <= 4.0 * EPS * abs(net.time)
    end_step(net, c, 0.0 if at_once else tau, was, before)


@block
@long_loops
def taylor_change(net: Net, c: int, tau: float) -> int:
    """Contact c changes its mode at tau; returns 0, or 1 where the correction would touch too many dofs."""
    if has_planes(net):
        change_at_end(net, c, tau)
        return 0
    h = net.step
    plain = net.plain[c] == 1
    was, before = net.mode[c], net.sigma[c]
    pay_slip(net, c, tau)
    kind = turn(net, c, tau, h)
    if kind < 0:
        # it only touched 0 and slips on
        push_due(net, c, taylor_search(net, c, tau))
        return 0
    if plain:
        plain_source(net, c, tau, was, before)
    count = correct_in_range(net, c, tau, h)
    if count >= net.local.shape[0]:
        forget(net, count)
        return 1
    t = net.time + tau * h
    if plain:
        keep_event(net, t, c, kind)
    else:
        keep_group_event(net, t, c, kind)
    pay_touched(net, tau)
    until = good_until(net, count, tau, h)
    # a correction that is good for next to nothing is the round-off of its coefficients: the step ends here
    brief = until - tau < BRIEF * (1.0 - tau) and tau > BRIEF
    if net.n_touched > 0 and correction_noise(net, count, tau, until, h) > 1.0:
        brief = True
    end_step(net, c, tau if brief else until, was, before)
    if brief:
        await_end(net, c, kind)
        forget(net, count)
        return 0
    apply_correction(net, count, c, tau, h)
    search_touched(net, count, c, tau)
    forget(net, count)
    if kind == EVENT_SLIP and not plain:
        ask_again(net, c, tau, t)
    return 0
