"""A set of stick and slip at an instant that always exists: release after release, each time a convex problem.

Contacts that are released have friction of at most mu(0) N and take the forces that make the kinetic energy of the
accelerations least (maximal dissipation); those that are not are held.  That problem has a solution whatever D is, and
it is one in which a released contact either slips against its force or is held again by less than mu(0) N.  Whatever
is held by more than mu_s N is released, the worst first, and never taken back: after as many releases as there are
contacts nothing is left to release.  Redundant contacts are held by up to mu_s N from the start, and what moves all the
same is released: which of them bears how much says nothing.  (Newton's method on modes that are guessed is faster, and
is tried before.)
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.friction_cone import load_factor
from fricmb.integrate.model.friction_discs import largest, least_energy, relative_acceleration, units
from fricmb.integrate.model.law_values import magnitude, point_along
from fricmb.integrate.model.problem_structs import Ports
from fricmb.integrate.model.state import State
from fricmb.integrate.problem import OPEN, SLIP, STICK, Codes, Floats

#: Relative accelerations that are none, beside the largest that there would be without friction.
STARTS = 1e-9


@kernel
def release(ports: Ports, y: State, part: Codes, mode: Codes, F: Floats) -> bool:
    """Modes and forces of the contacts that take part; False where the gradients did not get there.

    ``part`` (n_c,): 0 leaves a contact out, 2 is one that is released already.  ``F`` (m,) and ``y.n`` are filled.
    """
    nc = mode.shape[0]
    shared = ports.soft > 0.0
    free = np.zeros(nc, np.bool_)
    limit = np.zeros(nc)
    scale = np.zeros(F.shape[0])
    steep = units(ports, part, scale)
    for k in range(nc):
        free[k] = part[k] == 2
    F[:] = 0.0
    for _ in range(nc + 1):
        for k in range(nc):
            limit[k] = ports.mu_0[k] * y.N[k] if free[k] else (ports.mu_s[k] * y.N[k] if shared else np.inf)
        if not least_energy(ports, y.a0, part, limit, scale, steep, F):
            return False
        worst, excess = -1, 1.0 + 1e-9
        for k in range(nc):
            if part[k] == 0 or free[k]:
                continue
            if shared:
                # what cannot be held moves, whatever shares of the load the others take
                rate = slip_start(ports, y, F, k) / (STARTS * largest(y.a0))
                if rate > excess:
                    worst, excess = k, rate
                continue
            ratio = load_factor(ports, k, F, ports.mu_s[k] * y.N[k])
            if ratio > excess:
                worst, excess = k, ratio
        if worst < 0:
            break
        free[worst] = True
    for k in range(nc):
        mode[k] = OPEN
        if part[k] != 0:
            size = magnitude(ports.row, k, F)
            # on its cone and not accelerated it is held, but for one that has just been found to break away
            slips = free[k] and size >= (1.0 - 1e-9) * limit[k]
            slips = slips and (part[k] == 2 or slip_start(ports, y, F, k) > STARTS * largest(y.a0))
            mode[k] = SLIP if slips else STICK
            if slips:
                point_along(ports.row, k, F, -1.0, y.n)
    return True


@kernel
def slip_start(ports: Ports, y: State, F: Floats, k: int) -> float:
    """Magnitude of the relative acceleration of contact k."""
    total = 0.0
    for a in range(ports.row[k], ports.row[k + 1]):
        total += relative_acceleration(ports, y.a0, F, a) ** 2
    return float(np.sqrt(total))
