"""Slip of one contact under constant friction: the directions at the nodes are all that is unknown."""

from __future__ import annotations

import math

from fricmb.integrate.collocation.layout import (
    COUPLED,
    DIRECTION,
    FREE,
    JACOBIAN,
    LINES,
    MU_0_N,
    OUT,
    RELATIVE,
    RHS,
    ROWS,
    D,
    N,
)  # fmt: skip
from fricmb.integrate.collocation.one_contact.room import Run
from fricmb.integrate.compile.kernel import kernel


@kernel
def relative_velocity(run: Run, slot: int, d: int) -> None:
    """Relative velocity at the nodes for the directions there, F = -mu N n."""
    s = run.nx.shape[2]
    for a in range(d):
        for i in range(s):
            x = 0.0
            for l in range(s):
                x += run.tk[slot, run.flags[ROWS] * a + a, i, l] * run.nx[DIRECTION, a, l]
            run.nx[RELATIVE, a, i] = run.nx[FREE, a, i] - run.lim[MU_0_N] * x
    if run.flags[COUPLED] == 1:
        for i in range(s):
            x = 0.0
            y = 0.0
            for l in range(s):
                x += run.tk[slot, 1, i, l] * run.nx[DIRECTION, 1, l]
                y += run.tk[slot, 2, i, l] * run.nx[DIRECTION, 0, l]
            run.nx[RELATIVE, 0, i] -= run.lim[MU_0_N] * x
            run.nx[RELATIVE, 1, i] -= run.lim[MU_0_N] * y


@kernel
def slip_directions(run: Run, slot: int, tol: float) -> int:
    """Newton for t_i . g_i = 0 in two dimensions from the directions at hand; returns iterations, or -1.

    Regular through r = 0: a node's r may come out negative, which tells that the slip ended before it.
    """
    nx = run.nx
    wk = run.wk
    tk = run.tk
    s = nx.shape[2]
    for iteration in range(14):
        relative_velocity(run, slot, 2)
        for i in range(s):
            tx = -nx[DIRECTION, 1, i]
            ty = nx[DIRECTION, 0, i]
            wk[LINES, RHS, i] = tx * nx[RELATIVE, 0, i] + ty * nx[RELATIVE, 1, i]
            for l in range(s):
                ux = -nx[DIRECTION, 1, l]
                uy = nx[DIRECTION, 0, l]
                value = tx * tk[slot, 0, i, l] * ux + ty * tk[slot, 3, i, l] * uy
                if run.flags[COUPLED] == 1:
                    value += tx * tk[slot, 1, i, l] * uy + ty * tk[slot, 2, i, l] * ux
                wk[JACOBIAN, i, l] = run.lim[MU_0_N] * value
            wk[JACOBIAN, i, i] += nx[DIRECTION, 0, i] * nx[RELATIVE, 0, i] + nx[DIRECTION, 1, i] * nx[RELATIVE, 1, i]
        if not eliminate(run, s):
            return -1
        largest = 0.0
        for i in range(s):
            turn = wk[LINES, RHS, i]
            if not abs(turn) < 1e300:
                return -1
            largest = max(largest, turn * turn)
            turn = min(0.5, max(-0.5, turn))
            size = 1.0 / math.sqrt(1.0 + turn * turn)
            x = nx[DIRECTION, 0, i]
            y = nx[DIRECTION, 1, i]
            nx[DIRECTION, 0, i] = (x - turn * y) * size
            nx[DIRECTION, 1, i] = (y + turn * x) * size
        if largest < tol:
            relative_velocity(run, slot, 2)
            return iteration + 1
    return -1


