"""A problem with a mechanism as rooms for kernels."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.band import band_sizes
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.compile.room import room
from fricmb.integrate.implicit.modes.loop_softness import shares_a_loop, softness
from fricmb.integrate.implicit.scene.blocks_of_mechanism import load_mechanism
from fricmb.integrate.implicit.scene.dense_rows import DenseRows, dense_rows
from fricmb.integrate.implicit.scene.pattern import of_pattern
from fricmb.integrate.implicit.scene.structure import mechanism_of
from fricmb.integrate.implicit.scene.unknown_order import ordering
from fricmb.integrate.mechanism import Mechanism, loads_of
from fricmb.integrate.model.damped_normals import damped_normals
from fricmb.integrate.model.problem_structs import Spread, Table, knot_starts, leans, spread_of, table_of
from fricmb.integrate.model.structure import ties
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import NORMAL_CONSTANT, NORMAL_LAW, Codes, Floats, Ints, Pivots, Problem


class Linear(Layout):
    """Entries of mass, stiffness, damping and input; constant force over [y, u].

    ``tie`` for each entry of K, ``alone`` for each row: see :func:`ties`; empty for soft structures.
    """

    Mi: Ints
    Mj: Ints
    M: Floats
    Ki: Ints
    Kj: Ints
    K: Floats
    Ci: Ints
    Cj: Ints
    C: Floats
    Bi: Ints
    Bj: Ints
    B: Floats
    f: Floats
    tie: Floats
    alone: Floats


class Place(Layout):
    """Points fixed in bodies (see Places) and where their derivatives stand in ``Moving``.

    Extended coordinate e depends on the dofs ``dof[start[e]:start[e+1]]`` with the derivatives ``grad[at[...]]`` (-1:
    the coordinate is the dof itself).
    """

    address: Ints
    p_start: Ints
    p: Floats
    dof_start: Ints
    dof: Ints
    first: Ints
    grad_start: Ints
    hess_start: Ints
    y_start: Ints
    y_dof: Ints
    y_at: Ints


class Joint(Layout):
    """Joints (see Joints); ``n_x`` (k,) local coordinates."""

    table: Table
    row: Ints
    load_of: Ints
    n_x: Ints
    port: Ints
    one_sided: Codes
    hands_over: Codes
    dropped: Codes


class Port(Layout):
    """Friction: port c has the rows ``row[c]:row[c+1]``, one a direction of slip.

    ``joint`` (n_c,) the joint it belongs to or -1; ``slip`` of the others two forms a row, coordinate and velocity.
    ``knot_start``, ``knots``: see ``Contacts``; ``damped`` (n_c,) 1 where a normal-force law depends on a rate;
    ``soft`` (n_c,) softness of a port that sticks, beside that of its bodies (see ``loop_softness``).
    """

    joint: Ints
    row: Ints
    soft: Floats
    slip: Table
    w: Floats
    law: Codes
    mu_s: Floats
    mu_0: Floats
    lean: Floats
    knot_start: Ints
    knots: Floats
    z_start: Ints
    normal: Codes
    damped: Codes
    N: Floats
    N0: Floats
    laws: Table
    normals: Table


class Order(Layout):
    """Place of every unknown [v, lam, F, z] in the banded matrices, and their sizes (``compile.band``)."""

    place: Ints
    sizes: Pivots


class Mech(Layout):
    """All of a problem; ``mass`` (n,) the diagonal of the mass matrix; ``bends``, ``bend_start``: see ``Bends``.

    ``group`` (n,): degrees of freedom of one number are tied together, by whatever; others do not feel them.
    """

    linear: Linear
    place: Place
    joint: Joint
    port: Port
    signals: Table
    elements: Table
    spread: Spread
    order: Order
    breakpoints: Floats
    mass: Floats
    bends: Table
    bend_start: Ints
    group: Ints
    dense: DenseRows


@kernel
def first_multiplier(mech: Mech) -> int:
    """Index of the first multiplier among the unknowns [v, lam, F, z]."""
    return int(mech.order.place.shape[0] - mech.port.row[-1] - mech.port.z_start[-1] - mech.joint.row[-1])


def mech_of(problem: Problem) -> Mech:
    """The problem as the kernels take it, made once per problem object."""
    load_mechanism()
    return once_per(problem, "mechanism", lambda: _pack(problem))


def _pack(problem: Problem) -> Mech:
    m, contacts = mechanism_of(problem), problem.contacts
    M, K, C, B = m.M, m.K, m.C, m.B
    linear = Linear(
        M.row, M.column, M.value, K.row, K.column, K.value, C.row, C.column, C.value, B.row, B.column, B.value, m.f,
        *_ties(problem),
    )  # fmt: skip
    table = table_of(m.joints.table)
    rows = np.diff(m.joints.row)
    n_x = np.diff(table.x_start) // 2
    load_of = loads_of(m.joints)
    joint = Joint(
        table, m.joints.row, load_of, n_x, m.joints.port, m.joints.one_sided, m.joints.hands_over, m.joints.dropped
    )
    port_joint = joints_of_ports(problem, m)
    solid = np.ascontiguousarray
    normal = solid(contacts.normal, np.int8)
    free = rows[load_of] == 0
    if free.any():  # what presses and rubs without holding opens as a contact with a normal-force law does
        normal = np.where((port_joint >= 0) & free[port_joint], NORMAL_LAW, normal).astype(np.int8)
    port = Port(
        port_joint, solid(contacts.row, np.int64),
        _softness(problem, m, port_joint), table_of(m.slip),
        solid(contacts.w), solid(contacts.law, np.int8), solid(contacts.mu_s), solid(contacts.mu_0),
        leans(contacts),
        knot_starts(contacts), solid(contacts.knots), solid(contacts.z_start, np.int64), normal,
        damped_normals(problem),
        np.where(contacts.normal == NORMAL_CONSTANT, contacts.N, 0.0), solid(contacts.N0),
        table_of(contacts.law_table), table_of(contacts.normal_table),
    )  # fmt: skip
    p = m.places
    rest = of_pattern(problem, "places", lambda: _place_rows(m))
    places = Place(p.address, p.p_start, np.append(p.p, 0.0), p.dof_start, p.dof, p.first, *rest)
    found = of_pattern(problem, "order", lambda: ordering(problem, m, places.y_start, places.y_dof))
    sizes = band_sizes(len(found.place) - found.border, found.half, found.border)
    return room(Mech(
        linear, places, joint, port, table_of(problem.signals.table), table_of(problem.elements.table),
        spread_of(problem), Order(found.place, sizes),
        np.sort(np.asarray(problem.signals.breakpoints, float)), masses(m), table_of(problem.bends.table),
        solid(problem.bends.start, np.int64), found.group, dense_rows(problem, m),
    ))  # fmt: skip


def _ties(problem: Problem) -> tuple[Floats, Floats]:
    """Which entries of K are springs between two coordinates, and what of each row is none."""
    if problem.mechanism is not None:
        return np.zeros(0), np.zeros(0)
    K = problem.linear.csr("Kx")
    tie, alone = ties(K, np.asarray(problem.omega, float))
    return tie[K.value != 0.0] if tie.size else tie, alone


def _softness(problem: Problem, m: Mechanism, port_joint: Ints) -> Floats:
    """See ``loop_softness``; without joints it depends on the shapes of modes."""
    if problem.mechanism is None:
        return softness(problem, m, port_joint)
    return of_pattern(problem, "softness", lambda: softness(problem, m, port_joint))


def leans_in_a_loop(problem: Problem) -> bool:
    """Whether a port whose cone at rest has its centre off 0 is in a loop with another one."""
    m = mechanism_of(problem)
    return bool((shares_a_loop(problem, m, joints_of_ports(problem, m)) & (problem.contacts.lean != 0.0)).any())


def joints_of_ports(problem: Problem, m: Mechanism) -> Ints:
    """The joint of every port (n_c,), -1 for contacts."""
    found = np.full(problem.n_c, -1, np.int64)
    own = np.flatnonzero(m.joints.port >= 0)
    found[m.joints.port[own]] = own
    return found


def masses(m: Mechanism) -> Floats:
    """Diagonal of the mass matrix (n,), what changes are measured by: above 0 also where a coordinate has no mass."""
    mass = np.zeros(m.n)
    on = m.M.row == m.M.column
    np.add.at(mass, m.M.row[on], m.M.value[on])
    return np.maximum(mass, m.least_mass) if m.least_mass.size else mass


def _place_rows(m: Mechanism) -> tuple[Ints, ...]:
    """Where derivatives of places begin, and the dofs that each extended coordinate moves with."""
    p = m.places
    count, across = np.diff(p.first), np.diff(p.dof_start)
    grad = np.concatenate(([0], np.cumsum(count * across))).astype(np.int64)
    hess = np.concatenate(([0], np.cumsum(count * across * across))).astype(np.int64)
    start, dof, at = [0], [], []
    for i in range(m.n):
        dof.append(i)
        at.append(-1)
        start.append(len(dof))
    for k in range(len(p.address)):
        mine = p.dof[p.dof_start[k] : p.dof_start[k + 1]].tolist()
        for c in range(int(count[k])):
            dof.extend(mine)
            at.extend(int(grad[k]) + c * len(mine) + b for b in range(len(mine)))
            start.append(len(dof))
    return (grad, hess, *[np.array(x, dtype=np.int64) for x in (start, dof, at)])
