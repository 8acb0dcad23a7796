"""The loop of a run: a step of all, its transitions and samples in order of time, the end of the step."""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import entry, kernel
from fricmb.integrate.problem import STICK
from fricmb.integrate.run.stop import stopped
from fricmb.integrate.taylor.account import pay_groups
from fricmb.integrate.taylor.change import taylor_change
from fricmb.integrate.taylor.event_heap import pop_due, push_due
from fricmb.integrate.taylor.event_search import bounds, taylor_search
from fricmb.integrate.taylor.layout import (
    ALLOWED,
    AT_END,
    END,
    EPS,
    FASTEST,
    INPUT,
    LIMIT,
    LONGEST,
    N_EVENTS,
    N_HEAP,
    N_HERE,
    N_SAMPLES,
    N_SHORTER,
    N_STEPS,
    N_STOP,
    NEXT,
    PHASE,
    STALLED,
    STEP,
    TIME,
    TOL,
    UNTIL,
    WORK,
)  # fmt: skip
from fricmb.integrate.taylor.ledger import belt_work, count_rest
from fricmb.integrate.taylor.network import Net
from fricmb.integrate.taylor.polynomials import hold_force, horner, horner_rate, rescale
from fricmb.integrate.taylor.sample import sample
from fricmb.integrate.taylor.series import taylor_series
from fricmb.integrate.taylor.signals import ROUNDING, belt_value, signal_series
from fricmb.integrate.taylor.starting_modes import set_window, settle

#: Why a run came back.
DONE, FULL, PAUSE, CROWDED, WIDE, NOT_FINITE, STOPPED, TOO_SHORT, TOO_STEEP = range(9)
#: Steps in a row that do not move the time.
PATIENCE = 100
#: Phases of a step.
BEGIN, INSIDE, FINISH, SETTLE = range(4)


#: Errors in units of the tolerance from which on, and parts of the step down to which, its polynomials say nothing.
BEYOND, BRIEF = 1e12, 0.02
#: Round-off of a prescribed function is less than that, relative to its largest value.
NO_ROUNDING = 1e-7


@kernel
def tail_error(net: Net, h: float) -> float:
    """Last coefficients of the velocities relative to the tolerance."""
    P = net.Q.shape[0] - 1
    n = net.q.shape[0]
    last = net.Q[P]
    before = net.Q[P - 1]
    work = net.flat[WORK]
    floor = 0.01 * net.x[FASTEST]
    for j in range(n):
        work[j] = (P * abs(last[j]) + (P - 1) * abs(before[j])) / (net.top[j] + floor)
    worst, sound = 0.0, 0.0
    for j in range(n):
        worst = max(worst, work[j])
        sound += 0.0 * work[j]
    # comparisons pass over what is no number
    return float(worst / (h * net.x[TOL])) if sound == 0.0 else math.inf


@kernel
def idle_step(net: Net, left: float) -> float:
    """Where nothing accelerates: how long until the first contact breaks away, at most ``left``."""
    h = net.x[STEP]
    found = left
    for c in range(net.mode.shape[0]):
        force = hold_force(net, c, 0.0)
        rate = (hold_force(net, c, 1.0) - force) / h
        if rate != 0.0:
            found = min(found, max(0.0, (math.copysign(net.stick[c], rate) - force) / rate))
    return float(found)


@kernel
def follow_signals(net: Net, t: float, h: float) -> float:
    """A step of at most h over which prescribed functions are polynomials; 0 where they have no value."""
    fine = max(0.1 * net.x[TOL], ROUNDING)
    last = math.inf
    for _ in range(60):
        error = signal_series(net, t, h)
        # what a shorter step does not make smaller is round-off of the function's values
        if error <= fine or 0.5 * last < error < NO_ROUNDING:
            break
        last = error
        # where a function has no value its error is no number
        h *= max(0.3, 0.9 * (fine / error) ** 0.125) if error < math.inf else 0.3
        if not error < math.inf and h <= EPS * max(abs(t), net.x[LONGEST]):
            return 0.0
    return h


@kernel
def begin_step(net: Net) -> bool:
    """Choose the step and make its polynomials; False for an idle one, which has no transitions inside."""
    t = net.x[TIME]
    stop = net.stops[net.i[N_STOP]]
    left = stop - t
    h = min(net.x[NEXT], net.x[LONGEST])
    if h > left * (1.0 - 1e-9):
        h = left
    elif h > 0.5 * left:
        h = 0.5 * left
    for _ in range(60):
        h = follow_signals(net, t, h)
        net.x[STEP] = h
        net.x[UNTIL] = net.x[ALLOWED] = 1.0
        if h == 0.0:
            return False
        busy = taylor_series(net, h, net.places)
        if not busy and net.series.shape[0] == 0:
            idle = idle_step(net, left)
            if idle > h:
                rescale(net, idle / h)
                net.x[STEP] = idle
                return False
        error = tail_error(net, h)
        if error < BEYOND and net.x[ALLOWED] > BRIEF:
            break
        # a part of such a step is no good either: its polynomials are made again for a shorter one
        net.i[N_SHORTER] += 1
        h *= 0.1
    order = net.Q.shape[0] - 2.0
    factor = min(1.5, 0.95 * (error + 1e-30) ** (-1.0 / order))
    if error > 1.0 or net.x[ALLOWED] < 1.0:
        net.i[N_SHORTER] += 1
        rescale(net, min(factor, net.x[ALLOWED]))
        factor = 1.0
    net.x[NEXT] = net.x[STEP] * factor
    return True


