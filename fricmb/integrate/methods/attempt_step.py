"""One accepted or rejected one-step step of a run: its error, the transition it may meet, its rows."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block, declared
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.contact.event_location import locate, passes_by
from fricmb.integrate.contact.rest_problem import Rest
from fricmb.integrate.contact.transition import Before, transition
from fricmb.integrate.model.accelerations import slip_rate
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import INFINITE, State, copy_state, swap_state
from fricmb.integrate.output.recorder import INSIDE, STEP, Rows, put, record
from fricmb.integrate.problem import LAW_SMOOTH, SLIP, Floats
from fricmb.integrate.run.breakpoints import EPS
from fricmb.integrate.run.outcomes import (
    ACCEPTED,
    CHANGED,
    FAIL_CHATTER,
    FAIL_INFINITE,
    FAIL_LAW,
    FAIL_MODES,
    FAIL_REDUNDANT,
    FAIL_STEP,
    REJECTED,
)
from fricmb.integrate.step.bends_without_joints import bend_ahead, go_over_bend
from fricmb.integrate.step.event_functions import find_changing_contact
from fricmb.integrate.step.exact_structure import rung_below
from fricmb.integrate.step.knots import NOWHERE, beside_knots, knot_ahead
from fricmb.integrate.step.one_step import add_work, attempt, finish, update_scales
from fricmb.integrate.step.one_step_room import Accuracy, OneStep, is_exact
from fricmb.integrate.step.step_control import ONE_STEP_RUNGS, ONE_STEP_SAFETY, ladder, next_step, step_factor
from fricmb.integrate.step.step_error import step_error

#: Slip speed, relative to the velocities behind it, that is taken for none where no step can be taken.
NEARLY = 1e-12
#: Transitions at one instant after which that is done, too.
PATIENCE = 10


class Clock(Layout):
    """Step control: ``h`` next step, ``usual`` step to start with after a transition, ``span`` (2,) bounds.

    ``longest`` step at present, and anywhere, ``bound``; ``stops`` breakpoints; transitions in a row at one instant,
    ``at_once``, and since the time ``mark``, ``since_mark``; ``found``, ``retry`` (1,) space for locating.
    ``growth``: see ``step_control.next_step``; ``wanted`` what the error of the last step alone would let the next
    one be; ``knot`` when the next step has to end, since a law or an element bends then (not ahead: whenever it likes).
    """

    h: float
    usual: float
    span: Floats
    longest: float
    bound: float
    stops: Floats
    at_once: int
    since_mark: int
    found: Floats
    mark: float
    retry: Floats
    growth: float
    wanted: float
    knot: float


@kernel
def settled(code: int) -> int:
    """What a transition that went wrong is reported as; CHANGED where it did not."""
    if code == 0:
        return CHANGED
    return (FAIL_MODES, FAIL_REDUNDANT, FAIL_INFINITE)[code - 1]


@kernel
def incomplete(y: State) -> int:
    """Why the forces of a state could not be found."""
    return FAIL_INFINITE if y.fault == INFINITE else FAIL_REDUNDANT


@kernel
def reject(clock: Clock, one: OneStep, h: float) -> int:
    """Leave y where it is; the next step is h."""
    one.counts[1] += 1
    clock.h = h
    return REJECTED


@block
def off_beside_knots(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, h: float) -> float:
    """:func:`beside_knots` of the step just solved, in units of the tolerance."""
    off = beside_knots(packed.ports, packed.laws, s, one.tab, y, one.w, one.felt, acc.rtol, h)
    return float(off / acc.rtol)


@block
def next_knot(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, h: float) -> float:
    """:func:`knot_ahead` in the step just solved."""
    return float(knot_ahead(packed.ports, packed.laws, s, one.tab, y, one.w, one.felt, acc.rtol, h))


@block
def advance(
    packed: Packed, s: Scratch, y: State, end: State, one: OneStep, acc: Accuracy, r: Rest, old: Before, out: Rows,
    clock: Clock, left: float,
) -> int:  # fmt: skip
    """Try one step of ``clock.h``, at most ``left``, from y.

    After ACCEPTED y is the end of the step and ``end`` its start (stages are in ``one``); after CHANGED y stands behind
    the transition.
    """
    order = one.tab.c.shape[0]
    t = y.t
    before_knot = clock.knot > t
    if before_knot:
        left = min(left, clock.knot - t)
    h = min(clock.h, clock.longest)
    if h >= left * (1.0 - 1e-9):
        h = left
    elif is_exact(one):
        h = one.exact.ladder[rung_below(h)]
    else:
        # steps of a ladder come again, and their factors with them
        h = ladder(min(h, 0.5 * left) if h > 0.5 * left else h, ONE_STEP_RUNGS)
    # h may be a longer step than was asked for, the shortest rung of a ladder; the run fails by what was asked for
    if not min(h, clock.h) > 8.0 * EPS * abs(t) + 1e-280:
        return end_round_off(packed, s, y, r, old, out, clock)
    error = np.inf
    if attempt(packed, s, y, one, acc, h):
        error = step_error(packed, s, y, one, acc, h)
        if packed.ports.knots.shape[0] > 0:
            error = max(error, off_beside_knots(packed, s, y, one, acc, h))
    if not error <= 1.0 and not is_exact(one):
        clock.growth = 1.0
    if not error < np.inf:
        return reject(clock, one, 0.25 * h)
    copy_state(y, end)
    if not finish(packed, s, end, one, acc, h):
        return incomplete(end)
    contact = find_changing_contact(packed, s, y, end, one, acc, clock.found)
    wanted = h * min(5.0, max(0.1, step_factor(error, order, ONE_STEP_SAFETY)))
    if is_exact(one):
        wanted = min(wanted, one.exact.cap)
    knot = NOWHERE
    if packed.ports.knots.shape[0] > 0:
        knot = next_knot(packed, s, y, one, acc, h)
    if packed.bends.address.shape[0] > 0 and not is_exact(one):
        bend = bend_ahead(packed, s, y, one, acc, h)
        if bend < knot:
            # forces that jump there reach a cone anywhere on polynomials over both sides
            knot, contact = bend, -1
    if knot < 1.0 and (error <= 1.0 or knot * h < wanted) and (contact < 0 or knot < clock.found[0]):
        clock.knot = t + knot * h
        if not clock.knot > t:
            # a bend so near that no step ends before it: asked for again it would be as near
            return end_round_off(packed, s, y, r, old, out, clock)
        return reject(clock, one, h)
    if contact < 0 and error <= 1.0:
        if end.fault > 0.0:
            return FAIL_LAW
        record_inside(packed, s, y, end, one, acc, out)
        swap_state(y, end)
        record(out, y, STEP)
        one.counts[0] += 1
        clock.at_once = 0
        if h < left:
            clock.usual = max(h, 0.8 * clock.usual)
        clock.wanted = wanted
        clock.h = next_step(clock, h, wanted)
        if before_knot and h == left:
            # what comes is not what the polynomials so far have known
            clock.knot = -np.inf
            clock.h = max(clock.h, clock.usual)
            clock.growth = np.inf
            if packed.bends.address.shape[0] > 0 and not is_exact(one) and go_over_bend(packed, s, y):
                # what jumps may be more than a contact at rest can hold
                return settled(transition(packed, s, y, -1, False, r, old, out))
            return CHANGED
        return ACCEPTED
    if contact < 0 or (error > 1.0 and clock.found[0] * h > wanted):
        return reject(clock, one, wanted)
    if clock.found[0] < 1e-9 and y.mode[contact] == SLIP and h > 1e-6 * clock.usual:
        # slip that has only begun and seems to end at once: a wrong solution of too large a step, not to start from
        one.last_h = 0.0
        return reject(clock, one, 0.2 * h)
    clock.retry[0] = wanted
    contact = locate(packed, s, y, end, one, acc, contact, h, clock.found[0], clock.found, clock.retry)
    if contact == -2:
        return end_round_off(packed, s, y, r, old, out, clock)
    if contact == -1:
        return reject(clock, one, clock.retry[0])
    lifted = clock.found[1] == 1.0
    if not lifted and end.t - t > 1e-6 * clock.usual and passes_by(packed, s, y, end, acc, contact):
        one.last_h = 0.0
        return reject(clock, one, 0.5 * (end.t - t))
    if end.t > t:
        record_inside(packed, s, y, end, one, acc, out)
        one.counts[0] += 1
    clock.at_once = 0 if end.t - t > 16.0 * EPS * abs(t) else clock.at_once + 1
    if clock.at_once == PATIENCE:
        code = end_round_off(packed, s, y, r, old, out, clock)
        if code != FAIL_STEP:
            return code
    if clock.at_once > 20 + 4 * y.mode.shape[0] or pile_up(clock, end.t, y.mode.shape[0]):
        return FAIL_CHATTER
    copy_state(end, y)
    clock.h = clock.usual
    clock.growth = np.inf
    clock.knot = -np.inf
    one.last_h = 0.0
    return settled(transition(packed, s, y, contact, lifted, r, old, out))


@kernel
def pile_up(clock: Clock, t: float, n_c: int) -> bool:
    """Count a transition at t; whether hundreds of them have brought the run on by nothing."""
    if clock.since_mark == 0:
        clock.mark = t
    clock.since_mark += 1
    if clock.since_mark <= 200 + 20 * n_c:
        return False
    clock.since_mark = 0
    return bool(t - clock.mark < 1e-12 * (clock.span[1] - clock.span[0]))


@kernel
def end_round_off(packed: Packed, s: Scratch, y: State, r: Rest, old: Before, out: Rows, clock: Clock) -> int:
    """Where no step can be taken: end the slips that are as good as round-off and settle, if there are any.

    Of contacts that come to rest together, such as two points of a pad, one is left slipping a little.  Its speed is a
    few roundings of the velocities of the bodies: too small for a step to end it, and more than the round-off of one
    velocity.  Or it would come to rest within a time that is nothing beside the step.  Or forces jump there, and what
    rests lets go behind the jump alone.
    """
    if packed.bends.address.shape[0] > 0 and clock.at_once <= PATIENCE and go_over_bend(packed, s, y):
        clock.at_once += 1
        clock.h = clock.usual
        clock.growth = np.inf
        return settled(transition(packed, s, y, -1, False, r, old, out))
    kept = r.small.copy()
    found = False
    for k in range(y.mode.shape[0]):
        if y.mode[k] == SLIP and packed.ports.law[k] != LAW_SMOOTH:
            row0 = packed.ports.row[k]
            speed = magnitude(packed.ports.row, k, y.g)
            soon = -1e-9 * clock.usual * slip_rate(packed, y, k)
            if speed <= max(soon, NEARLY * y.size[row0] + 1e3 * kept[k]):
                found = True
                r.small[k] = speed
    clock.at_once += 1
    if not found or clock.at_once > 20 + 4 * y.mode.shape[0]:
        return FAIL_STEP
    clock.h = clock.usual
    code = settled(transition(packed, s, y, -1, False, r, old, out))
    r.small[:] = kept
    return code


@declared
def exact_record(packed: Packed, s: Scratch, y: State, end: State, one: OneStep, acc: Accuracy, out: Rows) -> None:
    """:func:`record_inside` on an exact structure; see ``collocation.finish_step``."""
    raise NotImplementedError


@kernel
def record_inside(packed: Packed, s: Scratch, y: State, end: State, one: OneStep, acc: Accuracy, out: Rows) -> None:
    """What dense output needs of an accepted step beside its ends."""
    if is_exact(one):
        exact_record(packed, s, y, end, one, acc, out)
    else:
        record_stages(packed, s, y, end, one, acc, out)


@block
def record_stages(packed: Packed, s: Scratch, y: State, end: State, one: OneStep, acc: Accuracy, out: Rows) -> None:
    """Rows for the stages inside an accepted step: dense output between them keeps the accuracy of the step."""
    # of accepted steps alone: a wild trial must not loosen the tolerance for the rest of the run
    update_scales(packed, y, one, acc)
    st, w, tab = one.st, one.w, one.tab
    n_s = tab.c.shape[0]
    h = end.t - y.t
    add_work(packed, s, end, one, h)
    n, nc = y.q.shape[0], y.mode.shape[0]
    for j in range(n_s - 1):
        k = out.used[0]
        row = out.values[k]
        row[0] = st.t[j]
        at = put(row, 1, st.Q[j])
        at = put(row, at, st.V[j])
        for i in range(n):
            value = tab.rate[j, 0] * y.v[i]
            for x in range(n_s):
                value += tab.rate[j, x + 1] * st.V[x, i]
            row[at + i] = value / h
        at = put(row, at + n, w.z[j])
        at = put(row, at, w.zd[j])
        at = put(row, at, w.F[j])
        at = put(row, at, w.N[j])
        for i in range(nc + 2):
            energy = y.work[i]
            for x in range(n_s):
                energy += h * tab.A[j, x] * one.power[x, i]
            row[at + i] = energy
        put(row, at + nc + 2, one.power[j])
        out.kind[k] = INSIDE
        for i in range(nc):
            out.mode[k, i] = y.mode[i]
        out.used[0] = k + 1
