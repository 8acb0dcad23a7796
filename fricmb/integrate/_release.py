"""A set of stick and slip at an instant that always exists: release after release, each time a convex problem.

Contacts that are released have friction of at most mu(0) N and take the forces that make the kinetic energy of the
accelerations least (maximal dissipation); those that are not are held.  That problem has a solution whatever D is, and
it is one in which a released contact either slips against its force or is held again by less than mu(0) N.  Whatever
is held by more than mu_s N is released, the worst first, and never taken back: after as many releases as there are
contacts nothing is left to release.  (Newton's method on modes that are guessed is faster, and is tried before.)

The problem over discs is solved by projected gradients with Nesterov's momentum, restarted where it points uphill
(O'Donoghue and Candes, Foundations of Computational Mathematics 15, 2015, 715-732); each contact in the units of its
own compliance, in which discs stay discs.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate._instant import State, slip_speed
from fricmb.integrate._kernel import kernel
from fricmb.integrate._pack import Ports
from fricmb.integrate._problem import OPEN, SLIP, STICK, Codes, Floats
from fricmb.integrate._stop import stopped

#: Gradients taken at most, residual at which they end and at which they will do, in parts of the largest force.
MOST, FINE, COARSE = 20000, 1e-13, 1e-7


@kernel
def release(ports: Ports, y: State, part: Codes, mode: Codes, F: Floats) -> bool:
    """Modes and forces of the contacts that take part; False where the gradients did not get there.

    ``part`` (n_c,): 0 leaves a contact out, 2 is one that is released already.  ``F`` (m,) and ``y.n`` are filled.
    """
    nc = mode.shape[0]
    free = np.zeros(nc, np.bool_)
    limit = np.zeros(nc)
    scale = np.zeros(F.shape[0])
    steep = 1e-300
    for k in range(nc):
        free[k] = part[k] == 2
        for a in range(ports.row[k], ports.row[k + 1]):
            F[a] = 0.0
            if part[k] != 0:
                # one unit for both rows of a contact: what is a disc stays one
                other = ports.row[k] + ports.row[k + 1] - 1 - a
                scale[a] = 1.0 / max(ports.D[a, a], ports.D[other, other])
    for a in range(F.shape[0]):
        total = 0.0
        for b in range(F.shape[0]):
            total += abs(ports.D[a, b]) * np.sqrt(scale[a] * scale[b])
        steep = max(steep, total)
    for _ in range(nc + 1):
        for k in range(nc):
            limit[k] = ports.mu_0[k] * y.N[k] if free[k] else np.inf
        if not least_energy(ports, y, part, limit, scale, steep, F):
            return False
        worst, excess = -1, 1.0 + 1e-9
        for k in range(nc):
            if part[k] == 0 or free[k]:
                continue
            size = slip_speed(F, ports.row[k], ports.row[k + 1] - ports.row[k])
            hold = ports.mu_s[k] * y.N[k]
            ratio = size / hold if hold > 0.0 else (2.0 if size > 0.0 else 0.0)
            if ratio > excess:
                worst, excess = k, ratio
        if worst < 0:
            break
        free[worst] = True
    for k in range(nc):
        mode[k] = OPEN
        if part[k] != 0:
            row0 = ports.row[k]
            size = slip_speed(F, row0, ports.row[k + 1] - row0)
            # on its cone and not accelerated it is held, but for one that has just been found to break away
            slips = free[k] and size >= (1.0 - 1e-9) * limit[k]
            slips = slips and (part[k] == 2 or slip_start(ports, y, F, k) > 1e-9 * largest(y.a0))
            mode[k] = SLIP if slips else STICK
            if slips and size > 0.0:
                for a in range(row0, ports.row[k + 1]):
                    y.n[a] = -F[a] / size
    return True


@kernel
def slip_start(ports: Ports, y: State, F: Floats, k: int) -> float:
    """Magnitude of the relative acceleration of contact k."""
    total = 0.0
    for a in range(ports.row[k], ports.row[k + 1]):
        total += relative_acceleration(ports, y, F, a) ** 2
    return float(np.sqrt(total))


@kernel
def relative_acceleration(ports: Ports, y: State, F: Floats, a: int) -> float:
    """Row a of a0 + D F."""
    value = y.a0[a]
    for b in range(F.shape[0]):
        value += ports.D[a, b] * F[b]
    return float(value)


@kernel
def largest(x: Floats) -> float:
    """Largest magnitude."""
    value = 1e-300
    for a in range(x.shape[0]):
        value = max(value, abs(x[a]))
    return value


@kernel
def least_energy(ports: Ports, y: State, part: Codes, limit: Floats, scale: Floats, steep: float, F: Floats) -> bool:
    """Forces within discs of radius ``limit`` (n_c,) that make F D F/2 + a0 F least, from those that stand in F."""
    m = F.shape[0]
    ahead, last, step = F.copy(), F.copy(), np.zeros(m)
    speed = 1.0
    for _ in range(MOST):
        if stopped():
            return False
        for a in range(m):
            step[a] = scale[a] / steep * relative_acceleration(ports, y, ahead, a)
        for a in range(m):
            F[a] = ahead[a] - step[a]
        for k in range(limit.shape[0]):
            row0, row1 = ports.row[k], ports.row[k + 1]
            size = slip_speed(F, row0, row1 - row0)
            if part[k] != 0 and size > limit[k]:
                for a in range(row0, row1):
                    F[a] *= limit[k] / size
        uphill, moved = 0.0, 0.0
        for a in range(m):
            if scale[a] > 0.0:
                uphill += (ahead[a] - F[a]) * (F[a] - last[a]) / scale[a]
                moved = max(moved, abs(F[a] - ahead[a]))
        if moved * steep <= FINE * largest(F) or moved == 0.0:
            return True
        new = 1.0 if uphill > 0.0 else 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * speed * speed))
        push = 0.0 if uphill > 0.0 else (speed - 1.0) / new
        speed = new
        for a in range(m):
            ahead[a] = F[a] + push * (F[a] - last[a])
            last[a] = F[a]
    return bool(moved * steep <= COARSE * largest(F))
