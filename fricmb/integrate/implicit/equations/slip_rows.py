"""Slip, load and stick of a port: its directions, and what they add to rows of the Jacobian."""

from __future__ import annotations

from typing import Any

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.equations.forces import (
    call_joint,
    directions,
    friction_at,
    load_place,
    loading,
    slope_at,
)
from fricmb.integrate.implicit.equations.jacobian_layers import Layers, add, add_form, add_row, place_slope
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech, first_multiplier
from fricmb.integrate.model.forces import evaluate
from fricmb.integrate.model.friction_cone import cone_margin, stick_limit
from fricmb.integrate.model.law_values import coefficient, magnitude, point_along
from fricmb.integrate.problem import (
    LAW_SMOOTH,
    NORMAL_CONSTANT,
    NORMAL_EXPRESSION,
    NORMAL_LAW,
    SLIP,
    STICK,
    Codes,
    Floats,
    Ints,
)

#: Mode of a port in two directions while modes are decided: at rest, and about to slip in a direction to be found.
SETTING_OUT = 3
#: Slip velocity, or acceleration, that is nothing beside what a step, or friction, brings.
SLIGHT = 1e-7


@kernel
def plane(mech: Mech, c: int) -> bool:
    """Whether port c slips in two or three directions under a set-valued law."""
    return bool(mech.port.row[c + 1] - mech.port.row[c] >= 2 and mech.port.law[c] != LAW_SMOOTH)


@kernel
def may_open(mech: Mech, c: int) -> bool:
    """Whether contact c is open while its load is below 0: a given number is not, and that of a joint is a reaction."""
    return bool(mech.port.normal[c] == NORMAL_LAW or mech.port.normal[c] == NORMAL_EXPRESSION)


@kernel
def carried(mech: Mech, c: int, N: float) -> float:
    """Normal force N of port c: not below 0, but for a joint's (where it passes through 0 is a transition)."""
    return float(N) if mech.port.joint[c] >= 0 else max(N, 0.0)


@kernel
def friction_coefficient(mech: Mech, k: Moving, c: int, speed: float, load: float) -> tuple[float, float, float]:
    """mu, dmu/dr, dmu/dN of port c, as far as friction acts (``friction_share``)."""
    mu, by_speed, by_load = coefficient(mech.port, mech.port.laws, c, k.s, speed, load)
    return k.share * mu, k.share * by_speed, k.share * by_load


@kernel
def slip_speed(row: Ints, c: int, n: Floats, F: Floats, x: Floats) -> float:
    """Part of x along the direction of slip: n, in several directions against the force where there is one."""
    first = row[c]
    if row[c + 1] - first == 1:
        return float(n[first] * x[first])
    size = magnitude(row, c, F)
    along = 0.0
    for a in range(first, row[c + 1]):
        along += (F[a] if size > 0.0 else n[a]) * x[a]
    return float(-along / size if size > 0.0 else along)


#: Loads below this part of the largest force, and friction under them: it moves nothing, and is not known better.
LIGHT = 1e-10


@kernel
def lack(mech: Mech, k: Moving, c: int, load: float) -> float:
    """1 for port c without load, falling to 0 where its friction tells beside the largest force.

    What it holds counts where that is more than its load: of dry friction without a load the coefficient is the force.
    """
    least = LIGHT * k.borne
    if load >= least or not least > 0.0:
        return 0.0
    held = stick_limit(mech.port, mech.port.laws, c, k.s, max(load, 0.0))
    return float(max(0.0, 1.0 - max(load, held) / least))


@kernel
def spare(mech: Mech, k: Moving, c: int, F: Floats, N: Floats) -> float:
    """Force that port c could still bear while it sticks; of one almost without load only what tells beside others."""
    left = cone_margin(mech.port, mech.port.laws, c, k.s, F, max(N[c], 0.0))
    return float(left + LIGHT * k.borne * lack(mech, k, c, N[c]))


@kernel
def keep_held(mech: Mech, mode: Codes, now: Floats, F: Floats) -> None:
    """Predict what holds ports that stick by what it is ``now``, where there are several, or joints beside one.

    They may hold more than there is to hold.  What no equation determines of their forces is left as predicted, and
    polynomials through its round-off would grow from step to step.
    """
    row = mech.port.row
    held = 0
    for c in range(mode.shape[0]):
        held += row[c + 1] - row[c] if mode[c] == STICK else 0
        held += 1 if mode[c] == STICK and mech.port.soft[c] > 0.0 else 0
    for c in range(mode.shape[0] if held > 1 else 0):
        for a in range(row[c], row[c + 1] if mode[c] == STICK else row[c]):
            F[a] = now[a]


@kernel
def aim(mech: Mech, mode: Codes, F: Floats, n: Floats) -> None:
    """Directions of ports that slip in a plane: against their forces."""
    for c in range(mode.shape[0]):
        if mode[c] == SLIP and plane(mech, c):
            point_along(mech.port.row, c, F, -1.0, n)


