"""The polynomial correction around a contact that changes its mode inside a step.

Behind the change at tau the motion is the old one plus a correction that solves the same equations under the new modes,
with the change of the contact's force as its source.  It starts at order 2 at the contact and at order 2 more (1 more
through dampers) with every neighbour, and ends at contacts that stick: so it touches few dofs.
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import SLIP, Floats2
from fricmb.integrate.taylor._layout import CUT, SHIFTED
from fricmb.integrate.taylor._net import Net

#: How a dof answers to a correction: without contact or in slip; held by a plain contact; with the changed contact,
#: that slips from now on, or sticks; with a contact of two dofs or a moving belt.
FREE, HELD, RELEASED, CAUGHT, TIED = range(5)


@kernel
def kind_of(net: Net, j: int, changed: int) -> int:
    """How dof j answers: see FREE to TIED."""
    owner = net.owner[j]
    if owner < 0:
        return FREE
    if net.plain[owner] == 0:
        return TIED
    if owner == changed:
        return RELEASED if net.mode[owner] == SLIP else CAUGHT
    return FREE if net.mode[owner] == SLIP else HELD


@kernel
def add_local(net: Net, j: int, count: int, changed: int) -> int:
    """Take dof j, and what its contact ties it to, among those a correction touches; returns how many there are."""
    owner = net.owner[j]
    first, last = 0, 1
    if owner >= 0 and net.plain[owner] == 0:
        first, last = net.row_start[owner], net.row_start[owner + 1]
    for e in range(first, last):
        i = net.row_dof[e] if last > 1 or first > 0 else j
        if net.place[i] >= 0 or count >= net.local.shape[0]:
            continue
        net.place[i] = count
        net.local[count] = i
        net.grown[count] = 0
        net.kind[count] = kind_of(net, i, changed)
        for k in range(net.dQ.shape[0]):
            net.dQ[k, count] = 0.0
        for k in range(net.dR.shape[0]):
            net.dR[k, count] = 0.0
        count += 1
    return count


@kernel
def spread(net: Net, k: int, count: int, changed: int, damped: bool) -> int:
    """Neighbours of what has begun to move at order k join."""
    here = net.dQ[k]
    ahead = net.dQ[k + 1]
    cut = net.x[CUT]
    for a in range(count):
        if net.grown[a]:
            continue
        if abs(here[a]) > cut or (damped and abs(ahead[a]) > cut):
            net.grown[a] = 1
            j = net.local[a]
            for e in range(net.start[j], net.start[j + 1]):
                i = net.neighbour[e]
                if net.place[i] < 0:
                    count = add_local(net, i, count, changed)
    return count


@kernel
def local_force(net: Net, c: int, k: int, changed: int) -> float:
    """Coefficient k of the change of the force of contact c, whose dofs are local and have dR."""
    if net.mode[c] == SLIP:
        return float(net.old[SHIFTED, k]) if c == changed else 0.0
    response = 0.0
    for e in range(net.row_start[c], net.row_start[c + 1]):
        place = net.place[net.row_dof[e]]
        if place >= 0:
            response += net.row_coef[e] * net.dR[k, place]
    force = -response / net.compliance[c]
    return float(force + net.old[SHIFTED, k] if c == changed else force)


@kernel
def correct(net: Net, changed: int, h: float) -> int:
    """The correction in powers of s - tau; returns how many dofs it touches."""
    P = net.Q.shape[0] - 1
    damped = net.damped[0] == 1
    count = 0
    for e in range(net.row_start[changed], net.row_start[changed + 1]):
        if net.place[net.row_dof[e]] < 0:
            count = add_local(net, net.row_dof[e], count, changed)
    push = net.push[net.row_start[changed]]
    local, place, start, index, stiff, visc = net.local, net.place, net.start, net.neighbour, net.k, net.c
    change, kinds = net.old[SHIFTED], net.kind
    for k in range(P - 1):
        count = spread(net, k, count, changed, damped)
        here, above, answer = net.dQ[k], net.dQ[k + 2], net.dR[k]
        factor = h * h / ((k + 1) * (k + 2))
        tied = False
        for a in range(count):
            j = local[a]
            value = 0.0
            for e in range(start[j], start[j + 1]):
                b = place[index[e]]
                if b >= 0:
                    value -= stiff[e] * here[b]
            answer[a] = value
        if damped:
            ahead = net.dQ[k + 1]
            rate = (k + 1) / h
            for a in range(count):
                j = local[a]
                value = 0.0
                for e in range(start[j], start[j + 1]):
                    b = place[index[e]]
                    if b >= 0:
                        value += visc[e] * ahead[b]
                answer[a] -= value * rate
        for a in range(count):
            kind = kinds[a]
            if kind == FREE:
                above[a] = factor * answer[a]
            elif kind == RELEASED:
                above[a] = factor * (answer[a] + push * change[k])
            elif kind == CAUGHT:
                above[a] = factor * push * change[k]
            elif kind == TIED:
                above[a] = factor * answer[a]
                tied = True
            else:
                above[a] = 0.0
        if tied:
            add_tied(net, k, count, factor, changed)
    return count


@kernel
def add_tied(net: Net, k: int, count: int, factor: float, changed: int) -> None:
    """Coefficient k of forces of contacts with two dofs or a moving belt into the correction."""
    for a in range(count):
        if net.kind[a] != TIED:
            continue
        j = net.local[a]
        owner = net.owner[j]
        for e in range(net.row_start[owner], net.row_start[owner + 1]):
            if net.row_dof[e] == j:
                net.dQ[k + 2, a] += factor * net.push[e] * local_force(net, owner, k, changed)


@kernel
def shift_rows(table: Floats2, last: int, count: int, by: float) -> None:
    """Powers of s become powers of s - by, column by column."""
    for i in range(last):
        above = table[last]
        for k in range(last - 1, i - 1, -1):
            row = table[k]
            for a in range(count):
                row[a] += by * above[a]
            above = row


@kernel
def add_correction(net: Net, count: int, tau: float) -> None:
    """Shift the correction to powers of s and add it."""
    P = net.Q.shape[0] - 1
    shift_rows(net.dQ, P, count, -tau)
    shift_rows(net.dR, P - 2, count, -tau)
    local = net.local
    for k in range(P + 1):
        target, row = net.Q[k], net.dQ[k]
        for a in range(count):
            target[local[a]] += row[a]
    for k in range(P - 1):
        target, row = net.R[k], net.dR[k]
        for a in range(count):
            target[local[a]] += row[a]
