"""A contact changes its mode inside a step: the event itself, and who has to be looked at again."""

from __future__ import annotations

import math

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import EVENT_REVERSAL, EVENT_SLIP, EVENT_STICK, SLIP, STICK, Ints
from fricmb.integrate.taylor._correct import add_correction, correct, local_force
from fricmb.integrate.taylor._heap import push_due
from fricmb.integrate.taylor._layout import BEFORE, INPUT, JUMP, N_EVENTS, SHIFTED, STEP, TIME, WATCH
from fricmb.integrate.taylor._ledger import count_local, moving_belts
from fricmb.integrate.taylor._net import Net
from fricmb.integrate.taylor._search import shift_one, taylor_search
from fricmb.integrate.taylor._series import belt_at, displacement

#: Relative excess over the cone that still counts as on it.
MARGIN = 1e-11


@kernel
def source(net: Net, c: int, tau: float, h: float, direction: float, stick: bool) -> None:
    """Change of the force of contact c at tau, in powers of s - tau, into old[SHIFTED]; its mode is still the old one.

    In stick without the response of the structure, which the correction adds.
    """
    y = net.old[BEFORE]
    out = net.old[SHIFTED]
    last = net.R.shape[0] - 1
    # the force that would hold the contact
    for k in range(last + 1):
        value = 0.0
        for e in range(net.row_start[c], net.row_start[c + 1]):
            value += net.row_coef[e] * net.R[k, net.row_dof[e]]
        if net.wu_start[c] < net.wu_start[c + 1]:
            value -= (k + 1) * belt_at(net, c, k + 1) / h
        y[k] = -value / net.compliance[c]
    shift_one(y, last, tau)
    for k in range(last + 1):
        now = y[k] if net.mode[c] == STICK else 0.0
        then = y[k] if stick else 0.0
        if k == 0 and net.mode[c] == SLIP:
            now = -net.slip[c] * net.sigma[c]
        if k == 0 and not stick:
            then = -net.slip[c] * direction
        out[k] = then - now


@kernel
def weigh_local(net: Net, count: int, changed: int, tau: float, h: float) -> None:
    """What the correction takes from the slack of the contacts it touches, and adds to the work of the belts."""
    P = net.Q.shape[0] - 1
    powers, weights = net.old[WATCH], net.old[BEFORE]
    power = 1.0
    for k in range(P):
        powers[k] = power
        power *= 1.0 - tau
        weights[k] = power / (k + 1)
    for a in range(count):
        c = net.owner[net.local[a]]
        if c < 0 or net.row_dof[net.row_start[c]] != net.local[a]:
            continue
        stuck = net.mode[c] == STICK
        total = 0.0
        if stuck or c == changed:
            work = 0.0
            for k in range(P - 1):
                force = local_force(net, c, k, changed)
                work += force * weights[k]
                total += abs(force) * powers[k]
            if net.plain[c] == 1:
                net.x[INPUT] += net.belt[c] * h * work
        elif net.slack[c] >= 0.0:
            for k in range(P):
                value = 0.0
                for e in range(net.row_start[c], net.row_start[c + 1]):
                    place = net.place[net.row_dof[e]]
                    if place >= 0:
                        value += net.row_coef[e] * net.dQ[k + 1, place]
                total += abs(value) * (k + 1) / h * powers[k]
        net.slack[c] -= total


@kernel
def keep_event(net: Net, t: float, c: int, kind: int) -> None:
    """Add a transition to the list."""
    at = net.i[N_EVENTS]
    net.i[N_EVENTS] = at + 1
    net.events[at, 0] = t
    net.events[at, 1] = c
    net.events[at, 2] = kind


@kernel
def set_mode(net: Net, c: int, mode: int, direction: float) -> None:
    """Mode and direction of contact c."""
    net.mode[c] = mode
    net.sigma[c] = direction
    if net.plain[c] == 1:
        net.free[net.row_dof[net.row_start[c]]] = 1.0 if mode == SLIP else 0.0


@kernel
def hold_force(net: Net, c: int, s: float, h: float) -> float:
    """The force that would hold contact c at s; of coupled contacts its force."""
    value = 0.0
    if net.coupled.F.shape[0] > 0:
        for k in range(net.coupled.F.shape[0] - 1, -1, -1):
            value = value * s + net.coupled.F[k, c]
        return float(value)
    for e in range(net.row_start[c], net.row_start[c + 1]):
        j = net.row_dof[e]
        part = 0.0
        for k in range(net.R.shape[0] - 1, -1, -1):
            part = part * s + net.R[k, j]
        value += net.row_coef[e] * part
    if net.wu_start[c] < net.wu_start[c + 1]:
        rate = 0.0
        for k in range(net.R.shape[0] - 1, -1, -1):
            rate = rate * s + (k + 1) * belt_at(net, c, k + 1) / h
        value -= rate
    return float(-value / net.compliance[c])


@block
def taylor_change(net: Net, c: int, tau: float, places: Ints) -> int:
    """Contact c changes its mode at tau; returns 0, or 1 where the correction would touch too many dofs."""
    h = net.x[STEP]
    held = hold_force(net, c, tau, h)
    was = net.mode[c]
    direction = -math.copysign(1.0, held)
    stick = was == SLIP and abs(held) <= net.stick[c] * (1.0 + MARGIN)
    if was == SLIP:
        here = displacement(net, c, tau, h)
        net.loss[c] += net.slip[c] * abs(here - net.mark[c])
        net.mark[c] = here
    else:
        net.mark[c] = displacement(net, c, tau, h)
    net.since[c] = tau if not stick else -1.0
    if was == SLIP and not stick and direction == net.sigma[c]:
        # it only touched 0 and slips on
        push_due(net, c, taylor_search(net, c, tau, places))
        return 0
    source(net, c, tau, h, direction, stick)
    moving = moving_belts(net, tau)
    set_mode(net, c, STICK if stick else SLIP, direction)
    count = correct(net, c, h)
    full = count >= net.local.shape[0] and count < net.q.shape[0]
    weigh_local(net, count, c, tau, h)
    last = net.Q.shape[0] - 1
    reach = (1.0 - tau) ** (last - 1)
    for a in range(count):
        net.x[JUMP] = max(net.x[JUMP], last * abs(net.dQ[last, a]) * reach / h)
    count_local(net, count, tau, -1.0)
    add_correction(net, count, tau)
    count_local(net, count, tau, 1.0)
    net.x[INPUT] += moving_belts(net, tau) - moving
    kind = EVENT_STICK if stick else (EVENT_SLIP if was == STICK else EVENT_REVERSAL)
    keep_event(net, net.x[TIME] + tau * h, c, kind)
    push_due(net, c, taylor_search(net, c, tau, places))
    for a in range(count):
        other = net.owner[net.local[a]]
        if other >= 0 and other != c and net.row_dof[net.row_start[other]] == net.local[a] and net.slack[other] < 0.0:
            push_due(net, other, taylor_search(net, other, tau, places))
    for a in range(count):
        net.place[net.local[a]] = -1
    return 1 if full else 0
