"""Corrections where contacts are coupled or their friction depends on slip speed.

As in _correct: behind the change the motion is the old one plus a correction that solves the same equations, order by
order from the contact outwards.  What sticks to a touched contact is touched with it at the same order; a slip force
changes by the difference of mu over the new and over the old motion.
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import SLIP, STICK
from fricmb.integrate.taylor._coupled_series import relative_row
from fricmb.integrate.taylor._curve import compose
from fricmb.integrate.taylor._groups import solve_group, stuck_contact
from fricmb.integrate.taylor._layout import BEFORE, N_GROUPS, N_TOUCHED
from fricmb.integrate.taylor._net import Net
from fricmb.integrate.taylor._search import shift_one


@kernel
def add_contact(net: Net, c: int, tau: float, h: float) -> bool:
    """Give a contact a place among the touched: its force before, and its slip speed, in powers of s - tau."""
    slot = net.i[N_TOUCHED]
    if slot >= net.coupled.here.shape[0]:
        return False
    net.i[N_TOUCHED] = slot + 1
    net.coupled.slot[c] = slot
    net.coupled.here[slot] = c
    net.coupled.first[slot] = -1
    for k in range(net.coupled.dF.shape[0]):
        net.coupled.dF[k, slot] = 0.0
    last = net.coupled.F.shape[0] - 1
    was = net.coupled.was[slot]
    for k in range(last + 1):
        was[k] = net.coupled.F[k, c]
    shift_one(was, last, tau)
    at = net.coupled.lawful[c]
    if at >= 0 and net.mode[c] == SLIP:
        b = net.coupled.local_b[slot]
        x = b[b.shape[0] - 1]
        for k in range(last + 2):
            x[k] = net.sigma[c] * relative_row(net, c, k, h)
        x[0] -= net.coupled.middle[at]
        for k in range(last + 2):
            x[k] /= net.coupled.half[at]
        shift_one(x, last + 1, tau)
    return True


@kernel
def add_dof(net: Net, j: int, count: int) -> int:
    """Give a dof a place among the touched."""
    if net.place[j] >= 0 or count >= net.local.shape[0]:
        return count
    net.place[j] = count
    net.local[count] = j
    net.grown[count] = 0
    for k in range(net.dQ.shape[0]):
        net.dQ[k, count] = 0.0
    for k in range(net.dR.shape[0]):
        net.dR[k, count] = 0.0
    return count + 1


@kernel
def add_group(net: Net, gi: int, count: int, tau: float, h: float) -> int:
    """Take a whole group of contacts and its dofs among the touched."""
    co = net.coupled
    if co.touched[gi]:
        return count
    co.touched[gi] = 1
    at = net.i[N_GROUPS]
    co.groups[at] = gi
    net.i[N_GROUPS] = at + 1
    for a in range(co.dof_start[gi], co.dof_start[gi + 1]):
        count = add_dof(net, co.group_dof[a], count)
    for a in range(co.group_start[gi], co.group_start[gi + 1]):
        if not add_contact(net, co.group_contact[a], tau, h):
            return int(net.local.shape[0])
    return count


@kernel
def spread_coupled(net: Net, k: int, count: int, tau: float, h: float) -> int:
    """Neighbours of what has begun to move at order k join, with their groups."""
    damped = net.damped[0] == 1
    here, ahead = net.dQ[k], net.dQ[k + 1]
    for a in range(count):
        if net.grown[a] or (here[a] == 0.0 and not (damped and ahead[a] != 0.0)):
            continue
        net.grown[a] = 1
        j = net.local[a]
        for e in range(net.start[j], net.start[j + 1]):
            i = net.neighbour[e]
            if net.place[i] >= 0:
                continue
            gi = net.coupled.dof_group[i]
            count = add_group(net, gi, count, tau, h) if gi >= 0 else add_dof(net, i, count)
            if count >= net.local.shape[0]:
                return count
    return count


@kernel
def relative_change(net: Net, c: int, k: int, h: float) -> float:
    """Coefficient k of the change of the relative velocity of contact c."""
    value = 0.0
    for e in range(net.row_start[c], net.row_start[c + 1]):
        value += net.row_coef[e] * (k + 1) * net.dQ[k + 1, net.place[net.row_dof[e]]] / h
    return float(value)


@kernel
def slip_change(net: Net, slot: int, changed: int, k: int, h: float) -> float:
    """Coefficient k of the change of the force of a contact that slips."""
    co = net.coupled
    c = co.here[slot]
    at = co.lawful[c]
    if at < 0:
        if c != changed:
            return 0.0
        return float((-net.slip[c] * net.sigma[c] if k == 0 else 0.0) - co.was[slot, k])
    b = co.local_b[slot]
    x = b[b.shape[0] - 1]
    change = net.sigma[c] * relative_change(net, c, k, h) / co.half[at]
    weight = -net.sigma[c] * co.N[c]
    curve, terms = co.curve[at], co.terms[at]
    if c == changed:
        x[k] += change
        return float(weight * compose(curve, terms, x, b, k) - co.was[slot, k])
    if co.first[slot] < 0:
        if change == 0.0:
            compose(curve, terms, x, b, k)
            return 0.0
        # here the motions begin to differ: the old one's coefficients from this order on
        co.first[slot] = k
        was = co.was[slot]
        for q in range(k, co.F.shape[0]):
            was[q] = weight * compose(curve, terms, x, b, q)
    x[k] += change
    return float(weight * compose(curve, terms, x, b, k) - co.was[slot, k])


@kernel
def catch_up(net: Net, first: int, k: int) -> None:
    """Sums of the orders before k for contacts that joined at it."""
    co = net.coupled
    for slot in range(first, net.i[N_TOUCHED]):
        c = co.here[slot]
        at = co.lawful[c]
        if at < 0 or net.mode[c] != SLIP:
            continue
        b = co.local_b[slot]
        for q in range(k):
            compose(co.curve[at], co.terms[at], b[b.shape[0] - 1], b, q)


@kernel
def structure_change(net: Net, k: int, count: int, h: float) -> None:
    """Coefficient k of the change of the structure's accelerations at the touched dofs, into dR and dQ."""
    here, ahead, above, answer = net.dQ[k], net.dQ[k + 1], net.dQ[k + 2], net.dR[k]
    local, place, start, index, stiff, visc = net.local, net.place, net.start, net.neighbour, net.k, net.c
    rate = (k + 1) / h
    damped = net.damped[0] == 1
    for a in range(count):
        j = local[a]
        value = 0.0
        for e in range(start[j], start[j + 1]):
            b = place[index[e]]
            if b >= 0:
                value -= stiff[e] * here[b]
                if damped:
                    value -= visc[e] * ahead[b] * rate
        answer[a] = value
        above[a] = value


