"""Whether a step of BDF meets a transition: such a step is left to the one-step method."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.methods.bdf_stability import BdfGuard
from fricmb.integrate.model.accelerations import slip_rate
from fricmb.integrate.model.forces import Scratch, normal_force
from fricmb.integrate.model.friction_cone import cone_margin, stick_limit
from fricmb.integrate.model.law_values import along
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, SLIP, STICK

#: Part of its limit by which the force of a stuck contact may change in a step.
LEAP = 0.4


@kernel
def excess(packed: Packed, s: Scratch, y: State, k: int) -> float:
    """How far the force of a stuck contact is above its limit."""
    return -float(cone_margin(packed.ports, packed.laws, k, s, y.F, y.N[k]))


@kernel
def note_loads(packed: Packed, s: Scratch, start: State, y: State, guard: BdfGuard) -> None:
    """Keep how fast stuck forces near their limits in the one-step step from ``start`` to y, after which BDF begins."""
    h = y.t - start.t
    for k in range(y.mode.shape[0]):
        guard.over[k] = 0.0
        if y.mode[k] == STICK and start.mode[k] == STICK and packed.ports.law[k] != LAW_SMOOTH:
            guard.over[k] = (excess(packed, s, y, k) - excess(packed, s, start, k)) / h
    guard.over[y.mode.shape[0]] = h


@kernel
def meets_transition(packed: Packed, s: Scratch, y: State, end: State, guard: BdfGuard) -> bool:
    """Whether some contact changes its mode between y and ``end``, at its end or between (by cubic interpolation)."""
    h = end.t - y.t
    meets = False
    for k in range(y.mode.shape[0]):
        if packed.ports.var[k] >= 0:
            N = normal_force(packed.ports, packed.normals, k, s)
            if (N < 0.0) != (y.mode[k] == OPEN):
                meets = True
        if packed.ports.law[k] == LAW_SMOOTH:
            continue
        if y.mode[k] == SLIP:
            r0, r1 = along(packed.ports.row, k, y.n, y.g), along(packed.ports.row, k, end.n, end.g)
            d0, d1 = h * slip_rate(packed, y, k), h * slip_rate(packed, end, k)
            if r1 <= 0.0 or dips(r0, r1, d0, d1) < 0.0:
                meets = True
        elif y.mode[k] == STICK:
            limit = stick_limit(packed.ports, packed.laws, k, s, end.N[k])
            before, over = excess(packed, s, y, k), excess(packed, s, end, k)
            slope = (over - before) / h
            bend = abs(slope - guard.over[k])
            guard.over[k] = slope
            # the one-step method takes over in time: an extremum might pass the limit between two steps
            if over > 0.0 or over + h * (1.5 * max(0.0, slope) + bend) > 0.0:
                meets = True
            # or has just done so within this one: twice what the parabola through three points rises above its ends
            if max(before, over) + 0.5 * h * h * bend / (h + guard.over[y.mode.shape[0]]) > 0.0:
                meets = True
            for a in range(packed.ports.row[k], packed.ports.row[k + 1]):
                # a load that changes so fast where nothing moves is seen by no error test
                if abs(end.F[a] - y.F[a]) > LEAP * limit:
                    meets = True
    guard.over[y.mode.shape[0]] = h
    return meets


@kernel
def calm(packed: Packed, y: State, h: float) -> bool:
    """Whether no slipping contact lands within a few steps h, nor has only begun to slip."""
    for k in range(y.mode.shape[0]):
        if y.mode[k] != SLIP or packed.ports.law[k] == LAW_SMOOTH:
            continue
        if along(packed.ports.row, k, y.n, y.g) < 3.0 * h * max(0.0, -slip_rate(packed, y, k)):
            return False
    return True


@kernel
def dips(r0: float, r1: float, d0: float, d1: float) -> float:
    """Smallest value of the cubic with these values and slopes at 0 and 1: inside, else at an end."""
    if d0 >= 0.0 or d1 <= 0.0:
        return min(r0, r1)
    a = d0 + d1 - 2.0 * (r1 - r0)
    b = 3.0 * (r1 - r0) - 2.0 * d0 - d1
    root = b * b - 3.0 * a * d0
    if root < 0.0:
        return min(r0, r1)
    x = -d0 / (b + np.sqrt(root)) if b > 0.0 else (np.sqrt(root) - b) / (3.0 * a)
    return float(r0 + x * (d0 + x * (b + x * a)))
