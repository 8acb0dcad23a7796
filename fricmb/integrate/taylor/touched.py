"""Which dofs and contacts a correction touches: it starts at a contact and spreads from neighbour to neighbour."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import SLIP
from fricmb.integrate.taylor.friction_curve import slip_law
from fricmb.integrate.taylor.network import Net
from fricmb.integrate.taylor.polynomials import relative_row, shift_one

#: How a dof answers to a correction: without a plain contact or in slip; held by one; with the changed contact, a plain
#: one, that slips from now on, or sticks.
FREE, HELD, RELEASED, CAUGHT = range(4)


@kernel
def kind_of(net: Net, j: int, changed: int) -> int:
    """How dof j answers: see FREE to CAUGHT."""
    owner = net.owner[j]
    if owner < 0:
        return FREE
    if owner == changed:
        return RELEASED if net.mode[owner] == SLIP else CAUGHT
    return FREE if net.mode[owner] == SLIP else HELD


@kernel
def add_dof(net: Net, j: int, count: int, changed: int) -> int:
    """Give a dof a place among the touched; returns how many there are."""
    if net.place[j] >= 0 or count >= net.local.shape[0]:
        return count
    net.place[j] = count
    net.local[count] = j
    net.grown[count] = 0
    net.kind[count] = kind_of(net, j, changed)
    for k in range(net.dQ.shape[0]):
        net.dQ[k, count] = 0.0
    for k in range(net.dR.shape[0]):
        net.dR[k, count] = 0.0
    return count + 1


@kernel
def add_contact(net: Net, c: int, tau: float, h: float) -> bool:
    """Give a contact of a group a place: its force before, and its slip speed, in powers of s - tau."""
    groups = net.groups
    slot = net.n_touched
    if slot >= groups.here.shape[0]:
        return False
    net.n_touched = slot + 1
    groups.slot[c] = slot
    groups.here[slot] = c
    groups.first[slot] = -1
    for k in range(groups.dF.shape[0]):
        groups.dF[k, slot] = 0.0
    last = groups.F.shape[0] - 1
    was = groups.was[slot]
    for k in range(last + 1):
        was[k] = groups.F[k, c]
    shift_one(was, last, tau)
    at = slip_law(net, c)
    if at >= 0:
        b = groups.local_b[slot]
        x = b[b.shape[0] - 1]
        for k in range(last + 2):
            x[k] = net.sigma[c] * relative_row(net, c, k, h)
        x[0] -= groups.middle[at]
        for k in range(last + 2):
            x[k] /= groups.half[at]
        shift_one(x, last + 1, tau)
    return True


@kernel
def add_group(net: Net, gi: int, count: int, changed: int, tau: float, h: float) -> int:
    """Take a whole group of contacts and its dofs among the touched."""
    groups = net.groups
    if groups.touched[gi]:
        return count
    groups.touched[gi] = 1
    at = net.n_groups
    groups.reached[at] = gi
    net.n_groups = at + 1
    for a in range(groups.dof_start[gi], groups.dof_start[gi + 1]):
        count = add_dof(net, groups.group_dof[a], count, changed)
    for a in range(groups.group_start[gi], groups.group_start[gi + 1]):
        if not add_contact(net, groups.group_contact[a], tau, h):
            return int(net.local.shape[0])
    return count


@kernel
def begin_touched(net: Net, changed: int, tau: float, h: float) -> int:
    """The dofs of the changed contact, and of its group."""
    net.n_touched = 0
    net.n_groups = 0
    if net.plain[changed] == 1:
        return add_dof(net, net.first_dof[changed], 0, changed)
    return add_group(net, net.groups.group[changed], 0, changed, tau, h)


@kernel
def spread(net: Net, k: int, count: int, changed: int, tau: float, h: float) -> int:
    """Neighbours of what has begun to move at order k join, with their groups."""
    damped = net.damped == 1
    here, ahead = net.dQ[k], net.dQ[k + 1]
    for a in range(count):
        if net.grown[a]:
            continue
        if abs(here[a]) > 0.0 or (damped and abs(ahead[a]) > 0.0):
            net.grown[a] = 1
            j = net.local[a]
            for e in range(net.start[j], net.start[j + 1]):
                i = net.neighbour[e]
                if net.place[i] >= 0:
                    continue
                gi = net.groups.dof_group[i]
                if gi < 0:
                    count = add_dof(net, i, count, changed)
                else:
                    count = add_group(net, gi, count, changed, tau, h)
    return count


@kernel
def forget(net: Net, count: int) -> None:
    """Clear the marks of a correction."""
    groups = net.groups
    for a in range(min(count, net.local.shape[0])):
        net.place[net.local[a]] = -1
    for slot in range(net.n_touched):
        groups.slot[groups.here[slot]] = -1
    for g in range(net.n_groups):
        groups.touched[groups.reached[g]] = 0