@block
def add_slip(
    mech: Mech, k: Moving, c: int, direction: int, lam: Floats, L: Layers, row: int, value: float, full: bool,
) -> None:  # fmt: skip
    """Add ``value dg`` of port c to a row (``full``: by velocity and position; else the derivative of g' by v')."""
    port, table = mech.port, mech.joint.table
    j = port.joint[c]
    if j < 0:
        a0 = port.slip.x_start[c] + 2 * direction
        if full:
            add_form(mech, k, L, row, port.slip, a0 + 1, value)
        else:
            add_row(mech, k, L.A1, row, port.slip, a0, value)
        return
    n_x = call_joint(mech, k, j, lam)
    at = friction_at(n_x, mech.joint.row[j + 1] - mech.joint.row[j])
    own, d = at + direction * n_x, directions(mech, c)
    a0 = table.x_start[j]
    for a in range(n_x):
        if not full:
            add_row(mech, k, L.A1, row, table, a0 + a, value * k.out[own + a])
            continue
        add_form(mech, k, L, row, table, a0 + n_x + a, value * k.out[own + a])
        turn = 0.0
        for b in range(n_x):
            turn += k.out[slope_at(n_x, at, d, direction, b) + a] * k.x[n_x + b]
        add_form(mech, k, L, row, table, a0 + a, value * turn)


@kernel
def forms_of_slip(mech: Mech, k: Moving, c: int, direction: int, lam: Floats) -> tuple[Any, int, int, int]:
    """Where the slip velocity of port c in a direction stands: table, first form, how many, and their factors in k.out.

    Those of a joint, which is called for them, have factors; a port has one form of its own.
    """
    j = mech.port.joint[c]
    table, first, n_x, at = mech.port.slip, mech.port.slip.x_start[c] + 2 * direction, 1, 0
    if j >= 0:
        n_x = call_joint(mech, k, j, lam)
        table, first = mech.joint.table, mech.joint.table.x_start[j]
        at = friction_at(n_x, mech.joint.row[j + 1] - mech.joint.row[j]) + direction * n_x
    return table, first, n_x, at


@block
def lightness(mech: Mech, k: Moving, c: int, direction: int, lam: Floats, mass: Floats) -> float:
    """Change of the slip velocity of port c by a unit force in its direction, were there no (other) joints.

    With other values (n,) than the masses: the sum of squares of slopes over these.
    """
    place, j = mech.place, mech.port.joint[c]
    table, first, n_x, at = forms_of_slip(mech, k, c, direction, lam)
    value = 0.0
    for form in range(first, first + n_x):
        factor = k.out[at + form - first] if j >= 0 else 1.0
        for i in range(table.form_start[form], table.form_start[form + 1]):
            e = table.form_index[i] - 1
            if not 0 <= e < k.ddy.shape[0]:
                continue
            for b in range(place.y_start[e], place.y_start[e + 1]):
                slope = factor * table.form_coefficient[i] * place_slope(place, k, b)
                value += slope * slope / mass[place.y_dof[b]]
    return float(value)


@kernel
def slip_gradient(mech: Mech, k: Moving, c: int, direction: int, lam: Floats, out: Floats) -> None:
    """Derivatives of the slip velocity of port c in a direction by all velocities, into out (n,)."""
    place, j = mech.place, mech.port.joint[c]
    table, first, n_x, at = forms_of_slip(mech, k, c, direction, lam)
    out[:] = 0.0
    for form in range(first, first + n_x):
        factor = k.out[at + form - first] if j >= 0 else 1.0
        for i in range(table.form_start[form], table.form_start[form + 1]):
            e = table.form_index[i] - 1
            if not 0 <= e < k.ddy.shape[0]:
                continue
            for b in range(place.y_start[e], place.y_start[e + 1]):
                out[place.y_dof[b]] += factor * table.form_coefficient[i] * place_slope(place, k, b)


@kernel
def guided(mech: Mech, c: int, direction: int) -> bool:
    """Whether no force of contact c moves anything in a direction: a guide bears it."""
    table = mech.port.slip
    n_y = mech.place.y_start.shape[0] - 1
    if mech.port.joint[c] >= 0:
        return False
    form = table.x_start[c] + 2 * direction
    found = True
    for i in range(table.form_start[form], table.form_start[form + 1]):
        found = found and not 0 <= table.form_index[i] - 1 < n_y
    return bool(found)


@block
def add_stick(mech: Mech, k: Moving, c: int, lam: Floats, L: Layers, row: int, full: bool) -> None:
    """Rows of a port that sticks; what sticks across a guide bears nothing there."""
    for a in range(mech.port.row[c + 1] - mech.port.row[c]):
        if guided(mech, c, a):
            add(mech.order, L.A1, row + a, row + a, 1.0)
            continue
        add_slip(mech, k, c, a, lam, L, row + a, 1.0, full)
        if mech.port.soft[c] > 0.0:
            soft = mech.port.soft[c] * lightness(mech, k, c, a, lam, mech.mass)
            add(mech.order, L.A2 if full else L.A1, row + a, row + a, soft)


@block
def add_load(mech: Mech, k: Moving, c: int, lam: Floats, L: Layers, row: int, value: float, full: bool) -> None:
    """Add ``value dN`` of port c to a row; without ``full`` by the multipliers alone."""
    port, joint = mech.port, mech.joint
    j = port.joint[c]
    if j < 0:
        if full and port.normal[c] != NORMAL_CONSTANT:
            normals, s = port.normals, k.s
            n_x = evaluate(normals, c, s)
            for i in range(n_x):
                add_form(mech, k, L, row, normals, normals.x_start[c] + i, value * s.out[1 + i])
        return
    n_x = call_joint(mech, k, j, lam)
    m = joint.row[j + 1] - joint.row[j]
    at = load_place(n_x, friction_at(n_x, m), directions(mech, c)) + 1
    origin = first_multiplier(mech)
    first, last = loading(mech, j)
    for i in range(last - first):
        add(mech.order, L.A1, row, origin + first + i, value * k.out[at + i])
    if full:
        at += last - first
        for a in range(2 * n_x):  # by positions, then by velocities
            add_form(mech, k, L, row, joint.table, joint.table.x_start[j] + a, value * k.out[at + a])
