"""The loop of a run: steps, located transitions, and what stops it."""

from __future__ import annotations

from fricmb.integrate._kernel import entry, kernel
from fricmb.integrate._problem import (
    EVENT_CLOSE,
    EVENT_OPEN,
    EVENT_REVERSAL,
    EVENT_SLIP,
    EVENT_STICK,
    OPEN,
    SLIP,
    STICK,
    Codes,
    Ints,
)
from fricmb.integrate._room import block
from fricmb.integrate.constrained._accept import Watch, margins, pivots_of, triggers
from fricmb.integrate.constrained._decide import FOUND, SEVERAL, decide, mark_rest
from fricmb.integrate.constrained._locate import last_unique, locate_trigger, violated
from fricmb.integrate.constrained._pack import Mech, Moving
from fricmb.integrate.constrained._project import EPS, project_velocities
from fricmb.integrate.constrained._record import Record, copy_state, crowded, record_event, record_step
from fricmb.integrate.constrained._stages import Stages
from fricmb.integrate.constrained._state import NONE, Instant, State, instant_matrix, react
from fricmb.integrate.constrained._step import Control, end_step, error_of, remember, try_step

#: Outcomes of a run.
DONE, FULL, FAIL_STEP, FAIL_NONE, FAIL_SEVERAL, FAIL_MARGIN, FAIL_SINGULAR, FAIL_LOST, FAIL_PROJECT = range(9)
#: A step ends a try at this part of the span.
SMALLEST = 1e-14
#: Pivots this small beside what they were: the constraints are as good as dependent.
SINGULAR = 1e-11


@kernel
def next_stop(c: Control, t: float) -> float:
    """The next time that has to be stepped to exactly; sees to it that functions of time are taken from inside."""
    stop = c.span[1]
    for i in range(c.stops.shape[0]):
        if c.stops[i] > t + 4.0 * EPS * abs(t) and c.stops[i] < stop:
            stop = c.stops[i]
    return float(stop)


@kernel
def set_window(k: Moving, c: Control, t: float) -> None:
    """Evaluate functions of time inside the present interval between breakpoints."""
    low, high = -1e300, 1e300
    for i in range(c.stops.shape[0]):
        edge = c.stops[i]
        if edge <= t + 4.0 * EPS * abs(t):
            low = max(low, edge + 2.0 * EPS * abs(edge) + 1e-300)
        else:
            high = min(high, edge - 2.0 * EPS * abs(edge) - 1e-300)
    k.s.window[0] = low
    k.s.window[1] = high


@kernel
def grow(c: Control, out: Watch, y: State) -> None:
    """Running maxima."""
    for i in range(y.v.shape[0]):
        c.v[i] = max(c.v[i], abs(y.v[i]))
    for i in range(y.z.shape[0]):
        c.z[i] = max(c.z[i], abs(y.z[i]))
    for i in range(y.F.shape[0]):
        out.size[0] = max(out.size[0], abs(y.g[i]))
        out.size[1] = max(out.size[1], abs(y.F[i]))
    for i in range(y.lam.shape[0]):
        out.size[1] = max(out.size[1], abs(y.lam[i]))


@block
def change_modes(
    mech: Mech,
    k: Moving,
    w: Instant,
    y: State,
    before: State,
    c: Control,
    out: Watch,
    rec: Record,
    part: Codes,
    j: int,
    address: Ints,
) -> int:
    """Go through the transition of trigger j (-1: a breakpoint): modes together with reactions, events."""
    n_c = y.F.shape[0]
    copy_state(y, before)
    if j >= 2 * n_c:
        return FAIL_LOST
    set_window(k, c, y.t[0])
    for i in range(n_c):
        part[i] = 1 if y.mode[i] == STICK else 0
        if y.mode[i] == SLIP and abs(y.g[i]) <= 1e-11 * out.size[0]:
            part[i] = 1
    forced = -1
    if j >= 0:
        port = j // 2
        if j % 2 == 1:
            y.mode[port] = SLIP if y.mode[port] == OPEN else OPEN
            if y.mode[port] == SLIP:
                y.n[port] = 1.0 if y.g[port] > 0.0 else -1.0
                part[port] = 1 if abs(y.g[port]) <= 1e-11 * out.size[0] else 0
        elif y.mode[port] == STICK:
            forced = port
        else:
            part[port] = 1
    code = decide(mech, k, w, y, part, forced, mech.address)
    if code != FOUND:
        return FAIL_SEVERAL if code == SEVERAL else FAIL_NONE
    for i in range(n_c):
        was, now = before.mode[i], y.mode[i]
        kind = -1
        if was == SLIP and now == STICK:
            kind = EVENT_STICK
        elif was == STICK and now == SLIP:
            kind = EVENT_SLIP
        elif was != OPEN and now == OPEN:
            kind = EVENT_OPEN
        elif was == OPEN and now != OPEN:
            kind = EVENT_CLOSE
        elif was == SLIP and now == SLIP and before.n[i] != y.n[i]:
            kind = EVENT_REVERSAL
        if kind >= 0:
            record_event(rec, y.t[0], i, kind)
    if not project_velocities(mech, k, w, y, False, True, mech.address):
        return FAIL_PROJECT
    if not react(mech, k, w, y, False, mech.address):
        return FAIL_NONE
    c.h[1] = 0.0
    c.made[0] = 0.0
    if margins(mech, k, w, y, out, mech.address) <= 0.0:
        return FAIL_MARGIN
    return DONE


