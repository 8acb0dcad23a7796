"""Locating transitions, and the end of unique friction, with steps of variable length."""

from __future__ import annotations

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.constrained.accelerations import NONE, Instant, State, instant_matrix
from fricmb.integrate.constrained.forces import move
from fricmb.integrate.constrained.problem_structs import Mech, Moving
from fricmb.integrate.constrained.projection import EPS
from fricmb.integrate.constrained.radau_step import Control, end_step, try_step
from fricmb.integrate.constrained.recorder import copy_state
from fricmb.integrate.constrained.slip_rows import lack
from fricmb.integrate.constrained.stages import Stages
from fricmb.integrate.constrained.watch import Watch, gaps, least_singular, margins, triggers
from fricmb.integrate.problem import LAW_SMOOTH, NORMAL_LAW, OPEN, SLIP, Ints
from fricmb.integrate.step.crossing import first_below


@kernel
def is_slip(j: int, y: State) -> bool:
    """Whether trigger j is a slip velocity (else a force)."""
    return bool(j < 2 * y.mode.shape[0] and j % 2 == 0 and y.mode[j // 2] == SLIP)


@kernel
def grain(mech: Mech, out: Watch, j: int, y: State) -> float:
    """Round-off of trigger j: of a slip velocity, a distance or a force."""
    n_c = y.mode.shape[0]
    if is_slip(j, y):
        return float(1e-13 * out.size[0])
    if 2 * n_c <= j < 2 * n_c + mech.joint.port.shape[0] and mech.joint.dropped[mech.joint.row[j - 2 * n_c]] == 2:
        return float(1e-13 * out.size[2])
    return float(1e-13 * out.size[1])


@block
def violated(mech: Mech, k: Moving, out: Watch, y: State, end: State, st: Stages, address: Ints) -> int:
    """The trigger that falls furthest below 0 in the step from y to end, or -1; values at the end stay in ``trigger``.

    ``out.where`` is less than 1 where neither the end nor a stage shows it, but the polynomial through them does there.
    """
    s = st.tab.c.shape[0]
    worst, least = -1, 0.0
    out.where[0] = 1.0
    triggers(mech, k, out, end.mode, end.n, y.F, y.N, y.g, y.lam, False)
    out.inner[0] = out.trigger
    if out.opened[0] > 0:
        gaps(mech, k, end, out)
    for i in range(s):
        last = i == s - 1
        if last:
            triggers(mech, k, out, end.mode, end.n, end.F, end.N, end.g, end.lam, True)
        else:
            triggers(mech, k, out, end.mode, end.n, st.F[i], st.N[i], st.g[i], st.lam[i], False)
        out.inner[i + 1] = out.trigger
        for j in range(out.trigger.shape[0]):
            value = out.trigger[j]
            limit = 10.0 * grain(mech, out, j, end)
            if value < -limit and value / max(limit, 1e-290) < least:
                worst, least = j, value / max(limit, 1e-290)
    return worst if worst >= 0 else first_between(mech, k, out, y, st)


#: Forces at the stages are of lower order than velocities: this part of the largest one, between them, is no sign.
ROUGH = 1e-6


#: Tries of what only the polynomial shows, each by a shorter step.
DOUBTS = 4


@kernel
def is_smooth(mech: Mech, k: Moving, j: int, y: State, st: Stages) -> bool:
    """Whether trigger j is what its values say between the stages: neither an open joint's nor one almost without load.

    Open joints have no values but at the end of the step; slip almost without load may turn as it likes.
    """
    n_c = y.mode.shape[0]
    if j >= 2 * n_c:
        return bool(mech.joint.dropped[mech.joint.row[j - 2 * n_c]] != 2)
    if j % 2 == 1 or y.mode[j // 2] == OPEN or mech.port.law[j // 2] == LAW_SMOOTH:
        return bool(mech.port.normal[j // 2] == NORMAL_LAW)
    loaded = lack(y.N[j // 2], k.borne[0]) == 0.0
    for i in range(st.tab.c.shape[0]):
        loaded = loaded and lack(st.N[i, j // 2], k.borne[0]) == 0.0
    return bool(loaded)


@kernel
def first_between(mech: Mech, k: Moving, out: Watch, y: State, st: Stages) -> int:
    """The trigger that first falls below 0 between the stages of a step from y alone, or -1; ``out.where`` then."""
    found = -1
    for j in range(2 * y.mode.shape[0] + mech.joint.port.shape[0]):
        if not is_smooth(mech, k, j, y, st):
            continue
        hair = 10.0 * grain(mech, out, j, y) if is_slip(j, y) else ROUGH * out.size[1]
        for i in range(st.tab.c.shape[0]):
            out.values[i] = out.inner[i + 1, j] + hair
        # what begins at 0 rises from there, whatever the polynomial makes of its first moment
        first = out.inner[0, j] + hair if out.inner[0, j] > hair else 0.0
        _, below = first_below(st.tab, first, out.values, out.series)
        if below < out.where[0]:
            found = j
            out.where[0] = below
    return found


@kernel
def locate_trigger(
    mech: Mech, k: Moving, w: Instant, y: State, end: State, st: Stages, c: Control, out: Watch, h: float, first: int
) -> tuple[float, int]:
    """Length of the step that ends where the first trigger vanishes, and that trigger; ``end`` is left there.

    Regula falsi (Illinois) on steps of variable length; a step at whose end another trigger is below 0 replaces the
    upper bound.  What the polynomial alone shows is tried by a step to there: trigger -1 where that finds nothing, and
    it is a step like any other.  Length 0 where a step could not be made.
    """
    inside = out.where[0]
    if out.opened[0] > 0:
        gaps(mech, k, y, out)
    triggers(mech, k, out, y.mode, y.n, y.F, y.N, y.g, y.lam, True)
    j = first
    low, f_low = 0.0, max(out.trigger[j], 0.0)
    if out.opened[0] > 0:
        gaps(mech, k, end, out)
    triggers(mech, k, out, end.mode, end.n, end.F, end.N, end.g, end.lam, True)
    high, f_high = h, min(out.trigger[j], 0.0)
    side = 0
    step = h
    for i in range(80):
        gap = f_low - f_high
        step = low + (high - low) * (f_low / gap if gap > 0.0 and f_high < 0.0 and f_low > 0.0 else 0.5)
        if i % 8 == 7:
            step = 0.5 * (low + high)
        step = min(max(step, low + 1e-3 * (high - low)), high - 1e-3 * (high - low))
        if inside < 1.0:
            step = inside * high
        if not (
            try_step(mech, k, y, st, c, step, mech.address) and end_step(mech, k, w, y, end, st, c, step, mech.address)
        ):
            return 0.0, j
        worst = violated(mech, k, out, y, end, st, mech.address)
        if inside < 1.0 and (worst < 0 or (out.where[0] < 1.0 and i >= DOUBTS)):
            return step, -1
        inside = out.where[0]
        if inside < 1.0:
            j, high, f_high = worst, step, 0.0
            low = low if out.where[0] * high > low else 0.0
            f_low = max(out.inner[0, j], 0.0) if low == 0.0 else 0.0
            continue
        value = out.trigger[j]
        limit = grain(mech, out, j, end)
        if worst >= 0 and worst != j and out.trigger[j] >= -limit:
            j = worst
            high, f_high, f_low = step, min(out.trigger[j], 0.0), 0.0
            continue
        if abs(value) <= limit or high - low <= 8.0 * EPS * max(abs(y.t[0]), abs(h)):
            break
        if value < 0.0 or worst >= 0:
            high, f_high = step, min(value, 0.0)
            f_low *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            low, f_low = step, value
            f_high *= 0.5 if side == 2 else 1.0
            side = 2
    return step, j


@kernel
def last_unique(
    mech: Mech, k: Moving, w: Instant, y: State, end: State, st: Stages, c: Control, out: Watch, h: float
) -> float:
    """Length of the longest step at whose end friction still has a single solution, by bisection; ``end`` is there."""
    low, high = 0.0, h
    for _ in range(60):
        middle = 0.5 * (low + high)
        if middle <= low or middle >= high:
            break
        made = try_step(mech, k, y, st, c, middle, mech.address) and end_step(
            mech, k, w, y, end, st, c, middle, mech.address
        )
        if made and margins(mech, k, w, end, out, False, mech.address) > 0.0:
            low = middle
        else:
            high = middle
        if high - low <= 1e-13 * h + 4.0 * EPS * abs(y.t[0]):
            break
    if low > 0.0 and try_step(mech, k, y, st, c, low, mech.address):
        end_step(mech, k, w, y, end, st, c, low, mech.address)
        margins(mech, k, w, end, out, False, mech.address)
    return low


#: A least singular value that a step can bring down to this part of what it was at the start: a singular position.
REACHED = 3e-6


@kernel
def nears_singular(out: Watch, h: float) -> bool:
    """Whether a step h might meet a singular position, the least singular value falling on."""
    fall = out.sigma[2] - out.sigma[0]
    return bool(out.sigma[3] > 0.0 and fall > 0.0 and out.sigma[0] * out.sigma[3] <= 4.0 * fall * h)


@kernel
def dips(mech: Mech, k: Moving, w: Instant, y: State, end: State, st: Stages, out: Watch, h: float) -> bool:
    """Whether the least singular value falls to less than half at a stage of the step just solved."""
    copy_state(y, end, mech.address)
    for i in range(st.tab.c.shape[0]):
        move(mech, k, y.t[0] + st.tab.c[i] * h, st.Q[i], st.V[i], mech.address)
        if instant_matrix(mech, k, w, end, NONE, mech.address) != 0:
            return True
        if least_singular(mech, w, out, 1) < 0.5 * out.sigma[0]:
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
        first = sigma_after(mech, k, w, y, end, st, c, out, a, mech.address)
        if first <= REACHED * out.sigma[1]:
            return a
        second = sigma_after(mech, k, w, y, end, st, c, out, b, mech.address)
        if second <= REACHED * out.sigma[1]:
            return b
        if first < second or first > 1e299:
            high = b
        else:
            low = a
        if high - low < 1e-2 * h and min(first, second) > 0.2 * out.sigma[0]:
            break
    return 0.0


@block
def sigma_after(
    mech: Mech, k: Moving, w: Instant, y: State, end: State, st: Stages, c: Control, out: Watch,
    h: float, address: Ints,
) -> float:  # fmt: skip
    """Least singular value of the constraints after a step h, left in ``end``; a large one where none can be made."""
    made = try_step(mech, k, y, st, c, h, mech.address) and end_step(mech, k, w, y, end, st, c, h, mech.address)
    if not made or instant_matrix(mech, k, w, end, NONE, mech.address) != 0:
        return 1e300
    return float(least_singular(mech, w, out, 1))
