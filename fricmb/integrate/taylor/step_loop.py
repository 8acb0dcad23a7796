"""The loop of a run: a step of all, its transitions and samples in order of time, the end of the step."""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import entry, kernel
from fricmb.integrate.compile.kernel_library import long_loops
from fricmb.integrate.problem import STICK
from fricmb.integrate.run.stop import stopped
from fricmb.integrate.taylor.account import pay_groups
from fricmb.integrate.taylor.change import taylor_change
from fricmb.integrate.taylor.event_heap import pop_due, push_due
from fricmb.integrate.taylor.event_search import bounds, taylor_search
from fricmb.integrate.taylor.groups import SECOND
from fricmb.integrate.taylor.landing_path import leave_landings
from fricmb.integrate.taylor.layout import (
    AT_END,
    CREPT,
    END,
    EPS,
    INPUT,
    LIMIT,
    LONGEST,
    N_CREEP,
    N_EVENTS,
    N_HEAP,
    N_HERE,
    N_ONCE,
    N_SAMPLES,
    N_SHORTER,
    N_STEPS,
    N_STOP,
    PHASE,
    STALLED,
    STEP,
    TIME,
    UNTIL,
)  # fmt: skip
from fricmb.integrate.taylor.ledger import belt_work, count_rest
from fricmb.integrate.taylor.network import Net, has_planes
from fricmb.integrate.taylor.polynomials import horner, horner_rate, rescale
from fricmb.integrate.taylor.sample import sample
from fricmb.integrate.taylor.signals import belt_value
from fricmb.integrate.taylor.starting_modes import set_window, settle
from fricmb.integrate.taylor.step_start import begin_step, follow_signals

#: Why a run came back.
DONE, FULL, PAUSE, CROWDED, WIDE, NOT_FINITE, STOPPED, TOO_SHORT, TOO_STEEP, CREEPS = range(10)
#: Steps in a row that do not move the time.
PATIENCE = 100
#: Steps in a row below that part of the longest step, which series are no way to take.
MANY, SLIGHT = 3000, 1e-4
#: Phases of a step.
BEGIN, INSIDE, FINISH, SETTLE = range(4)


@kernel
def find_ends(net: Net) -> None:
    """Contacts whose mode may end in the step, into the heap."""
    bounds(net)
    net.i[N_HEAP] = 0
    net.i[N_HERE] = 0
    for c in range(net.mode.shape[0]):
        net.due[c] = math.inf
        if net.groups.planar[c] == SECOND:
            continue
        net.since[c] = 0.0 if net.since[c] == AT_END else -1.0
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
    if net.x[UNTIL] == 0.0:
        net.x[UNTIL] = 1.0
        net.i[PHASE] = BEGIN
        net.i[N_ONCE] += 1
        return DONE if net.i[N_ONCE] <= PATIENCE + net.mode.shape[0] else TOO_SHORT
    n = net.q.shape[0]
    end_account(net)
    h = net.x[STEP]
    last = net.Q.shape[0] - 1
    horner(net.Q, last, 1.0, net.q)
    horner_rate(net.Q, last, 1.0, h, net.v)
    leave_landings(net)
    sound = 0.0
    for j in range(n):
        net.top[j] = max(net.top[j], abs(net.v[j]))
        sound += 0.0 * (net.q[j] + net.v[j])
    for c in range(net.mode.shape[0]):
        if net.mode[c] == STICK and net.plain[c] == 1:
            e = net.row_start[c]
            net.v[net.row_dof[e]] = belt_value(net, c, 1.0) / net.row_coef[e]
    net.i[N_ONCE] = 0
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
    if sound != 0.0:
        return NOT_FINITE
    return CREEPS if creeps(net) else DONE


@kernel
def creeps(net: Net) -> bool:
    """Whether steps have been next to nothing for long, beside what structure and prescribed functions allow."""
    t, h = net.x[TIME], net.x[STEP]
    if h >= SLIGHT * net.x[LONGEST] or not has_planes(net):
        net.i[N_CREEP] = 0
    else:
        if net.i[N_CREEP] == 0:
            net.x[CREPT] = t - h
        net.i[N_CREEP] += 1
    if net.i[N_CREEP] <= MANY:
        return False
    net.i[N_CREEP] = 0
    return bool(t - net.x[CREPT] < MANY * SLIGHT * follow_signals(net, t, net.x[LONGEST]))


@kernel
def list_may_be_full(net: Net) -> bool:
    """Whether the list of transitions might not hold those with which a step begins."""
    return bool(has_planes(net) and net.i[N_EVENTS] + net.mode.shape[0] > net.events.shape[0])


@entry
@long_loops
def drive_taylor(net: Net, t_pause: float, most: int) -> int:
    """Step until the end, until an array is full, until t_pause, or until ``most`` steps are done."""
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
            if net.i[N_STEPS] >= net.steps.shape[0] or list_may_be_full(net):
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
