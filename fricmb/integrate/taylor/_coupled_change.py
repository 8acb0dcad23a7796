"""A contact changes its mode inside a step, where contacts are coupled or friction depends on slip speed."""

from __future__ import annotations

import math

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import EVENT_REVERSAL, EVENT_SLIP, EVENT_STICK, SLIP, STICK, Ints
from fricmb.integrate.taylor._account import force_at, pay, pay_touched
from fricmb.integrate.taylor._change import MARGIN, keep_event
from fricmb.integrate.taylor._correct import shift_rows
from fricmb.integrate.taylor._coupled_correct import coupled_correct, forget
from fricmb.integrate.taylor._coupled_series import relative_row
from fricmb.integrate.taylor._curve import coefficient_at, fit_around, range_of, within
from fricmb.integrate.taylor._groups import factor_group, solve_group, stuck_contact
from fricmb.integrate.taylor._heap import push_due
from fricmb.integrate.taylor._layout import FASTEST, N_EVENTS, N_TOUCHED, STEP, TIME, TOL, UNTIL, WORK
from fricmb.integrate.taylor._net import Net
from fricmb.integrate.taylor._search import taylor_search
from fricmb.integrate.taylor._series import belt_at, polynomial

#: How often a correction is made again on a wider range of slip speeds.
TRIES = 4
#: Part of the rest of a step for which a correction has to be good.
BRIEF = 1e-3


@kernel
def holding_force(net: Net, c: int, tau: float, h: float) -> float:
    """The force that would hold contact c at tau, the others of its group staying what they are."""
    gi = net.coupled.group[c]
    was = net.mode[c]
    net.mode[c] = STICK
    factor_group(net, gi)
    co = net.coupled
    total = net.flat[WORK]
    for a in range(co.dof_start[gi], co.dof_start[gi + 1]):
        total[co.group_dof[a]] = polynomial(net, 1, co.group_dof[a], tau)
    for a in range(co.group_start[gi], co.group_start[gi + 1]):
        other = co.group_contact[a]
        if net.mode[other] == SLIP:
            force = force_at(net, other, tau)
            for e in range(net.row_start[other], net.row_start[other + 1]):
                total[net.row_dof[e]] += net.push[e] * force
    first, place = co.group_start[gi], 0
    for i in range(co.n_stuck[gi]):
        other = stuck_contact(net, gi, i)
        if other == c:
            place = first + i
        value = 0.0
        if net.wu_start[other] < net.wu_start[other + 1]:
            for k in range(co.F.shape[0] - 1, -1, -1):
                value = value * tau + (k + 1) * belt_at(net, other, k + 1) / h
        for e in range(net.row_start[other], net.row_start[other + 1]):
            value -= net.row_coef[e] * total[net.row_dof[e]]
        co.rhs[first + i] = value
    solve_group(net, gi)
    net.mode[c] = was
    return float(co.rhs[place])


@kernel
def first_curve(net: Net, c: int, held: float, tau: float, h: float) -> None:
    """A curve for a contact that begins to slip, over the speeds that it may reach in the rest of the step."""
    at = net.coupled.lawful[c]
    if at < 0 or net.mode[c] != SLIP:
        return
    rest = (1.0 - tau) * h
    jump = abs(abs(held) - net.coupled.N[c] * coefficient_at(net, c, 0.0))
    slope = 0.0
    for k in range(net.coupled.F.shape[0] - 1, 0, -1):
        slope = slope * tau + k * net.coupled.F[k, c]
    reach = net.compliance[c] * rest * (jump + abs(slope) * (1.0 - tau)) + abs(relative_row(net, c, 1, h)) * (1.0 - tau)
    fit_around(net, c, 0.0, 0.0, 1.5 * reach + 0.01 * net.x[FASTEST])


@kernel
def widen(net: Net, tau: float) -> bool:
    """Fit anew what left the range of its curve behind tau; returns whether anything did."""
    co = net.coupled
    again = False
    last = co.F.shape[0] - 1
    for slot in range(net.i[N_TOUCHED]):
        c = co.here[slot]
        at = co.lawful[c]
        if at < 0 or net.mode[c] != SLIP:
            continue
        b = co.local_b[slot]
        x = b[b.shape[0] - 1]
        if within(net, at, x, last, 1.0 - tau) < 1.0:
            middle, half = co.middle[at], co.half[at]
            above = min(8.0, 1.2 * range_of(x, last, 1.0 - tau, True) - x[0])
            below = min(8.0, x[0] - 1.2 * range_of(x, last, 1.0 - tau, False))
            fit_around(net, c, middle + x[0] * half, max(0.1, below) * half, max(0.1, above) * half)
            again = again or co.half[at] > 1.05 * half
    return again


