"""One step of any ports on an exact structure: guesses, the equations of the ports, the state at its end."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.collocation.blocks_in_step import (
    end_blocks,
    free_outputs,
    load_at_start,
    outputs_at_start,
    slot_of,
    start_blocks,
)
from fricmb.integrate.collocation.held_rows import give_held_forces, hold_rows, pattern_of, place_of
from fricmb.integrate.collocation.nonlinear_ports import exact_ports
from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.forces import Scratch, set_instant
from fricmb.integrate.model.law_values import point_along
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.problem import LAW_CONSTANT, LAW_SMOOTH, SLIP, STICK
from fricmb.integrate.step.contact_newton import solve_ports
from fricmb.integrate.step.one_step import newton_tolerances
from fricmb.integrate.step.one_step_room import Accuracy, OneStep, widest
from fricmb.integrate.step.stage_predictor import contacts_from_start
from fricmb.integrate.step.step_control import or_reached


@kernel
def held_at_rest(packed: Packed, y: State, one: OneStep, i: int) -> float:
    """Acceleration that the friction of contacts at rest can take from velocity i."""
    push = 0.0
    for k in range(y.mode.shape[0]):
        if y.mode[k] == STICK:
            for a in range(packed.ports.row[k], packed.ports.row[k + 1]):
                push += abs(one.exact.MB[a, i]) * abs(packed.ports.mu_s[k]) * y.N[k]
    return push


@kernel
def begins_within(y: State, one: OneStep, acc: Accuracy, h: float) -> bool:
    """Whether a velocity reached in the step just solved is far above all that was known of it before."""
    found = False
    for i in range(y.q.shape[0]):
        known = max(acc.v[i], abs(y.v[i]), acc.floor_v[i], h * abs(y.a[i]))
        found = found or or_reached(known, y.v[i] + one.exact.end[1, i]) > known
    return found


@kernel
def weigh_inputs(packed: Packed, y: State, one: OneStep, acc: Accuracy, h: float, solved: bool) -> None:
    """What a unit of every input, held for the step, changes in velocities, each by its own scale.

    What has never moved, as friction holds it, has no scale but what friction could do: its force is resolved to a part
    of the limit.  So has what moved by the round-off of others, as when one of them comes to rest.  ``solved``: what
    has not moved and is taken along under a smooth law is measured by what it reaches in the step.
    """
    ex = one.exact
    top = widest(acc.v)
    for i in range(y.q.shape[0]):
        scale = max(acc.v[i], abs(y.v[i]), acc.floor_v[i])
        if scale <= max(2.0 * acc.floor_v[i], 1e-10 * top):
            scale = max(scale, h * held_at_rest(packed, y, one, i))
        if solved:
            scale = or_reached(scale, y.v[i] + ex.end[1, i])
        one.scale[i] = scale
    for c in range(ex.b1.shape[0]):
        worst = 0.0
        for i in range(y.q.shape[0]):
            size = abs(ex.MB[c, i])
            if size > 0.0:
                scale = max(one.scale[i], abs(y.a[i]) * h, 1e-10 * top, 1e-290)
                worst = max(worst, size / scale)
        ex.weight[c] = h * worst


@kernel
def guess_ports(packed: Packed, y: State, one: OneStep, h: float) -> None:
    """First values of the port unknowns: those at the start of the step."""
    w, st, ex = one.w, one.st, one.exact
    n_s = st.t.shape[0]
    for a in range(y.z.shape[0]):
        w.psi_z[a] = y.z[a]
    for i in range(n_s):
        st.t[i] = y.t + ex.tab.c[i] * h
        for j in range(n_s):
            st.hA[i, j] = h * ex.tab.A[i, j]
        contacts_from_start(packed, y, w, i)
        for k in range(y.mode.shape[0]):
            one.N[i, k] = y.N[k]


@kernel
def guess_forces(packed: Packed, y: State, one: OneStep, ratio: float) -> None:
    """First forces and directions from the polynomials of a longer step from the same state, 1/``ratio`` as long."""
    w, ex = one.w, one.exact
    n_s = w.F.shape[0]
    for k in range(y.mode.shape[0]):
        row0, end = packed.ports.row[k], packed.ports.row[k + 1]
        turns = y.mode[k] == SLIP and packed.ports.law[k] != LAW_SMOOTH and end - row0 == 2
        if not turns and y.mode[k] != STICK:
            continue
        for a in range(row0, end):
            for i in range(n_s):
                w.F[i, a] = 0.0
            for r in range(n_s - 1, -1, -1):
                c = 0.0
                for x in range(n_s):
                    c += ex.monomial[r, x] * ex.P[a, x]
                for i in range(n_s):
                    w.F[i, a] = w.F[i, a] * (ratio * ex.tab.c[i]) + c
        for i in range(n_s if turns else 0):
            point_along(packed.ports.row, k, w.F[i], -1.0, w.n[i])


@kernel
def guess_velocities(packed: Packed, y: State, one: OneStep) -> None:
    """Relative velocities under the forces at the start, where laws ask for them."""
    w = one.w
    m = y.g.shape[0]
    for k in range(y.mode.shape[0]):
        if packed.ports.law[k] == LAW_CONSTANT:
            continue
        for i in range(w.F.shape[0]):
            w.r[i, k] = 0.0
            for a in range(packed.ports.row[k], packed.ports.row[k + 1]):
                value = w.gb[i, a]
                for j in range(w.F.shape[0]):
                    for c in range(m):
                        value += w.G[i * m + a, j * m + c] * w.F[j, c]
                if packed.ports.law[k] != LAW_SMOOTH:
                    w.r[i, k] += w.n[i, a] * value


@kernel
def solve_held(packed: Packed, s: Scratch, y: State, one: OneStep, slot: int, h: float) -> int:
    """Solve the contacts' equations with what sticks eliminated beforehand; its iterations, -1, or 0 where it is not.

    A step off the ladder is one of a kind, and not worth it.
    """
    w, ex = one.w, one.exact
    pattern = pattern_of(packed, y.mode) if slot > 0 else 0
    place = place_of(packed, one, y.mode, pattern, h) if pattern > 0 else -1
    if place < 0:
        return 0
    first, free = np.empty(w.dF.shape[0]), np.empty(y.mode.shape[0], np.int8)
    hold_rows(ex, w, place, y.mode, free, first)
    found = solve_ports(packed.ports, packed.laws, s, w, one.st.hA, free, one.tol)
    give_held_forces(packed, ex, w, place, y.mode, first)
    for k in range(y.mode.shape[0]):
        if y.mode[k] == STICK:
            for i in range(w.N.shape[0]):
                w.N[i, k] = y.N[k]
    return max(found, 1) if found >= 0 else -1


@kernel
def solve_linear(packed: Packed, s: Scratch, y: State, one: OneStep, slot: int, h: float) -> bool:
    """The equations of contacts alone, on a structure that answers linearly."""
    w, ex = one.w, one.exact
    m = y.g.shape[0]
    n_in = ex.b1.shape[0]
    n_s = w.F.shape[0]
    for a in range(m):
        for i in range(n_s):
            line = w.G[i * m + a]
            for c in range(m):
                gains = ex.tk[slot, n_in * a + c, i]
                for j in range(n_s):
                    line[j * m + c] = gains[j]
        for i in range(n_s):
            w.gb[i, a] = ex.xf[a, i]
            w.Fo[i, a] = 0.0
    guess_velocities(packed, y, one)
    found = solve_held(packed, s, y, one, slot, h)
    if found == 0:
        found = solve_ports(packed.ports, packed.laws, s, w, one.st.hA, y.mode, one.tol)
    if found < 0:
        return False
    for a in range(m):
        for i in range(n_s):
            ex.P[a, i] = w.F[i, a]
    return True


@block
def exact_attempt(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, h: float) -> bool:
    """Solve a step h from y on an exact structure (stands in for :func:`attempt`).  False without convergence."""
    ex = one.exact
    set_instant(packed.signals, s, y.t, y.q, y.v)
    load_at_start(packed, s, y.q, ex.f)
    start_blocks(ex, y.v)
    slot = slot_of(one, h)
    ex.length = h
    outputs_at_start(packed, s, y, one, h)
    free_outputs(ex, slot, h, ex.unknown)
    guess_ports(packed, y, one, h)
    if one.last_t == y.t and h <= one.last_h:
        guess_forces(packed, y, one, h / one.last_h)
    weigh_inputs(packed, y, one, acc, h, False)
    newton_tolerances(packed, acc, h, y, one.tol, one.scale, 1e-3)
    one.counts[2] += 1
    if ex.c1.shape[0] > y.g.shape[0]:
        solved = exact_ports(packed, s, y, one, acc, slot)
    else:
        solved = solve_linear(packed, s, y, one, slot, h)
    one.last_t = y.t
    one.last_h = h if solved else 0.0
    if not solved:
        return False
    end_blocks(ex, slot, h)
    largest = 0.0
    for i in range(y.q.shape[0]):
        one.st.V[0, i] = y.v[i] + ex.end[1, i]  # forces are weighed by what the step reaches
        largest += abs(ex.end[0, i]) + abs(ex.end[1, i])
    if begins_within(y, one, acc, h):
        weigh_inputs(packed, y, one, acc, h, True)
    return largest < 1e290
