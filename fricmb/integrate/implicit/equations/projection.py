"""Back onto the constraints: positions, then velocities, along the inverse mass matrix."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.equations.forces import forces, has_dense_rows, move
from fricmb.integrate.implicit.equations.instant_matrix import ALL, NONE, STUCK, instant_matrix, solve_instant
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.implicit.stages.held_rows import stop_rows
from fricmb.integrate.problem import STICK
from fricmb.integrate.run.breakpoints import EPS

#: Corrections of positions at most: after a step one or two are needed.
CORRECTIONS = 6
#: Last correction, beside the largest coordinate of a body or of a point, with which joints count as closed: larger
#: ones go nowhere.  (Round-off of constraints is that of points, also where bodies move by next to nothing.)
CLOSED = 1e-10


@kernel
def is_closed(k: Moving, last: float) -> bool:
    """Whether corrections have come to their end with a last one."""
    extent = 0.0
    for e in range(k.ddy.shape[0]):
        extent = max(extent, abs(k.s.X[1 + e]))
    return bool(last <= CLOSED * extent)


@block
def project_positions(mech: Mech, k: Moving, w: Instant, y: State) -> bool:
    """Move q the least, in the norm of the mass matrix, so that phi(q) = 0 to round-off; leaves the factored matrix."""
    n, m = y.q.shape[0], y.lam.shape[0]
    last, change = 1e300, 0.0
    for i in range(CORRECTIONS):
        move(mech, k, y.t, y.q, y.v)
        forces(mech, k, y.lam, y.F, y.N, y.g)
        if i == 0 and not instant_matrix(mech, k, w, y, NONE):
            return False
        for j in range(w.r.shape[0]):
            w.r[j] = 0.0
        for j in range(m):
            w.r[n + j] = k.phi[j]
        solve_instant(mech, w)
        largest = change = 0.0
        size, group = w.other, mech.group
        size[:] = 1e-290
        # by the roots of masses: lengths and angles have no other measure in common
        for j in range(n):
            y.q[j] -= w.r[j]
            change = max(change, abs(w.r[j]))
            size[group[j]] = max(size[group[j]], np.sqrt(mech.mass[j]) * abs(y.q[j]))
        for j in range(n):
            largest = max(largest, np.sqrt(mech.mass[j]) * abs(w.r[j]) / size[group[j]])
        if not change < 1e300:
            return False
        if largest <= 4.0 * EPS or (i > 1 and largest > 0.5 * last):
            return is_closed(k, change)
        last = largest
    return is_closed(k, change)


@block
def project_velocities(mech: Mech, k: Moving, w: Instant, y: State, factored: bool, stuck: bool) -> bool:
    """Move v the least so that the constraints' rates, and the slip of ports that stick (``stuck``), are 0."""
    n, m, n_c = y.q.shape[0], y.lam.shape[0], y.mode.shape[0]
    row = mech.port.row
    move(mech, k, y.t, y.q, y.v)
    forces(mech, k, y.lam, y.F, y.N, y.g)
    if stuck and has_dense_rows(mech) and stop_rows(mech, k, y, w.held):
        move(mech, k, y.t, y.q, y.v)
        forces(mech, k, y.lam, y.F, y.N, y.g)
        return True
    # without joints no load is a reaction: friction of what slips adds nothing that accelerations or forces bring
    friction = STUCK if m > 0 else ALL
    if not (factored and not stuck) and not instant_matrix(mech, k, w, y, friction if stuck else NONE):
        return False
    for _ in range(2):
        for j in range(w.r.shape[0]):
            w.r[j] = 0.0
        for j in range(m):
            w.r[n + j] = k.phi_rate[j]
        for c in range(n_c):
            if stuck and y.mode[c] == STICK:
                for a in range(row[c], row[c + 1]):
                    w.r[n + m + a] = y.g[a]
        solve_instant(mech, w)
        for j in range(n):
            y.v[j] -= w.r[j]
        move(mech, k, y.t, y.q, y.v)
        forces(mech, k, y.lam, y.F, y.N, y.g)
    return True
