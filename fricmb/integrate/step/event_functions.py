"""Looking for transitions inside a step that has been solved, and how far from one its end is.

Whether a contact that sticks has left its friction cone, |F| > mu_s N, is seen here: within a step by
``cone_crossing``, from squares, which are polynomials; at its end by ``margin``.  Both ask ``model/friction_cone``.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.accelerations import share_load
from fricmb.integrate.model.forces import Scratch, normal_force, set_instant
from fricmb.integrate.model.friction_cone import cone_margin, squared_margin, stick_limit
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, SLIP, STICK, Floats
from fricmb.integrate.step.crossing import crossing_at_points, crossing_at_stages, first_crossing
from fricmb.integrate.step.one_step_room import Accuracy, OneStep

#: What a contact's transition may be told by, and neither yet: see :func:`margin`.
BY_LAW, BY_LOAD, BY_EITHER = 0.0, 1.0, -1.0
#: A slip speed below this part of the velocities that it is the difference of is round-off: the slip begins; so does a
#: normal force below this part of what it reaches in the step.
BEGINS = 1e-13


@block
def find_changing_contact(
    packed: Packed, s: Scratch, y: State, end: State, one: OneStep, acc: Accuracy, found: Floats
) -> int:
    """Contact that changes its mode first within the step just solved, or -1; ``found`` (1,) about where, in (0, 1].

    Slip ends where r passes 0 (also between two stages), stick where |F| leaves the cone, contact where N passes 0.
    ``end`` is the state at the end of the step, whose forces come from accelerations and have the full order.
    """
    tab, w = one.tab, one.w
    n_s = tab.c.shape[0]
    contact = -1
    found[0] = 2.0
    if packed.ports.soft > 0.0:
        for j in range(n_s):
            share_load(packed, s, y.mode, w.N[j], w.F[j], y.way, 1.0)
    for k in range(y.mode.shape[0]):
        x = 2.0
        if packed.ports.law[k] != LAW_SMOOTH and y.mode[k] == SLIP:
            x = slip_crossing(packed, y, one, acc, k)
        elif y.mode[k] == STICK:
            x = cone_crossing(packed, s, y, end, one, k)
        if packed.ports.var[k] >= 0:
            x = min(x, normal_crossing(packed, s, y, one, k))
        if x < found[0]:
            found[0] = x
            contact = k
    return contact if n_s > 0 else -1


@kernel
def slip_crossing(packed: Packed, y: State, one: OneStep, acc: Accuracy, k: int) -> float:
    """Where the speed of a contact that slips first passes 0; 2 where it does not.

    Slip that only begins, at 0 up to round-off, rises from there, whatever the polynomial makes of its first moment:
    where the acceleration does not jump it rises by less than the stages resolve.
    """
    row0 = packed.ports.row[k]
    first = magnitude(packed.ports.row, k, y.g)
    grain = BEGINS * y.size[row0] + 1e-4 * acc.noise
    begins = first <= grain
    for j in range(one.tab.c.shape[0]):
        one.margin[j] = one.w.r[j, k] + (grain if begins else 0.0)
    if begins:
        first = 0.0
    if packed.ports.soft > 0.0:
        return crossing_at_points(one.tab, first, one.margin)
    return first_crossing(one.tab, first, one.margin, one.series)


@kernel
def force_noise(packed: Packed, y: State, k: int, h: float) -> float:
    """Round-off of a stuck contact's forces at the stages of a step h."""
    row0 = packed.ports.row[k]
    return float(1e-15 * y.size[row0] / max(h * packed.ports.D[row0, row0], 1e-290))


