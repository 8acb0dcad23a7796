"""The part of a correction that the forces of groups have in it.

What sticks to a touched contact is touched with it at the same order; a slip force changes by the difference of mu over
the new and over the old motion.
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import STICK
from fricmb.integrate.taylor.friction_curve import compose, slip_law
from fricmb.integrate.taylor.group_forces import is_held, solve_group, stuck_contact
from fricmb.integrate.taylor.layout import BEFORE
from fricmb.integrate.taylor.network import Net


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
    groups = net.groups
    c = groups.here[slot]
    at = groups.lawful[c]
    if at < 0:
        if c != changed:
            return 0.0
        return float((-net.slip[c] * net.sigma[c] if k == 0 else 0.0) - groups.was[slot, k])
    b = groups.local_b[slot]
    x = b[b.shape[0] - 1]
    change = net.sigma[c] * relative_change(net, c, k, h) / groups.half[at]
    weight = -net.sigma[c] * groups.N[c]
    curve, terms = groups.curve[at], groups.terms[at]
    if c == changed:
        x[k] += change
        return float(weight * compose(curve, terms, x, b, k) - groups.was[slot, k])
    if groups.first[slot] < 0:
        if change == 0.0:
            compose(curve, terms, x, b, k)
            return 0.0
        # here the motions begin to differ: the old one's coefficients from this order on
        groups.first[slot] = k
        was = groups.was[slot]
        for q in range(k, groups.F.shape[0]):
            was[q] = weight * compose(curve, terms, x, b, q)
    x[k] += change
    return float(weight * compose(curve, terms, x, b, k) - groups.was[slot, k])


@kernel
def catch_up(net: Net, first: int, k: int) -> None:
    """Sums of the orders before k for contacts that joined at it."""
    groups = net.groups
    for slot in range(first, net.n_touched):
        c = groups.here[slot]
        at = slip_law(net, c)
        if at < 0:
            continue
        b = groups.local_b[slot]
        for q in range(k):
            compose(groups.curve[at], groups.terms[at], b[b.shape[0] - 1], b, q)


@kernel
def hold_changes(net: Net, k: int, changed: int, factor: float) -> None:
    """Coefficient k of the changes of the forces of the touched contacts that stick.

    That of one which has begun to stick brings its relative acceleration to 0.
    """
    groups = net.groups
    above = net.dQ[k + 2]
    for g in range(net.n_groups):
        gi = groups.reached[g]
        first = groups.group_start[gi]
        held = is_held(net, gi) and gi != groups.group[changed]
        for i in range(groups.n_stuck[gi]):
            c = stuck_contact(net, gi, i)
            value = -factor * net.old[BEFORE, k] if c == changed else 0.0
            for e in range(net.row_start[c], net.row_start[c + 1]):
                value -= net.row_coef[e] * above[net.place[net.row_dof[e]]]
            groups.rhs[first + i] = value
        solve_group(net, gi)
        for i in range(groups.n_stuck[gi]):
            c = stuck_contact(net, gi, i)
            groups.dF[k, groups.slot[c]] = groups.rhs[first + i] / factor
            for e in range(net.row_start[c], net.row_start[c + 1]):
                a = net.place[net.row_dof[e]]
                above[a] = 0.0 if held else above[a] + net.push[e] * groups.rhs[first + i]


@kernel
def group_changes(net: Net, k: int, joined: int, changed: int, factor: float, h: float) -> None:
    """Coefficient k of the changes of the touched groups' forces, and of what they bring into the displacements.

    Contacts from ``joined`` on are touched since this order.  ``factor``: displacement by acceleration.
    """
    groups = net.groups
    catch_up(net, joined, k)
    above = net.dQ[k + 2]
    for slot in range(net.n_touched):
        c = groups.here[slot]
        if net.mode[c] == STICK:
            continue
        force = slip_change(net, slot, changed, k, h)
        groups.dF[k, slot] = force
        if force != 0.0:
            for e in range(net.row_start[c], net.row_start[c + 1]):
                above[net.place[net.row_dof[e]]] += factor * net.push[e] * force
    hold_changes(net, k, changed, factor)
