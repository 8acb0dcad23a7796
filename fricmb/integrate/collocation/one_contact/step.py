"""One slip step of a single contact: weights, directions at the nodes, error, end."""

from __future__ import annotations

import math

from fricmb.integrate.collocation.block_motion import two_sum
from fricmb.integrate.collocation.layout import (
    AT_BLOCKS,
    AT_LENGTH,
    AT_LOSS,
    AT_LOW,
    AT_TIME,
    B0,
    B1,
    C0,
    C1,
    CHANGE,
    DIRECTION,
    E1,
    FORCE,
    FREE,
    IIS,
    IS,
    LINES,
    LOSS,
    LOW_END,
    MINV,
    MODAL,
    MU_0_N,
    MW,
    N_BUILDS,
    N_ITERATIONS,
    N_PHASES,
    N_ROWS,
    N_STEPS,
    NODE,
    Q1,
    Q2,
    Q3,
    RATE,
    RELATIVE,
    ROWS,
    SCALE,
    TABLEAU,
    TAIL,
    TAIL_BEFORE,
    TIME,
    TIME_LOW,
    U_END,
    U_LOW,
    V_END,
    VECTORS,
    W2,
    WEIGHT,
    A,
    G,
    K,
    N,
    S,
    U,
    V,
)  # fmt: skip
from fricmb.integrate.collocation.moment_weights import free_weights, port_weights
from fricmb.integrate.collocation.nodes import RUNGS
from fricmb.integrate.collocation.one_contact.phase import contact_acceleration
from fricmb.integrate.collocation.one_contact.room import Run
from fricmb.integrate.collocation.one_contact.slip_directions import relative_velocity, slip_directions
from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.lanes import LANES, all_lanes, lanes, set_lanes, total
from fricmb.integrate.problem import SLIP, Ints


@block
def transfer_weights(run: Run, h: float, slot: int, stiff: float, address: Ints) -> None:
    """Fill a slot of the tables."""
    free_weights(run, 0, run.flags[MODAL] == 1, h, stiff, slot)
    port_weights(run, 0, run.flags[MODAL] == 1, h, 0)
    # column by column, so that all nodes are taken at once
    for pair in range(run.tk.shape[1]):
        for l in range(run.tk.shape[2]):
            for i in range(run.tk.shape[2]):
                run.answers[slot, pair, l, i] = run.tk[0, pair, i, l]


@kernel
def on_ladder(run: Run, rung: int, stiff: float) -> int:
    """Slot of a rung, filled if it was not."""
    slot = run.slots[rung]
    if slot < 0:
        count = run.tb.shape[0] - 1
        slot = 1 + run.slots[RUNGS + 1] % count
        run.slots[RUNGS + 1] += 1
        if run.slots[RUNGS + 1] > count:
            for r in range(RUNGS + 1):
                if run.slots[r] == slot:
                    run.slots[r] = -1
        transfer_weights(run, run.ladder[rung], slot, stiff, run.places)
        run.slots[rung] = slot
        run.si[N_BUILDS] += 1
    return int(slot)


@kernel
def free_answer(run: Run, slot: int, h: float) -> None:
    """Relative velocity at the nodes without contact force."""
    bx = run.bx
    tb = run.tb
    nx = run.nx
    m = run.flags[ROWS]
    s = run.basis.shape[0]
    modal = run.flags[MODAL] == 1
    for a in range(m):
        for at in range(0, nx.shape[2], LANES):
            free = all_lanes(run.sm[G, a])
            for j in range(run.blk.shape[2]):
                c1 = run.co[C1, a, j]
                if c1 != 0.0:
                    free = free + c1 * bx[A, j] * lanes(tb[slot, S, j], at) + c1 * bx[K, j] * lanes(tb[slot, IS, j], at)
            set_lanes(nx[FREE, a], at, free)
        for j in range(run.blk.shape[2]):
            c1 = run.co[C1, a, j]
            if not modal:
                for i in range(s):
                    t = run.nd[VECTORS, NODE, i] * h
                    du = bx[V, j] * t + bx[A, j] * tb[slot, IS, j, i] + bx[K, j] * tb[slot, IIS, j, i]
                    nx[FREE, a, i] += run.co[C0, a, j] * du - c1 * bx[E1, j] * t


@block
def solve_slip(run: Run, slot: int, h: float, tol: float, address: Ints) -> bool:
    """Solve a slip step from the directions in n: directions and g at the nodes."""
    wk = run.wk
    m = run.flags[ROWS]
    free_answer(run, slot, h)
    if m == 1:
        relative_velocity(run, slot, 1)
        return True
    enough = min(
        1e-6, 0.1 * tol / max(1e-300, wk[LINES, CHANGE, 0], wk[LINES, CHANGE, 1]) / (run.lim[MU_0_N] * h + 1e-300),
    )  # fmt: skip
    count = slip_directions(run, slot, max(enough, 1e-28))
    run.si[N_ITERATIONS] += max(count, 1)
    return count > 0


