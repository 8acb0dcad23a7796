"""Where forces bend within a step of a mechanism: see ``step.element_bends``."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.constrained.between_stages import look_at_step, push_by_force
from fricmb.integrate.constrained.forces import load_at, move, scatter
from fricmb.integrate.constrained.moving import Moving
from fricmb.integrate.constrained.problem_structs import Mech
from fricmb.integrate.constrained.radau_step import Control, asked
from fricmb.integrate.constrained.stages import Stages
from fricmb.integrate.constrained.state import State
from fricmb.integrate.model.forces import element_forces
from fricmb.integrate.problem import LAW_SMOOTH, NORMAL_LAW, OPEN, Codes, Floats
from fricmb.integrate.step.element_bends import before_bend, carried_over_bend, first_bend
from fricmb.integrate.step.knots import NOWHERE


@kernel
def place_bodies(mech: Mech, k: Moving, t: float, q: Floats, v: Floats) -> None:
    """An instant into X."""
    move(mech, k, t, q, v)


@kernel
def bring_to_dofs(mech: Mech, k: Moving, n: int, f: Floats) -> None:
    """Forces on extended coordinates (``k.fy``), brought to the n degrees of freedom."""
    place = mech.place
    for i in range(n):
        f[i] = k.fy[i]
    for c in range(place.address.shape[0]):
        d0 = place.dof_start[c]
        count = place.dof_start[c + 1] - d0
        for r in range(place.first[c + 1] - place.first[c]):
            for i in range(count):
                f[place.dof[d0 + i]] += k.grad[place.grad_start[c] + r * count + i] * k.fy[n + place.first[c] + r]


@kernel
def forces_at(mech: Mech, k: Moving, n: int, mode: Codes, f: Floats) -> None:
    """Forces of elements and of normal-force laws on the n degrees of freedom at X; behind them loads.

    What acts on places is brought to the degrees of freedom.  Loads are those of contacts, before max with 0; of
    joints, whose reactions these are, and of what is open, 0.
    """
    port = mech.port
    k.fy[:] = 0.0
    element_forces(mech.elements, mech.spread, k.s, k.fy)
    for p in range(port.joint.shape[0]):
        f[n + p] = load_at(mech, k, p) if port.joint[p] < 0 and mode[p] != OPEN else 0.0
        if port.joint[p] < 0 and port.normal[p] == NORMAL_LAW:
            scatter(k, port.normals, port.normals.x_start[p], f[n + p])
    bring_to_dofs(mech, k, n, f)


@kernel
def felt_by(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float, free: Floats) -> None:
    """Accelerations, by the scale of their velocities, by units of forces (n) and of loads (n_c) into ``free``.

    A force counts by what it does without joints, which is an upper bound; loads of joints are their reactions.
    """
    n = y.q.shape[0]
    look_at_step(mech, k, y, st, c, h)
    for i in range(n):
        free[i] = 1.0 / (c.mass[i] * st.scale[i])
    for p in range(y.mode.shape[0]):
        coefficient = abs(mech.port.mu_s[p]) if mech.port.law[p] != LAW_SMOOTH else 1.0
        free[n + p] = coefficient * push_by_force(mech, k, y, c, p) if mech.port.joint[p] < 0 else 0.0


@block
def bend_within(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float, slight: float) -> float:
    """Part of the step h just solved up to the first bend that its polynomials do not know; ``NOWHERE`` without one.

    ``slight``: part of the tolerance that a bend may bring.
    """
    count = mech.bend_start[mech.bend_start.shape[0] - 1]
    signs, line, state = np.empty((2, count)), np.empty(st.tab.c.shape[0] + 1), np.empty((2, y.q.shape[0]))
    x, low = first_bend(
        place_bodies, forces_at, felt_by, mech, k, k.s, st.tab, y, st, c, slight * asked(c), h, signs, line, state
    )  # fmt: skip
    if not x < 1.0:
        return NOWHERE
    return float(before_bend(place_bodies, mech, k, k.s, st.tab, y, st, x, low, h, signs, line, state))


@block
def go_over_bend(mech: Mech, k: Moving, y: State) -> bool:
    """Carry y over the bend that it has come to; False where there is none at once."""
    return bool(carried_over_bend(place_bodies, mech, k, k.s, y))