@kernel
def find_ends(net: Net) -> None:
    """Contacts whose mode may end in the step, into the heap."""
    bounds(net)
    net.i[N_HEAP] = 0
    net.i[N_HERE] = 0
    for c in range(net.mode.shape[0]):
        net.since[c] = 0.0 if net.since[c] == AT_END else -1.0
        net.due[c] = math.inf
        if net.slack[c] <= 0.0:
            push_due(net, c, taylor_search(net, c, 0.0, net.places))


@kernel
def next_end(net: Net) -> float:
    """When the next transition comes (s)."""
    while net.i[N_HEAP] > 0:
        if net.heap_t[0] == net.due[net.heap_c[0]]:
            return float(net.heap_t[0])
        pop_due(net)
    return math.inf


@kernel
def next_sample(net: Net) -> float:
    """When the next sample is to be taken (s)."""
    if net.i[N_SAMPLES] >= net.times.shape[0]:
        return math.inf
    return float((net.times[net.i[N_SAMPLES]] - net.x[TIME]) / net.x[STEP])


@kernel
def go_through(net: Net) -> int:
    """Transitions and samples of the step in order of time."""
    grain = 4.0 * EPS * max(abs(net.x[TIME]), net.x[STEP]) / net.x[STEP]
    while True:
        if stopped():
            return STOPPED
        end = next_end(net)
        at = next_sample(net)
        until = net.x[UNTIL]
        final = net.x[TIME] + until * net.x[STEP] >= net.x[END] - 8.0 * EPS * abs(net.x[END])
        if at <= until + grain:
            left = net.left[net.i[N_SAMPLES]] == 1
            edge = end + grain if left else end - grain
            # the right-hand value at the end of a step belongs to the next one
            if at < edge and (left or final or at < until - grain):
                sample(net, min(max(at, 0.0), until))
                continue
        if end > until:
            return DONE
        if net.i[N_EVENTS] >= net.events.shape[0]:
            return FULL
        if net.i[N_HERE] >= net.i[LIMIT]:
            return CROWDED
        net.i[N_HERE] += 1
        c = net.heap_c[0]
        pop_due(net)
        if taylor_change(net, c, end, net.places) == 1:
            return WIDE


@kernel
def end_account(net: Net) -> None:
    """Close the account of groups; what lies behind the point where the step is to end is given up."""
    until = net.x[UNTIL]
    pay_groups(net, until)
    if until < 1.0:
        net.i[N_SHORTER] += 1
        rescale(net, until)
        net.x[UNTIL] = 1.0


@kernel
def finish_step(net: Net) -> int:
    """The state at the end of the step."""
    n = net.q.shape[0]
    end_account(net)
    h = net.x[STEP]
    last = net.Q.shape[0] - 1
    horner(net.Q, last, 1.0, net.q)
    horner_rate(net.Q, last, 1.0, h, net.v)
    sound = 0.0
    for j in range(n):
        net.top[j] = max(net.top[j], abs(net.v[j]))
        sound += 0.0 * (net.q[j] + net.v[j])
    for c in range(net.mode.shape[0]):
        if net.mode[c] == STICK and net.plain[c] == 1:
            e = net.row_start[c]
            net.v[net.row_dof[e]] = belt_value(net, c, 1.0) / net.row_coef[e]
    at = net.i[N_STEPS]
    net.steps[at, 0] = net.x[TIME]
    net.steps[at, 1] = h
    net.i[N_STEPS] = at + 1
    stop = net.stops[net.i[N_STOP]]
    t = net.x[TIME] + h
    if t >= stop - 8.0 * EPS * abs(stop):
        t = stop
        net.i[N_STOP] += 1
        net.i[PHASE] = SETTLE
    else:
        net.i[PHASE] = BEGIN
    net.x[TIME] = t
    return DONE if sound == 0.0 else NOT_FINITE


@entry
def drive_taylor(net: Net, t_pause: float, most: int) -> int:
    """Step until the end, until there is no room, until t_pause, or until ``most`` steps are done."""
    until = net.i[N_STEPS] + most
    while True:
        if net.i[PHASE] == SETTLE:
            if net.i[N_STOP] >= net.stops.shape[0]:
                return DONE
            set_window(net)
            if net.i[N_STOP] > 0 and net.series.shape[0] > 0:
                if net.i[N_EVENTS] + net.mode.shape[0] > net.events.shape[0]:
                    return FULL
                settle(net, True)
            net.i[PHASE] = BEGIN
        if net.i[PHASE] == BEGIN:
            if net.i[N_STEPS] >= net.steps.shape[0]:
                return FULL
            if net.i[N_STEPS] >= until or net.x[TIME] > t_pause:
                return PAUSE
            busy = begin_step(net)
            # a start from rest may take some steps that are nothing; more of them are no way to get on
            still = net.x[TIME] + net.x[STEP] <= net.x[TIME]
            net.i[STALLED] = net.i[STALLED] + 1 if still else 0
            if net.i[STALLED] > PATIENCE or not net.x[STEP] > 0.0:
                return TOO_SHORT
            if busy:
                find_ends(net)
            else:
                net.i[N_HEAP] = 0
            net.x[INPUT] += belt_work(net, 0.0)
            count_rest(net, 0.0, 1.0)
            net.i[PHASE] = INSIDE
        code = go_through(net)
        if code != DONE:
            return code
        code = finish_step(net)
        if code != DONE:
            return code
