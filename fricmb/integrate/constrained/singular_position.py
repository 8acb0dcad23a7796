"""Positions in which constraints depend on one another: how near one is, and how far a step may go towards it."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.constrained.accelerations import NONE, instant_matrix, solve_instant
from fricmb.integrate.constrained.moving import Moving
from fricmb.integrate.constrained.problem_structs import Mech
from fricmb.integrate.constrained.state import Instant, State
from fricmb.integrate.constrained.watch import Watch

#: Inverse iterations where nothing is known of the direction.
TURNS = 20
#: A least singular value that falls and has come down to this part of what it was at the start: a singular position.
#: (Reactions grow with the inverse of its square: nearer still, no step can be solved to a tolerance.)
REACHED = 2.5e-5
#: The same, where steps have become as short as round-off on the way there.
SUSPECTED = 1e-3
#: The same, where steps become shorter than the way to it; their part of that way.
NEAR, APPROACH = 0.6, 0.7
#: Part by which it changes before its rate is counted anew: what is less may be round-off, in short steps.
NOTED = 1e-3


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
def has_come_near(out: Watch, part: float) -> bool:
    """Whether the least singular value is on its way to 0, and below a part of what it was at the start."""
    return bool(out.sigma < part * out.sigma_start and out.sigma_rate < 0.0)


@kernel
def sigma_at(mech: Mech, k: Moving, w: Instant, y: State, out: Watch) -> float:
    """Least singular value at a state that has just been completed; 0 where the matrix is singular."""
    # without friction the factors of the projection are those of the instant
    if y.F.shape[0] > 0 and not instant_matrix(mech, k, w, y, NONE):
        return 0.0
    return least_singular(mech, w, out, 1)


@kernel
def near_singular(mech: Mech, k: Moving, w: Instant, y: State, out: Watch, h: float) -> bool:
    """Whether the constraints are as good as dependent at y, which has just been completed by a step h."""
    out.sigma = sigma_at(mech, k, w, y, out)
    out.sigma_h += h
    change = out.sigma - out.sigma_before
    if abs(change) > NOTED * out.sigma_before:
        out.sigma_rate = change / out.sigma_h
        out.sigma_before = out.sigma
        out.sigma_h = 0.0
    return out.sigma == 0.0 or has_come_near(out, REACHED)


@kernel
def way_left(out: Watch) -> float:
    """Time until the least singular value is 0 if it falls on as it did."""
    return -out.sigma / out.sigma_rate if out.sigma_rate < 0.0 else np.inf


@kernel
def longest_towards(out: Watch) -> float:
    """Longest step on the way to a singular position that is near: one far beyond it would not see it."""
    return APPROACH * way_left(out) if out.sigma < NEAR * out.sigma_start else np.inf


@kernel
def may_have_passed(mech: Mech, k: Moving, w: Instant, end: State, out: Watch, h: float) -> bool:
    """Whether a step h, which has just been completed, may have gone through a singular position.

    The least singular value fell before it and is larger behind it.  Where the step is a small part of the way that
    was left, that is a turn.
    """
    return bool(h > 0.3 * way_left(out) and sigma_at(mech, k, w, end, out) > out.sigma)
