"""Ports in loops that hold a load together: shares of it within their cones, and what gives way where none are.

As in scenes without joints, only what is determined is decided on, by forces that together move nothing; reactions
follow.  Contacts and pads alone have loads that do not depend on how they share (``model/friction_discs``); where dry
joints take part, or what may not pull, loads may (``group_cones``, ``model/cone_shares``).
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.implicit.equations.forces import is_open, move
from fricmb.integrate.implicit.equations.slip_rows import slip_speed
from fricmb.integrate.implicit.modes.group_cones import (
    cones_of,
    idle,
    keep_loads,
    load_of,
    load_slopes,
    shares_of,
    units_of,
    without_idle,
)
from fricmb.integrate.implicit.modes.loop_mobility import holds, is_independent, may_share, mobility, rank
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.implicit.stages.stages import Stages
from fricmb.integrate.model.cone_shares import ENOUGH, Cones, most_spare, nearest_enough, shared
from fricmb.integrate.model.friction_cone import friction_size, stick_limit
from fricmb.integrate.model.friction_discs import NEARLY, least_slip, share
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.problem import LAW_SMOOTH, SLIP, STICK, Codes, Floats, Floats2, Ints

#: Times that loads which bend are drawn as straight lines anew, and what is left then, in their size.
ROUNDS, CURVED = 40, 1e-14


class Loops(Layout):
    """Rows of ports, and D = W^T M^-1 W of contacts in loops, by the diagonal of M and without joints."""

    row: Ints
    D: Floats2


@kernel
def overloaded(mech: Mech, k: Moving, mode: Codes, N: Floats, F: Floats, lam: Floats, part: float) -> bool:
    """Whether a port in a loop sticks beyond this part of its cone, or a joint beside it would have to pull."""
    some = False
    for c in range(mode.shape[0]):
        if mode[c] == STICK and may_share(mech, c):
            some = True
            limit = stick_limit(mech.port, mech.port.laws, c, k.s, max(N[c], 0.0))
            if friction_size(mech.port.row, c, F) > part * limit:
                return True
    joint = mech.joint
    for j in range(joint.port.shape[0] if some else 0):
        if joint.one_sided[j] != 0 and lam[joint.row[j]] < 0.0 and not is_open(mech, j):
            return True
    return False


@kernel
def reactions_are_free(mech: Mech) -> bool:
    """Whether no cone hangs on reactions: nothing that may not pull, no dry joint."""
    for j in range(mech.joint.port.shape[0]):
        if mech.joint.one_sided[j] != 0 or (mech.joint.port[j] >= 0 and holds(mech, mech.joint.port[j])):
            return False
    return True


@block
def share_load(
    mech: Mech, k: Moving, w: Instant, y: State, mode: Codes, N: Floats, F: Floats, lam: Floats, part: float
) -> float:
    """Share what ports in loops hold so that none is beyond ``part`` of its cone; above 1 where no shares do that.

    ``N``, ``lam``: loads and reactions, which follow.  ``k.way`` (m_p,) becomes the motion in which ports would give
    way: of those that would, where loads depend on shares.  The place must have been evaluated.
    """
    if not overloaded(mech, k, mode, N, F, lam, part):
        return 0.0
    n_c = mode.shape[0]
    held, limit = np.full(n_c, SLIP, np.int8), np.zeros(n_c)
    for c in range(n_c):
        if mode[c] == STICK and may_share(mech, c):
            held[c] = STICK
            limit[c] = part * stick_limit(mech.port, mech.port.laws, c, k.s, max(N[c], 0.0))
    answers = np.zeros((F.shape[0], lam.shape[0]))
    D = mobility(mech, k, w, y, held, answers)
    if is_independent(D):
        return 0.0
    for c in range(n_c):
        held[c] = SLIP
        for a in range(mech.port.row[c], mech.port.row[c + 1]):
            held[c] = STICK if D[a, a] > 0.0 else held[c]
    if not reactions_are_free(mech):
        return share_cones(mech, k, held, N, F, lam, part, answers, D)
    before = F.copy()
    load = float(share(Loops(mech.port.row, D), held, limit, F, k.way))
    for a in range(F.shape[0]):
        for i in range(lam.shape[0]):
            lam[i] += answers[a, i] * (F[a] - before[a])
    return load


@kernel
def share_cones(
    mech: Mech, k: Moving, held: Codes, N: Floats, F: Floats, lam: Floats, part: float, answers: Floats2, D: Floats2
) -> float:  # fmt: skip
    """The same where loads may follow the shares, by the cones with the most to spare."""
    keep_loads(mech, k, held, lam, answers, D)
    unit = np.zeros(F.shape[0])
    Z = shares_of(D) * units_of(mech, k, held, N, F, D, unit)
    relief, Z = without_idle(mech, k, held, N, F, lam, answers, unit, Z)
    x, weight, most = np.zeros(Z.shape[1]), np.zeros(held.shape[0] + mech.joint.port.shape[0]), 0.0
    cones = cones_of(mech, k, held, N, F + relief, lam, part, answers, unit, Z)
    several = Z.shape[1] > 0 and cones.held.any()
    if not several and relief.any():
        apply_shares(mech, k, held, N, F, lam, answers, unit, cones, x)
    for _ in range(ROUNDS if several else 0):
        most = most_spare(cones, x, weight)
        nearest_enough(cones, most, x)
        for c in range(held.shape[0]):
            for a in range(mech.port.row[c], mech.port.row[c + 1]):
                k.way[a] = -weight[c] / cones.size[c] * shared(cones, x, a)
        if apply_shares(mech, k, held, N, F, lam, answers, unit, cones, x) <= CURVED or most > ENOUGH:
            break
        cones = cones_of(mech, k, held, N, F, lam, part, answers, unit, Z)
    return float(1.0 - most) if x.any() or weight.any() else 0.0


@kernel
def apply_shares(
    mech: Mech, k: Moving, held: Codes, N: Floats, F: Floats, lam: Floats, answers: Floats2, unit: Floats, cones: Cones,
    x: Floats,
) -> float:  # fmt: skip
    """Give every port its share, with loads and reactions; what loads differ by from straight lines, in their size.

    The load of a pin is a length, so that the straight line leaves out shares that would hold as well.
    """
    change, by_force, bent = np.zeros(F.shape[0]), np.zeros(F.shape[0]), 0.0
    for a in range(F.shape[0]):
        change[a] = shared(cones, x, a) - F[a]
    before = lam.copy()
    for i in range(lam.shape[0]):
        for a in range(change.shape[0]):
            lam[i] += answers[a, i] * change[a]
    for c in range(held.shape[0]):
        if held[c] != STICK or not holds(mech, c):
            continue
        straight = N[c]
        load_slopes(mech, k, c, before, answers, by_force)
        for a in range(F.shape[0]):
            straight += by_force[a] * change[a]
        N[c] = load_of(mech, k, c, lam)
        if not idle(mech, k, c, N[c], by_force, unit):
            bent = max(bent, abs(N[c] - straight) / max(abs(N[c]), abs(straight), 1e-300))
    for a in range(F.shape[0]):
        F[a] += change[a]
    return float(bent)


@kernel
def share_stages(mech: Mech, k: Moving, w: Instant, y: State, end: State, st: Stages) -> bool:
    """The same of the stages of a step from y to ``end``; whether there was anything to share."""
    some = False
    for i in range(st.tab.c.shape[0]):
        if overloaded(mech, k, end.mode, st.N[i], st.F[i], st.lam[i], 1.0):
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
    if is_independent(D):
        return
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
            D = mobility(mech, k, w, y, every, none)
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
