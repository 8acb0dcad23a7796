"""States anywhere in a run from the rows of its steps: closed form in stick, Taylor series of the blocks in slip."""

from __future__ import annotations

import math

import numpy as np

from fricmb.integrate.collocation.block_motion import MOST, fundamental, two_sum, under_polynomials
from fricmb.integrate.collocation.layout import (
    AT_BLOCKS,
    AT_LENGTH,
    AT_LOSS,
    AT_LOW,
    AT_TIME,
    B0,
    B1,
    BELT,
    DAMP,
    MODAL,
    MONOMIAL,
    MU_0_N,
    Q_U,
    Q_V,
    ROWS,
    STUCK_BLOCKS,
    STUCK_V,
    V_U,
    V_V,
    W2,
    WITH_START,
    WT,
)  # fmt: skip
from fricmb.integrate.collocation.one_contact.room import Run
from fricmb.integrate.compile.kernel import entry
from fricmb.integrate.problem import SLIP, Floats, Floats2, Floats3, Ints


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


@entry
def sample_rows(
    run: Run, at: Ints, tau: Floats, t_of: Floats, hold: Floats3, load: Floats2, polynomial: Floats2, x: Floats2,
    q: Floats2, v: Floats2, F: Floats2, g: Floats2, mode: Ints, loss: Floats,
) -> None:  # fmt: skip
    """Fill q, v (n, n_t), F, g (m, n_t), mode, loss (n_t,) at ``tau`` after the start of each row ``at``.

    ``hold`` (2, m, n), ``load`` (2, m): held force by position and velocity, and of the loads; ``polynomial``
    (m + 2 n, s), ``x`` (2, n): space to work in.
    """
    phases = run.phases
    steps = run.steps
    n = run.blk.shape[2]
    m = run.flags[ROWS]
    s = run.nd.shape[1] - 1
    space = np.empty((2, MOST + 1))
    last = -1
    base = AT_BLOCKS + 3 * n
    for i in range(at.shape[0]):
        k = at[i]
        phase = run.kinds[k, 1]
        slips = run.kinds[k, 0] == SLIP
        z = 0 if slips else 1
        b = n if slips else run.flags[STUCK_BLOCKS]
        modal = run.flags[MODAL + z] == 1
        h = steps[k, AT_LENGTH]
        since = (steps[k, AT_TIME] - phases[phase, 2 * n]) + (steps[k, AT_LOW] - phases[phase, 2 * n + 1]) + tau[i]
        if slips and k != last:
            for a in range(m):
                for r in range(s):
                    value = 0.0
                    for l in range(s):
                        value += run.nd[MONOMIAL, r, l] * (steps[k, base + a * s + l] - steps[k, base + a * s + s - 1])
                    if r == 0:
                        value += steps[k, base + a * s + s - 1]
                    polynomial[a, r] = value
            for j in range(b):
                for r in range(s):
                    polynomial[m + j, r] = 0.0
                    polynomial[m + n + j, r] = 0.0
                    for a in range(m):
                        polynomial[m + n + j, r] += run.ci[B1, a, j] * polynomial[a, r]
                        if not modal:
                            polynomial[m + j, r] += run.ci[B0, a, j] * polynomial[a, r]
            last = k
        for j in range(b):
            u0 = steps[k, AT_BLOCKS + j]
            v0 = steps[k, AT_BLOCKS + n + j]
            a0 = steps[k, AT_BLOCKS + 2 * n + j]
            slope = phases[phase, 2 * n + 2 + j]
            if slips:
                du, dv = under_polynomials(
                    run.blk[0, W2, j], run.blk[0, DAMP, j], v0, a0, slope, h, tau[i], polynomial[m + j],
                    polynomial[m + n + j], space,
                )  # fmt: skip
                vj = v0 + dv
            else:
                x0, x1, x2 = fundamental(run.blk[1, W2, j], run.blk[1, DAMP, j], tau[i])
                k0 = slope - run.blk[1, W2, j] * v0
                du = v0 * tau[i] + a0 * x1 + k0 * x2
                vj = v0 + a0 * x0 + k0 * x1
            x[0, j] = u0 + du
            x[1, j] = vj - phases[phase, 3 * n + 2 + j] - phases[phase, 4 * n + 2 + j] * since
        for a in range(m):
            g[a, i] = -run.lim[BELT + a]
        for e in range(n):
            velocity = 0.0 if slips else run.vec[STUCK_V, e]
            move = velocity * since
            for j in range(b):
                move += run.mat[z, Q_U, e, j] * x[0, j]
                velocity += run.mat[z, V_V, e, j] * x[1, j]
            if not modal:
                for j in range(b):
                    move += run.mat[z, Q_V, e, j] * x[1, j]
                    velocity += run.mat[z, V_U, e, j] * x[0, j]
            high, low = two_sum(phases[phase, e], phases[phase, n + e], move)
            q[e, i] = high + low
            v[e, i] = velocity
            for a in range(m):
                g[a, i] += run.row[WT, a, e] * velocity
        mode[i] = 1 if slips else 0
        loss[i] = steps[k, AT_LOSS]
        if slips:
            theta = tau[i] / h
            size = 0.0
            for a in range(m):
                value = 0.0
                for r in range(s - 1, -1, -1):
                    value = value * theta + polynomial[a, r]
                F[a, i] = value
                size += value * value
            # the friction of slip has a known size; interpolation keeps it but for its own error
            size = run.lim[MU_0_N] / math.sqrt(size)
            for a in range(m):
                F[a, i] *= size
            power = theta
            for r in range(s + 1):
                value = 0.0
                for l in range(s + 1):
                    value += run.nd[WITH_START, r, l] * steps[k, base + m * s + l]
                loss[i] += h * power * value / (r + 1.0)
                power *= theta
            # the last of a landing is crossed otherwise than by this polynomial
            loss[i] = max(loss[i], steps[k, AT_LOSS])
            if k + 1 < steps.shape[0]:
                loss[i] = min(loss[i], steps[k + 1, AT_LOSS])
        else:
            for a in range(m):
                value = -load[0, a] - load[1, a] * t_of[i]
                for e in range(n):
                    value += hold[0, a, e] * q[e, i] + hold[1, a, e] * v[e, i]
                F[a, i] = value
                g[a, i] = 0.0
