"""Where forces bend within a step of a scene without joints: see ``element_bends``."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.forces import Scratch, element_forces, normal_force, set_instant
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, Codes, Floats
from fricmb.integrate.run.breakpoints import EPS
from fricmb.integrate.step.element_bends import before_bend, carried_over_bend, first_bend, put_signs, where_turned
from fricmb.integrate.step.knots import AT_AN_END, NEAR, NOWHERE, SLIGHT
from fricmb.integrate.step.one_step_room import Accuracy, OneStep, widest
from fricmb.integrate.step.stages import Stages
from fricmb.integrate.step.weigh_forces import felt_speed, pushed


@kernel
def place(packed: Packed, s: Scratch, t: float, q: Floats, v: Floats) -> None:
    """An instant into X."""
    set_instant(packed.signals, s, t, q, v)


@kernel
def forces_at(packed: Packed, s: Scratch, n: int, mode: Codes, f: Floats) -> None:
    """Forces of all elements and of normal-force laws on the n dofs at X, behind them the loads of all contacts.

    Loads are those before max with 0; what is open has none.
    """
    ports = packed.ports
    f[:] = 0.0
    element_forces(packed.elements, packed.spread, s, f[:n])
    for k in range(ports.var.shape[0]):
        if ports.var[k] < 0 or mode[k] == OPEN:
            continue
        f[n + k] = normal_force(ports, packed.normals, k, s)
        if ports.acts[k]:
            for i in range(n):
                f[i] += ports.Wn[i, k] * f[n + k]


@kernel
def felt_by(packed: Packed, s: Scratch, y: State, st: Stages, acc: Accuracy, h: float, free: Floats) -> None:
    """Accelerations, by the scale of their velocities, by units of forces (n) and of loads (n_c) into ``free``."""
    ports, top, n = packed.ports, widest(acc.v), y.q.shape[0]
    for i in range(n):
        free[i] = packed.structure.mobility[i] / felt_speed(y, st, acc, top, i)
    for k in range(ports.var.shape[0]):
        coefficient, most = abs(ports.mu_s[k]) if ports.law[k] != LAW_SMOOTH else 1.0, 0.0
        for a in range(ports.row[k], ports.row[k + 1]):
            most = max(most, pushed(packed, y, st, acc, a))
        free[n + k] = coefficient * most


@kernel
def go_over_bend(packed: Packed, s: Scratch, y: State) -> bool:
    """Carry y over the bend that it has come to; False where there is none at once."""
    return bool(carried_over_bend(place, packed, s, s, y))


@kernel
def begins_at_bend(packed: Packed, s: Scratch, y: State, one: OneStep, h: float) -> bool:
    """Whether a step begins where forces bend, on the near side by round-off: its stages are all on the far one."""
    count = packed.bend_start[packed.bend_start.shape[0] - 1]
    signs, line, state = np.empty((2, count)), np.empty(one.tab.c.shape[0] + 1), np.empty((2, y.q.shape[0]))
    set_instant(packed.signals, s, y.t, y.q, y.v)
    put_signs(packed.bends, packed.bend_start, s, signs[0])
    set_instant(packed.signals, s, one.st.t[0], one.st.Q[0], one.st.V[0])
    put_signs(packed.bends, packed.bend_start, s, signs[1])
    least, found = max(AT_AN_END, NEAR * EPS * abs(y.t) / h), False
    for b in range(count):
        if (signs[0, b] < 0.0) != (signs[1, b] < 0.0):
            found = found or where_turned(
                place, packed, s, s, one.tab, y, one.st, h, b, 0.0, one.tab.c[0], signs, line, state
            ) <= least
    return bool(found)


@block
def bend_ahead(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, h: float) -> float:
    """Part of the step h just solved up to the first bend that its polynomials do not know; ``NOWHERE`` without one."""
    count = packed.bend_start[packed.bend_start.shape[0] - 1]
    signs, line, state = np.empty((2, count)), np.empty(one.tab.c.shape[0] + 1), np.empty((2, y.q.shape[0]))
    x, low = first_bend(
        place, forces_at, felt_by, packed, s, s, one.tab, y, one.st, acc, SLIGHT * acc.rtol, h, signs, line, state
    )
    if not x < 1.0:
        return NOWHERE
    return float(before_bend(place, packed, s, s, one.tab, y, one.st, x, low, h, signs, line, state))
