"""The matrix of an instant: motion, constraints and friction together, and solving with it."""

from __future__ import annotations

from fricmb.integrate.compile.band import factor_band, solve_band
from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.equations.friction_rows import add_friction
from fricmb.integrate.implicit.equations.jacobian_layers import add, add_contacts, add_joints, add_mass
from fricmb.integrate.implicit.equations.slip_rows import SETTING_OUT, add_stick
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.problem import STICK

#: What of friction the matrix of an instant holds.
NONE, STUCK, ALL = 0, 1, 2


@kernel
def serves_again(w: Instant, y: State) -> bool:
    """Whether the factors that are there are those of y: where nothing turns they depend on modes alone."""
    again = w.kept == 1
    for c in range(y.mode.shape[0]):
        again = again and w.mode[c] == y.mode[c]
    return bool(again)


@kernel
def keep(mech: Mech, w: Instant, y: State) -> None:
    """Remember of which modes the factors with all of friction are, where they can serve again."""
    turns = mech.place.address.shape[0] > 0 or mech.joint.n_x.shape[0] > 0
    w.kept = 0 if turns else 1
    for c in range(y.mode.shape[0]):
        w.mode[c] = y.mode[c]
        if y.mode[c] == SETTING_OUT:  # in a direction that follows from the force
            w.kept = 0


@kernel
def all_stick(y: State) -> bool:
    """Whether nothing slips, is open or follows a smooth law."""
    stick = True
    for c in range(y.mode.shape[0]):
        stick = stick and y.mode[c] == STICK
    return stick


@block
def instant_matrix(mech: Mech, k: Moving, w: Instant, y: State, friction: int) -> bool:
    """Factor the matrix of the instant; False where it is singular.

    ``friction``: NONE leaves the forces of friction at 0, STUCK keeps ports that stick together, ALL is friction.
    """
    order = mech.order
    if friction == STUCK and y.lam.shape[0] == 0 and all_stick(y):
        friction = ALL  # the same matrix, and the one that is kept
    if friction == ALL and serves_again(w, y):
        return True
    w.kept = 0
    rows, nz = y.F.shape[0], y.z.shape[0]
    w.L.A0[:] = 0.0
    w.L.A1[:] = 0.0
    add_mass(mech, w.L)
    add_joints(mech, k, y.lam, y.F, w.L, False)
    add_contacts(mech, k, y.mode, w.L, False)
    size = order.place.shape[0]
    if friction == ALL:
        add_friction(mech, k, y.mode, y.n, y.F, y.lam, y.z, y.N, y.g, y.ga, w.L, False)
    else:
        for c in range(y.mode.shape[0]):
            row = size - nz - rows + mech.port.row[c]
            if friction == STUCK and y.mode[c] == STICK:
                add_stick(mech, k, c, y.lam, w.L, row, False)
                continue
            for a in range(mech.port.row[c + 1] - mech.port.row[c]):
                add(order, w.L.A1, row + a, row + a, 1.0)
    for i in range(nz):
        add(order, w.L.A1, size - nz + i, size - nz + i, 1.0)
    for i in range(w.ab.shape[0]):
        w.ab[i] = w.L.A0[i] + w.L.A1[i]
    if not factor_band(w.ab, w.pivots, order.sizes):
        return False
    if friction == ALL:
        keep(mech, w, y)
    return True


@kernel
def solve_instant(mech: Mech, w: Instant) -> None:
    """Solve with the factored matrix: ``w.x`` from ``w.r``."""
    place = mech.order.place
    for i in range(place.shape[0]):
        w.x[place[i]] = w.r[i]
    solve_band(w.ab, w.pivots, mech.order.sizes, w.x)
    for i in range(place.shape[0]):
        w.r[i] = w.x[place[i]]
