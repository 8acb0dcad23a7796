"""Modes at an instant: which of the contacts at rest stick, and where the others set out to (set-valued laws).

The problem is one of accelerations (``rest_problem``).  All are tried stuck; the worst beyond its cone is released,
one at a time.  For mu_s > mu_0 more than one set may hold: what comes to rest is released before what has
rested, which lets go only where it has to.  A cone is never split into axes.  Where these trials turn in a circle,
``disc_projection.release`` finds a set that holds.
"""

from __future__ import annotations

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.contact.rest_problem import Rest, solve_rest
from fricmb.integrate.model.accelerations import accelerate, complete, kinematics, known_forces, solve_response
from fricmb.integrate.model.forces import Scratch, normal_force
from fricmb.integrate.model.law_values import magnitude, point_along
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import INFINITE, State
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, SLIP, STICK


@block
def settle(packed: Packed, s: Scratch, y: State, r: Rest) -> int:
    """Find modes, directions, forces and accelerations of the state: contacts with ``r.part`` 0 keep their mode.

    On entry part marks contacts at rest (1) or just released (2).  Velocities of those at rest are projected to g = 0.
    Returns 0, or 1 where no consistent modes were found, 2: stuck contacts redundant, 3: accelerations infinite.
    """
    sizes, pivots = r.w.sizes, r.w.pivots
    some = False
    for k in range(y.mode.shape[0]):
        r.rested[k] = 1 if y.mode[k] == STICK else 0
        r.tol[k] = y.size[packed.ports.row[k]]
    for k in range(y.mode.shape[0]):
        if r.part[k] != 0:
            some = True
            y.mode[k] = STICK
    if some:
        project(packed, s, y, r)
        kinematics(packed, s, y)
        if packed.ports.soft > 0.0 and find_held(packed, y, r):
            project(packed, s, y, r)
            kinematics(packed, s, y)
        known_forces(packed, s, y)
        if solve_rest(packed, s, y, r) < 0:
            return 1
    if not complete(packed, s, y, sizes, pivots):
        return 3 if y.fault == INFINITE else 2
    return 0


@kernel
def find_held(packed: Packed, y: State, r: Rest) -> bool:
    """Mark contacts that slip by no more than round-off once those at rest do not: loops close through them.

    ``r.tol`` has the sizes of their velocities before.
    """
    some = False
    for k in range(y.mode.shape[0]):
        speed = magnitude(packed.ports.row, k, y.g)
        slips = r.part[k] == 0 and y.mode[k] == SLIP and packed.ports.law[k] != LAW_SMOOTH
        if slips and speed <= 1e-13 * r.tol[k] + r.small[k]:
            r.part[k] = 1
            y.mode[k] = STICK
            some = True
    return some


@kernel
def project(packed: Packed, s: Scratch, y: State, r: Rest) -> None:
    """Take the last round-off of g away where a contact is at rest: v += M^-1 W D^-1 (-g), momentum conserved.

    Forces and accelerations of ``y`` are lost.
    """
    kinematics(packed, s, y)
    size = 0
    for k in range(y.mode.shape[0]):
        if r.part[k] == 0:
            continue
        for a in range(packed.ports.row[k], packed.ports.row[k + 1]):
            y.rhs[size] = -y.g[a]
            size += 1
    if size == 0:
        return
    if not solve_response(packed.ports, y, r.part, False, size, r.w.sizes, r.w.pivots):
        return
    i = 0
    y.f[:] = 0.0
    for k in range(y.mode.shape[0]):
        if r.part[k] == 0:
            continue
        for a in range(packed.ports.row[k], packed.ports.row[k + 1]):
            for b in range(y.q.shape[0]):
                y.f[b] += packed.ports.W[b, a] * y.rhs[i]
            i += 1
    accelerate(packed.structure, y.f, y.a)
    for b in range(y.q.shape[0]):
        y.v[b] += y.a[b]


@block
def mark_rest(packed: Packed, s: Scratch, y: State, r: Rest, jumped: bool) -> None:
    """Mark as at rest every contact that sticks or whose relative velocity is nothing but round-off.

    ``jumped``: prescribed velocities may have jumped; what stuck slips then, where it has a speed.
    """
    kinematics(packed, s, y)
    for k in range(y.mode.shape[0]):
        row0 = packed.ports.row[k]
        r.part[k] = 0
        if packed.ports.law[k] == LAW_SMOOTH or y.mode[k] == OPEN:
            continue
        speed = magnitude(packed.ports.row, k, y.g)
        if y.mode[k] == STICK or speed <= 8e-16 * y.size[row0] + r.small[k]:
            r.part[k] = 1
        if jumped and y.mode[k] == STICK and speed > 1e-9 * y.size[row0] + 1e3 * r.small[k]:
            # else what drifts in stick is what a step leaves between its nodes
            r.part[k] = 0
            y.mode[k] = SLIP
        if r.part[k] == 0:
            point_along(packed.ports.row, k, y.g, 1.0, y.n)


@block
def find_open(packed: Packed, s: Scratch, y: State) -> None:
    """Open the contacts whose normal force is not positive, close the others."""
    kinematics(packed, s, y)
    for k in range(y.mode.shape[0]):
        if packed.ports.var[k] < 0:
            continue
        if normal_force(packed.ports, packed.normals, k, s) <= 0.0:
            y.mode[k] = OPEN
        elif y.mode[k] == OPEN:
            y.mode[k] = SLIP
