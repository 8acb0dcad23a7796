"""Derivatives of slip velocities at an instant."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.equations.forces import (
    bend,
    call_joint,
    directions,
    friction_at,
    has_dense_rows,
    slope_at,
)
from fricmb.integrate.implicit.scene.dense_rows import put_path
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import State
from fricmb.integrate.problem import Floats


@kernel
def slip_acceleration(mech: Mech, k: Moving, c: int, lam: Floats, a: int) -> float:
    """Derivative of the slip velocity of port c in direction a, the second derivatives in ``ddy`` being complete."""
    j = mech.port.joint[c]
    if j < 0:
        return bend(k, mech.port.slip, mech.port.slip.x_start[c] + 2 * a)
    n_x = call_joint(mech, k, j, lam)
    at = friction_at(n_x, mech.joint.row[j + 1] - mech.joint.row[j])
    value, d = 0.0, directions(mech, c)
    for i in range(n_x):
        value += k.out[at + a * n_x + i] * bend(k, mech.joint.table, mech.joint.table.x_start[j] + i)
        for b in range(n_x):
            value += k.out[slope_at(n_x, at, d, a, i) + b] * k.x[n_x + i] * k.x[n_x + b]
    return value


@kernel
def slip_accelerations(mech: Mech, k: Moving, y: State) -> None:
    """Derivatives of all slip velocities, the second derivatives in ``ddy`` being complete, into ``y.ga``."""
    if has_dense_rows(mech):
        dense = mech.dense
        put_path(dense.of, k.ddy, k.rows[0])
        for a in range(y.ga.shape[0]):
            y.ga[a] = k.rows[0, a]
            for b in range(k.s.ddu.shape[0]):
                y.ga[a] += dense.by_u[a, b] * k.s.ddu[b]
        return
    row = mech.port.row
    for c in range(y.mode.shape[0]):
        for a in range(row[c + 1] - row[c]):
            y.ga[row[c] + a] = slip_acceleration(mech, k, c, y.lam, a)
