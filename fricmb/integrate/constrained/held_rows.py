"""What sticks at dense rows: its forces, and accelerations and velocities with them, by its mobility alone."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.long_loops import long_loops
from fricmb.integrate.constrained.dense_rows import add_forces
from fricmb.integrate.constrained.forces import forces
from fricmb.integrate.constrained.loop_mobility import DEPENDENT
from fricmb.integrate.constrained.moving import Moving
from fricmb.integrate.constrained.problem_structs import Mech
from fricmb.integrate.constrained.slip_accelerations import slip_accelerations
from fricmb.integrate.constrained.slip_rows import SETTING_OUT, carried, friction_coefficient, guided
from fricmb.integrate.constrained.state import Held, State
from fricmb.integrate.problem import SLIP, STICK, Codes


@kernel
def list_held(mech: Mech, mode: Codes, held: Held) -> bool:
    """List the rows that stick; whether they are those whose factors are there."""
    same, count = held.stamp == mech.dense.stamp, 0
    for c in range(mode.shape[0]):
        for a in range(mech.port.row[c], mech.port.row[c + 1] if mode[c] == STICK else mech.port.row[c]):
            if not guided(mech, c, a - mech.port.row[c]):
                same = same and count < held.count and held.row[count] == a
                held.row[count] = a
                count += 1
    same = same and count == held.count
    held.count = count
    return bool(same)


@kernel
def factor_held(mech: Mech, mode: Codes, held: Held) -> bool:
    """Cholesky factors of the mobility of all that sticks; False where some of it is nearly redundant.

    Its lower factor turned, so that loops go along rows.
    """
    if list_held(mech, mode, held):
        return True
    held.stamp = 0
    U, D = held.factor, mech.dense.mobility
    for a in range(held.count):
        line, row = U[a], D[held.row[a]]
        for b in range(a, held.count):
            line[b] = row[held.row[b]]
        for i in range(a):
            before, share = U[i], U[i, a]
            for b in range(a, held.count):
                line[b] -= share * before[b]
        if not line[a] > DEPENDENT * row[held.row[a]]:
            return False
        root = np.sqrt(line[a])
        for b in range(a, held.count):
            line[b] /= root
    held.stamp = mech.dense.stamp
    return True


@kernel
def solve_held(held: Held) -> None:
    """Forces that bring the accelerations in ``held.side``, in place of these."""
    U, x = held.factor, held.side
    for a in range(held.count):
        line = U[a]
        x[a] /= line[a]
        for i in range(a + 1, held.count):
            x[i] -= line[i] * x[a]
    for a in range(held.count - 1, -1, -1):
        line, value = U[a], x[a]
        for i in range(a + 1, held.count):
            value -= line[i] * x[i]
        x[a] = value / line[a]


@kernel
def put_forces(mech: Mech, k: Moving, held: Held) -> None:
    """What forces in ``held.side`` do to all coordinates, into ``k.fy``."""
    k.rows[0, :] = 0.0
    for i in range(held.count):
        k.rows[0, held.row[i]] = held.side[i]
    k.fy[:] = 0.0
    add_forces(mech.dense.on, k.rows[0], k.fy)


@block
@long_loops
def react_at_rows(mech: Mech, k: Moving, y: State, held: Held) -> bool:
    """Accelerations and friction forces of the modes at X; False where there are none, or some are nearly redundant.

    Once by the mobility of what sticks, and once more for the round-off of that.  Where a port sets out in a plane its
    direction follows from its force, and equations are not linear: False, too.
    """
    for c in range(y.mode.shape[0]):
        if y.mode[c] == SETTING_OUT:
            return False
    if not factor_held(mech, y.mode, held):
        return False
    row = mech.port.row
    forces(mech, k, y.lam, y.F, y.N, y.g)
    for c in range(y.mode.shape[0]):
        load, size = carried(mech, c, y.N[c]), 0.0
        if y.mode[c] == SLIP:
            size = friction_coefficient(mech, k, c, 0.0, load)[0] * load
        for a in range(row[c], row[c + 1]):
            y.F[a] = -y.n[a] * size
    forces(mech, k, y.lam, y.F, y.N, y.g)
    for i in range(y.a.shape[0]):
        y.a[i] = mech.dense.inverse[i] * k.fy[i]
    for _ in range(2 if held.count > 0 else 0):
        k.ddy[:] = y.a
        slip_accelerations(mech, k, y)
        for i in range(held.count):
            held.side[i] = -y.ga[held.row[i]]
        solve_held(held)
        put_forces(mech, k, held)
        for i in range(held.count):
            y.F[held.row[i]] += held.side[i]
        for i in range(y.a.shape[0]):
            y.a[i] += mech.dense.inverse[i] * k.fy[i]
    k.ddy[:] = 0.0
    sound = 0.0
    for i in range(y.a.shape[0]):
        sound += 0.0 * y.a[i]
    return bool(sound == 0.0)


@block
@long_loops
def stop_rows(mech: Mech, k: Moving, y: State, held: Held) -> bool:
    """Move v the least so that what sticks does not slip, slip velocities being known; False as above."""
    if not factor_held(mech, y.mode, held):
        return False
    for i in range(held.count):
        held.side[i] = -y.g[held.row[i]]
    solve_held(held)
    put_forces(mech, k, held)
    for i in range(y.v.shape[0]):
        y.v[i] += mech.dense.inverse[i] * k.fy[i]
    return True
