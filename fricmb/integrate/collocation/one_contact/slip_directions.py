"""Slip of one contact under constant friction: the directions at the nodes are all that is unknown."""

from __future__ import annotations

import math

from fricmb.integrate.collocation.one_contact.room import Run
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.lanes import LANES, lanes, roots, rounded, set_lanes
from fricmb.integrate.problem import Floats2


@kernel
def relative_velocity(run: Run, slot: int, d: int) -> None:
    """Relative velocity at the nodes for the directions there, F = -mu N n."""
    muN = run.mu_0_N
    for a in range(d):
        for at in range(0, run.free.shape[1], LANES):
            g = lanes(run.free[a], at)
            for b in range(d):
                if a == b or run.coupled == 1:
                    answer = run.answers[slot, d * a + b]
                    for l in range(answer.shape[0]):
                        g = g - muN * run.direction[b, l] * lanes(answer[l], at)
            set_lanes(run.relative[a], at, g)


@kernel
def turning(run: Run, slot: int) -> None:
    """What is to vanish, t_i . g_i at the nodes, and its change per angle of each of the directions, column by column.

    The right-hand side is the column behind them.
    """
    J, answers = run.jacobian, run.answers[slot]
    s, muN, coupled = run.basis.shape[0], run.mu_0_N, run.coupled == 1
    for at in range(0, run.free.shape[1], LANES):
        x, y = lanes(run.direction[0], at), lanes(run.direction[1], at)
        gx, gy = lanes(run.relative[0], at), lanes(run.relative[1], at)
        set_lanes(J[s], at, x * gy - rounded(y, gx))
        r = x * gx + rounded(y, gy)
        for l in range(s):
            ux, uy = -muN * run.direction[1, l], muN * run.direction[0, l]
            across, along = uy * lanes(answers[3, l], at), ux * lanes(answers[0, l], at)
            if coupled:
                across = across + rounded(ux, lanes(answers[2, l], at))
                along = along + rounded(uy, lanes(answers[1, l], at))
            set_lanes(J[l], at, rounded(r, lanes(run.unit[l], at)) + x * across - y * along)


@kernel
def slip_directions(run: Run, slot: int, tol: float) -> int:
    """Newton for t_i . g_i = 0 in two dimensions from the directions at hand; returns iterations, or -1.

    Regular through r = 0: a node's r may come out negative, which tells that the slip ended before it.
    """
    d, s = run.direction, run.basis.shape[0]
    turns = run.jacobian[s]
    for iteration in range(14):
        relative_velocity(run, slot, 2)
        turning(run, slot)
        if not eliminate(run, s):
            return -1
        largest = 0.0
        for i in range(s):
            if not abs(turns[i]) < 1e300:
                return -1
            largest = max(largest, abs(turns[i]))
        if largest > 0.5:
            for i in range(s):
                turns[i] = min(0.5, max(-0.5, turns[i]))
        for at in range(0, d.shape[1], LANES):
            x, y, turn = lanes(d[0], at), lanes(d[1], at), lanes(turns, at)
            size = roots(1.0 + turn * turn)
            set_lanes(d[0], at, (x - turn * y) / size)
            set_lanes(d[1], at, (y + turn * x) / size)
        if largest * largest < tol:
            relative_velocity(run, slot, 2)
            return iteration + 1
    return -1


@kernel
def eliminate(run: Run, s: int) -> bool:
    """Solve the system of :func:`turning` in place, all rows at once (Gauss and Jordan's way).

    Rows are exchanged only where a pivot is small.  Each column is taken without its pivot, so that a pivot's row stays
    what it is, and is divided in the end (a place just written by itself
    and read again with others would be waited for).
    """
    J = run.jacobian
    width, inverse = J.shape[1], J[s + 1]
    for k in range(s):
        if k + 1 < s and abs(J[k, k]) < 1e-3 * abs(J[k, k + 1]):
            exchange(J, k, s)
        pivot = J[k, k]
        if pivot == 0.0:
            return False
        part = inverse[k] = 1.0 / pivot
        for at in range(0, width, LANES):
            others = lanes(J[k], at) - pivot * lanes(run.unit[k], at)
            for j in range(k + 1, s + 1):
                set_lanes(J[j], at, lanes(J[j], at) - (J[j, k] * part) * others)
    for at in range(0, width, LANES):
        set_lanes(J[s], at, lanes(J[s], at) * lanes(inverse, at))
    return True


@kernel
def exchange(J: Floats2, k: int, s: int) -> None:
    """Bring the largest entry of column k below the diagonal onto it."""
    best = k
    for i in range(k + 1, s):
        if abs(J[k, i]) > abs(J[k, best]):
            best = i
    for j in range(k, s + 1):
        J[j, k], J[j, best] = J[j, best], J[j, k]


@kernel
def start_direction(run: Run) -> float:
    """Direction of slip that starts at g = 0: ``(mu N D + rho I) n = a`` with |n| = 1, rho >= 0; returns rho.

    a is that of :func:`contact_acceleration`.

    For mu N -> |D^-1 a| it is along D^-1 a (rho = 0).
    """
    if run.belt.shape[0] == 1:
        run.n[0] = 1.0 if run.out[0, 0] >= 0.0 else -1.0
        return float(max(0.0, abs(run.out[0, 0]) - run.mu_0_N * run.D[0, 0]))
    rho = 0.0
    for _ in range(60):
        p = run.mu_0_N * run.D[0, 0] + rho
        q = 0.5 * run.mu_0_N * (run.D[0, 1] + run.D[1, 0])
        r = run.mu_0_N * run.D[1, 1] + rho
        det = p * r - q * q
        if det == 0.0:
            rho = max(rho, 1e-300)
            run.n[0] = run.out[0, 0]
            run.n[1] = run.out[0, 1]
            break
        run.n[0] = (r * run.out[0, 0] - q * run.out[0, 1]) / det
        run.n[1] = (p * run.out[0, 1] - q * run.out[0, 0]) / det
        size2 = run.n[0] * run.n[0] + run.n[1] * run.n[1]
        if size2 <= 1.0:
            break
        # Newton on 1/|n| - 1 (concave in rho: converges from the left)
        curve = (run.n[0] * (r * run.n[0] - q * run.n[1]) + run.n[1] * (p * run.n[1] - q * run.n[0])) / det
        size = math.sqrt(size2)
        step = (size - 1.0) * size2 / curve
        if step <= 1e-15 * (rho + run.mu_0_N * (run.D[0, 0] + run.D[1, 1])):
            break
        rho += step
    size = math.hypot(run.n[0], run.n[1])
    if size > 0.0:
        run.n[0] /= size
        run.n[1] /= size
    else:
        run.n[0] = 1.0
        run.n[1] = 0.0
    return float(rho)