@kernel
def eliminate(run: Run, s: int) -> bool:
    """Solve J x = rhs in place; rows are exchanged only where a pivot is small."""
    for k in range(s):
        pivot = run.wk[JACOBIAN, k, k]
        if k + 1 < s and abs(pivot) < 1e-3 * abs(run.wk[JACOBIAN, k + 1, k]):
            exchange(run, k, s)
            pivot = run.wk[JACOBIAN, k, k]
        if pivot == 0.0:
            return False
        inverse = 1.0 / pivot
        for i in range(k + 1, s):
            x = run.wk[JACOBIAN, i, k] * inverse
            for j in range(k + 1, s):
                run.wk[JACOBIAN, i, j] -= x * run.wk[JACOBIAN, k, j]
            run.wk[LINES, RHS, i] -= x * run.wk[LINES, RHS, k]
    for i in range(s - 1, -1, -1):
        x = run.wk[LINES, RHS, i]
        for j in range(i + 1, s):
            x -= run.wk[JACOBIAN, i, j] * run.wk[LINES, RHS, j]
        run.wk[LINES, RHS, i] = x / run.wk[JACOBIAN, i, i]
    return True


@kernel
def exchange(run: Run, k: int, s: int) -> None:
    """Bring the largest entry of column k below the diagonal onto it."""
    best = k
    for i in range(k + 1, s):
        if abs(run.wk[JACOBIAN, i, k]) > abs(run.wk[JACOBIAN, best, k]):
            best = i
    for j in range(k, s):
        x = run.wk[JACOBIAN, k, j]
        run.wk[JACOBIAN, k, j] = run.wk[JACOBIAN, best, j]
        run.wk[JACOBIAN, best, j] = x
    x = run.wk[LINES, RHS, k]
    run.wk[LINES, RHS, k] = run.wk[LINES, RHS, best]
    run.wk[LINES, RHS, best] = x


@kernel
def start_direction(run: Run) -> float:
    """Direction of slip that starts at g = 0: ``(mu N D + rho I) n = a`` with |n| = 1, rho >= 0; returns rho.

    a is that of :func:`contact_acceleration`.

    For mu N -> |D^-1 a| it is along D^-1 a (rho = 0).
    """
    con = run.con
    wk = run.wk
    sm = run.sm
    if run.flags[ROWS] == 1:
        sm[N, 0] = 1.0 if wk[LINES, OUT, 0] >= 0.0 else -1.0
        return float(max(0.0, abs(wk[LINES, OUT, 0]) - run.lim[MU_0_N] * con[D, 0, 0]))
    rho = 0.0
    for _ in range(60):
        p = run.lim[MU_0_N] * con[D, 0, 0] + rho
        q = 0.5 * run.lim[MU_0_N] * (con[D, 0, 1] + con[D, 1, 0])
        r = run.lim[MU_0_N] * con[D, 1, 1] + rho
        det = p * r - q * q
        if det == 0.0:
            rho = max(rho, 1e-300)
            sm[N, 0] = wk[LINES, OUT, 0]
            sm[N, 1] = wk[LINES, OUT, 1]
            break
        sm[N, 0] = (r * wk[LINES, OUT, 0] - q * wk[LINES, OUT, 1]) / det
        sm[N, 1] = (p * wk[LINES, OUT, 1] - q * wk[LINES, OUT, 0]) / det
        size2 = sm[N, 0] * sm[N, 0] + sm[N, 1] * sm[N, 1]
        if size2 <= 1.0:
            break
        # Newton on 1/|n| - 1 (concave in rho: converges from the left)
        curve = (sm[N, 0] * (r * sm[N, 0] - q * sm[N, 1]) + sm[N, 1] * (p * sm[N, 1] - q * sm[N, 0])) / det
        size = math.sqrt(size2)
        step = (size - 1.0) * size2 / curve
        if step <= 1e-15 * (rho + run.lim[MU_0_N] * (con[D, 0, 0] + con[D, 1, 1])):
            break
        rho += step
    size = math.hypot(sm[N, 0], sm[N, 1])
    if size > 0.0:
        sm[N, 0] /= size
        sm[N, 1] /= size
    else:
        sm[N, 0] = 1.0
        sm[N, 1] = 0.0
    return float(rho)
