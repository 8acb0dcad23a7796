"""Contacts in loops that hold a load together: shares of it within their cones, and what gives way where none are.

As in scenes without joints, only what is determined is decided on (``model/friction_discs``).  Contacts and pads take
part, by forces that together move nothing; reactions of joints without friction follow.  Where a loop closes through
dry joints, or what may open, loads depend on how contacts share: there they do so only by forces that together do
nothing to any body, so that reactions stay, and a dry joint at its limit counts as slipping.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.constrained.forces import move
from fricmb.integrate.constrained.loop_mobility import as_if_free, may_share, rank, reactions_are_free, with_joints
from fricmb.integrate.constrained.moving import Moving
from fricmb.integrate.constrained.problem_structs import Mech
from fricmb.integrate.constrained.slip_rows import slip_speed
from fricmb.integrate.constrained.stages import Stages
from fricmb.integrate.constrained.state import Instant, State
from fricmb.integrate.model.friction_cone import friction_size, stick_limit
from fricmb.integrate.model.friction_discs import NEARLY, least_slip, share
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.problem import LAW_SMOOTH, SLIP, STICK, Codes, Floats, Floats2, Ints


class Loops(Layout):
    """Rows of ports, and D = W^T M^-1 W of contacts in loops, by the diagonal of M and without joints."""

    row: Ints
    D: Floats2


@kernel
def overloaded(mech: Mech, k: Moving, mode: Codes, N: Floats, F: Floats, part: float) -> bool:
    """Whether a contact in a loop sticks beyond this part of its cone."""
    for c in range(mode.shape[0]):
        if mode[c] == STICK and may_share(mech, c):
            limit = stick_limit(mech.port, mech.port.laws, c, k.s, max(N[c], 0.0))
            if friction_size(mech.port.row, c, F) > part * limit:
                return True
    return False


@block
def share_load(
    mech: Mech, k: Moving, w: Instant, y: State, mode: Codes, N: Floats, F: Floats, lam: Floats, part: float
) -> float:
    """Share what contacts in loops hold so that none is beyond ``part`` of its cone: see ``friction_discs.share``.

    ``lam``: reactions, which follow.  ``k.way`` (m_p,) becomes the motion in which contacts would give way.  The place
    must have been evaluated.
    """
    if not overloaded(mech, k, mode, N, F, part):
        return 0.0
    n_c = mode.shape[0]
    held, limit = np.full(n_c, SLIP, np.int8), np.zeros(n_c)
    for c in range(n_c):
        if mode[c] == STICK and may_share(mech, c):
            held[c] = STICK
            limit[c] = part * stick_limit(mech.port, mech.port.laws, c, k.s, max(N[c], 0.0))
    answers = np.zeros((F.shape[0], lam.shape[0]))
    D = mobility(mech, k, w, y, held, answers)
    count = 0
    for c in range(n_c):
        moves = 0
        for a in range(mech.port.row[c], mech.port.row[c + 1]):
            moves += 1 if D[a, a] > 0.0 else 0
        held[c] = STICK if moves > 0 else SLIP
        count += moves
    if rank(D) == count:
        return 0.0
    before = F.copy()
    load = float(share(Loops(mech.port.row, D), held, limit, F, k.way))
    for a in range(F.shape[0]):
        for i in range(lam.shape[0]):
            lam[i] += answers[a, i] * (F[a] - before[a])
    return load


@kernel
def mobility(mech: Mech, k: Moving, w: Instant, y: State, held: Codes, answers: Floats2) -> Floats2:
    """D of the contacts that are STICK in ``held``; with joints holding (``answers``) where nothing hangs on that."""
    if reactions_are_free(mech):
        return with_joints(mech, k, w, y, held, answers)
    return as_if_free(mech, k, y, held)


@kernel
def share_stages(mech: Mech, k: Moving, w: Instant, y: State, end: State, st: Stages) -> bool:
    """The same of the stages of a step from y to ``end``; whether there was anything to share."""
    some = False
    for i in range(st.tab.c.shape[0]):
        if overloaded(mech, k, end.mode, st.N[i], st.F[i], 1.0):
            time = y.t + st.tab.c[i] * (end.t - y.t)
            move(mech, k, time, st.Q[i], st.V[i])
            share_load(mech, k, w, y, end.mode, st.N[i], st.F[i], st.lam[i], 1.0)
            some = True
    if some:
        move(mech, k, end.t, end.q, end.v)
    return some


@kernel
def give_way(mech: Mech, k: Moving, w: Instant, y: State, part: Codes, code: int) -> bool:
    """Mark with ``code`` the contacts that slip in the motion in which a loop gives way; False where there is none.

    They reach their cones as one: none can hold the load without the others.
    """
    move(mech, k, y.t, y.q, y.v)
    k.way[:] = 0.0
    if share_load(mech, k, w, y, y.mode, y.N, y.F, y.lam, NEARLY) <= 0.0:
        return False
    slips = least_slip(mech.port.row, k.way)
    for c in range(part.shape[0] if slips > 0.0 else 0):
        if y.mode[c] == STICK and magnitude(mech.port.row, c, k.way) > slips:
            part[c] = code
    return slips > 0.0


@kernel
def mark_loops(mech: Mech, k: Moving, w: Instant, y: State, part: Codes) -> None:
    """Mark in ``k.looped`` the contacts at rest whose slip the others at rest prevent: they cannot slip alone."""
    k.looped[:] = 0
    held, some = np.full(part.shape[0], SLIP, np.int8), False
    for c in range(part.shape[0]):
        if part[c] != 0 and may_share(mech, c):
            held[c] = STICK
            some = True
    if not some:
        return
    move(mech, k, y.t, y.q, y.v)
    D = mobility(mech, k, w, y, held, np.zeros((y.F.shape[0], y.lam.shape[0])))
    whole = rank(D)
    for c in range(part.shape[0]):
        if held[c] == STICK:
            rest = D.copy()
            for a in range(mech.port.row[c], mech.port.row[c + 1]):
                rest[a, :] = 0.0
                rest[:, a] = 0.0
            k.looped[c] = 1 if rank(rest) == whole else 0


@kernel
def join_rest(mech: Mech, k: Moving, w: Instant, y: State, part: Codes, small: float, code: int) -> None:
    """Mark with ``code`` what slips by no more than round-off in loops, kept from it by joints and by what is at rest.

    Its slip is made of those of the others, each of which is round-off; ``small``: what it then is at most.  What comes
    to rest as one with others, none of which could do so alone, slows down with them.
    """
    n_c, whole, port = part.shape[0], -1, mech.port
    held, every = np.full(n_c, SLIP, np.int8), np.full(n_c, SLIP, np.int8)
    D, none = np.zeros((0, 0)), np.zeros((y.F.shape[0], y.lam.shape[0]))
    for c in range(n_c):
        slips = part[c] == 0 and y.mode[c] == SLIP and port.soft[c] > 0.0 and port.law[c] != LAW_SMOOTH
        slips = slips and y.N[c] > 0.0 and magnitude(port.row, c, y.g) <= small
        if slips and slip_speed(port.row, c, y.n, y.F, y.ga) < 0.0:
            part[c] = code
        held[c] = STICK if part[c] != 0 and port.soft[c] > 0.0 else SLIP
        every[c] = STICK if slips else held[c]
    for c in range(n_c):
        if every[c] == held[c]:
            continue
        if whole < 0:
            move(mech, k, y.t, y.q, y.v)
            D = with_joints(mech, k, w, y, every, none)
            whole = rank(of_ports(mech, D, held))
        held[c] = STICK
        if rank(of_ports(mech, D, held)) > whole:
            held[c] = SLIP
        else:
            part[c] = code


@kernel
def of_ports(mech: Mech, D: Floats2, held: Codes) -> Floats2:
    """D with rows of those alone that are STICK in ``held``."""
    some = D.copy()
    for c in range(held.shape[0]):
        for a in range(mech.port.row[c], mech.port.row[c + 1] if held[c] != STICK else mech.port.row[c]):
            some[a, :] = 0.0
            some[:, a] = 0.0
    return some
