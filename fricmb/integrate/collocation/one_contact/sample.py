"""States anywhere in a run from the rows of its steps: closed form in stick, Taylor series of the blocks in slip."""

from __future__ import annotations

import math

from fricmb.integrate.collocation.block_motion import MOST, fundamental, two_sum
from fricmb.integrate.collocation.one_contact.room import AT_BLOCKS, AT_LENGTH, AT_LOSS, AT_LOW, AT_TIME, Run
from fricmb.integrate.compile.kernel import entry, kernel
from fricmb.integrate.compile.lanes import LANES, all_lanes, lanes, set_lanes
from fricmb.integrate.problem import SLIP, Floats, Floats2, Floats3, Ints

#: Rows of the space to work in, block by block: v' = -SQUARE u - DAMPING v in slip with its fastest rate; v, v' and the
#: slope of the load at the start of a step; u and v; v' and u' per force of each row of the contact.
SQUARE, DAMPING, FASTEST, START_V, START_A, SLOPES, MOVED, SPEED, BY_FORCE = range(9)


@entry
def locate(run: Run, n_rows: int, t: Floats, at: Ints, tau: Floats) -> None:
    """Row and time since its start of sorted or unsorted times; at a transition the row after it."""
    k = 0
    for i in range(t.shape[0]):
        if k > 0 and t[i] < run.steps[k, AT_TIME] + run.steps[k, AT_LOW]:
            k = 0
        if k == 0 and n_rows > 8:
            low = 0
            high = n_rows
            while high - low > 1:
                middle = (low + high) // 2
                if run.steps[middle, AT_TIME] + run.steps[middle, AT_LOW] <= t[i]:
                    low = middle
                else:
                    high = middle
            k = low
        while k + 1 < n_rows and run.steps[k + 1, AT_TIME] + run.steps[k + 1, AT_LOW] <= t[i]:
            k += 1
        at[i] = k
        tau[i] = max(0.0, (t[i] - run.steps[k, AT_TIME]) - run.steps[k, AT_LOW])


@kernel
def constants(run: Run, work: Floats2) -> None:
    """Put what does not change from row to row."""
    m = run.belt.shape[0]
    for j in range(run.w2.shape[1]):
        w2, d = run.w2[0, j], run.damp[0, j]
        work[SQUARE, j], work[DAMPING, j] = w2, d
        work[FASTEST, j] = max(math.sqrt(abs(w2)), abs(d))
        for a in range(m):
            work[BY_FORCE + a, j] = run.b1[a, j]
            work[BY_FORCE + m + a, j] = run.b0[a, j]


@kernel
def force_polynomials(run: Run, k: int, polynomial: Floats2) -> None:
    """Forces of a step in slip by powers of the part of the step that is gone."""
    s, n = run.basis.shape[0], run.w2.shape[1]
    for a in range(run.belt.shape[0]):
        nodes = run.steps[k, AT_BLOCKS + 3 * n + a * s :]
        last = nodes[s - 1]
        for at in range(0, polynomial.shape[1], LANES):
            found = all_lanes(0.0)
            for l in range(s - 1):
                found = found + (nodes[l] - last) * lanes(run.basis[l], at)
            set_lanes(polynomial[a], at, found)
        polynomial[a, 0] += last


@kernel
def slip_blocks(run: Run, k: int, work: Floats2, polynomial: Floats2, tau: float) -> None:
    """What u gains in tau, and v after it, by the Taylor series of u' = v + b0 F, v' = -w2 u - d v + b1 F + slope t."""
    n, m, s = run.w2.shape[1], run.belt.shape[0], run.basis.shape[0]
    modal = run.modal[0] == 1
    for j in range(n):
        work[START_V, j] = run.steps[k, AT_BLOCKS + n + j]
        work[START_A, j] = run.steps[k, AT_BLOCKS + 2 * n + j]
        work[SLOPES, j] = run.phases[run.kinds[k, 1], 2 * n + 2 + j] * tau
    gone = tau / run.steps[k, AT_LENGTH]
    for at in range(0, work.shape[1], LANES):
        fastest = 0.0
        for j in range(at, at + LANES):
            fastest = max(fastest, work[FASTEST, j])
        square, damping = lanes(work[SQUARE], at), lanes(work[DAMPING], at)
        speed = lanes(work[START_V], at)
        u = v = moved = all_lanes(0.0)
        rate_u, given = speed, lanes(work[START_A], at)
        power, bound = 1.0, 1.0
        q = 0
        while (q < s + 2 or bound > 1e-18) and q <= MOST:
            if q < s:
                for a in range(m):
                    force = polynomial[a, q] * power
                    given = given + force * lanes(work[BY_FORCE + a], at)
                    if not modal:
                        rate_u = rate_u + force * lanes(work[BY_FORCE + m + a], at)
            weight = tau / (q + 1)
            # v last: it is the only one that waits for the term before
            v = weight * ((given - square * u) - damping * v)
            u = weight * rate_u
            moved = moved + u
            speed = speed + v
            rate_u = v
            given = lanes(work[SLOPES], at) if q == 0 else all_lanes(0.0)
            q += 1
            power *= gone
            bound *= fastest * weight
        set_lanes(work[MOVED], at, moved)
        set_lanes(work[SPEED], at, speed)


