"""Where forces bend within a step of a scene without joints: see ``element_bends``."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.forces import Scratch, element_forces, normal_force, set_instant
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, Codes, Floats, Floats2
from fricmb.integrate.run.breakpoints import EPS
from fricmb.integrate.step.element_bends import ASKED, first_bend, look, put_signs, where_turned
from fricmb.integrate.step.knots import AT_AN_END, NEAR, NOWHERE, SLIGHT
from fricmb.integrate.step.one_step_room import Accuracy, OneStep, widest
from fricmb.integrate.step.stages import Stages
from fricmb.integrate.step.weigh_forces import felt_speed, pushed

#: Roundings of the time by which a step ends short of a bend: its last stage must not see what comes behind.
SHORT_OF = 4096.0


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
def before_bend(
    packed: Packed, s: Scratch, y: State, one: OneStep, x: float, low: float, h: float, signs: Floats2, line: Floats,
    state: Floats2,
) -> float:  # fmt: skip
    """A place at x where nothing has changed its sign since ``low``: the last stage of a step that ends there, too."""
    here, back = np.empty(signs.shape[1]), EPS * (1.0 + abs(y.t) / h)
    for _ in range(ASKED):
        look(place, packed, s, one.tab, y, one.st, x, h, line, state)
        put_signs(packed.bends, packed.bend_start, s, here)
        same = True
        for b in range(here.shape[0]):
            same = same and (here[b] < 0.0) == (signs[0, b] < 0.0)
        if same or x - back <= low:
            break
        x -= back
        back *= 4.0
    # the polynomial itself is known to some roundings
    return float(max(x - SHORT_OF * EPS * (1.0 + abs(y.t) / h), low))


@kernel
def go_over_bend(packed: Packed, s: Scratch, y: State) -> bool:
    """Carry y over the bend that it has come to, by a few roundings of the time; False where there is none at once.

    As far again as to the first function that changes its sign: several may do so there, each by its own round-off.
    """
    count, n = packed.bend_start[packed.bend_start.shape[0] - 1], y.q.shape[0]
    before, behind, q, v = np.empty(count), np.empty(count), y.q.copy(), y.v.copy()
    set_instant(packed.signals, s, y.t, y.q, y.v)
    put_signs(packed.bends, packed.bend_start, s, before)
    way = EPS * max(abs(y.t), 1e-290)
    for _ in range(ASKED + 4):
        way *= 4.0
        for i in range(n):
            q[i] = y.q[i] + way * y.v[i]
            v[i] = y.v[i] + way * y.a[i]
        set_instant(packed.signals, s, y.t + way, q, v)
        put_signs(packed.bends, packed.bend_start, s, behind)
        for b in range(count):
            if (before[b] < 0.0) != (behind[b] < 0.0):
                way *= 2.0
                for i in range(n):
                    y.q[i] += way * y.v[i]
                    y.v[i] += way * y.a[i]
                y.t += way
                return True
    return False


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
    return before_bend(packed, s, y, one, x, low, h, signs, line, state) if x < 1.0 else NOWHERE
