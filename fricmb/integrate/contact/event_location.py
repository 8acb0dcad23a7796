"""Transitions in a run: locating them with real steps of variable length, and what follows at the instant.

Shared by radau, bdf and collocation of several contacts.  Collocation of one contact (``collocation/one_contact``:
``stick``, ``landing``), Taylor steps (``taylor/event_search``) and scenes with joints
(``constrained/event_location``) have their own.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.contact.mode_decision import Rest, find_open, mark_rest, settle
from fricmb.integrate.model.accelerations import State, share_load
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.friction_cone import stick_limit
from fricmb.integrate.model.law_values import coefficient, magnitude
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.output.recorder import AFTER, BEFORE, Rows, record, record_event
from fricmb.integrate.problem import (
    EVENT_CLOSE,
    EVENT_OPEN,
    EVENT_REVERSAL,
    EVENT_SLIP,
    EVENT_STICK,
    LAW_SMOOTH,
    OPEN,
    SLIP,
    STICK,
    Codes,
    Floats,
    Ints,
)
from fricmb.integrate.run.breakpoints import EPS
from fricmb.integrate.run.room_protocols import Events, Laws, Modes
from fricmb.integrate.run.stop import stopped
from fricmb.integrate.step.event_functions import find_trigger, margin
from fricmb.integrate.step.radau_step import Accuracy, OneStep, attempt, finish
from fricmb.integrate.step.step_control import ONE_STEP_SAFETY, step_factor
from fricmb.integrate.step.step_error import step_error


class Before(NamedTuple):
    """Modes and directions before a transition."""

    mode: Codes
    n: Floats


@kernel
def copy_state(source: State, target: State) -> None:
    """Make ``target`` equal to ``source``."""
    target.t[0] = source.t[0]
    for i in range(source.q.shape[0]):
        target.q[i] = source.q[i]
        target.v[i] = source.v[i]
        target.a[i] = source.a[i]
        target.f[i] = source.f[i]
        target.low[i] = source.low[i]
    for a in range(source.z.shape[0]):
        target.z[a] = source.z[a]
        target.zd[a] = source.zd[a]
    for a in range(source.g.shape[0]):
        target.F[a] = source.F[a]
        target.n[a] = source.n[a]
        target.g[a] = source.g[a]
        target.a0[a] = source.a0[a]
        target.size[a] = source.size[a]
        target.wd[a] = source.wd[a]
    for k in range(source.mode.shape[0]):
        target.N[k] = source.N[k]
        target.mode[k] = source.mode[k]
    for k in range(source.work.shape[0]):
        target.work[k] = source.work[k]
        target.rate[k] = source.rate[k]


@kernel
def swap_state(one: State, other: State) -> None:
    """Exchange two states but for their forces f."""
    for a, b in (
        (one.t, other.t),
        (one.q, other.q),
        (one.v, other.v),
        (one.a, other.a),
        (one.low, other.low),
        (one.z, other.z),
        (one.zd, other.zd),
        (one.F, other.F),
        (one.n, other.n),
        (one.g, other.g),
        (one.a0, other.a0),
        (one.size, other.size),
        (one.wd, other.wd),
        (one.N, other.N),
        (one.work, other.work),
        (one.rate, other.rate),
    ):
        exchange(a, b)
    for k in range(one.mode.shape[0]):
        mode = one.mode[k]
        one.mode[k] = other.mode[k]
        other.mode[k] = mode


@kernel
def exchange(a: Floats, b: Floats) -> None:
    """Exchange the entries of two arrays."""
    for i in range(a.shape[0]):
        kept = a[i]
        a[i] = b[i]
        b[i] = kept


@kernel
def slip_rate(packed: Packed, y: State, k: int) -> float:
    """Rate of the slip speed of contact k in its direction, n . (W^T a - w')."""
    value = 0.0
    for a in range(packed.ports.row[k], packed.ports.row[k + 1]):
        rate = -y.wd[a]
        for i in range(y.q.shape[0]):
            rate += packed.ports.W[i, a] * y.a[i]
        value += y.n[a] * rate
    return value


@block
def root_along_step(
    packed: Packed, s: Scratch, y: State, end: State, one: OneStep, acc: Accuracy, k: int, h: float, guess: float,
    found: Floats, address: Ints,
) -> float:  # fmt: skip
    """Where contact k comes to its transition, near ``guess``, on the motion of the step h just solved.

    Negative where ``end`` has been moved there and may stay; nan where no root is found.  To be stood in for, where
    the motion within a step is known as well as its end.
    """
    return np.nan


@block
def locate(
    packed: Packed, s: Scratch, y: State, end: State, one: OneStep, acc: Accuracy, k: int, h: float, x: float,
    found: Floats, retry: Floats, address: Ints,
) -> int:  # fmt: skip
    """Find the step that ends at the first transition, by real steps from y; contact k is the first suspect.

    Returns the contact, with its state in ``end``; -1 where the step has to be done again with ``retry[0]``
    (inaccurate so far: close to landing this refines geometrically); -2 where nothing converges.
    """
    t_unit = EPS * max(abs(y.t[0]), h)
    lo, hi = 0.0, h
    f_lo = np.nan
    f_hi = np.nan
    step = max(x, 0.0) * h
    same = 0
    failures = 0
    last = one.tab.c.shape[0] - 1
    if one.exact.ladder.shape[0] > 0 and step_error(packed, s, y, one, acc, h, address) <= 1.0:
        new = root_along_step(packed, s, y, end, one, acc, k, h, step, found, address)
        if new < 0.0:
            return k
        step = new if 0.0 < new < h else step
    for trial in range(60):
        if stopped():
            return -1
        if hi <= 4.0 * t_unit or step <= 2.0 * t_unit:
            copy_state(y, end)
            return k
        if not attempt(packed, s, y, one, acc, step, address):
            failures += 1
            if failures > 8:
                # close to a sharp turn that looks like a stop: up to where it can be solved, and on from there
                retry[0] = 0.7 * lo if lo > 0.0 else step
                return -1 if retry[0] > 16.0 * t_unit else -2
            hi = step
            f_hi = np.nan
            step = lo + 0.5 * (step - lo)
            continue
        error = step_error(packed, s, y, one, acc, step, address)
        if error > 1.0:
            retry[0] = step * max(0.1, step_factor(error, one.tab.c.shape[0], ONE_STEP_SAFETY))
            return -1
        copy_state(y, end)
        if not finish(packed, s, end, one, acc, step, address):
            return -2
        first = find_trigger(packed, s, y, end, one, found, address)
        if first >= 0 and first != k and found[0] * step < step - 4.0 * t_unit:
            k = first
            hi = step
            f_lo = np.nan
            lo = 0.0
            f_hi = margin(packed, s, y, end, one.w.r[last, k], k, found)
            if not f_hi < 0.0:
                f_hi = np.nan
            step = found[0] * step
            continue
        f = margin(packed, s, y, end, one.w.r[last, k], k, found)
        new = np.nan
        if one.exact.ladder.shape[0] > 0:
            new = root_along_step(packed, s, y, end, one, acc, k, step, step, found, address)
            if new < 0.0:
                return k
        slipping = y.mode[k] == SLIP and packed.ports.law[k] != LAW_SMOOTH
        if f < 0.0:
            if f_hi == f_hi and f_lo == f_lo and same < 0:
                f_lo *= 0.5
            hi, f_hi, same = step, f, -1
        else:
            if f_hi == f_hi and f_lo == f_lo and same > 0:
                f_hi *= 0.5
            lo, f_lo, same = step, f, 1
        if not lo < new < hi and slipping and one.w.r[last, k] == f:
            rate = slip_rate(packed, end, k)
            if rate < 0.0:
                new = step - f / rate
        if not lo < new < hi and f_lo == f_lo and f_hi == f_hi:
            new = lo - f_lo * (hi - lo) / (f_hi - f_lo)
        if f == 0.0 or abs(new - step) <= 2.0 * t_unit or hi - lo <= 4.0 * t_unit:
            return k
        if not lo < new < hi:
            if f >= 0.0 and trial > 3 and np.isnan(f_hi) and lo > 0.999 * hi:
                # nothing changes sign: the suspicion came from between the stages of too large a step
                retry[0] = 0.5 * h
                return -1
            new = 0.5 * (lo + hi)
        step = new
    return k


@kernel
def passes_by(packed: Packed, s: Scratch, y: State, end: State, acc: Accuracy, k: int) -> bool:
    """Whether slip of k in two directions that seems to end at ``end`` of a step from y may have turned round instead.

    Friction cannot hold the contact there, so only a path that is straight to round-off comes to rest on its way; any
    other one turns round beside it, faster than the step can see.  What it misses rest by is less than the tolerance
    once the step begins near enough.
    """
    row0 = packed.ports.row[k]
    if packed.ports.row[k + 1] - row0 != 2 or y.mode[k] != SLIP or packed.ports.law[k] == LAW_SMOOTH:
        return False
    D, n, N = packed.ports.D, end.n, end.N[k]
    pull = coefficient(packed.ports, packed.laws, k, s, 0.0, N)[0] * N
    b0, b1 = -end.wd[row0], -end.wd[row0 + 1]
    for i in range(y.q.shape[0]):
        b0 += packed.ports.W[i, row0] * end.a[i]
        b1 += packed.ports.W[i, row0 + 1] * end.a[i]
    # without friction
    b0 += pull * (D[row0, row0] * n[row0] + D[row0, row0 + 1] * n[row0 + 1])
    b1 += pull * (D[row0 + 1, row0] * n[row0] + D[row0 + 1, row0 + 1] * n[row0 + 1])
    whole = D[row0, row0] * D[row0 + 1, row0 + 1] - D[row0, row0 + 1] * D[row0 + 1, row0]
    hold0 = D[row0 + 1, row0 + 1] * b0 - D[row0, row0 + 1] * b1
    hold1 = D[row0, row0] * b1 - D[row0 + 1, row0] * b0
    # in the cone (model/friction_cone), D not divided by
    if np.hypot(hold0, hold1) <= stick_limit(packed.ports, packed.laws, k, s, N) * abs(whole):
        return False
    beside = abs(n[row0] * b1 - n[row0 + 1] * b0) / max(np.hypot(b0, b1), 1e-290)
    return bool(magnitude(packed.ports.row, k, y.g) * beside > 0.01 * acc.rtol[0] * acc.r[k])


@kernel
def turned(ports: Laws, k: int, mode: int, n: Floats, old: Floats) -> bool:
    """Whether one-dimensional slip of contact k has changed its sense."""
    row0 = ports.row[k]
    one = mode == SLIP and ports.law[k] != LAW_SMOOTH and ports.row[k + 1] - row0 == 1
    return bool(one and n[row0] * old[row0] < 0.0)


@kernel
def record_changes(ports: Laws, t: float, y: Modes, old: Modes, out: Events) -> None:
    """Record an event at t for every contact whose mode, or sense of one-dimensional slip, differs from ``old``."""
    for c in range(y.mode.shape[0]):
        if y.mode[c] != old.mode[c]:
            if y.mode[c] == OPEN:
                record_event(out, t, c, EVENT_OPEN)
            elif old.mode[c] == OPEN:
                record_event(out, t, c, EVENT_CLOSE)
            else:
                record_event(out, t, c, EVENT_STICK if y.mode[c] == STICK else EVENT_SLIP)
        elif turned(ports, c, y.mode[c], y.n, old.n):
            record_event(out, t, c, EVENT_REVERSAL)


@kernel
def lands_now(packed: Packed, y: State, k: int, part: int) -> bool:
    """Whether a slip ends so soon that no step to its end can be told from none: 16 roundings of the time away."""
    if part != 0 or y.mode[k] != SLIP or packed.ports.law[k] == LAW_SMOOTH:
        return False
    speed = magnitude(packed.ports.row, k, y.g)
    return bool(speed <= -16.0 * EPS * abs(y.t[0]) * slip_rate(packed, y, k))


@kernel
def holds_nothing(packed: Packed, y: State, k: int) -> bool:
    """Whether a stuck contact that has reached its cone bears nothing but round-off: it is the cone that has closed."""
    row0 = packed.ports.row[k]
    if y.mode[k] != STICK or packed.ports.var[k] < 0:
        return False
    top = 0.0
    for i in range(y.a.shape[0]):
        top = max(top, abs(y.a[i]))
    held = packed.ports.D[row0, row0] * magnitude(packed.ports.row, k, y.F)
    return bool(held <= 1e-12 * top)


@kernel
def give_way(packed: Packed, s: Scratch, y: State, r: Rest, old: Before) -> bool:
    """Release, of redundant contacts that share a load, those that slip in the motion by which they give way.

    They reach their cones as one: none can hold the load without the others.  False where there is no such motion.
    """
    nc = y.mode.shape[0]
    kept = y.F.copy()
    load = share_load(packed, s, y.mode, y.N, kept, y.way, 1.0 - 1e-6)
    most = 0.0
    for c in range(nc if load > 0.0 else 0):
        row0 = packed.ports.row[c]
        most = max(most, magnitude(packed.ports.row, c, y.way))
    for c in range(nc if most > 0.0 else 0):
        row0 = packed.ports.row[c]
        speed = magnitude(packed.ports.row, c, y.way)
        if old.mode[c] == STICK and r.part[c] == 1 and speed > 1e-3 * most:
            r.part[c] = 2
            for a in range(row0, packed.ports.row[c + 1]):
                y.n[a] = y.way[a] / speed
    return most > 0.0


@block
def transition(
    packed: Packed, s: Scratch, y: State, k: int, lifted: bool, r: Rest, old: Before, out: Rows, address: Ints
) -> int:
    """Go through the transition that contact k has reached (k = -1: a breakpoint of prescribed motion).

    ``lifted``: it is its normal force that has come to 0.

    Records the rows on both sides and the events.  Returns the code of :func:`settle`.
    """
    ports = packed.ports
    # an open contact has no other transition (located without a step, nothing has told which it is)
    lifted = lifted or (k >= 0 and (y.mode[k] == OPEN or holds_nothing(packed, y, k)))
    record(out, y, BEFORE)
    for c in range(y.mode.shape[0]):
        old.mode[c] = y.mode[c]
    for a in range(y.n.shape[0]):
        old.n[a] = y.n[a]
    find_open(packed, s, y, address)
    if lifted:
        # the normal force is at its zero, up to round-off of either sign
        y.mode[k] = SLIP if old.mode[k] == OPEN else OPEN
    mark_rest(packed, s, y, r, address)
    for c in range(y.mode.shape[0]):
        row0 = ports.row[c]
        force = ports.D[row0, row0] * stick_limit(ports, packed.laws, c, s, y.N[c])
        if lands_now(packed, y, c, r.part[c]):
            r.part[c] = 1
        if c != k and r.part[c] == 1 and old.mode[c] == SLIP and slip_rate(packed, y, c) >= -1e-9 * force:
            # released at this very instant: tried stuck again it would be on its cone, and so without end
            r.part[c] = 2
    if k >= 0 and not lifted and packed.ports.law[k] != LAW_SMOOTH:
        if old.mode[k] == STICK and ports.soft[0] > 0.0 and give_way(packed, s, y, r, old):
            pass
        elif old.mode[k] == STICK:
            r.part[k] = 2
            size = magnitude(ports.row, k, y.F)
            for a in range(ports.row[k], ports.row[k + 1]):
                y.n[a] = -y.F[a] / size
        else:
            r.part[k] = 1
    code = settle(packed, s, y, r, address)
    if code != 0:
        return code
    record_changes(ports, y.t[0], y, old, out)
    record(out, y, AFTER)
    return 0
