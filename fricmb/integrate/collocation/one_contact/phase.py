"""Between phases: the state by dofs, and what a contact at rest relative to its partner does next."""

from __future__ import annotations

import math

from fricmb.integrate.collocation.block_motion import two_sum
from fricmb.integrate.collocation.layout import (
    BELT,
    D_INV,
    DAMP,
    E0,
    E1,
    FORCE,
    FORCE_0,
    FORCE_1,
    LINES,
    LOAD,
    LOAD_0,
    LOAD_1,
    MODAL,
    MODE,
    MU_S_N,
    MW,
    N_PHASES,
    OUT,
    POS,
    POS_LOW,
    Q_U,
    Q_V,
    RATE,
    ROWS,
    SCALE,
    SLOPE,
    START_0,
    START_1,
    STIFF,
    STUCK_V,
    TIME,
    TIME_LOW,
    U_LOW,
    V_U,
    V_V,
    VEL,
    VISC,
    W2,
    WT,
    A,
    G,
    K,
    U,
    V,
)  # fmt: skip
from fricmb.integrate.collocation.one_contact.room import Run
from fricmb.integrate.collocation.one_contact.slip_directions import start_direction
from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import SLIP, STICK, Ints


@block
def begin_phase(run: Run, z: int, b: int, address: Ints) -> None:
    """Block states of structure z at the present state, its loads, and a row of the phase."""
    n = run.sd.shape[1]
    t = run.sx[TIME]
    for i in range(n):
        value = run.vec[LOAD_0, i] + run.vec[LOAD_1, i] * t + run.vec[LOAD_1, i] * run.sx[TIME_LOW]
        slope = run.vec[LOAD_1, i]
        for j in range(n):
            value -= run.dof[STIFF, i, j] * (run.sd[POS, j] + run.sd[POS_LOW, j])
            if z == 1:
                value -= run.dof[VISC, i, j] * run.vec[STUCK_V, j]
                slope -= run.dof[STIFF, i, j] * run.vec[STUCK_V, j]
        run.bx[FORCE, i] = value
        run.bx[RATE, i] = slope
    phase = run.si[N_PHASES]
    for i in range(n):
        run.phases[phase, i] = run.sd[POS, i]
        run.phases[phase, n + i] = run.sd[POS_LOW, i]
        run.phases[phase, 2 * n + 2 + i] = 0.0
        run.phases[phase, 3 * n + 2 + i] = 0.0
        run.phases[phase, 4 * n + 2 + i] = 0.0
    run.phases[phase, 2 * n] = t
    run.phases[phase, 2 * n + 1] = run.sx[TIME_LOW]
    modal = run.flags[MODAL + z] == 1
    for j in range(b):
        u = 0.0
        v = 0.0
        load = 0.0
        slope = 0.0
        e0 = 0.0
        e1 = 0.0
        for i in range(n):
            v += run.mat[z, START_1, j, i] * run.sd[VEL, i]
            load += run.mat[z, FORCE_1, j, i] * run.bx[FORCE, i]
            slope += run.mat[z, FORCE_1, j, i] * run.bx[RATE, i]
        if not modal:
            for i in range(n):
                u += run.mat[z, START_0, j, i] * run.sd[VEL, i]
                e0 += run.mat[z, FORCE_0, j, i] * run.bx[FORCE, i]
                e1 += run.mat[z, FORCE_0, j, i] * run.bx[RATE, i]
        run.bx[U, j] = u
        run.bx[U_LOW, j] = 0.0
        run.bx[V, j] = v + e0
        run.bx[E0, j] = e0
        run.bx[E1, j] = e1
        run.bx[LOAD, j] = load + run.blk[z, DAMP, j] * e0 + e1
        run.bx[SLOPE, j] = slope + run.blk[z, DAMP, j] * e1
        run.phases[phase, 2 * n + 2 + j] = run.bx[SLOPE, j]
        run.phases[phase, 3 * n + 2 + j] = e0
        run.phases[phase, 4 * n + 2 + j] = e1
    run.si[N_PHASES] += 1