@kernel
def hold_changes(net: Net, k: int, changed: int, newly: bool) -> None:
    """Coefficient k of the changes of the forces of the touched contacts that stick."""
    co = net.coupled
    above = net.dQ[k + 2]
    for g in range(net.i[N_GROUPS]):
        gi = co.groups[g]
        first = co.group_start[gi]
        for i in range(co.n_stuck[gi]):
            c = stuck_contact(net, gi, i)
            value = -net.old[BEFORE, k] if newly and c == changed else 0.0
            for e in range(net.row_start[c], net.row_start[c + 1]):
                value -= net.row_coef[e] * above[net.place[net.row_dof[e]]]
            co.rhs[first + i] = value
        solve_group(net, gi)
        for i in range(co.n_stuck[gi]):
            c = stuck_contact(net, gi, i)
            co.dF[k, co.slot[c]] = co.rhs[first + i]
            for e in range(net.row_start[c], net.row_start[c + 1]):
                above[net.place[net.row_dof[e]]] += net.push[e] * co.rhs[first + i]


@kernel
def coupled_correct(net: Net, changed: int, tau: float, h: float) -> int:
    """The correction in powers of s - tau behind the change of a contact, its mode being the new one.

    Returns how many dofs it touches.  The change of contacts that have begun to stick brings their relative
    acceleration to 0.
    """
    co = net.coupled
    net.i[N_TOUCHED] = 0
    net.i[N_GROUPS] = 0
    last = co.F.shape[0] - 1
    newly = net.mode[changed] == STICK
    ending = net.old[BEFORE]
    for k in range(last + 1):
        ending[k] = (k + 1) * relative_row(net, changed, k + 1, h) / h
    shift_one(ending, last, tau)
    count = add_group(net, co.group[changed], 0, tau, h)
    joined = 0
    for k in range(last + 1):
        count = spread_coupled(net, k, count, tau, h)
        if count >= net.local.shape[0]:
            return count
        catch_up(net, joined, k)
        joined = net.i[N_TOUCHED]
        structure_change(net, k, count, h)
        above = net.dQ[k + 2]
        for slot in range(joined):
            c = co.here[slot]
            if net.mode[c] == STICK:
                continue
            force = slip_change(net, slot, changed, k, h)
            co.dF[k, slot] = force
            if force != 0.0:
                for e in range(net.row_start[c], net.row_start[c + 1]):
                    above[net.place[net.row_dof[e]]] += net.push[e] * force
        hold_changes(net, k, changed, newly)
        factor = h * h / ((k + 1) * (k + 2))
        for a in range(count):
            above[a] *= factor
    return count


@kernel
def forget(net: Net, count: int) -> None:
    """Clear the marks of a correction."""
    co = net.coupled
    for a in range(min(count, net.local.shape[0])):
        net.place[net.local[a]] = -1
    for slot in range(net.i[N_TOUCHED]):
        co.slot[co.here[slot]] = -1
    for g in range(net.i[N_GROUPS]):
        co.touched[co.groups[g]] = 0
