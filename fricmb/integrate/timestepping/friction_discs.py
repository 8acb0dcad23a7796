"""Projections on the balls of the contacts, their derivatives, and what they say about a solution."""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.law_values import coefficient
from fricmb.integrate.problem import Floats
from fricmb.integrate.timestepping.layout import BROKEN, CAUGHT, DRIVES, HELD, NO_NUMBER, SOUND
from fricmb.integrate.timestepping.room import Run

#: R of the proximal steps times the local compliance.
STIFF = 1e5


@kernel
def project(run: Run, F: Floats, g: Floats) -> float:
    """Y = F - R g, its projections P, their derivatives into H; returns sum theta / R."""
    total = 0.0
    for c in range(run.status.shape[0]):
        row0 = run.row[c]
        d = run.row[c + 1] - row0
        R = STIFF / run.soft[c]
        rho = run.rho[c]
        if d == 1:
            y = F[row0] - R * g[row0]
            z = y - run.delta[row0]
            p = y
            run.H[3 * c] = R
            if abs(z) > rho or rho == 0.0:
                p = run.delta[row0] + math.copysign(rho, z)
                run.H[3 * c] = 0.0
            run.P[row0] = p
            total += p * (y - 0.5 * p) / R
            continue
        z0 = F[row0] - R * g[row0] - run.delta[row0]
        z1 = F[row0 + 1] - R * g[row0 + 1] - run.delta[row0 + 1]
        size = math.hypot(z0, z1)
        share = 1.0
        run.H[3 * c], run.H[3 * c + 1], run.H[3 * c + 2] = R, 0.0, R
        if size > rho or rho == 0.0:
            share = rho / size if size > 0.0 else 0.0
            n0, n1 = (z0 / size, z1 / size) if size > 0.0 else (0.0, 0.0)
            run.H[3 * c] = R * share * n1 * n1
            run.H[3 * c + 1] = -R * share * n0 * n1
            run.H[3 * c + 2] = R * share * n0 * n0
        for a in range(2):
            z = z0 if a == 0 else z1
            y = z + run.delta[row0 + a]
            p = run.delta[row0 + a] + share * z
            run.P[row0 + a] = p
            total += p * (y - 0.5 * p) / R
    return total


@kernel
def keep_piece(run: Run) -> None:
    """Remember on which piece of the projections a Newton step starts."""
    for e in range(run.H.shape[0]):
        run.weight[e] = run.H[e]
    for a in range(run.P.shape[0]):
        run.y[a] = run.P[a]


@kernel
def same_piece(run: Run) -> bool:
    """Whether it ended there: the derivatives are the same, and where they vanish the projections."""
    different = 0
    for e in range(run.H.shape[0]):
        different += run.H[e] != run.weight[e]
    for c in range(run.status.shape[0]):
        if run.H[3 * c] == 0.0:
            row0 = run.row[c]
            different += abs(run.P[row0] - run.y[row0]) > 1e-12 * run.rho[c]
    return different == 0


@kernel
def hold_skipped(run: Run, F: Floats, g: Floats) -> None:
    """Take contacts for stuck that went over from one side of slip to the other; what this changes in P into ``move``.

    Between the two they stick, in a range of g so narrow that no full step ends in it.
    """
    for a in range(run.move.shape[0]):
        run.move[a] = 0.0
    for c in range(run.status.shape[0]):
        a = run.row[c]
        slips = run.row[c + 1] - a == 1 and run.weight[3 * c] == 0.0 and run.H[3 * c] == 0.0
        if slips and abs(run.P[a] - run.y[a]) > run.rho[c]:
            R = STIFF / run.soft[c]
            run.move[a] = F[a] - R * g[a] - run.P[a]
            run.H[3 * c] = R
            run.P[a] += run.move[a]


@kernel
def all_flat(run: Run) -> bool:
    """Whether every projection is linear where it is: one direction, or stuck."""
    for c in range(run.status.shape[0]):
        if run.row[c + 1] - run.row[c] == 2 and run.H[3 * c + 1] != 0.0:
            return False
        if run.row[c + 1] - run.row[c] == 2 and run.H[3 * c] != run.H[3 * c + 2]:
            return False
    return True


@kernel
def residual(run: Run, F: Floats, g: Floats) -> float:
    """Largest |F - P(F - g / soft)|."""
    worst = 0.0
    for c in range(run.status.shape[0]):
        row0 = run.row[c]
        d = run.row[c + 1] - row0
        size = 0.0
        for a in range(row0, row0 + d):
            size = math.hypot(size, F[a] - g[a] / run.soft[c] - run.delta[a])
        share = min(1.0, run.rho[c] / size) if size > 0.0 else 0.0
        for a in range(row0, row0 + d):
            z = F[a] - g[a] / run.soft[c] - run.delta[a]
            worst = max(worst, abs(F[a] - run.delta[a] - share * z))
    return worst


@kernel
def mark_stuck(run: Run, F: Floats, g: Floats) -> None:
    """Make g exactly 0 where the force is inside its ball, or on its rim and no more than that is solved to."""
    largest = 0.0
    for c in range(run.status.shape[0]):
        largest = max(largest, run.rho[c])
    for c in range(run.status.shape[0]):
        row0 = run.row[c]
        d = run.row[c + 1] - row0
        distance = 0.0
        for a in range(row0, row0 + d):
            distance = math.hypot(distance, F[a] - run.delta[a])
        inside = run.H[3 * c] == STIFF / run.soft[c] and (d == 1 or run.H[3 * c + 2] == run.H[3 * c])
        held = inside and distance <= run.rho[c]
        # one whose loop is held by others is at rest on its rim, too
        if run.status[c] in (HELD, CAUGHT, BROKEN) or run.loop[c] >= 0:
            size = 0.0
            for a in range(row0, row0 + d):
                size = math.hypot(size, g[a])
            # all are solved to a part of the largest force: so are the loads that a loop shares out
            radius = largest if run.loop[c] >= 0 else run.rho[c]
            held = held or size <= 2.0 * run.residual * radius * run.soft[c]
        if held and run.rho[c] > 0.0:
            for a in range(row0, row0 + d):
                g[a] = 0.0


@kernel
def slide_radius(run: Run, c: int, speed: float, N: float) -> float:
    """mu(r, N) N; 0 where that is negative, through which iterates may pass."""
    mu = coefficient(run, run.laws, c, run.s, speed, N)[0]
    if not abs(mu) < math.inf:
        run.fault = NO_NUMBER
    elif mu < 0.0 and run.fault == SOUND:
        run.fault = DRIVES
    return float(max(0.0, mu) * N)
