"""How a group that gives way sets out in the plane: forces of friction that its motion follows from, to begin with.

Directions of slip follow from one another, and where none of the group moves yet they are anything.  Under given loads
the forces are those within discs of radius mu_k N that make the energy of the accelerations least (maximal
dissipation), a convex problem; loads follow, and come in anew until nothing changes.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.implicit.equations.accelerations import react
from fricmb.integrate.implicit.equations.instant_matrix import NONE, instant_matrix, solve_instant
from fricmb.integrate.implicit.equations.slip_rows import SETTING_OUT, friction_coefficient
from fricmb.integrate.implicit.modes.group_cones import load_of
from fricmb.integrate.implicit.modes.load_share import Loops
from fricmb.integrate.implicit.modes.loop_mobility import holds, mobility
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.model.friction_discs import largest, least_energy, units
from fricmb.integrate.model.law_values import magnitude, point_along
from fricmb.integrate.problem import OPEN, SLIP, STICK

#: Times that loads come in anew, and the change of forces, beside the largest, that is nothing.
ROUNDS, SAME = 60, 1e-10


@block
def start_group(mech: Mech, k: Moving, w: Instant, y: State) -> None:
    """Forces, reactions and accelerations of ports that set out together; left as they are where none are found."""
    n_c, n, m, row = y.mode.shape[0], y.q.shape[0], y.lam.shape[0], mech.port.row
    held, taken, count = np.full(n_c, SLIP, np.int8), np.zeros(n_c, np.int8), 0
    for c in range(n_c):
        if y.mode[c] == SETTING_OUT:
            held[c], taken[c] = STICK, 1
            count += 1
    if count < 2:
        return
    forces, reactions, accelerations = y.F.copy(), y.lam.copy(), y.a.copy()
    for c in range(n_c):
        y.mode[c] = OPEN if taken[c] == 1 else y.mode[c]
    found = react(mech, k, w, y, False)
    free, alone, rest = y.ga.copy(), y.lam.copy(), y.a.copy()
    for c in range(n_c):
        y.mode[c] = SETTING_OUT if taken[c] == 1 else y.mode[c]
    answers, scale, F = np.zeros((y.F.shape[0], m)), np.zeros(y.F.shape[0]), np.zeros(y.F.shape[0])
    if found:
        loops = Loops(row, mobility(mech, k, w, y, held, answers))
        steep, lam, limit = units(loops, taken, scale), alone.copy(), np.zeros(n_c)
        for _ in range(ROUNDS):
            for c in range(n_c):
                if taken[c] == 1:
                    load = max(load_of(mech, k, c, lam) if holds(mech, c) else y.N[c], 0.0)
                    limit[c] = friction_coefficient(mech, k, c, 0.0, load)[0] * load
            before = F.copy()
            least_energy(loops, free, taken, limit, scale, steep, F)
            for i in range(m):
                lam[i] = alone[i]
                for a in range(F.shape[0]):
                    lam[i] += answers[a, i] * F[a]
            if largest(F - before) <= SAME * largest(F):
                break
        found = instant_matrix(mech, k, w, y, NONE)
    if not found:
        y.F[:], y.lam[:], y.a[:] = forces, reactions, accelerations
        return
    w.r[:] = 0.0
    for a in range(F.shape[0]):
        w.r[n + m + a] = F[a]
    solve_instant(mech, w)
    for i in range(n):
        y.a[i] = rest[i] + w.r[i]
    for i in range(m):
        y.lam[i] = alone[i] + w.r[n + i]
    for c in range(n_c):
        if taken[c] == 1 and magnitude(row, c, F) > 0.0:
            for a in range(row[c], row[c + 1]):
                y.F[a] = F[a]
            k.held[c] = magnitude(row, c, F)
            point_along(row, c, F, -1.0, y.n)
