"""Jacobians of a mechanism in three banded layers: what goes with the derivative, the velocity and the position.

With unknowns [v, lam, F, z] and a shift gamma = 1/(h lambda) the matrix of a stage is  gamma A0 + A1 + A2/gamma.
"""

from __future__ import annotations

from fricmb.integrate.compile.band import place_of
from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.implicit.equations.forces import call_joint, directions, friction_at, slope_at
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech, Order, Place, first_multiplier
from fricmb.integrate.model.forces import evaluate
from fricmb.integrate.model.problem_structs import Table
from fricmb.integrate.problem import NORMAL_LAW, OPEN, Codes, Floats


class Layers(Layout):
    """Banded matrices as ``compile.band`` keeps them."""

    A0: Floats
    A1: Floats
    A2: Floats


@kernel
def add(order: Order, A: Floats, i: int, j: int, value: float) -> None:
    """Add to entry (i, j)."""
    A[place_of(order.sizes, order.place[i], order.place[j])] += value


@kernel
def place_slope(place: Place, k: Moving, i: int) -> float:
    """Derivative i of an extended coordinate by a degree of freedom: 1 where it is one itself."""
    at = place.y_at[i]
    return 1.0 if at < 0 else float(k.grad[at])


@block
def add_extended(mech: Mech, k: Moving, L: Layers, row: int, e: int, rate: bool, value: float) -> None:
    """Add ``value dy_e`` (or ``value dy'_e``) to a row."""
    place = mech.place
    for i in range(place.y_start[e], place.y_start[e + 1]):
        at, dof = place.y_at[i], place.y_dof[i]
        grad = place_slope(place, k, i)
        if not rate:
            add(mech.order, L.A2, row, dof, value * grad)
        else:
            add(mech.order, L.A1, row, dof, value * grad)
            if at >= 0:
                add(mech.order, L.A2, row, dof, value * k.grad_rate[at])


@block
def add_form(mech: Mech, k: Moving, L: Layers, row: int, table: Table, a: int, value: float) -> None:
    """Add ``value d(form a)`` to a row."""
    if value == 0.0:
        return
    n_y = k.ddy.shape[0]
    for j in range(table.form_start[a], table.form_start[a + 1]):
        i = table.form_index[j] - 1
        if 0 <= i < 2 * n_y:
            e = i if i < n_y else i - n_y
            add_extended(mech, k, L, row, e, i >= n_y, value * table.form_coefficient[j])


@kernel
def add_slopes(mech: Mech, k: Moving, A: Floats, line: int, by_row: bool, table: Table, a: int, value: float) -> None:
    """Add ``value d(form a)/dq`` to a row of one layer, or (not ``by_row``) to a column."""
    if value == 0.0:
        return
    place = mech.place
    for j in range(table.form_start[a], table.form_start[a + 1]):
        e = table.form_index[j] - 1
        if 0 <= e < k.ddy.shape[0]:
            for i in range(place.y_start[e], place.y_start[e + 1]):
                slope, dof = value * table.form_coefficient[j] * place_slope(place, k, i), place.y_dof[i]
                if by_row:
                    add(mech.order, A, line, dof, slope)
                else:
                    add(mech.order, A, dof, line, slope)


@block
def add_column(mech: Mech, k: Moving, A: Floats, column: int, table: Table, a: int, value: float) -> None:
    """Add ``value d(form a)/dq`` as a column: minus the force of a multiplier on the degrees of freedom."""
    add_slopes(mech, k, A, column, False, table, a, value)


@block
def add_row(mech: Mech, k: Moving, A: Floats, row: int, table: Table, a: int, value: float) -> None:
    """Add ``value d(form a)/dq`` to a row of one layer."""
    add_slopes(mech, k, A, row, True, table, a, value)


@kernel
def add_down(mech: Mech, k: Moving, A: Floats, left: Table, a: int, column: int, value: float, slope: float) -> None:
    """Add ``value slope`` in one column to the rows of the degrees of freedom on which a force on form a acts."""
    place = mech.place
    for j in range(left.form_start[a], left.form_start[a + 1]):
        e = left.form_index[j] - 1
        if 0 <= e < k.ddy.shape[0]:
            for i in range(place.y_start[e], place.y_start[e + 1]):
                force = value * left.form_coefficient[j] * place_slope(place, k, i)
                add(mech.order, A, place.y_dof[i], column, force * slope)


@block
def add_stiffness(mech: Mech, k: Moving, L: Layers, left: Table, a: int, right: Table, b: int, value: float) -> None:
    """Add ``value d(form b)`` to the rows of the degrees of freedom on which a force on form a acts.

    Column by column, as the matrices are kept: of contacts that press on many modes these are most entries.
    """
    if value == 0.0:
        return
    place = mech.place
    n_y = k.ddy.shape[0]
    for j in range(right.form_start[b], right.form_start[b + 1]):
        e = right.form_index[j] - 1
        if not 0 <= e < 2 * n_y:
            continue
        rate, weight = e >= n_y, right.form_coefficient[j]
        e -= n_y if rate else 0
        for i in range(place.y_start[e], place.y_start[e + 1]):
            at, dof, slope = place.y_at[i], place.y_dof[i], weight * place_slope(place, k, i)
            if not rate:
                add_down(mech, k, L.A2, left, a, dof, value, slope)
            else:
                add_down(mech, k, L.A1, left, a, dof, value, slope)
                if at >= 0:
                    add_down(mech, k, L.A2, left, a, dof, value, weight * k.grad_rate[at])


