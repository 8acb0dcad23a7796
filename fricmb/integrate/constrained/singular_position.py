"""Positions in which constraints depend on one another: how near one is, and steps that meet or pass one."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.constrained.accelerations import NONE, instant_matrix, solve_instant
from fricmb.integrate.constrained.forces import move
from fricmb.integrate.constrained.moving import Moving
from fricmb.integrate.constrained.problem_structs import Mech
from fricmb.integrate.constrained.radau_step import Control, step_to
from fricmb.integrate.constrained.recorder import copy_state
from fricmb.integrate.constrained.stages import Stages
from fricmb.integrate.constrained.state import Instant, State
from fricmb.integrate.constrained.watch import Watch

#: Inverse iterations where nothing is known of the direction.
TURNS = 20


#: A least singular value this small beside what it was: the constraints are as good as dependent.
SINGULAR = 1e-9


#: A least singular value that a step can bring down to this part of what it was at the start: a singular position.
REACHED = 3e-6


@kernel
def least_singular(mech: Mech, w: Instant, out: Watch, turns: int) -> float:
    """Least singular value of ``G M^-1/2`` by inverse iteration; the matrix without friction is factored.

    One turn follows its direction from step to step.  It is proportional to the distance from a singular position.
    """
    m = out.weak.shape[0]
    if m == 0:
        return 1.0
    n = mech.order.place.shape[0] - mech.port.row[-1] - mech.port.z_start[-1] - m
    length = 0.0
    for _ in range(turns):
        length = 0.0
        for i in range(m):
            if mech.joint.dropped[i] != 0:
                out.weak[i] = 0.0
            length += out.weak[i] * out.weak[i]
        for i in range(w.r.shape[0]):
            w.r[i] = 0.0
        for i in range(m):
            w.r[n + i] = out.weak[i] / np.sqrt(max(length, 1e-300))
        solve_instant(mech, w)
        length = 0.0
        for i in range(m):
            out.weak[i] = w.r[n + i]
            length += out.weak[i] * out.weak[i]
    return float(length**-0.25) if length > 0.0 else 1.0


@kernel
def near_singular(mech: Mech, k: Moving, w: Instant, y: State, out: Watch, h: float) -> bool:
    """Whether the constraints are as good as dependent at y, which has just been completed by a step h."""
    out.sigma_before = out.sigma
    out.sigma_h = h
    # without friction the factors of the projection are those of the instant
    if y.F.shape[0] > 0 and not instant_matrix(mech, k, w, y, NONE):
        return True
    out.sigma = least_singular(mech, w, out, 1)
    return bool(out.sigma < SINGULAR * out.sigma_start)


@kernel
def nears_singular(out: Watch, h: float) -> bool:
    """Whether a step h might meet a singular position, the least singular value falling on."""
    fall = out.sigma_before - out.sigma
    return bool(out.sigma_h > 0.0 and fall > 0.0 and out.sigma * out.sigma_h <= 4.0 * fall * h)


@kernel
def dips(mech: Mech, k: Moving, w: Instant, y: State, end: State, st: Stages, out: Watch, h: float) -> bool:
    """Whether the least singular value falls to less than half at a stage of the step just solved."""
    copy_state(y, end)
    for i in range(st.tab.c.shape[0]):
        move(mech, k, y.t + st.tab.c[i] * h, st.Q[i], st.V[i])
        if not instant_matrix(mech, k, w, end, NONE):
            return True
        if least_singular(mech, w, out, 1) < 0.5 * out.sigma:
            return True
    return False


@kernel
def step_to_singular(
    mech: Mech, k: Moving, w: Instant, y: State, end: State, st: Stages, c: Control, out: Watch, h: float
) -> float:
    """Length of a step of at most h to a singular position, left in ``end``; 0: there is none.  Golden section."""
    low, high = 0.0, h
    for _ in range(50):
        a = low + 0.381966 * (high - low)
        b = low + 0.618034 * (high - low)
        first = sigma_after(mech, k, w, y, end, st, c, out, a)
        if first <= REACHED * out.sigma_start:
            return a
        second = sigma_after(mech, k, w, y, end, st, c, out, b)
        if second <= REACHED * out.sigma_start:
            return b
        if first < second or first > 1e299:
            high = b
        else:
            low = a
        if high - low < 1e-2 * h and min(first, second) > 0.2 * out.sigma:
            break
    return 0.0


@block
def sigma_after(
    mech: Mech, k: Moving, w: Instant, y: State, end: State, st: Stages, c: Control, out: Watch,
    h: float,
) -> float:  # fmt: skip
    """Least singular value of the constraints after a step h, left in ``end``; a large one where none can be made."""
    if not step_to(mech, k, w, y, end, st, c, h) or not instant_matrix(mech, k, w, end, NONE):
        return 1e300
    return float(least_singular(mech, w, out, 1))