@kernel
def accelerations(run: Run, z: int, b: int, since: float) -> None:
    """Put A and K of every block, ``since`` after the start of the phase."""
    bx = run.bx
    blk = run.blk
    for j in range(b):
        u = bx[U, j] + bx[U_LOW, j]
        bx[A, j] = bx[LOAD, j] + bx[SLOPE, j] * since - blk[z, W2, j] * u - blk[z, DAMP, j] * bx[V, j]
        bx[K, j] = bx[SLOPE, j] - blk[z, W2, j] * bx[V, j]


@kernel
def to_dofs(run: Run, z: int, b: int, since: float) -> None:
    """Positions and velocities from the block states, ``since`` after the start of the phase."""
    n = run.sd.shape[1]
    modal = run.flags[MODAL + z] == 1
    for i in range(n):
        move = 0.0
        small = 0.0
        velocity = 0.0
        if z == 1:
            velocity = run.vec[STUCK_V, i]
            move = velocity * since
        for j in range(b):
            move += run.mat[z, Q_U, i, j] * run.bx[U, j]
            small += run.mat[z, Q_U, i, j] * run.bx[U_LOW, j]
            velocity += run.mat[z, V_V, i, j] * (run.bx[V, j] - run.bx[E0, j] - run.bx[E1, j] * since)
        if not modal:
            for j in range(b):
                move += run.mat[z, Q_V, i, j] * (run.bx[V, j] - run.bx[E0, j] - run.bx[E1, j] * since)
                velocity += run.mat[z, V_U, i, j] * (run.bx[U, j] + run.bx[U_LOW, j])
        run.sd[POS, i], run.sd[POS_LOW, i] = two_sum(run.sd[POS, i], run.sd[POS_LOW, i] + small, move)
        run.sd[VEL, i] = velocity
        run.sd[SCALE, i] = max(run.sd[SCALE, i], abs(velocity))


@kernel
def contact_acceleration(run: Run) -> None:
    """Relative acceleration without friction into out[0], the force that would hold the contact into out[1]."""
    n = run.sd.shape[1]
    m = run.flags[ROWS]
    for i in range(n):
        value = run.vec[LOAD_0, i] + run.vec[LOAD_1, i] * run.sx[TIME]
        for j in range(n):
            value -= run.dof[STIFF, i, j] * (run.sd[POS, j] + run.sd[POS_LOW, j]) + run.dof[VISC, i, j] * run.sd[VEL, j]
        run.bx[FORCE, i] = value
    for a in range(m):
        value = 0.0
        for i in range(n):
            value += run.row[MW, a, i] * run.bx[FORCE, i]
        run.wk[LINES, OUT, a] = value
    for a in range(m):
        value = 0.0
        for b in range(m):
            value -= run.con[D_INV, a, b] * run.wk[LINES, OUT, b]
        run.wk[LINES, OUT + 1, a] = value


@kernel
def project(run: Run) -> None:
    """Velocities onto g = 0 with the momentum of the contact's own impulse."""
    m = run.flags[ROWS]
    n = run.sd.shape[1]
    for a in range(m):
        run.sm[G, a] = -run.lim[BELT + a]
        for i in range(n):
            run.sm[G, a] += run.row[WT, a, i] * run.sd[VEL, i]
    for i in range(n):
        for a in range(m):
            for b in range(m):
                run.sd[VEL, i] -= run.row[MW, a, i] * run.con[D_INV, a, b] * run.sm[G, b]
    for a in range(m):
        run.sm[G, a] = 0.0


@kernel
def settle(run: Run) -> bool:
    """At g = 0: stick if the cone can hold the contact, else slip in the direction in which it starts."""
    contact_acceleration(run)
    m = run.flags[ROWS]
    size = 0.0
    for a in range(m):
        size += run.wk[LINES, OUT + 1, a] * run.wk[LINES, OUT + 1, a]
    if math.sqrt(size) <= run.lim[MU_S_N] * (1.0 + 1e-12):
        run.si[MODE] = STICK
        return True
    run.si[MODE] = SLIP
    start_direction(run)
    return False
