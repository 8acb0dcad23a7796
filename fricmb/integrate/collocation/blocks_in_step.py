"""Blocks of the structure within one step: state at its start, free motion, answer to inputs, state at its end."""

from __future__ import annotations

from fricmb.integrate.collocation.layout import (
    B0,
    B1,
    C0,
    C1,
    DAMP,
    IIS,
    IS,
    NODE,
    Q1,
    Q2,
    Q3,
    Q_U,
    Q_V,
    TABLEAU,
    V_U,
    V_V,
    VECTORS,
    W2,
    S,
)
from fricmb.integrate.collocation.moment_weights import free_weights, port_weights
from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.forces import Scratch, belt_velocity, gather, set_time
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.problem import STICK, Floats, Ints
from fricmb.integrate.step.exact_structure import INPUTS, IS_MODAL, OUTPUTS, RUNGS, STIFF_AT, UNKNOWN, Exact, rung_below
from fricmb.integrate.step.radau_step import OneStep

#: Places in ``Exact.bs``: u, v + e0, acceleration, its rate, e0 and e1 of the constant load; gains of u and v.
U0, V0, A0, K0, LOAD_E0, LOAD_E1, DU, DV = range(8)
#: Places in ``Exact.start``: blocks u and v by forces, by velocities.
BY_FORCE_0, BY_FORCE_1, BY_VELOCITY_0, BY_VELOCITY_1 = range(4)


@block
def exact_tables(one: OneStep, h: float, slot: int, address: Ints) -> None:
    """Fill a slot of the tables for the step h."""
    ex = one.exact
    modal = ex.flags[IS_MODAL] == 1
    free_weights(ex, 0, modal, h, ex.par[STIFF_AT], slot)
    port_weights(ex, 0, modal, h, slot)


@kernel
def slot_of(one: OneStep, h: float, address: Ints) -> int:
    """Slot of the tables for h, filled if it was not; 0 for a step off the ladder."""
    ex = one.exact
    rung = rung_below(h)
    if ex.ladder[rung] != h:
        exact_tables(one, h, 0, address)
        one.counts[4] += 1
        return 0
    slot = ex.slots[rung]
    if slot < 0:
        count = ex.tb.shape[0] - 1
        slot = 1 + ex.slots[RUNGS] % count
        ex.slots[RUNGS] += 1
        if ex.slots[RUNGS] > count:
            for r in range(RUNGS):
                if ex.slots[r] == slot:
                    ex.slots[r] = -1
        exact_tables(one, h, slot, address)
        one.counts[4] += 1
        ex.slots[rung] = slot
    return int(slot)


@kernel
def load_at_start(packed: Packed, s: Scratch, q: Floats, f: Floats) -> None:
    """Forces at X on the structure but those of damping and ports: f - K q - Ku u - Cu u' + B u."""
    structure = packed.structure
    n = f.shape[0]
    nu = s.ddu.shape[0]
    u0 = 1 + 2 * n
    for i in range(n):
        value = structure.f[i]
        for e in range(structure.first[i], structure.first[i + 1]):
            value -= structure.K[e] * q[structure.column[e]]
        for j in range(nu):
            value += (structure.B[i, j] - structure.Ku[i, j]) * s.X[u0 + j] - structure.Cu[i, j] * s.X[u0 + nu + j]
        f[i] = value


@kernel
def start_blocks(ex: Exact, v: Floats) -> None:
    """Block states at the start of a step under the load in ``f``, displacements counted from there."""
    bs = ex.bs
    n = v.shape[0]
    modal = ex.flags[IS_MODAL] == 1
    for j in range(ex.blk.shape[2]):
        u, w, e0, e1 = 0.0, 0.0, 0.0, 0.0
        for i in range(n):
            w += ex.start[BY_VELOCITY_1, j, i] * v[i]
            e1 += ex.start[BY_FORCE_1, j, i] * ex.f[i]
        if not modal:
            for i in range(n):
                u += ex.start[BY_VELOCITY_0, j, i] * v[i]
                e0 += ex.start[BY_FORCE_0, j, i] * ex.f[i]
        w2 = ex.blk[0, W2, j]
        d = ex.blk[0, DAMP, j]
        bs[U0, j] = u
        bs[V0, j] = w + e0
        bs[LOAD_E0, j] = e0
        bs[A0, j] = e1 + d * e0 - w2 * u - d * (w + e0)
        bs[K0, j] = -w2 * (w + e0)