@kernel
def end_state(run: Run, slot: int, h: float) -> None:
    """Block states at the end of a slip step into u_end, low_end, v_end."""
    bx = run.bx
    tb = run.tb
    nx = run.nx
    m = run.flags[ROWS]
    s = run.basis.shape[0]
    end = s - 1
    modal = run.flags[MODAL] == 1
    muN = run.lim[MU_0_N]
    for j in range(run.blk.shape[2]):
        du = bx[V, j] * h + bx[A, j] * tb[slot, IS, j, end] + bx[K, j] * tb[slot, IIS, j, end]
        dv = bx[A, j] * tb[slot, S, j, end] + bx[K, j] * tb[slot, IS, j, end]
        for a in range(m):
            b1 = -muN * run.ci[B1, a, j]
            if b1 != 0.0:
                y, z = all_lanes(0.0), all_lanes(0.0)
                for at in range(0, nx.shape[2], LANES):
                    d = lanes(nx[DIRECTION, a], at)
                    y, z = y + d * lanes(tb[slot, Q2, j], at), z + d * lanes(tb[slot, Q1, j], at)
                du += b1 * total(y)
                dv += b1 * total(z)
            if not modal:
                b0 = -muN * run.ci[B0, a, j]
                w2 = run.blk[0, W2, j]
                for l in range(s):
                    push = b0 * nx[DIRECTION, a, l]
                    du += push * (h * run.nd[TABLEAU, end, l] - w2 * tb[slot, Q3, j, l])
                    dv -= push * w2 * tb[slot, Q2, j, l]
        bx[U_END, j], bx[LOW_END, j] = two_sum(bx[U, j], bx[U_LOW, j], du)
        bx[V_END, j] = bx[V, j] + dv


@kernel
def weigh(run: Run, h: float) -> None:
    """Largest change of a velocity per impulse on each row, each by its own scale, into CHANGE."""
    top = 0.0
    n = run.sd.shape[1]
    for i in range(n):
        top = max(top, run.sd[SCALE, i])
    for a in range(run.flags[ROWS]):
        largest = 0.0
        for i in range(n):
            size = abs(run.row[MW, a, i])
            if size > 0.0:
                scale = max(run.sd[SCALE, i], abs(run.bx[RATE, i]) * h, 1e-10 * top, 1e-300)
                largest = max(largest, size / scale)
        run.wk[LINES, CHANGE, a] = largest


@kernel
def step_error(run: Run, h: float, tol: float) -> float:
    """Estimated error of a slip step in units of the tolerance, the worst over signals by their own scales."""
    m = run.flags[ROWS]
    s = run.basis.shape[0]
    muN = run.lim[MU_0_N]
    worst = 0.0
    for a in range(m):
        last = 0.0
        before = 0.0
        for l in range(s):
            last += run.nd[VECTORS, TAIL, l] * run.nx[DIRECTION, a, l]
            before += run.nd[VECTORS, TAIL_BEFORE, l] * run.nx[DIRECTION, a, l]
        size = max(abs(last), 0.2 * abs(before)) - 1e-15
        if size > 0.0:
            worst = max(worst, size * muN * h * run.wk[LINES, CHANGE, a] / tol)
    return worst


@kernel
def rates(run: Run) -> None:
    """Accelerations of the dofs in slip into rate: the scale of what a short step changes."""
    n = run.sd.shape[1]
    contact_acceleration(run)
    for i in range(n):
        value = 0.0
        for j in range(n):
            value += run.dof[MINV, i, j] * run.bx[FORCE, j]
        for a in range(run.flags[ROWS]):
            value -= run.row[MW, a, i] * run.lim[MU_0_N] * run.sm[N, a]
        run.bx[RATE, i] = value


@kernel
def keep_slip(run: Run, h: float) -> float:
    """Write the row of a slip step; returns its friction loss."""
    n = run.sd.shape[1]
    m = run.flags[ROWS]
    s = run.basis.shape[0]
    at_row = run.si[N_ROWS]
    run.kinds[at_row, 0] = SLIP
    run.kinds[at_row, 1] = run.si[N_PHASES] - 1
    run.steps[at_row, AT_TIME] = run.sx[TIME]
    run.steps[at_row, AT_LOW] = run.sx[TIME_LOW]
    run.steps[at_row, AT_LENGTH] = h
    run.steps[at_row, AT_LOSS] = run.sx[LOSS]
    for j in range(n):
        run.steps[at_row, AT_BLOCKS + j] = run.bx[U, j] + run.bx[U_LOW, j]
        run.steps[at_row, AT_BLOCKS + n + j] = run.bx[V, j]
        run.steps[at_row, AT_BLOCKS + 2 * n + j] = run.bx[A, j]
    at = AT_BLOCKS + 3 * n
    for a in range(m):
        for l in range(s):
            run.steps[at_row, at + a * s + l] = -run.lim[MU_0_N] * run.nx[DIRECTION, a, l]
    at += m * s
    power = 0.0
    for a in range(m):
        power += run.sm[G, a] * run.sm[G, a]
    run.steps[at_row, at] = run.lim[MU_0_N] * math.sqrt(power)
    loss = 0.0
    for l in range(s):
        power = 0.0
        for a in range(m):
            power += run.lim[MU_0_N] * run.nx[DIRECTION, a, l] * run.nx[RELATIVE, a, l]
        run.steps[at_row, at + 1 + l] = power
        loss += h * run.nd[VECTORS, WEIGHT, l] * power
    run.si[N_ROWS] += 1
    run.si[N_STEPS] += 1
    return loss


@kernel
def commit(run: Run, h: float, loss: float) -> None:
    """Take over the end of a slip step."""
    for j in range(run.blk.shape[2]):
        run.bx[U, j] = run.bx[U_END, j]
        run.bx[U_LOW, j] = run.bx[LOW_END, j]
        run.bx[V, j] = run.bx[V_END, j]
    end = run.basis.shape[0] - 1
    for a in range(run.flags[ROWS]):
        run.sm[G, a] = run.nx[RELATIVE, a, end]
        run.sm[N, a] = run.nx[DIRECTION, a, end]
    run.sx[TIME], run.sx[TIME_LOW] = two_sum(run.sx[TIME], run.sx[TIME_LOW], h)
    run.sx[LOSS] += loss
