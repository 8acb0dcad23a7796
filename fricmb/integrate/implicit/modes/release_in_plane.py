"""Who lets go of ports at rest in the plane, under loads that no friction changes: as ``release_in_turn``, over discs.

Forces at rest are the solution of one convex problem: within discs of a radius for each port they make the energy of
the accelerations least; those within their disc leave no acceleration, the others are at its rim, against it (maximal
dissipation).  A port's disc has no rim while it sticks, and the radius ``mu_k N`` once it has let go; the one furthest
beyond ``mu_s N`` lets go next.  Ports may be redundant: of what they share the least is taken.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.equations.accelerations import react
from fricmb.integrate.implicit.equations.slip_rows import friction_coefficient, guided
from fricmb.integrate.implicit.modes.load_share import Loops
from fricmb.integrate.implicit.modes.loop_mobility import mobility
from fricmb.integrate.implicit.modes.mode_trial import IN_LOOP, at_rest, release
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.model.friction_cone import stick_limit
from fricmb.integrate.model.friction_discs import least_energy, units
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.problem import OPEN, SLIP, STICK, Codes, Floats

#: A radius that no force reaches, in units of the largest limit; part of its radius within which a force is inside.
NO_RIM, INSIDE = 1e9, 1.0 - 1e-7
#: Part of its limit by which a force is beyond it.
BEYOND = 1e-9


@kernel
def has_own_limits(mech: Mech, y: State, part: Codes) -> bool:
    """Whether some port is at rest, each has a limit of its own, and no load follows from friction."""
    some, plain = False, y.lam.shape[0] == 0
    for c in range(part.shape[0]):
        if at_rest(mech, y, c, part):
            some = True
            plain = plain and mech.port.lean[c] == 0.0
            for a in range(mech.port.row[c + 1] - mech.port.row[c]):
                plain = plain and not guided(mech, c, a)
    return some and plain


@kernel
def furthest_beyond(mech: Mech, taken: Codes, radius: Floats, limit: Floats, F: Floats) -> int:
    """The port that sticks and is furthest beyond its limit, or -1."""
    worst, over = -1, 1.0 + BEYOND
    for c in range(taken.shape[0]):
        size = magnitude(mech.port.row, c, F)
        if taken[c] == 1 and radius[c] > limit[c] and size > over * limit[c]:
            worst, over = c, size / max(limit[c], 1e-300)
    return worst


@block
def release_in_plane(mech: Mech, k: Moving, w: Instant, y: State, part: Codes, forced: int) -> bool:
    """Modes, forces and directions of all ports at rest; False where loads follow from friction.

    ``forced`` (or -1), and what IN_LOOP in ``part``, has let go already.
    """
    if not has_own_limits(mech, y, part):
        return False
    n_c, row, before = part.shape[0], mech.port.row, y.mode.copy()
    taken, held = np.zeros(n_c, np.int8), np.full(n_c, SLIP, np.int8)
    for c in range(n_c):
        if at_rest(mech, y, c, part):
            taken[c], held[c] = 1, STICK
            y.mode[c] = OPEN
    if not react(mech, k, w, y, False):
        y.mode[:] = before
        return False
    free = y.ga.copy()
    rows = Loops(row, mobility(mech, k, w, y, held, np.zeros((y.F.shape[0], 0))))
    scale, F = np.zeros(y.F.shape[0]), np.zeros(y.F.shape[0])
    steep = units(rows, taken, scale)
    limit, slips, radius = np.zeros(n_c), np.zeros(n_c), np.zeros(n_c)
    for c in range(n_c):
        load = max(y.N[c], 0.0)
        limit[c] = stick_limit(mech.port, mech.port.laws, c, k.s, load)
        slips[c] = friction_coefficient(mech, k, c, 0.0, load)[0] * load
    rim = NO_RIM * limit.max()
    for c in range(n_c):
        radius[c] = slips[c] if c == forced or part[c] == IN_LOOP else rim
    worst = 0
    while worst >= 0:
        if not least_energy(rows, free, taken, radius, scale, steep, F):
            y.mode[:] = before
            return False
        worst = furthest_beyond(mech, taken, radius, limit, F)
        if worst >= 0:
            radius[worst] = slips[worst]
    y.mode[:] = before
    for c in range(n_c):
        if taken[c] == 1:
            y.mode[c] = STICK
            for a in range(row[c], row[c + 1]):
                y.F[a] = F[a]
            if radius[c] < rim and magnitude(row, c, F) >= INSIDE * radius[c]:
                release(mech, k, y, c)
    return True
