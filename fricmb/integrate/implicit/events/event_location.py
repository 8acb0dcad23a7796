"""Locating transitions, and the end of unique friction, with steps of variable length."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.formulas.crossing import evaluate, first_crossing, narrowed
from fricmb.integrate.implicit.equations.slip_rows import slip_speed
from fricmb.integrate.implicit.events.event_functions import gaps, violated
from fricmb.integrate.implicit.events.triggers import friction, grain, is_gap, is_slip, kind_of, load, owner, triggers
from fricmb.integrate.implicit.modes.uniqueness import margins
from fricmb.integrate.implicit.output.recorder import copy_state
from fricmb.integrate.implicit.scene.control import Control
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.implicit.scene.watch import FRICTION, LOAD, Watch
from fricmb.integrate.implicit.stages.one_step import step_to
from fricmb.integrate.implicit.stages.stages import Stages
from fricmb.integrate.run.breakpoints import EPS

#: What is left of a trigger from one step to the next as long as the slope of its polynomial is worth following.
BETTER = 0.1
#: Tries of what only the polynomial shows, each by a shorter step.
DOUBTS = 4


@kernel
def by_polynomial(st: Stages, out: Watch, j: int, h: float) -> tuple[float, float]:
    """Where the polynomial of trigger j first vanishes in a step h, and its slope there; (-1, 0) where it does not."""
    for i in range(st.tab.c.shape[0]):
        out.values[i] = out.inner[i + 1, j]
    x = first_crossing(st.tab, max(out.inner[0, j], 0.0), out.values, out.series)
    if x > 1.0:
        return -1.0, 0.0
    _, slope, _ = evaluate(out.series, x)
    return x * h, slope / h


@kernel
def from_touch(st: Stages, out: Watch, j: int, h: float, rate: float) -> float:
    """Where what is 0 at the start of a step h, and rises at a rate, vanishes again; -1 where it does not.

    By its polynomial over the time, without the root at the start: hops may be far shorter than steps.  At a rate of 0
    it rises by the next derivative; the slope is round-off there, and may be below 0.
    """
    for i in range(st.tab.c.shape[0]):
        out.values[i] = out.inner[i + 1, j] / st.tab.c[i]
    x = first_crossing(st.tab, max(rate, 0.0) * h, out.values, out.series)
    return x * h if 0.0 < x <= 1.0 else -1.0


@kernel
def rate_at_start(mech: Mech, out: Watch, j: int, y: State) -> float:
    """Rate of the slip of trigger j at the start y of a step, of a distance where it was last told; 0 for others."""
    if is_gap(mech, j):
        return float(out.rate[owner(mech, j)])
    return slip_speed(mech.port.row, owner(mech, j), y.n, y.F, y.ga) if is_slip(mech, j, y) else 0.0


@kernel
def has_series(st: Stages) -> bool:
    """Whether there is a series of the step."""
    return bool(st.series.terms > 0)


@kernel
def at_series(mech: Mech, k: Moving, end: State, st: Stages, out: Watch, j: int, h: float) -> float:
    """Trigger j of a port a time h behind the start of the series; the port's forces and slip go into ``end``."""
    se, c = st.series, owner(mech, j)
    at, N = h / se.length, 0.0
    for a in range(mech.port.row[c], mech.port.row[c + 1]):
        F, g = 0.0, 0.0
        for i in range(se.terms - 1, -1, -1):
            F, g = F * at + se.F[i, a], g * at + se.g[i, a]
        end.F[a], end.g[a] = F, g
    for i in range(se.terms - 1, -1, -1):
        N = N * at + se.N[i, c]
    end.N[c] = N
    if kind_of(mech, j) == LOAD:
        return load(mech, end.mode, end.N, c)
    return friction(mech, k, out, end.mode, end.n, end.F, end.N, end.g, c)


@kernel
def by_series(mech: Mech, k: Moving, end: State, st: Stages, out: Watch, j: int, low: float, high: float) -> float:
    """Where the series of trigger j passes through 0 between two lengths of the step (Illinois), or -1."""
    f_low = at_series(mech, k, end, st, out, j, low)
    f_high = at_series(mech, k, end, st, out, j, high)
    if not (f_low > 0.0 > f_high):
        return -1.0
    moved, root = 0, low
    for _ in range(60):
        root = low + (high - low) * (f_low / (f_low - f_high))
        value = at_series(mech, k, end, st, out, j, root)
        if not low < root < high or value == 0.0:
            break
        low, f_low, high, f_high, moved = narrowed(low, f_low, high, f_high, moved, root, value, beyond=value < 0.0)
        if high - low <= EPS * high:
            break
    return root


