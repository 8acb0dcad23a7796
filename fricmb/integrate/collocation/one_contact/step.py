"""One slip step of a single contact: weights, directions at the nodes, error, end."""

from __future__ import annotations

import math

from fricmb.integrate.collocation.block_motion import two_sum
from fricmb.integrate.collocation.moment_weights import free_weights, port_weights
from fricmb.integrate.collocation.nodes import RUNGS
from fricmb.integrate.collocation.one_contact.phase import contact_acceleration, keep_row
from fricmb.integrate.collocation.one_contact.room import AT_BLOCKS, Run
from fricmb.integrate.collocation.one_contact.slip_directions import relative_velocity, slip_directions
from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.lanes import LANES, all_lanes, lanes, set_lanes, total
from fricmb.integrate.problem import SLIP


@block
def transfer_weights(run: Run, h: float, slot: int, stiff: float) -> None:
    """Fill a slot of the tables."""
    free_weights(run, run.modal[0] == 1, h, stiff, slot)
    port_weights(run, run.modal[0] == 1, h, 0)
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
        count = run.S.shape[0] - 1
        slot = 1 + run.slots[RUNGS + 1] % count
        run.slots[RUNGS + 1] += 1
        if run.slots[RUNGS + 1] > count:
            for r in range(RUNGS + 1):
                if run.slots[r] == slot:
                    run.slots[r] = -1
        transfer_weights(run, run.ladder[rung], slot, stiff)
        run.slots[rung] = slot
        run.counts[4] += 1
    return int(slot)


@kernel
def free_answer(run: Run, slot: int, h: float) -> None:
    """Relative velocity at the nodes without contact force."""
    m = run.belt.shape[0]
    s = run.basis.shape[0]
    modal = run.modal[0] == 1
    for a in range(m):
        for at in range(0, run.free.shape[1], LANES):
            free = all_lanes(run.g[a])
            for j in range(run.w2.shape[1]):
                c1 = run.c1[a, j]
                if c1 != 0.0:
                    free = free + c1 * run.a[j] * lanes(run.S[slot, j], at) + c1 * run.k[j] * lanes(run.IS[slot, j], at)
            set_lanes(run.free[a], at, free)
        for j in range(run.w2.shape[1]):
            c1 = run.c1[a, j]
            if not modal:
                for i in range(s):
                    t = run.tab.c[i] * h
                    du = run.v[j] * t + run.a[j] * run.IS[slot, j, i] + run.k[j] * run.IIS[slot, j, i]
                    run.free[a, i] += run.c0[a, j] * du - c1 * run.e1[j] * t


@block
def solve_slip(run: Run, slot: int, h: float, tol: float) -> bool:
    """Solve a slip step from the directions that stand at the nodes: directions and relative velocities there."""
    m = run.belt.shape[0]
    free_answer(run, slot, h)
    if m == 1:
        relative_velocity(run, slot, 1)
        return True
    enough = min(1e-6, 0.1 * tol / max(1e-300, run.change[0], run.change[1]) / (run.mu_0_N * h + 1e-300))
    count = slip_directions(run, slot, max(enough, 1e-28))
    run.counts[2] += max(count, 1)
    run.counts[3] += max(count, 1)
    return count > 0


@kernel
def end_state(run: Run, slot: int, h: float) -> None:
    """Block states at the end of a slip step into ``u_end``, ``low_end``, ``v_end``."""
    m = run.belt.shape[0]
    s = run.basis.shape[0]
    end = s - 1
    modal = run.modal[0] == 1
    muN = run.mu_0_N
    for j in range(run.w2.shape[1]):
        du = run.v[j] * h + run.a[j] * run.IS[slot, j, end] + run.k[j] * run.IIS[slot, j, end]
        dv = run.a[j] * run.S[slot, j, end] + run.k[j] * run.IS[slot, j, end]
        for a in range(m):
            b1 = -muN * run.b1[a, j]
            if b1 != 0.0:
                y, z = all_lanes(0.0), all_lanes(0.0)
                for at in range(0, run.free.shape[1], LANES):
                    d = lanes(run.direction[a], at)
                    y, z = y + d * lanes(run.Q2[slot, j], at), z + d * lanes(run.Q1[slot, j], at)
                du += b1 * total(y)
                dv += b1 * total(z)
            if not modal:
                b0 = -muN * run.b0[a, j]
                w2 = run.w2[0, j]
                for l in range(s):
                    push = b0 * run.direction[a, l]
                    du += push * (h * run.tab.A[end, l] - w2 * run.Q3[slot, j, l])
                    dv -= push * w2 * run.Q2[slot, j, l]
        run.u_end[j], run.low_end[j] = two_sum(run.u[j], run.u_low[j], du)
        run.v_end[j] = run.v[j] + dv


