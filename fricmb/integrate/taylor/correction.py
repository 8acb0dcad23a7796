"""The polynomial correction around a contact that changes its mode inside a step.

Behind the change at tau the motion is the old one plus a correction that solves the same equations under the new modes,
with the change of the contact's force as its source.  It starts at order 2 at the contact and at order 2 more (1 more
through dampers) with every neighbour, and ends at contacts that stick: so it touches few dofs.
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import SLIP, STICK, Floats2, Ints
from fricmb.integrate.taylor.group_correction import group_changes
from fricmb.integrate.taylor.layout import BEFORE, SHIFTED
from fricmb.integrate.taylor.network import Net
from fricmb.integrate.taylor.polynomials import held_row, relative_row, shift_one, shift_rows
from fricmb.integrate.taylor.touched import CAUGHT, FREE, RELEASED, begin_touched, spread


@kernel
def plain_source(net: Net, c: int, tau: float, was: int, before: float) -> None:
    """Change of the force of plain contact c at tau, in powers of s - tau, into old[SHIFTED].

    ``was`` and ``before`` are its mode and direction until then.  In stick it is without the response of the structure,
    which the correction adds.
    """
    y, out = net.old[BEFORE], net.old[SHIFTED]
    last = net.R.shape[0] - 1
    for k in range(last + 1):
        y[k] = held_row(net, c, k)
    shift_one(y, last, tau)
    for k in range(last + 1):
        now = y[k] if was == STICK else 0.0
        then = y[k] if net.mode[c] == STICK else 0.0
        if k == 0 and was == SLIP:
            now = -net.slip[c] * before
        if k == 0 and net.mode[c] == SLIP:
            then = -net.slip[c] * net.sigma[c]
        out[k] = then - now


@kernel
def group_source(net: Net, c: int, tau: float, h: float) -> None:
    """Relative acceleration of contact c of a group before tau, in powers of s - tau, into old[BEFORE]."""
    ending = net.old[BEFORE]
    last = net.groups.F.shape[0] - 1
    for k in range(last + 1):
        ending[k] = (k + 1) * relative_row(net, c, k + 1, h) / h
    shift_one(ending, last, tau)


@kernel
def plain_force_change(net: Net, c: int, k: int, changed: int) -> float:
    """Coefficient k of the change of the force of plain contact c, whose dof is local and has dR."""
    if net.mode[c] == SLIP:
        return float(net.old[SHIFTED, k]) if c == changed else 0.0
    e = net.row_start[c]
    force = -net.row_coef[e] * net.dR[k, net.place[net.row_dof[e]]] / net.compliance[c]
    return float(force + net.old[SHIFTED, k] if c == changed else force)


@kernel
def structure_change(net: Net, k: int, count: int, h: float) -> None:
    """Coefficient k of the change of the structure's accelerations at the touched dofs."""
    here, answer = net.dQ[k], net.dR[k]
    local, place, start, index, stiff, visc = net.local, net.place, net.start, net.neighbour, net.k, net.c
    for a in range(count):
        j = local[a]
        value = 0.0
        for e in range(start[j], start[j + 1]):
            b = place[index[e]]
            if b >= 0:
                value -= stiff[e] * here[b]
        answer[a] = value
    if net.damped == 0:
        return
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


@kernel
def correct(net: Net, changed: int, tau: float, h: float) -> int:
    """The correction in powers of s - tau; returns how many dofs it touches.  The change has its new mode.

    Of a plain contact its source is in ``old[SHIFTED]``.
    """
    if net.plain[changed] == 0:
        group_source(net, changed, tau, h)
    count = begin_touched(net, changed, tau, h)
    push = net.push[net.row_start[changed]]
    change, kinds = net.old[SHIFTED], net.kind
    joined = 0
    for k in range(net.R.shape[0]):
        count = spread(net, k, count, changed, tau, h)
        if count >= net.local.shape[0]:
            break
        structure_change(net, k, count, h)
        above, answer = net.dQ[k + 2], net.dR[k]
        factor = h * h / ((k + 1) * (k + 2))
        for a in range(count):
            kind = kinds[a]
            if kind == FREE:
                above[a] = factor * answer[a]
            elif kind == RELEASED:
                above[a] = factor * (answer[a] + push * change[k])
            elif kind == CAUGHT:
                above[a] = factor * push * change[k]
            else:
                above[a] = 0.0
        if net.n_groups > 0:
            group_changes(net, k, joined, changed, factor, h)
            joined = net.n_touched
    return count


@kernel
def add_rows(table: Floats2, rows: Floats2, last: int, place: Ints, count: int) -> None:
    """Add the first columns of rows to the columns at their places, up to degree ``last``."""
    for k in range(last + 1):
        target, row = table[k], rows[k]
        for a in range(count):
            target[place[a]] += row[a]


@kernel
def add_correction(net: Net, count: int, tau: float) -> None:
    """Shift the correction to powers of s and add it."""
    P = net.Q.shape[0] - 1
    touched = net.n_touched
    shift_rows(net.dQ, P, count, -tau)
    shift_rows(net.dR, P - 2, count, -tau)
    shift_rows(net.groups.dF, P - 2, touched, -tau)
    add_rows(net.Q, net.dQ, P, net.local, count)
    add_rows(net.R, net.dR, P - 2, net.local, count)
    if touched > 0:
        add_rows(net.groups.F, net.groups.dF, P - 2, net.groups.here, touched)