@block
def add_pairs(mech: Mech, k: Moving, L: Layers, i: int, j: int, rate: bool, value: float) -> None:
    """Add the entry (i, j) of a stiffness or damping matrix over extended coordinates."""
    place = mech.place
    n_y = k.ddy.shape[0]
    if i >= n_y or j >= n_y:
        return
    for a in range(place.y_start[i], place.y_start[i + 1]):
        grad = place_slope(place, k, a)
        add_extended(mech, k, L, place.y_dof[a], j, rate, value * grad)


@kernel
def add_mass(mech: Mech, L: Layers) -> None:
    """The mass matrix."""
    linear = mech.linear
    for e in range(linear.M.shape[0]):
        add(mech.order, L.A0, linear.Mi[e], linear.Mj[e], linear.M[e])


@block
def add_structure(mech: Mech, k: Moving, L: Layers) -> None:
    """Stiffness and damping of linear and nonlinear elements, and of forces that turn with bodies (``k.fy``)."""
    linear, place = mech.linear, mech.place
    n_y = k.ddy.shape[0]
    for e in range(linear.K.shape[0]):
        add_pairs(mech, k, L, linear.Ki[e], linear.Kj[e], False, linear.K[e])
    for e in range(linear.C.shape[0]):
        add_pairs(mech, k, L, linear.Ci[e], linear.Cj[e], True, linear.C[e])
    for c in range(place.address.shape[0]):
        d0 = place.dof_start[c]
        b = place.dof_start[c + 1] - d0
        e0 = n_y - place.first[place.address.shape[0]] + place.first[c]
        for r in range(place.first[c + 1] - place.first[c]):
            h = place.hess_start[c] + r * b * b
            for i in range(b):
                for j in range(b):
                    value = k.fy[e0 + r] * k.hess[h + i * b + j]
                    if value != 0.0:
                        add(mech.order, L.A2, place.dof[d0 + i], place.dof[d0 + j], -value)
    elements, spread, s = mech.elements, mech.spread, k.s
    for e in range(elements.address.shape[0]):
        n_x = evaluate(elements, e, s)
        n_f = spread.f_start[e + 1] - spread.f_start[e]
        x0 = elements.x_start[e]
        for f in range(n_f):
            first = spread.f_start[e] + f
            for i in range(spread.start[first], spread.start[first + 1]):
                y = spread.dof[i]
                for a in range(place.y_start[y], place.y_start[y + 1]):
                    grad = spread.coefficient[i] * place_slope(place, k, a)
                    for x in range(n_x):
                        slope = s.out[n_f + f * n_x + x]
                        add_form(mech, k, L, place.y_dof[a], elements, x0 + x, -grad * slope)


@block
def add_joints(mech: Mech, k: Moving, lam: Floats, F: Floats, L: Layers, full: bool) -> None:
    """Constraints and reactions; ``full``: with what changes with position (else the rows and columns of G alone)."""
    joint = mech.joint
    table = joint.table
    n = first_multiplier(mech)
    for j in range(joint.n_x.shape[0]):
        n_x = call_joint(mech, k, j, lam)
        m = joint.row[j + 1] - joint.row[j]
        a0 = table.x_start[j]
        H = m + m * n_x
        B = H + n_x * n_x
        at = friction_at(n_x, m)
        c = joint.port[j]
        for r in range(m):
            row = n + joint.row[j] + r
            if joint.dropped[joint.row[j] + r] != 0:
                add(mech.order, L.A1, row, row, 1.0)
                continue
            for a in range(n_x):
                G = k.out[m + r * n_x + a]
                add_column(mech, k, L.A1, row, table, a0 + a, -G)
                if full:
                    add_form(mech, k, L, row, table, a0 + n_x + a, G)
                    add_form(mech, k, L, row, table, a0 + a, k.out[B + r * n_x + a])
                else:
                    add_row(mech, k, L.A1, row, table, a0 + a, G)
        d = directions(mech, c) if c >= 0 else 0
        for i in range(d):
            column = n + joint.row[-1] + mech.port.row[c] + i
            for a in range(n_x):
                add_column(mech, k, L.A1, column, table, a0 + a, -k.out[at + i * n_x + a])
        if full:
            for a in range(n_x):
                for b in range(n_x):
                    value = k.out[H + a * n_x + b]
                    for i in range(d):
                        value += F[mech.port.row[c] + i] * k.out[slope_at(n_x, at, d, i, a) + b]
                    add_stiffness(mech, k, L, table, a0 + a, table, a0 + b, -value)


@block
def add_contacts(mech: Mech, k: Moving, mode: Codes, L: Layers, full: bool) -> None:
    """Columns of the friction of contacts that are no joints; ``full``: stiffness of what normal-force laws press.

    By the mode, not by the load: where a contact has just opened or closed, that is 0 but for round-off.
    """
    port = mech.port
    n_c = port.joint.shape[0]
    first = mech.order.place.shape[0] - port.z_start[-1] - port.row[-1]
    for c in range(n_c):
        if port.joint[c] >= 0:
            continue
        for a in range(port.row[c], port.row[c + 1]):
            form = port.slip.x_start[c] + 2 * (a - port.row[c])
            add_column(mech, k, L.A1, first + a, port.slip, form, -1.0)
        if full and port.normal[c] == NORMAL_LAW and mode[c] != OPEN:
            normals, s = port.normals, k.s
            evaluate(normals, c, s)
            x0 = normals.x_start[c]
            for i in range(2):
                add_stiffness(mech, k, L, normals, x0, normals, x0 + i, -s.out[1 + i])
