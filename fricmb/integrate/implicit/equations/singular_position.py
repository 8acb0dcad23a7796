"""Positions in which constraints depend on one another: how near one is, and how far a step may go towards it."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.band import factor_band, spread_of_pivots
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.equations.instant_matrix import NONE, instant_matrix, solve_instant
from fricmb.integrate.implicit.scene.control import Control
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech, first_multiplier
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.implicit.scene.watch import Watch
from fricmb.integrate.problem import Floats
from fricmb.integrate.run.breakpoints import EPS

#: Inverse iterations where nothing is known of the direction.
TURNS = 20
#: A least singular value that falls and has come down to this part of the largest so far: a singular position.
#: (Reactions grow with the inverse of its square: nearer still, no step can be solved to a tolerance.)
REACHED = 2.5e-5
#: The same, where steps have become as short as round-off on the way there.
SUSPECTED = 1e-3
#: The same, below which a step covers a part of the way left at most, and that part.
NEAR, APPROACH = 0.6, 0.7
#: Round-off of velocities where the least singular value is as large as it was at most; reactions, and with them
#: velocities, have more of it with the square of its inverse, and no step is more accurate.
ROUND_OFF = 20.0 * EPS
#: Part by which it changes before its rate is counted anew: what is less may be round-off, in short steps.
NOTED = 1e-3
#: Spread of the pivots, without units, at which constraints depend on one another where a run starts: the square of the
#: least singular value is in it, and round-off of 1e-16.
DEPENDENT = 1e-14


@kernel
def starts_dependent(mech: Mech, w: Instant) -> bool:
    """Whether constraints depend on one another in the instant's matrix (layers ``w.L``); ``w.ab`` is overwritten.

    Masses, inertias and lengths stand side by side in it, and pivots would say most about the units.  So velocities
    are counted in units of equal kinetic energy, and rows of G in such that G M^-1 G' has a diagonal of ones; friction,
    which has none of these rows, is left out.
    """
    order, scale = mech.order, w.x
    n, size, half, length = first_multiplier(mech), order.place.shape[0], order.sizes[1], order.sizes[3]
    if mech.joint.row[-1] == 0:
        return False
    scale[:] = 0.0
    for i in range(n):
        scale[order.place[i]] = 1.0 / np.sqrt(mech.mass[i])
    for r in range(mech.joint.row[-1]):
        at, square = order.place[n + r], 0.0
        for j in range(max(at - half, 0), min(at + half + 1, size)):
            square += (w.L.A1[j * length + 2 * half + at - j] * scale[j]) ** 2
        w.r[r] = 1.0 / np.sqrt(square) if square > 0.0 else 0.0
    for r in range(mech.joint.row[-1]):
        scale[order.place[n + r]] = w.r[r]
    for j in range(size):
        for i in range(max(j - half, 0), min(j + half + 1, size)):
            at = j * length + 2 * half + i - j
            w.ab[at] = (w.L.A0[at] + w.L.A1[at]) * scale[i] * scale[j]
        if scale[j] == 0.0:
            w.ab[j * length + 2 * half] = 1.0
    return not factor_band(w.ab, w.pivots, order.sizes) or spread_of_pivots(w.ab, order.sizes) < DEPENDENT


@kernel
def least_singular(mech: Mech, w: Instant, out: Watch, turns: int) -> float:
    """Least singular value of ``G M^-1/2`` by inverse iteration; the matrix without friction is factored.

    One turn follows its direction from step to step, from ``weak`` to ``weak_end``.  It is proportional to the distance
    from a singular position.
    """
    m = out.weak.shape[0]
    if m == 0:
        return 1.0
    n = first_multiplier(mech)
    for i in range(m):
        out.weak_end[i] = 0.0 if mech.joint.dropped[i] != 0 else out.weak[i]
    length = 0.0
    for _ in range(turns):
        length = np.sqrt(max(squared(out.weak_end), 1e-300))
        for i in range(w.r.shape[0]):
            w.r[i] = 0.0
        for i in range(m):
            w.r[n + i] = out.weak_end[i] / length
        solve_instant(mech, w)
        for i in range(m):
            out.weak_end[i] = 0.0 if mech.joint.dropped[i] != 0 else w.r[n + i]
        length = squared(out.weak_end)
    return float(length**-0.25) if length > 0.0 else 1.0


@kernel
def squared(x: Floats) -> float:
    """Sum of squares."""
    total = 0.0
    for i in range(x.shape[0]):
        total += x[i] * x[i]
    return total


@kernel
def has_come_near(out: Watch, part: float) -> bool:
    """Whether the least singular value is on its way to 0, and below a part of the largest so far."""
    return bool(out.sigma < part * out.sigma_top and out.sigma_rate < 0.0)


@kernel
def start_watch(mech: Mech, w: Instant, out: Watch, top: float) -> None:
    """Least singular value where a run, or one with other joints, begins; its matrix without friction is factored.

    ``top``: the largest so far.  Where constraints were left out since they follow from others, nothing is watched:
    those that were kept may depend on one another where all of them together do not.
    """
    out.redundant = 0
    for i in range(mech.joint.dropped.shape[0]):
        if mech.joint.dropped[i] == 1:
            out.redundant = 1
    out.sigma_end = least_singular(mech, w, out, TURNS)
    out.sigma_before = out.sigma_end
    out.sigma_top = max(top, out.sigma_end)
    out.sigma_h = out.sigma_rate = 0.0
    copy_columns(mech, w.L.A1, out.reactions_end, True)
    go_on(out)


@kernel
def go_on(out: Watch) -> None:
    """What has been found for the end of a step is where the next one starts."""
    out.sigma = out.sigma_end
    for i in range(out.weak.shape[0]):
        out.weak[i] = out.weak_end[i]
    for i in range(out.reactions.shape[0]):
        out.reactions[i] = out.reactions_end[i]


@kernel
def copy_columns(mech: Mech, A: Floats, columns: Floats, out: bool) -> None:
    """Columns of the multipliers out of a banded matrix, or into it."""
    n, length = first_multiplier(mech), mech.order.sizes[3]
    for i in range(mech.joint.row[-1]):
        first = mech.order.place[n + i] * length
        for j in range(length):
            if out:
                columns[i * length + j] = A[first + j]
            else:
                A[first + j] = columns[i * length + j]


@kernel
def has_turned(mech: Mech, w: Instant, out: Watch) -> bool:
    """Whether K = G M^-1 G', G of the instant on the left and of the last state on the right, is no longer positive.

    With both of one position it is; a singular value that goes through 0 in between changes the sign of its
    determinant, which is that of the matrix of the instant (the layers ``w.L`` hold it) with the reactions of the last
    state.  Two at once, of two mechanisms that are alike, leave it: then ``weak_end K^-1 weak_end`` is negative.
    The factors in ``w.ab`` are those of K afterwards.
    """
    order = mech.order
    for i in range(w.ab.shape[0]):
        w.ab[i] = w.L.A0[i] + w.L.A1[i]
    copy_columns(mech, w.ab, out.reactions, False)
    if not factor_band(w.ab, w.pivots, order.sizes):
        return False
    negative = False
    for j in range(order.place.shape[0]):
        swapped = w.pivots[j] != j + 1
        negative = negative != (swapped != (w.ab[j * order.sizes[3] + order.sizes[1] + order.sizes[2]] < 0.0))
    if negative:
        return True
    n = first_multiplier(mech)
    for i in range(w.r.shape[0]):
        w.r[i] = 0.0
    for i in range(out.weak_end.shape[0]):
        w.r[n + i] = out.weak_end[i]
    solve_instant(mech, w)
    along = 0.0
    for i in range(out.weak_end.shape[0]):
        along += out.weak_end[i] * w.r[n + i]
    return along < 0.0


@kernel
def way_left(out: Watch) -> float:
    """Time until the least singular value is 0 if it falls on as it did."""
    return -out.sigma / out.sigma_rate if out.sigma_rate < 0.0 else np.inf


@kernel
def may_have_passed(mech: Mech, k: Moving, w: Instant, end: State, out: Watch, h: float) -> bool:
    """Whether a singular position may lie between the last state and the ``end`` of a step h that is just complete.

    It may have gone through, or come back to where the least singular value is larger; of a step that is a small part
    of the way that was left (0.3), the latter is but a turn of the motion.  ``sigma_end``, ``weak_end`` and
    ``reactions_end`` are left for :func:`near_singular`.
    """
    if out.weak.shape[0] == 0:
        out.sigma_end = 1.0
        return False
    out.sigma_end = 0.0
    # without friction the factors of the projection are those of the instant
    if end.F.shape[0] > 0 and not instant_matrix(mech, k, w, end, NONE):
        return False
    out.sigma_end = least_singular(mech, w, out, 1)
    copy_columns(mech, w.L.A1, out.reactions_end, True)
    came_back = out.sigma_end > out.sigma and h > 0.3 * way_left(out) and out.sigma < NEAR * out.sigma_top
    return out.redundant == 0 and (came_back or has_turned(mech, w, out))


@kernel
def near_singular(c: Control, out: Watch, h: float) -> bool:
    """Whether the constraints are as good as dependent at the end of a step h (after ``may_have_passed``)."""
    go_on(out)
    out.sigma_h += h
    out.sigma_top = max(out.sigma_top, out.sigma)
    change = out.sigma - out.sigma_before
    if abs(change) > NOTED * out.sigma_before:
        out.sigma_rate = change / out.sigma_h
        out.sigma_before = out.sigma
        out.sigma_h = 0.0
    elif out.sigma_h > 0.0:
        # had it gone on as it did, more would have been noted by now
        out.sigma_rate = max(out.sigma_rate, -NOTED * out.sigma_before / out.sigma_h)
    c.blur = ROUND_OFF * (out.sigma_top / max(out.sigma, 1e-290)) ** 2
    return out.sigma == 0.0 or (out.redundant == 0 and has_come_near(out, REACHED))


@kernel
def longest_towards(out: Watch) -> float:
    """Longest step on the way to a singular position that is near: one far beyond it would not see it."""
    near = out.redundant == 0 and out.sigma < NEAR * out.sigma_top
    return APPROACH * way_left(out) if near else np.inf
