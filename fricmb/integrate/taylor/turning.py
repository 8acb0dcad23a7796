"""What a contact whose mode ends goes over to, and the transition that is reported.

One direction and one limit, ``net.stick``: the friction cone is a comparison (see ``model/friction_cone``).  Contacts
in two directions turn in ``landing``.
"""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.event_kinds import EVENT_REVERSAL, EVENT_SLIP, EVENT_STICK
from fricmb.integrate.problem import SLIP, STICK
from fricmb.integrate.taylor.event_heap import push_due
from fricmb.integrate.taylor.group_forces import factor_group, solve_group, stuck_contact
from fricmb.integrate.taylor.layout import WORK
from fricmb.integrate.taylor.network import Net
from fricmb.integrate.taylor.polynomials import hold_force, polynomial
from fricmb.integrate.taylor.signals import belt_rate
from fricmb.integrate.taylor.slip_range import first_curve

#: Relative excess over the cone that still counts as on it.
MARGIN = 1e-11


@kernel
def set_mode(net: Net, c: int, mode: int, direction: float) -> None:
    """Mode and direction of contact c."""
    net.mode[c] = mode
    net.sigma[c] = direction
    if net.plain[c] == 1:
        net.free[net.row_dof[net.row_start[c]]] = 1.0 if mode == SLIP else 0.0


@kernel
def holding_force(net: Net, c: int, tau: float, h: float) -> float:
    """The force that would hold contact c at tau, the others of its group staying what they are."""
    gi = net.groups.group[c]
    was = net.mode[c]
    net.mode[c] = STICK
    factor_group(net, gi)
    groups = net.groups
    total = net.flat[WORK]
    for a in range(groups.dof_start[gi], groups.dof_start[gi + 1]):
        total[groups.group_dof[a]] = polynomial(net.R, groups.group_dof[a], tau)
    for a in range(groups.group_start[gi], groups.group_start[gi + 1]):
        other = groups.group_contact[a]
        if net.mode[other] == SLIP:
            force = hold_force(net, other, tau)
            for e in range(net.row_start[other], net.row_start[other + 1]):
                total[net.row_dof[e]] += net.push[e] * force
    first, place = groups.group_start[gi], 0
    for i in range(groups.n_stuck[gi]):
        other = stuck_contact(net, gi, i)
        if other == c:
            place = first + i
        value = 0.0
        if net.wu_start[other] < net.wu_start[other + 1]:
            for k in range(groups.F.shape[0] - 1, -1, -1):
                value = value * tau + belt_rate(net, other, k, h)
        for e in range(net.row_start[other], net.row_start[other + 1]):
            value -= net.row_coef[e] * total[net.row_dof[e]]
        groups.rhs[first + i] = value
    solve_group(net, gi)
    net.mode[c] = was
    return float(groups.rhs[place])


@kernel
def turn(net: Net, c: int, tau: float, h: float) -> int:
    """Give contact c its new mode; returns the kind of transition, -1 where it slips on."""
    was = net.mode[c]
    if was == STICK or net.plain[c] == 1:
        held = hold_force(net, c, tau)
    else:
        held = holding_force(net, c, tau, h)
    direction = -math.copysign(1.0, held)
    kind = EVENT_SLIP
    if was == SLIP:
        if abs(held) <= net.stick[c] * (1.0 + MARGIN):
            kind = EVENT_STICK
        else:
            kind = -1 if direction == net.sigma[c] else EVENT_REVERSAL
    net.since[c] = -1.0 if kind == EVENT_STICK else tau
    if kind >= 0:
        set_mode(net, c, STICK if kind == EVENT_STICK else SLIP, direction)
    if net.plain[c] == 0:
        if kind >= 0:
            first_curve(net, c, held, tau, h)
        factor_group(net, net.groups.group[c])
    return int(kind)


@kernel
def keep_event(net: Net, t: float, c: int, kind: int) -> None:
    """Add a transition to the list."""
    at = net.n_events
    net.n_events = at + 1
    net.events[at, 0] = t
    net.events[at, 1] = c
    net.events[at, 2] = kind


@kernel
def keep_group_event(net: Net, t: float, c: int, kind: int) -> None:
    """Add a transition of a contact of a group; of several at one instant, that end in stick, what they come to."""
    if kind == EVENT_STICK:
        at = net.n_events - 1
        while at >= 0 and net.events[at, 0] == t:
            if net.events[at, 1] == c and net.events[at, 2] == EVENT_REVERSAL:
                net.events[at, 2] = EVENT_STICK
                return
            if net.events[at, 1] == c and net.events[at, 2] == EVENT_SLIP:
                net.n_events -= 1
                for later in range(at, net.n_events):
                    for part in range(3):
                        net.events[later, part] = net.events[later + 1, part]
                return
            at -= 1
    keep_event(net, t, c, kind)


@kernel
def ask_again(net: Net, c: int, tau: float, t: float) -> None:
    """Of those that have just turned round: now that contact c has let go they may be able to stick."""
    at = net.n_events - 1
    while at >= 0 and net.events[at, 0] == t:
        other = int(net.events[at, 1])
        turned = net.events[at, 2] == EVENT_REVERSAL and net.mode[other] == SLIP
        if turned and net.groups.group[other] == net.groups.group[c]:
            push_due(net, other, tau)
        at -= 1