@kernel
def cone_crossing(packed: Packed, s: Scratch, y: State, end: State, one: OneStep, k: int) -> float:
    """Where |F| of a stuck contact first leaves the cone, by squares; 2 where it does not."""
    held = stick_limit(packed.ports, packed.laws, k, s, y.N[k])
    first = max(0.0, squared_margin(packed.ports, k, y.F, held))
    n_s = one.tab.c.shape[0]
    # stage multipliers are of lower order: a hair beyond the cone inside the step is left to its end
    hair = 1e-6 * held * held
    limit = stick_limit(packed.ports, packed.laws, k, s, end.N[k])
    last = squared_margin(packed.ports, k, end.F, limit)
    # and in a very short step they are the round-off of velocities over the step
    unknown = force_noise(packed, y, k, end.t - y.t) > 1e-8 * limit
    for j in range(n_s - 1):
        limit = stick_limit(packed.ports, packed.laws, k, s, one.w.N[j, k])
        one.margin[j] = squared_margin(packed.ports, k, one.w.F[j], limit) + hair
        if unknown:
            one.margin[j] = first + one.tab.c[j] * (last - first) + hair
    one.margin[n_s - 1] = last + hair
    # a load that sets out from 0: see ``normal_crossing``; of squares a polynomial resolves no more than of forces
    if packed.ports.soft > 0.0 or held * held < BEGINS * limit * limit:
        x = crossing_at_stages(one.tab, first + hair, one.margin)
    else:
        x = first_crossing(one.tab, first + hair, one.margin, one.series)
    if x > 1.0 and last < 0.0:
        before = one.tab.c[n_s - 2] if n_s > 1 else 0.0
        inner = one.margin[n_s - 2] - hair if n_s > 1 else first
        return float(before + (1.0 - before) * inner / (inner - last)) if inner > 0.0 else 1.0
    return x


@kernel
def normal_crossing(packed: Packed, s: Scratch, y: State, one: OneStep, k: int) -> float:
    """Where the normal force of a closed contact goes below 0, or of an open one above; 2 where it does not.

    One that sets out from 0 leaves it, whatever the polynomial makes of its first moment: of a power as Hertz's it dips
    below 0 before the first stage however short the step is.
    """
    sign = -1.0 if y.mode[k] == OPEN else 1.0
    set_instant(packed.signals, s, y.t, y.q, y.v)
    largest = 0.0
    for j in range(one.tab.c.shape[0]):
        one.margin[j] = sign * one.N[j, k]
        largest = max(largest, one.margin[j])
    first = max(0.0, sign * normal_force(packed.ports, packed.normals, k, s))
    if first < BEGINS * largest:
        return crossing_at_stages(one.tab, first, one.margin)
    return first_crossing(one.tab, first, one.margin, one.series)


@kernel
def margin(
    packed: Packed, s: Scratch, y: State, end: State, speed: float, k: int, beyond: float, found: Floats
) -> float:
    """Distance of contact k from its transition at ``end`` of a step from y (negative: beyond it).

    ``speed``: that of its slip there, negative where it would go on beyond its end.
    ``found[1]`` becomes BY_LOAD where it is the normal force that comes to 0, else BY_LAW.  ``beyond`` says which of
    the two was found beyond its zero in the same search: a slip that has just begun is slow, and as its load goes to 0
    now one and now the other looks nearer.
    """
    value = np.inf
    if packed.ports.var[k] >= 0:
        set_instant(packed.signals, s, end.t, end.q, end.v)
        value = normal_force(packed.ports, packed.normals, k, s)
        found[1] = BY_LOAD
        if y.mode[k] == OPEN:
            return -value
    if packed.ports.law[k] == LAW_SMOOTH:
        return value
    unit = 1.0  # of a normal force beside which the other one is measured
    if y.mode[k] == SLIP:
        other = speed
        unit = max(y.size[packed.ports.row[k]], abs(speed)) / max(y.N[k], abs(value), 1e-290)
    else:
        other = cone_margin(packed.ports, packed.laws, k, s, end.F, end.N[k])
    by_law = packed.ports.var[k] < 0 or other < unit * value
    if packed.ports.var[k] >= 0 and beyond == BY_LAW and value >= 0.0:
        by_law = True
    elif beyond == BY_LOAD and other >= 0.0:
        by_law = False
    if by_law:
        found[1] = BY_LAW
        return float(other)
    return value
