"""What an impact is computed from: rows of normal and tangential velocities, distances, and their accelerations."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import entry, kernel
from fricmb.integrate.implicit.equations.accelerations import accelerations_of_places
from fricmb.integrate.implicit.equations.forces import bend, call_joint, directions, friction_at, move, value_of_form
from fricmb.integrate.implicit.events.event_functions import gap_noise
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import State
from fricmb.integrate.problem import Floats, Floats2


@kernel
def rates(mech: Mech, k: Moving, lam: Floats, normal: Floats, slip: Floats) -> None:
    """Rates of all constraints (m,), those of open joints as well, and slip velocities (m_p,), at X."""
    joint, port = mech.joint, mech.port
    for j in range(joint.n_x.shape[0]):
        n_x = call_joint(mech, k, j, lam)
        m, c = joint.row[j + 1] - joint.row[j], joint.port[j]
        for r in range(m):
            value = 0.0
            for a in range(n_x):
                value += k.out[m + r * n_x + a] * k.x[n_x + a]
            normal[joint.row[j] + r] = value
        at = friction_at(n_x, m)
        for i in range(directions(mech, c) if c >= 0 else 0):
            value = 0.0
            for a in range(n_x):
                value += k.out[at + i * n_x + a] * k.x[n_x + a]
            slip[port.row[c] + i] = value
    for c in range(port.joint.shape[0]):
        for a in range(port.row[c], port.row[c + 1] if port.joint[c] < 0 else port.row[c]):
            form = port.slip.x_start[c] + 2 * (a - port.row[c]) + 1
            slip[a] = value_of_form(k, port.slip, form) - port.w[a]


@kernel
def rows_at(
    mech: Mech, k: Moving, y: State, v: Floats, G: Floats2, G0: Floats, W: Floats2, W0: Floats, gap: Floats,
    noise: Floats, normal: Floats, slip: Floats,
) -> None:  # fmt: skip
    """Rates at the instant of y as linear functions of velocities: ``G v + G0`` (m,) of constraints, ``W v + W0`` slip.

    ``gap``, ``noise`` (n_j,): value of the first constraint of each joint and its round-off; ``v`` (n,), ``normal``
    (m,), ``slip`` (m_p,) are space.
    """
    v[:] = 0.0
    move(mech, k, y.t, y.q, v)
    rates(mech, k, y.lam, G0, W0)
    for i in range(v.shape[0]):
        v[:] = 0.0
        v[i] = 1.0
        move(mech, k, y.t, y.q, v)
        rates(mech, k, y.lam, normal, slip)
        for r in range(normal.shape[0]):
            G[r, i] = normal[r] - G0[r]
        for a in range(slip.shape[0]):
            W[a, i] = slip[a] - W0[a]
    move(mech, k, y.t, y.q, y.v)
    for j in range(mech.joint.n_x.shape[0]):
        n_x = call_joint(mech, k, j, y.lam)
        some = mech.joint.row[j + 1] > mech.joint.row[j]
        gap[j] = k.out[0] if some else 0.0
        noise[j] = gap_noise(mech, k, j, n_x) if some and mech.joint.one_sided[j] != 0 else 0.0


@kernel
def accelerations_of_gaps(mech: Mech, k: Moving, y: State, found: Floats) -> None:
    """Second derivatives (n_j,) of the distances of one-sided joints, open or not, with the accelerations of y."""
    joint = mech.joint
    move(mech, k, y.t, y.q, y.v)
    accelerations_of_places(mech, k, y.a)
    for j in range(joint.n_x.shape[0]):
        found[j] = 0.0
        if joint.one_sided[j] == 0:
            continue
        n_x = call_joint(mech, k, j, y.lam)
        B = 1 + n_x + n_x * n_x
        for a in range(n_x):
            found[j] += k.out[1 + a] * bend(k, joint.table, joint.table.x_start[j] + a)
            found[j] += k.out[B + a] * k.x[n_x + a]


@entry
def impact_rows(
    mech: Mech, k: Moving, y: State, v: Floats, G: Floats2, G0: Floats, W: Floats2, W0: Floats, gap: Floats,
    noise: Floats, normal: Floats, slip: Floats,
) -> None:  # fmt: skip
    """As ``rows_at``."""
    rows_at(mech, k, y, v, G, G0, W, W0, gap, noise, normal, slip)


@entry
def gap_accelerations(mech: Mech, k: Moving, y: State, found: Floats) -> None:
    """As ``accelerations_of_gaps``."""
    accelerations_of_gaps(mech, k, y, found)
