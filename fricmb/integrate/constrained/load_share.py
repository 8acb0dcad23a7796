"""Contacts in loops that hold a load together: shares of it within their cones, and what gives way where none are.

As in scenes without joints, only what is determined is decided on (``model/friction_discs``).  Contacts alone take
part, and only by forces that together do nothing to any body: reactions stay, and with them the loads of joints.  Where
a loop closes through dry joints, whose loads depend on how they share, one at its limit counts as slipping.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.constrained.forces import move
from fricmb.integrate.constrained.jacobian_layers import place_slope
from fricmb.integrate.constrained.moving import Moving
from fricmb.integrate.constrained.problem_structs import Mech
from fricmb.integrate.constrained.stages import Stages
from fricmb.integrate.constrained.state import State
from fricmb.integrate.model.friction_cone import friction_size, stick_limit
from fricmb.integrate.model.friction_discs import NEARLY, least_slip, share
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.problem import LAW_SMOOTH, SLIP, STICK, Codes, Floats, Floats2, Ints

#: What is left of a row, of its own size, once it has been told by the others: no more than round-off.
DEPENDENT = 1e-9


class Loops(Layout):
    """Rows of ports, and D = W^T M^-1 W of contacts in loops, by the diagonal of M and without joints."""

    row: Ints
    D: Floats2


@kernel
def may_share(mech: Mech, c: int) -> bool:
    """Whether port c is a contact in a loop."""
    return bool(mech.port.joint[c] < 0 and mech.port.soft[c] > 0.0)


@kernel
def overloaded(mech: Mech, k: Moving, mode: Codes, N: Floats, F: Floats, part: float) -> bool:
    """Whether a contact in a loop sticks beyond this part of its cone."""
    for c in range(mode.shape[0]):
        if mode[c] == STICK and may_share(mech, c):
            limit = stick_limit(mech.port, mech.port.laws, c, k.s, max(N[c], 0.0))
            if friction_size(mech.port.row, c, F) > part * limit:
                return True
    return False


@kernel
def slopes_of_slip(mech: Mech, k: Moving, c: int, W: Floats2) -> None:
    """Slopes of the slip of contact c by the degrees of freedom into its rows of W, by the root of the masses."""
    port, place, table = mech.port, mech.place, mech.port.slip
    for a in range(port.row[c], port.row[c + 1]):
        form = table.x_start[c] + 2 * (a - port.row[c])
        for i in range(table.form_start[form], table.form_start[form + 1]):
            e = table.form_index[i] - 1
            if not 0 <= e < k.ddy.shape[0]:
                continue
            for b in range(place.y_start[e], place.y_start[e + 1]):
                dof = place.y_dof[b]
                W[a, dof] += table.form_coefficient[i] * place_slope(place, k, b) / np.sqrt(mech.mass[dof])


@kernel
def mobility(mech: Mech, k: Moving, held: Codes) -> Floats2:
    """D (m_p, m_p) of the contacts that are STICK in ``held``; the place must have been evaluated (``move``)."""
    m = mech.port.row[held.shape[0]]
    W = np.zeros((m, mech.mass.shape[0]))
    for c in range(held.shape[0]):
        if held[c] == STICK:
            slopes_of_slip(mech, k, c, W)
    D = np.zeros((m, m))
    for a in range(m):
        for b in range(m):
            for i in range(W.shape[1]):
                D[a, b] += W[a, i] * W[b, i]
    return D


@kernel
def rank(D: Floats2) -> int:
    """Rank of a Gram matrix whose rows are 0 where they do not count: elimination, the largest left first."""
    A, m, found = D.copy(), D.shape[0], 0
    for _ in range(m):
        best, most = -1, DEPENDENT
        for a in range(m):
            if D[a, a] > 0.0 and A[a, a] > most * D[a, a]:
                best, most = a, A[a, a] / D[a, a]
        if best < 0:
            break
        found += 1
        pivot = A[best].copy()
        for a in range(m):
            factor = pivot[a] / pivot[best]
            for b in range(m):
                A[a, b] -= factor * pivot[b]
    return found


@block
def share_load(mech: Mech, k: Moving, mode: Codes, N: Floats, F: Floats, part: float) -> float:
    """Share what contacts in loops hold so that none is beyond ``part`` of its cone: see ``friction_discs.share``.

    ``k.way`` (m_p,) becomes the motion in which they would give way.  The place must have been evaluated.
    """
    if not overloaded(mech, k, mode, N, F, part):
        return 0.0
    n_c = mode.shape[0]
    held, limit = np.full(n_c, SLIP, np.int8), np.zeros(n_c)
    count = 0
    for c in range(n_c):
        if mode[c] == STICK and may_share(mech, c):
            held[c] = STICK
            limit[c] = part * stick_limit(mech.port, mech.port.laws, c, k.s, max(N[c], 0.0))
            count += mech.port.row[c + 1] - mech.port.row[c]
    D = mobility(mech, k, held)
    if rank(D) == count:
        return 0.0
    return float(share(Loops(mech.port.row, D), held, limit, F, k.way))


@kernel
def share_stages(mech: Mech, k: Moving, y: State, end: State, st: Stages) -> bool:
    """The same of the stages of a step from y to ``end``; whether there was anything to share."""
    some = False
    for i in range(st.tab.c.shape[0]):
        if overloaded(mech, k, end.mode, st.N[i], st.F[i], 1.0):
            time = y.t + st.tab.c[i] * (end.t - y.t)
            move(mech, k, time, st.Q[i], st.V[i])
            share_load(mech, k, end.mode, st.N[i], st.F[i], 1.0)
            some = True
    if some:
        move(mech, k, end.t, end.q, end.v)
    return some


@kernel
def give_way(mech: Mech, k: Moving, y: State, part: Codes, code: int) -> bool:
    """Mark with ``code`` the contacts that slip in the motion in which a loop gives way; False where there is none.

    They reach their cones as one: none can hold the load without the others.
    """
    move(mech, k, y.t, y.q, y.v)
    k.way[:] = 0.0
    if share_load(mech, k, y.mode, y.N, y.F, NEARLY) <= 0.0:
        return False
    slips = least_slip(mech.port.row, k.way)
    for c in range(part.shape[0] if slips > 0.0 else 0):
        if y.mode[c] == STICK and magnitude(mech.port.row, c, k.way) > slips:
            part[c] = code
    return slips > 0.0


@kernel
def at_rest_in_loops(mech: Mech, part: Codes) -> Codes:
    """STICK (n_c,) for the contacts in loops that are at rest by ``part``, SLIP for all others."""
    held = np.full(part.shape[0], SLIP, np.int8)
    for c in range(part.shape[0]):
        if part[c] != 0 and may_share(mech, c):
            held[c] = STICK
    return held


@kernel
def mark_loops(mech: Mech, k: Moving, y: State, part: Codes) -> None:
    """Mark in ``k.looped`` the contacts at rest whose slip the others at rest prevent: they cannot slip alone."""
    k.looped[:] = 0
    held = at_rest_in_loops(mech, part)
    if not (held == STICK).any():
        return
    move(mech, k, y.t, y.q, y.v)
    D = mobility(mech, k, held)
    whole = rank(D)
    for c in range(part.shape[0]):
        if held[c] == STICK:
            rest = D.copy()
            for a in range(mech.port.row[c], mech.port.row[c + 1]):
                rest[a, :] = 0.0
                rest[:, a] = 0.0
            k.looped[c] = 1 if rank(rest) == whole else 0


@kernel
def join_rest(mech: Mech, k: Moving, y: State, part: Codes, small: float, code: int) -> None:
    """Mark with ``code`` the contacts in loops that those at rest keep from slipping, where they do so by no more.

    Their slip is made of those of the others, each of which is round-off; ``small``: what it then is at most.
    """
    held, whole = at_rest_in_loops(mech, part), -1
    for c in range(part.shape[0]):
        slips = part[c] == 0 and y.mode[c] == SLIP and may_share(mech, c) and mech.port.law[c] != LAW_SMOOTH
        if not slips or y.N[c] <= 0.0 or magnitude(mech.port.row, c, y.g) > small:
            continue
        if whole < 0:
            move(mech, k, y.t, y.q, y.v)
            whole = rank(mobility(mech, k, held))
        held[c] = STICK
        if rank(mobility(mech, k, held)) > whole:
            held[c] = SLIP
        else:
            part[c] = code
