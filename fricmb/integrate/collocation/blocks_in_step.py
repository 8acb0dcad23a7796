"""Blocks of the structure within one step: state at its start, free motion, answer to inputs, state at its end."""

from __future__ import annotations

from fricmb.integrate.collocation.moment_weights import free_weights, port_weights
from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.forces import Scratch, belt_velocity, gather, set_time
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.problem import STICK, Floats
from fricmb.integrate.step.exact_structure import RUNGS, Exact, rung_below
from fricmb.integrate.step.one_step_room import OneStep


@block
def exact_tables(one: OneStep, h: float, slot: int) -> None:
    """Fill a slot of the tables for the step h."""
    ex = one.exact
    modal = ex.modal == 1
    free_weights(ex, modal, h, ex.stiff_at, slot)
    port_weights(ex, modal, h, slot)


@kernel
def slot_of(one: OneStep, h: float) -> int:
    """Slot of the tables for h, filled if it was not; 0 for a step off the ladder."""
    ex = one.exact
    rung = rung_below(h)
    if ex.ladder[rung] != h:
        exact_tables(one, h, 0)
        one.counts[4] += 1
        return 0
    slot = ex.slots[rung]
    if slot < 0:
        count = ex.S.shape[0] - 1
        slot = 1 + ex.slots[RUNGS] % count
        ex.slots[RUNGS] += 1
        if ex.slots[RUNGS] > count:
            for r in range(RUNGS):
                if ex.slots[r] == slot:
                    ex.slots[r] = -1
        exact_tables(one, h, slot)
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
    modal = ex.modal == 1
    for j in range(ex.w2.shape[1]):
        u, w, e0, e1 = 0.0, 0.0, 0.0, 0.0
        first, behind = ex.moves[0, j], ex.moves[1, j]
        for i in range(first, behind):
            w += ex.start_1[j, i] * v[i]
            e1 += ex.force_1[j, i] * ex.f[i]
        if not modal:
            for i in range(first, behind):
                u += ex.start_0[j, i] * v[i]
                e0 += ex.force_0[j, i] * ex.f[i]
        w2 = ex.w2[0, j]
        d = ex.damp[0, j]
        ex.v0[j] = w + e0
        ex.a0[j] = e1 + d * e0 - w2 * u - d * (w + e0)
        ex.k0[j] = -w2 * (w + e0)


@kernel
def outputs_at_start(packed: Packed, s: Scratch, y: State, one: OneStep, h: float) -> None:
    """Outputs at the nodes if the structure stood still in q and kept its velocities, into ``xf``; signals into P."""
    ex = one.exact
    n = y.q.shape[0]
    m = y.g.shape[0]
    nu = s.ddu.shape[0]
    base = ex.b1.shape[0] - 2 * nu
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
            set_time(packed.signals, s, y.t + ex.tab.c[i] * h, n)
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
    tk = ex.tk
    n_s = ex.xf.shape[1]
    n_in = ex.b1.shape[0]
    modal = ex.modal == 1
    for o in range(ex.c1.shape[0]):
        for j in range(ex.w2.shape[1]):
            c1 = ex.c1[o, j]
            if c1 != 0.0:
                y = c1 * ex.a0[j]
                z = c1 * ex.k0[j]
                for i in range(n_s):
                    ex.xf[o, i] += y * ex.S[slot, j, i] + z * ex.IS[slot, j, i]
            c0 = ex.c0[o, j]
            if not modal and c0 != 0.0:
                for i in range(n_s):
                    t = ex.tab.c[i] * h
                    du = ex.v0[j] * t + ex.a0[j] * ex.IS[slot, j, i] + ex.k0[j] * ex.IIS[slot, j, i]
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
    n_in = ex.b1.shape[0]
    for o in range(ex.x.shape[0]):
        for i in range(n_s):
            value = ex.xf[o, i]
            for c in range(n_in):
                if ex.linked[o, c] != 0.0 and c < ex.unknown:
                    for x in range(n_s):
                        value += ex.tk[slot, n_in * o + c, i, x] * ex.P[c, x]
            ex.x[o, i] = value


@kernel
def end_blocks(ex: Exact, slot: int, h: float) -> None:
    """Gains of block states over the step, then of positions and velocities, into ``end``."""
    n_s = ex.xf.shape[1]
    last = n_s - 1
    modal = ex.modal == 1
    for j in range(ex.w2.shape[1]):
        du = ex.v0[j] * h + ex.a0[j] * ex.IS[slot, j, last] + ex.k0[j] * ex.IIS[slot, j, last]
        dv = ex.a0[j] * ex.S[slot, j, last] + ex.k0[j] * ex.IS[slot, j, last]
        w2 = ex.w2[0, j]
        for c in range(ex.b1.shape[0]):
            b1 = ex.b1[c, j]
            if b1 != 0.0:
                y = 0.0
                z = 0.0
                for x in range(n_s):
                    y += ex.Q2[slot, j, x] * ex.P[c, x]
                    z += ex.Q1[slot, j, x] * ex.P[c, x]
                du += b1 * y
                dv += b1 * z
            b0 = ex.b0[c, j]
            if not modal and b0 != 0.0:
                for x in range(n_s):
                    push = b0 * ex.P[c, x]
                    du += push * (h * ex.tab.A[last, x] - w2 * ex.Q3[slot, j, x])
                    dv -= push * w2 * ex.Q2[slot, j, x]
        ex.du[j] = du
        ex.dv[j] = dv
    for i in range(ex.end.shape[1]):
        dq = 0.0
        dv = 0.0
        for j in range(ex.moved_by[0, i], ex.moved_by[1, i]):
            dq += ex.q_u[i, j] * ex.du[j]
            dv += ex.v_v[i, j] * ex.dv[j]
            if not modal:
                dq += ex.q_v[i, j] * ex.dv[j]
                dv += ex.v_u[i, j] * ex.du[j]
        ex.end[0, i] = dq
        ex.end[1, i] = dv