@kernel
def cut_step(net: Net, count: int, tau: float, h: float) -> None:
    """End the step where the correction is no longer good: by its last coefficients and by the curves' ranges."""
    co = net.coupled
    last = net.Q.shape[0] - 1
    reach = (1.0 - tau) ** (last - 1)
    error = 0.0
    for a in range(count):
        tail = last * abs(net.dQ[last, a]) + (last - 1) * abs(net.dQ[last - 1, a])
        error = max(error, tail * reach / (h * (net.top[net.local[a]] + 0.01 * net.x[FASTEST])))
    error /= net.x[TOL]
    part = 1.0 if error <= 1.0 else 0.9 * error ** (-1.0 / (last - 1.0))
    for slot in range(net.i[N_TOUCHED]):
        c = co.here[slot]
        at = co.lawful[c]
        if at < 0 or net.mode[c] != SLIP:
            continue
        b = co.local_b[slot]
        part = min(part, within(net, at, b[b.shape[0] - 1], co.F.shape[0] - 1, 1.0 - tau))
        if co.rough[at] > 1.0:
            part = min(part, 0.7 * co.rough[at] ** (-1.0 / (co.nodes.shape[0] - 1.0)))
    net.x[UNTIL] = min(net.x[UNTIL], tau + (1.0 - tau) * part)


@kernel
def add_coupled(net: Net, count: int, tau: float) -> None:
    """Shift the correction to powers of s and add it."""
    co = net.coupled
    P = net.Q.shape[0] - 1
    touched = net.i[N_TOUCHED]
    shift_rows(net.dQ, P, count, -tau)
    shift_rows(net.dR, P - 2, count, -tau)
    shift_rows(co.dF, P - 2, touched, -tau)
    for k in range(P + 1):
        target, row = net.Q[k], net.dQ[k]
        for a in range(count):
            target[net.local[a]] += row[a]
    for k in range(P - 1):
        target, row = net.R[k], net.dR[k]
        for a in range(count):
            target[net.local[a]] += row[a]
        target, row = co.F[k], co.dF[k]
        for slot in range(touched):
            target[co.here[slot]] += row[slot]


@kernel
def turn(net: Net, c: int, tau: float, h: float) -> int:
    """Give contact c its new mode; returns the kind of transition, -1 where it slips on."""
    was = net.mode[c]
    held = force_at(net, c, tau) if was == STICK else holding_force(net, c, tau, h)
    direction = -math.copysign(1.0, held)
    kind = EVENT_SLIP
    if was == SLIP:
        if abs(held) <= net.stick[c] * (1.0 + MARGIN):
            net.mode[c] = STICK
            kind = EVENT_STICK
        elif direction == net.sigma[c]:
            kind = -1
        else:
            kind = EVENT_REVERSAL
    else:
        net.mode[c] = SLIP
    if kind != EVENT_STICK:
        net.since[c] = tau
    else:
        net.since[c] = -1.0
    if kind >= 0:
        net.sigma[c] = direction
        first_curve(net, c, held, tau, h)
    factor_group(net, net.coupled.group[c])
    return int(kind)


@kernel
def keep_net_event(net: Net, t: float, c: int, kind: int) -> None:
    """Add a transition to the list; of several of one contact at one instant, that ends in stick, what they come to."""
    if kind == EVENT_STICK:
        at = net.i[N_EVENTS] - 1
        while at >= 0 and net.events[at, 0] == t:
            if net.events[at, 1] == c and net.events[at, 2] == EVENT_REVERSAL:
                net.events[at, 2] = EVENT_STICK
                return
            if net.events[at, 1] == c and net.events[at, 2] == EVENT_SLIP:
                net.i[N_EVENTS] -= 1
                for later in range(at, net.i[N_EVENTS]):
                    for part in range(3):
                        net.events[later, part] = net.events[later + 1, part]
                return
            at -= 1
    keep_event(net, t, c, kind)


@kernel
def ask_again(net: Net, c: int, tau: float, t: float) -> None:
    """Of those that have just turned round: now that contact c has let go they may be able to stick."""
    at = net.i[N_EVENTS] - 1
    while at >= 0 and net.events[at, 0] == t:
        other = int(net.events[at, 1])
        turned = net.events[at, 2] == EVENT_REVERSAL and net.mode[other] == SLIP
        if turned and net.coupled.group[other] == net.coupled.group[c]:
            push_due(net, other, tau)
        at -= 1


@block
def coupled_change(net: Net, c: int, tau: float, places: Ints) -> int:
    """Contact c changes its mode at tau; returns 0, or 1 where the correction would touch too many dofs."""
    h = net.x[STEP]
    pay(net, c, tau)
    kind = turn(net, c, tau, h)
    if kind < 0:
        push_due(net, c, taylor_search(net, c, tau, places))
        return 0
    count = coupled_correct(net, c, tau, h)
    for _ in range(TRIES):
        if count >= net.local.shape[0] or not widen(net, tau):
            break
        forget(net, count)
        count = coupled_correct(net, c, tau, h)
    if count >= net.local.shape[0]:
        forget(net, count)
        return 1
    cut_step(net, count, tau, h)
    co = net.coupled
    pay_touched(net, count, tau)
    keep_net_event(net, net.x[TIME] + tau * h, c, kind)
    if net.x[UNTIL] - tau < BRIEF * (1.0 - tau) and tau > BRIEF:
        # a correction that is good for next to nothing is the round-off of its coefficients: the step ends here
        net.x[UNTIL] = tau
        net.due[c] = math.inf
        forget(net, count)
        return 0
    add_coupled(net, count, tau)
    for slot in range(net.i[N_TOUCHED]):
        push_due(net, co.here[slot], taylor_search(net, co.here[slot], tau, places))
    forget(net, count)
    if kind == EVENT_SLIP:
        ask_again(net, c, tau, net.x[TIME] + tau * h)
    return 0
