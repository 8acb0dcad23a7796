"""Between phases: the state by dofs, and what a contact at rest relative to its partner does next."""

from __future__ import annotations

import math

from fricmb.integrate.collocation.block_motion import two_sum
from fricmb.integrate.collocation.one_contact.room import AT_BLOCKS, AT_LENGTH, AT_LOSS, AT_LOW, AT_TIME, Run
from fricmb.integrate.collocation.one_contact.slip_directions import start_direction
from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import SLIP, STICK


@block
def begin_phase(run: Run, z: int, b: int) -> None:
    """Block states of structure z at the present state, its loads, and a row of the phase."""
    n = run.pos.shape[0]
    t = run.time
    for i in range(n):
        value = run.load_0[i] + run.load_1[i] * t + run.load_1[i] * run.time_low
        slope = run.load_1[i]
        for j in range(n):
            value -= run.stiff[i, j] * (run.pos[j] + run.pos_low[j])
            if z == 1:
                value -= run.visc[i, j] * run.stuck_v[j]
                slope -= run.stiff[i, j] * run.stuck_v[j]
        run.force[i] = value
        run.rate[i] = slope
    phase = run.used[1]
    for i in range(n):
        run.phases[phase, i] = run.pos[i]
        run.phases[phase, n + i] = run.pos_low[i]
        run.phases[phase, 2 * n + 2 + i] = 0.0
        run.phases[phase, 3 * n + 2 + i] = 0.0
        run.phases[phase, 4 * n + 2 + i] = 0.0
    run.phases[phase, 2 * n] = t
    run.phases[phase, 2 * n + 1] = run.time_low
    modal = run.modal[z] == 1
    for j in range(b):
        u = 0.0
        v = 0.0
        load = 0.0
        slope = 0.0
        e0 = 0.0
        e1 = 0.0
        for i in range(n):
            v += run.start_1[z, j, i] * run.vel[i]
            load += run.force_1[z, j, i] * run.force[i]
            slope += run.force_1[z, j, i] * run.rate[i]
        if not modal:
            for i in range(n):
                u += run.start_0[z, j, i] * run.vel[i]
                e0 += run.force_0[z, j, i] * run.force[i]
                e1 += run.force_0[z, j, i] * run.rate[i]
        run.u[j] = u
        run.u_low[j] = 0.0
        run.v[j] = v + e0
        run.e0[j] = e0
        run.e1[j] = e1
        run.load[j] = load + run.damp[z, j] * e0 + e1
        run.slope[j] = slope + run.damp[z, j] * e1
        run.phases[phase, 2 * n + 2 + j] = run.slope[j]
        run.phases[phase, 3 * n + 2 + j] = e0
        run.phases[phase, 4 * n + 2 + j] = e1
    run.used[1] += 1


@kernel
def accelerations(run: Run, z: int, b: int, since: float) -> None:
    """Accelerations ``a`` of all blocks and their rates ``k``, a time ``since`` after the start of the phase."""
    for j in range(b):
        u = run.u[j] + run.u_low[j]
        run.a[j] = run.load[j] + run.slope[j] * since - run.w2[z, j] * u - run.damp[z, j] * run.v[j]
        run.k[j] = run.slope[j] - run.w2[z, j] * run.v[j]


@kernel
def keep_row(run: Run, mode: int, b: int, h: float) -> int:
    """Begin the row of a step h with the state of its b blocks; returns its number."""
    row, n = run.used[0], run.pos.shape[0]
    run.kinds[row, 0] = mode
    run.kinds[row, 1] = run.used[1] - 1
    step = run.steps[row]
    step[AT_TIME], step[AT_LOW], step[AT_LENGTH], step[AT_LOSS] = run.time, run.time_low, h, run.loss
    for j in range(b):
        step[AT_BLOCKS + j] = run.u[j] + run.u_low[j]
        step[AT_BLOCKS + n + j] = run.v[j]
        step[AT_BLOCKS + 2 * n + j] = run.a[j]
    run.used[0] += 1
    run.counts[0] += 1
    return int(row)


@kernel
def to_dofs(run: Run, z: int, b: int, since: float) -> None:
    """Positions and velocities from the block states, ``since`` after the start of the phase."""
    n = run.pos.shape[0]
    modal = run.modal[z] == 1
    for i in range(n):
        move = 0.0
        small = 0.0
        velocity = 0.0
        if z == 1:
            velocity = run.stuck_v[i]
            move = velocity * since
        for j in range(b):
            move += run.q_u[z, i, j] * run.u[j]
            small += run.q_u[z, i, j] * run.u_low[j]
            velocity += run.v_v[z, i, j] * (run.v[j] - run.e0[j] - run.e1[j] * since)
        if not modal:
            for j in range(b):
                move += run.q_v[z, i, j] * (run.v[j] - run.e0[j] - run.e1[j] * since)
                velocity += run.v_u[z, i, j] * (run.u[j] + run.u_low[j])
        run.pos[i], run.pos_low[i] = two_sum(run.pos[i], run.pos_low[i] + small, move)
        run.vel[i] = velocity
        run.scale[i] = max(run.scale[i], abs(velocity))


@kernel
def contact_acceleration(run: Run) -> None:
    """Relative acceleration without friction into ``out[0]``, the force that would hold the contact into ``out[1]``."""
    n = run.pos.shape[0]
    m = run.belt.shape[0]
    for i in range(n):
        value = run.load_0[i] + run.load_1[i] * run.time
        for j in range(n):
            value -= run.stiff[i, j] * (run.pos[j] + run.pos_low[j]) + run.visc[i, j] * run.vel[j]
        run.force[i] = value
    for a in range(m):
        value = 0.0
        for i in range(n):
            value += run.mw[a, i] * run.force[i]
        run.out[0, a] = value
    for a in range(m):
        value = 0.0
        for b in range(m):
            value -= run.D_inv[a, b] * run.out[0, b]
        run.out[1, a] = value


@kernel
def project(run: Run) -> None:
    """Velocities onto g = 0 with the momentum of the contact's own impulse."""
    m = run.belt.shape[0]
    n = run.pos.shape[0]
    for a in range(m):
        run.g[a] = -run.belt[a]
        for i in range(n):
            run.g[a] += run.wt[a, i] * run.vel[i]
    for i in range(n):
        for a in range(m):
            for b in range(m):
                run.vel[i] -= run.mw[a, i] * run.D_inv[a, b] * run.g[b]
    for a in range(m):
        run.g[a] = 0.0


@kernel
def settle(run: Run) -> bool:
    """At g = 0: stick if the cone can hold the contact, else slip in the direction in which it starts."""
    contact_acceleration(run)
    m = run.belt.shape[0]
    size = 0.0
    for a in range(m):
        size += run.out[1, a] * run.out[1, a]
    if math.sqrt(size) <= run.mu_s_N * (1.0 + 1e-12):
        run.mode = STICK
        return True
    run.mode = SLIP
    start_direction(run)
    return False