@kernel
def outputs_at_start(packed: Packed, s: Scratch, y: State, one: OneStep, h: float) -> None:
    """Outputs at the nodes if the structure stood still in q and kept its velocities, into ``xf``; signals into P."""
    ex = one.exact
    n = y.q.shape[0]
    m = y.g.shape[0]
    nu = s.ddu.shape[0]
    base = ex.flags[INPUTS] - 2 * nu
    ne = packed.elements.address.shape[0]
    for k in range(y.mode.shape[0]):
        for a in range(packed.ports.row[k], packed.ports.row[k + 1]):
            # the round-off of a contact that sticks would be a large force over a short step
            g = 0.0 if y.mode[k] == STICK else y.g[a]
            g += belt_velocity(packed.ports, s, n, a)
            for i in range(ex.xf.shape[1]):
                ex.xf[a, i] = g
    for c in range(2 * nu):
        ex.now[base + c] = s.X[1 + 2 * n + c]
    varies = ex.xf.shape[0] > m
    for i in range(ex.xf.shape[1]):
        if nu > 0 or varies:
            set_time(packed.signals, s, y.t[0] + ex.nd[VECTORS, NODE, i] * h, n)
        for a in range(m):
            ex.xf[a, i] -= belt_velocity(packed.ports, s, n, a)
        for c in range(2 * nu):
            ex.P[base + c, i] = s.X[1 + 2 * n + c] - ex.now[base + c]
        if varies:
            at = m
            for k in range(ne):
                count = gather(packed.elements, k, s.X, s.x)
                for a in range(count):
                    ex.xf[at + a, i] = s.x[a]
                at += count
            for k in range(packed.ports.var.shape[0]):
                if packed.ports.var[k] >= 0:
                    count = gather(packed.normals, k, s.X, s.x)
                    for a in range(count):
                        ex.xf[at + a, i] = s.x[a]
                    at += count


@kernel
def free_outputs(ex: Exact, slot: int, h: float, first: int) -> None:
    """Add to ``xf`` the free motion of the blocks, and the answer to inputs from ``first`` on."""
    bs = ex.bs
    tb = ex.tb
    tk = ex.tk
    n_s = ex.xf.shape[1]
    n_in = ex.flags[INPUTS]
    modal = ex.flags[IS_MODAL] == 1
    for o in range(ex.flags[OUTPUTS]):
        for j in range(ex.blk.shape[2]):
            c1 = ex.co[C1, o, j]
            if c1 != 0.0:
                y = c1 * bs[A0, j]
                z = c1 * bs[K0, j]
                for i in range(n_s):
                    ex.xf[o, i] += y * tb[slot, S, j, i] + z * tb[slot, IS, j, i]
            c0 = ex.co[C0, o, j]
            if not modal and c0 != 0.0:
                for i in range(n_s):
                    t = ex.nd[VECTORS, NODE, i] * h
                    du = bs[V0, j] * t + bs[A0, j] * tb[slot, IS, j, i] + bs[K0, j] * tb[slot, IIS, j, i]
                    ex.xf[o, i] += c0 * du
        for c in range(first, n_in):
            if ex.linked[o, c] != 0.0:
                for i in range(n_s):
                    value = 0.0
                    for x in range(n_s):
                        value += tk[slot, n_in * o + c, i, x] * ex.P[c, x]
                    ex.xf[o, i] += value


@kernel
def all_outputs(ex: Exact, slot: int) -> None:
    """Outputs at the nodes under the present inputs, into ``x``."""
    n_s = ex.xf.shape[1]
    n_in = ex.flags[INPUTS]
    for o in range(ex.x.shape[0]):
        for i in range(n_s):
            value = ex.xf[o, i]
            for c in range(n_in):
                if ex.linked[o, c] != 0.0 and c < ex.flags[UNKNOWN]:
                    for x in range(n_s):
                        value += ex.tk[slot, n_in * o + c, i, x] * ex.P[c, x]
            ex.x[o, i] = value


@kernel
def end_blocks(ex: Exact, slot: int, h: float) -> None:
    """Gains of block states over the step, then of positions and velocities, into ``end``."""
    bs = ex.bs
    tb = ex.tb
    n_s = ex.xf.shape[1]
    last = n_s - 1
    modal = ex.flags[IS_MODAL] == 1
    for j in range(ex.blk.shape[2]):
        du = bs[V0, j] * h + bs[A0, j] * tb[slot, IS, j, last] + bs[K0, j] * tb[slot, IIS, j, last]
        dv = bs[A0, j] * tb[slot, S, j, last] + bs[K0, j] * tb[slot, IS, j, last]
        w2 = ex.blk[0, W2, j]
        for c in range(ex.flags[INPUTS]):
            b1 = ex.ci[B1, c, j]
            if b1 != 0.0:
                y = 0.0
                z = 0.0
                for x in range(n_s):
                    y += tb[slot, Q2, j, x] * ex.P[c, x]
                    z += tb[slot, Q1, j, x] * ex.P[c, x]
                du += b1 * y
                dv += b1 * z
            b0 = ex.ci[B0, c, j]
            if not modal and b0 != 0.0:
                for x in range(n_s):
                    push = b0 * ex.P[c, x]
                    du += push * (h * ex.nd[TABLEAU, last, x] - w2 * tb[slot, Q3, j, x])
                    dv -= push * w2 * tb[slot, Q2, j, x]
        bs[DU, j] = du
        bs[DV, j] = dv
    for i in range(ex.end.shape[1]):
        dq = 0.0
        dv = 0.0
        for j in range(ex.blk.shape[2]):
            dq += ex.mat[Q_U, i, j] * bs[DU, j]
            dv += ex.mat[V_V, i, j] * bs[DV, j]
            if not modal:
                dq += ex.mat[Q_V, i, j] * bs[DV, j]
                dv += ex.mat[V_U, i, j] * bs[DU, j]
        ex.end[0, i] = dq
        ex.end[1, i] = dv