@kernel
def weigh(run: Run, h: float) -> None:
    """Largest change of a velocity per impulse on each row, each by its own scale, into ``change``."""
    top = 0.0
    n = run.pos.shape[0]
    for i in range(n):
        top = max(top, run.scale[i])
    for a in range(run.belt.shape[0]):
        largest = 0.0
        for i in range(n):
            size = abs(run.mw[a, i])
            if size > 0.0:
                scale = max(run.scale[i], abs(run.rate[i]) * h, 1e-10 * top, 1e-300)
                largest = max(largest, size / scale)
        run.change[a] = largest


@kernel
def step_error(run: Run, h: float, tol: float) -> float:
    """Estimated error of a slip step in units of the tolerance, the worst over signals by their own scales."""
    m = run.belt.shape[0]
    s = run.basis.shape[0]
    muN = run.mu_0_N
    worst = 0.0
    for a in range(m):
        last = 0.0
        before = 0.0
        for l in range(s):
            last += run.tails[0, l] * run.direction[a, l]
            before += run.tails[1, l] * run.direction[a, l]
        size = max(abs(last), 0.2 * abs(before)) - 1e-15
        if size > 0.0:
            worst = max(worst, size * muN * h * run.change[a] / tol)
    return worst


@kernel
def rates(run: Run) -> None:
    """Accelerations of the dofs in slip into ``rate``: the scale of what a short step changes."""
    n = run.pos.shape[0]
    contact_acceleration(run)
    for i in range(n):
        value = 0.0
        for j in range(n):
            value += run.minv[i, j] * run.force[j]
        for a in range(run.belt.shape[0]):
            value -= run.mw[a, i] * run.mu_0_N * run.n[a]
        run.rate[i] = value


@kernel
def keep_slip(run: Run, h: float) -> float:
    """Write the row of a slip step; returns its friction loss."""
    n = run.pos.shape[0]
    m = run.belt.shape[0]
    s = run.basis.shape[0]
    at_row = keep_row(run, SLIP, n, h)
    at = AT_BLOCKS + 3 * n
    for a in range(m):
        for l in range(s):
            run.steps[at_row, at + a * s + l] = -run.mu_0_N * run.direction[a, l]
    at += m * s
    power = 0.0
    for a in range(m):
        power += run.g[a] * run.g[a]
    run.steps[at_row, at] = run.mu_0_N * math.sqrt(power)
    loss = 0.0
    for l in range(s):
        power = 0.0
        for a in range(m):
            power += run.mu_0_N * run.direction[a, l] * run.relative[a, l]
        run.steps[at_row, at + 1 + l] = power
        loss += h * run.tab.b[l] * power
    return loss


@kernel
def commit(run: Run, h: float, loss: float) -> None:
    """Take over the end of a slip step."""
    for j in range(run.w2.shape[1]):
        run.u[j] = run.u_end[j]
        run.u_low[j] = run.low_end[j]
        run.v[j] = run.v_end[j]
    end = run.basis.shape[0] - 1
    for a in range(run.belt.shape[0]):
        run.g[a] = run.relative[a, end]
        run.n[a] = run.direction[a, end]
    run.time, run.time_low = two_sum(run.time, run.time_low, h)
    run.loss += loss