@kernel
def locate_trigger(
    mech: Mech, k: Moving, w: Instant, y: State, end: State, st: Stages, c: Control, out: Watch, h: float, first: int
) -> tuple[float, int]:
    """Length of the step that ends where the first trigger vanishes, and that trigger; ``end`` is left there.

    Steps of variable length: by root and slope of the polynomial of the trigger, then by regula falsi (Illinois), until
    the trigger is within ``grain`` of 0 or the time within 8 roundings.  A step at whose end another trigger is below 0
    replaces the upper bound.  A dip that the polynomial alone shows is tried by a shorter step; one that shows none is
    returned with trigger -1.  Length 0 where a step could not be made.
    """
    inside = out.where
    if out.opened > 0:
        gaps(mech, k, y.t, y.q, y.v, y.lam, out)
    triggers(mech, k, out, y.mode, y.n, y.F, y.N, y.g, y.lam, True)
    j = first
    rises = rate_at_start(mech, out, first, y)
    low, f_low = 0.0, max(out.trigger[j], 0.0)
    high, f_high = h, min(out.inner[st.tab.c.shape[0], j], 0.0)
    moved = 0
    step = h
    left = np.inf
    # where friction ends or begins; loads that set in or bend are found from both sides
    exact = kind_of(mech, first) == FRICTION or is_gap(mech, first)
    guess, slope = by_polynomial(st, out, first, h) if inside >= 1.0 and exact else (-1.0, 0.0)
    begins = is_gap(mech, first) or (is_slip(mech, first, y) and inside >= 1.0)
    if begins and out.inner[0, first] <= 10.0 * grain(mech, out, first, y):
        guess, slope = from_touch(st, out, first, h, rises), 0.0
    of_series = has_series(st)
    for i in range(80):
        root = by_series(mech, k, end, st, out, j, low, high) if of_series and kind_of(mech, j) <= LOAD else -1.0
        if root > 0.0:
            guess, slope = root, 0.0
        gap = f_low - f_high
        step = low + (high - low) * (f_low / gap if gap > 0.0 and f_high < 0.0 and f_low > 0.0 else 0.5)
        if i % 8 == 7:
            step = 0.5 * (low + high)
        step = min(max(step, low + 1e-3 * (high - low)), high - 1e-3 * (high - low))
        if inside < 1.0 and not low < guess < inside * high:
            step = inside * high
        elif low < guess < high:
            step = guess
        if not step_to(mech, k, w, y, end, st, c, step):
            if step != guess:
                return 0.0, j
            guess, slope = -1.0, 0.0
            continue
        worst = violated(mech, k, w, out, y, end, st)
        if inside < 1.0 and (worst < 0 or (out.where < 1.0 and i >= DOUBTS)):
            return step, -1
        inside = out.where
        if inside < 1.0:
            j, high, f_high = worst, step, 0.0
            low = low if out.where * high > low else 0.0
            f_low = max(out.inner[0, j], 0.0) if low == 0.0 else 0.0
            continue
        value = out.trigger[j]
        # where a step begins beyond by what `violated` takes for nothing, no shorter one comes nearer
        limit = grain(mech, out, j, end) * (1.0 if f_low > 0.0 else 10.0)
        if worst >= 0 and worst != j and out.trigger[j] >= -limit:
            j = worst
            high, f_high, f_low = step, min(out.trigger[j], 0.0), 0.0
            continue
        if kind_of(mech, j) == LOAD and not of_series:
            limit = 0.0  # by Hertz a load is next to nothing long before it is 0
        if abs(value) <= limit or high - low <= 8.0 * EPS * max(abs(y.t), abs(h)):
            break
        if is_gap(mech, j):
            slope = out.rate[owner(mech, j)]
        elif j != first or abs(value) > BETTER * left:
            slope = 0.0
        left, guess = abs(value), (step - value / slope if slope < 0.0 else -1.0)
        beyond = value < 0.0 or worst >= 0
        value = min(value, 0.0) if beyond else value
        low, f_low, high, f_high, moved = narrowed(low, f_low, high, f_high, moved, step, value, beyond)
    return step, j


#: Roundings of the time by which a state is told to be before a jump.
AHEAD = 16.0


@kernel
def goes_before_jump(
    mech: Mech, k: Moving, w: Instant, y: State, end: State, st: Stages, c: Control, out: Watch, h: float, j: int
) -> bool:
    """Whether trigger j, at whose zero the step h ends, jumps there; ``end`` is moved to the side before it then.

    A force that appears at a touch lets go of what rests by a jump: located, the step may end on either side, and the
    row of what still holds would show a force far over its limit.
    """
    held = j >= 0 and kind_of(mech, j) == FRICTION and not is_slip(mech, j, y)
    if not held or out.trigger[j] >= -out.hair * out.top_force:
        return False
    shorter = h - AHEAD * EPS * max(abs(y.t), abs(h))
    if shorter > 0.0:
        return bool(step_to(mech, k, w, y, end, st, c, shorter))
    copy_state(y, end)
    return True


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
        if step_to(mech, k, w, y, end, st, c, middle) and margins(mech, k, w, end, out, False) > 0.0:
            low = middle
        else:
            high = middle
        if high - low <= 1e-13 * h + 4.0 * EPS * abs(y.t):
            break
    if low > 0.0 and step_to(mech, k, w, y, end, st, c, low):
        margins(mech, k, w, end, out, True)
    return low