@kernel
def stuck_blocks(run: Run, k: int, work: Floats2, tau: float) -> None:
    """What u gains in tau, and v after it, in closed form."""
    n = run.w2.shape[1]
    for j in range(run.stuck_blocks):
        w2 = run.w2[1, j]
        x0, x1, x2 = fundamental(w2, run.damp[1, j], tau)
        v0, a0 = run.steps[k, AT_BLOCKS + n + j], run.steps[k, AT_BLOCKS + 2 * n + j]
        k0 = run.phases[run.kinds[k, 1], 2 * n + 2 + j] - w2 * v0
        work[MOVED, j] = v0 * tau + a0 * x1 + k0 * x2
        work[SPEED, j] = v0 + a0 * x0 + k0 * x1


@kernel
def dofs_from_blocks(run: Run, k: int, work: Floats2, tau: float, i: int, q: Floats2, v: Floats2, g: Floats2) -> None:
    """Positions, velocities and relative velocity at sample i; the gains become block states first."""
    n, m = run.w2.shape[1], run.belt.shape[0]
    slips = run.kinds[k, 0] == SLIP
    z, b = (0, n) if slips else (1, run.stuck_blocks)
    phase = run.phases[run.kinds[k, 1]]
    since = (run.steps[k, AT_TIME] - phase[2 * n]) + (run.steps[k, AT_LOW] - phase[2 * n + 1]) + tau
    moved, speed = work[MOVED], work[SPEED]
    for j in range(b):
        moved[j] += run.steps[k, AT_BLOCKS + j]
        speed[j] -= phase[3 * n + 2 + j] + phase[4 * n + 2 + j] * since
    for a in range(m):
        g[a, i] = -run.belt[a]
    for e in range(n):
        velocity = 0.0 if slips else run.stuck_v[e]
        move = velocity * since
        for j in range(b):
            move += run.q_u[z, e, j] * moved[j]
            velocity += run.v_v[z, e, j] * speed[j]
        if run.modal[z] == 0:
            for j in range(b):
                move += run.q_v[z, e, j] * speed[j]
                velocity += run.v_u[z, e, j] * moved[j]
        high, low = two_sum(phase[e], phase[n + e], move)
        q[e, i] = high + low
        v[e, i] = velocity
        for a in range(m):
            g[a, i] += run.wt[a, e] * velocity


@kernel
def slip_force(run: Run, polynomial: Floats2, gone: float, i: int, F: Floats2) -> None:
    """Friction at sample i, of its known size: interpolation keeps that but for its own error."""
    size = 0.0
    for a in range(run.belt.shape[0]):
        value = 0.0
        for r in range(run.basis.shape[0] - 1, -1, -1):
            value = value * gone + polynomial[a, r]
        F[a, i] = value
        size += value * value
    size = run.mu_0_N / math.sqrt(size)
    for a in range(run.belt.shape[0]):
        F[a, i] *= size


@kernel
def loss_at(run: Run, k: int, gone: float) -> float:
    """Friction loss after a part of a step in slip."""
    n, m, s = run.w2.shape[1], run.belt.shape[0], run.basis.shape[0]
    found = run.steps[k, AT_LOSS]
    first = AT_BLOCKS + 3 * n + m * s
    power = gone * run.steps[k, AT_LENGTH]
    for r in range(s + 1):
        value = 0.0
        for l in range(s + 1):
            value += run.tab.basis[r, l] * run.steps[k, first + l]
        found += power * value / (r + 1.0)
        power *= gone
    # the last of a landing is crossed otherwise than by this polynomial
    found = max(found, run.steps[k, AT_LOSS])
    if k + 1 < run.steps.shape[0]:
        found = min(found, run.steps[k + 1, AT_LOSS])
    return float(found)


@entry
def sample_rows(
    run: Run, at: Ints, tau: Floats, t_of: Floats, hold: Floats3, load: Floats2, polynomial: Floats2, work: Floats2,
    q: Floats2, v: Floats2, F: Floats2, g: Floats2, mode: Ints, loss: Floats,
) -> None:  # fmt: skip
    """Fill q, v (n, n_t), F, g (m, n_t), mode (n_t,) at ``tau`` after the start of each row ``at``.

    ``loss`` (n_t,), or (0,) where it is not wanted.  ``hold`` (2, m, n), ``load`` (2, m): held force by position and
    velocity, and of the loads; ``polynomial`` (m, s'), ``work`` (BY_FORCE + 2 m, n'): space to work in.
    """
    last = -1
    constants(run, work)
    for i in range(at.shape[0]):
        k = at[i]
        slips = run.kinds[k, 0] == SLIP
        mode[i] = 1 if slips else 0
        if slips:
            if k != last:
                force_polynomials(run, k, polynomial)
                last = k
            slip_blocks(run, k, work, polynomial, tau[i])
        else:
            stuck_blocks(run, k, work, tau[i])
        dofs_from_blocks(run, k, work, tau[i], i, q, v, g)
        if loss.shape[0] > 0:
            loss[i] = loss_at(run, k, tau[i] / run.steps[k, AT_LENGTH]) if slips else run.steps[k, AT_LOSS]
        if slips:
            slip_force(run, polynomial, tau[i] / run.steps[k, AT_LENGTH], i, F)
            continue
        for a in range(run.belt.shape[0]):
            value = -load[0, a] - load[1, a] * t_of[i]
            for e in range(q.shape[0]):
                value += hold[0, a, e] * q[e, i] + hold[1, a, e] * v[e, i]
            F[a, i] = value
            g[a, i] = 0.0
