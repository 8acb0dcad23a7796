"""Transitions in a run: locating them with real steps of variable length (what follows there: ``transition``).

Shared by radau, bdf and collocation of several contacts.  Collocation of one contact (``collocation/one_contact``:
``stick``, ``landing``), Taylor steps (``taylor/event_search``) and scenes with joints
(``constrained/event_location``) have their own.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block, declared
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.accelerations import slip_rate
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.friction_cone import stick_limit
from fricmb.integrate.model.law_values import coefficient, magnitude
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State, copy_state
from fricmb.integrate.problem import LAW_SMOOTH, SLIP, STICK, Floats
from fricmb.integrate.run.breakpoints import EPS
from fricmb.integrate.step.event_functions import BY_EITHER, find_changing_contact, margin
from fricmb.integrate.step.one_step import attempt, finish
from fricmb.integrate.step.one_step_room import Accuracy, OneStep, is_exact
from fricmb.integrate.step.step_control import ONE_STEP_SAFETY, step_factor
from fricmb.integrate.step.step_error import step_error

#: Roundings of the time within which a release happens at once: another contact has just let go, and in a step as short
#: as that forces between its ends are round-off of velocities.
AT_ONCE = 1024.0


@declared
def exact_root(
    packed: Packed, s: Scratch, y: State, end: State, one: OneStep, acc: Accuracy, k: int, h: float, guess: float,
    found: Floats,
) -> float:  # fmt: skip
    """Where contact k comes to its transition, near ``guess``, on the motion of the step h just solved.

    Negative where ``end`` has been moved there and may stay; nan where no root is found.  On an exact structure, where
    the motion within a step is known as well as its end; see ``collocation.root_along_step``.
    """
    raise NotImplementedError


@block
def locate(
    packed: Packed, s: Scratch, y: State, end: State, one: OneStep, acc: Accuracy, contact: int, h: float, x: float,
    found: Floats, retry: Floats,
) -> int:  # fmt: skip
    """Find the step that ends at the first transition, by real steps from y; ``contact`` is the first suspect.

    Returns the contact, with its state in ``end``; -1 where the step has to be done again with ``retry[0]``
    (inaccurate so far: close to landing this refines geometrically); -2 where nothing converges.
    """
    t_unit = EPS * max(abs(y.t), h)
    lo, hi = 0.0, h
    f_lo = np.nan
    f_hi = np.nan
    step = max(x, 0.0) * h
    same = 0
    beyond = BY_EITHER
    failures = 0
    last = one.tab.c.shape[0] - 1
    if is_exact(one) and step_error(packed, s, y, one, acc, h) <= 1.0:
        new = exact_root(packed, s, y, end, one, acc, contact, h, step, found)
        if new < 0.0:
            return contact
        step = new if 0.0 < new < h else step
    for trial in range(60):
        if hi <= 4.0 * t_unit or step <= 2.0 * t_unit:
            copy_state(y, end)
            return contact
        if not attempt(packed, s, y, one, acc, step):
            failures += 1
            if failures > 8:
                # close to a sharp turn that looks like a stop: up to where it can be solved, and on from there
                retry[0] = 0.7 * lo if lo > 0.0 else step
                return -1 if retry[0] > 16.0 * t_unit else -2
            hi = step
            f_hi = np.nan
            step = lo + 0.5 * (step - lo)
            continue
        error = step_error(packed, s, y, one, acc, step)
        if error > 1.0:
            retry[0] = step * max(0.1, step_factor(error, one.tab.c.shape[0], ONE_STEP_SAFETY))
            return -1
        copy_state(y, end)
        if not finish(packed, s, end, one, acc, step):
            return -2
        sooner = find_changing_contact(packed, s, y, end, one, acc, found)
        if sooner >= 0 and sooner != contact and found[0] * step < step - 4.0 * t_unit:
            contact = sooner
            hi = step
            f_lo = np.nan
            lo = 0.0
            f_hi = margin(packed, s, y, end, one.w.r[last, contact], contact, BY_EITHER, found)
            beyond = found[1] if f_hi < 0.0 else BY_EITHER
            if not f_hi < 0.0:
                f_hi = np.nan
            step = found[0] * step
            continue
        f = margin(packed, s, y, end, one.w.r[last, contact], contact, beyond, found)
        if f < 0.0 and found[1] != beyond:
            # the other one's values tell nothing of this one's zero
            beyond, f_lo = found[1], np.nan
        new = np.nan
        if is_exact(one):
            new = exact_root(packed, s, y, end, one, acc, contact, step, step, found)
            if new < 0.0:
                return contact
        if f < 0.0 and y.mode[contact] == STICK and step <= AT_ONCE * t_unit:
            copy_state(y, end)
            return contact
        slipping = y.mode[contact] == SLIP and packed.ports.law[contact] != LAW_SMOOTH
        if f < 0.0:
            if f_hi == f_hi and f_lo == f_lo and same < 0:
                f_lo *= 0.5
            hi, f_hi, same = step, f, -1
        else:
            if f_hi == f_hi and f_lo == f_lo and same > 0:
                f_hi *= 0.5
            lo, f_lo, same = step, f, 1
        if not lo < new < hi and slipping and one.w.r[last, contact] == f:
            rate = slip_rate(packed, end, contact)
            if rate < 0.0:
                new = step - f / rate
        if not lo < new < hi and f_lo == f_lo and f_hi == f_hi:
            new = lo - f_lo * (hi - lo) / (f_hi - f_lo)
        if f == 0.0 or abs(new - step) <= 2.0 * t_unit or hi - lo <= 4.0 * t_unit:
            return contact
        if not lo < new < hi:
            if f >= 0.0 and trial > 3 and np.isnan(f_hi) and lo > 0.999 * hi:
                # nothing changes sign: the suspicion came from between the stages of too large a step
                retry[0] = 0.5 * h
                return -1
            new = 0.5 * (lo + hi)
        step = new
    return contact


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
    return bool(magnitude(packed.ports.row, k, y.g) * beside > 0.01 * acc.rtol * acc.r[k])