@entry
def begin(
    mech: Mech, k: Moving, w: Instant, y: State, c: Control, out: Watch, rec: Record, part: Codes, given: bool,
    small: float,
) -> int:  # fmt: skip
    """Modes, forces and accelerations at the start."""
    set_window(k, c, y.t[0] + 4e-16 * abs(y.t[0]) + 1e-300)
    if not project_velocities(mech, k, w, y, False, False, mech.address):
        return FAIL_SINGULAR
    out.pivot[1] = pivots_of(mech, w)
    if out.pivot[1] < 1e-14:
        return FAIL_SINGULAR
    mark_rest(mech, y, small, part)
    if given:
        for i in range(part.shape[0]):
            if y.mode[i] == SLIP and part[i] == 1:
                part[i] = 0
    code = decide(mech, k, w, y, part, -1, mech.address)
    if code != FOUND:
        if margins(mech, k, w, y, out, mech.address) <= 0.0:
            return FAIL_MARGIN
        return FAIL_SEVERAL if code == SEVERAL else FAIL_NONE
    grow(c, out, y)
    if margins(mech, k, w, y, out, mech.address) <= 0.0:
        return FAIL_MARGIN
    triggers(mech, out, y.mode, y.n, y.F, y.N, y.g, y.lam)
    for j in range(2 * y.F.shape[0], out.trigger.shape[0]):
        if out.trigger[j] < 0.0:
            out.pivot[0] = j
            return FAIL_LOST
    return DONE


@entry
def drive(
    mech: Mech, k: Moving, w: Instant, y: State, end: State, before: State, st: Stages, c: Control, out: Watch,
    rec: Record, part: Codes,
) -> int:  # fmt: skip
    """Step from y until the end of the span, or until the room for steps is used up."""
    s = st.tab.c.shape[0]
    set_window(k, c, y.t[0])
    while True:
        if crowded(rec, y.F.shape[0]):
            return FULL
        t = y.t[0]
        stop = next_stop(c, t)
        if stop - t <= 20.0 * EPS * max(abs(t), abs(stop)):
            y.t[0] = stop
            if stop >= c.span[1]:
                return DONE
            code = change_modes(mech, k, w, y, before, c, out, rec, part, -1, mech.address)
            if rec.used[0] > 0:
                rec.after[rec.used[0] - 1] = 1
            if code != DONE:
                return code
            continue
        left = stop - t
        h = c.h[0]
        if h >= left:
            h = left
        elif h > 0.5 * left:
            h = 0.5 * left
        if h <= SMALLEST * (c.span[1] - c.span[0]) + 8.0 * EPS * abs(t):
            margins(mech, k, w, y, out, mech.address)
            return FAIL_STEP
        c.made[0] = 0.0
        if not try_step(mech, k, y, st, c, h, mech.address):
            c.counts[1] += 1
            c.h[0] = 0.4 * h
            continue
        error = error_of(c, y, st)
        factor = 0.85 * max(error, 1e-12) ** (-1.0 / (s + 1))
        if error > 1.0:
            c.counts[1] += 1
            c.h[0] = h * max(0.2, factor)
            continue
        if not end_step(mech, k, w, y, end, st, c, h, mech.address):
            c.counts[1] += 1
            c.h[0] = 0.4 * h
            continue
        if margins(mech, k, w, end, out, mech.address) <= 0.0:
            h = last_unique(mech, k, w, y, end, st, c, out, h)
            if h > 0.0:
                record_step(rec, y, end, st, c, h)
                copy_state(end, y)
            return FAIL_MARGIN
        worst = violated(mech, out, end, st)
        if worst >= 0:
            h, worst = locate_trigger(mech, k, w, y, end, st, c, out, h, worst)
            if h == 0.0:
                c.counts[1] += 1
                c.h[0] *= 0.3
                continue
        record_step(rec, y, end, st, c, h)
        if h == left:
            end.t[0] = stop
        remember(c, y, st, h)
        c.counts[0] += 1
        copy_state(end, y)
        grow(c, out, y)
        if worst < 0 and (h < left or factor < 1.0):
            c.h[0] = h * min(3.0, max(0.3, factor))
        # without friction the factors of the projection are those of the instant
        if y.F.shape[0] > 0 and instant_matrix(mech, k, w, y, NONE, mech.address) != 0:
            return FAIL_SINGULAR
        out.pivot[0] = pivots_of(mech, w)
        if out.pivot[0] < SINGULAR * out.pivot[1]:
            return FAIL_SINGULAR
        if worst >= 0:
            rec.after[rec.used[0] - 1] = 1
            out.pivot[0] = worst
            code = change_modes(mech, k, w, y, before, c, out, rec, part, worst, mech.address)
            if code != DONE:
                return code
