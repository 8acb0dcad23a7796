"""The loop of a run: a step of all, its transitions and samples in order of time, the end of the step."""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import kernel, run_entry
from fricmb.integrate.compile.long_loops import long_loops
from fricmb.integrate.problem import STICK
from fricmb.integrate.run.outcomes import SLICE_OVER
from fricmb.integrate.run.slices import slice_over, ticks
from fricmb.integrate.taylor.account import pay_groups
from fricmb.integrate.taylor.change import taylor_change
from fricmb.integrate.taylor.event_heap import pop_due, push_due
from fricmb.integrate.taylor.event_search import bounds, taylor_search
from fricmb.integrate.taylor.groups import SECOND
from fricmb.integrate.taylor.landing_path import leave_landings
from fricmb.integrate.taylor.layout import AT_END, EPS
from fricmb.integrate.taylor.ledger import belt_work, count_rest
from fricmb.integrate.taylor.network import Net, has_planes
from fricmb.integrate.taylor.polynomials import horner, horner_rate, rescale
from fricmb.integrate.taylor.sample import sample
from fricmb.integrate.taylor.signals import belt_value
from fricmb.integrate.taylor.starting_modes import set_window, settle
from fricmb.integrate.taylor.step_start import begin_step, follow_signals

#: Why a run came back.
DONE, FULL, PAUSE, CROWDED, WIDE, NOT_FINITE, TOO_SHORT, TOO_STEEP, CREEPS = range(9)
#: Steps in a row that do not move the time.
PATIENCE = 100
#: A step of so many last digits of the time is nothing.
NOTHING = 32.0
#: Steps in a row below that part of the longest step, which series are no way to take.
MANY, SLIGHT = 3000, 1e-4
#: Phases of a step.
BEGIN, INSIDE, FINISH, SETTLE = range(4)


@kernel
def find_ends(net: Net) -> None:
    """Contacts whose mode may end in the step, into the heap."""
    bounds(net)
    net.n_heap = 0
    net.n_here = 0
    for c in range(net.mode.shape[0]):
        net.due[c] = math.inf
        if net.groups.planar[c] == SECOND:
            continue
        net.since[c] = 0.0 if net.since[c] == AT_END else -1.0
        if net.slack[c] <= 0.0:
            push_due(net, c, taylor_search(net, c, 0.0))


@kernel
def next_end(net: Net) -> float:
    """When the next transition comes (s)."""
    while net.n_heap > 0:
        if net.heap_t[0] == net.due[net.heap_c[0]]:
            return float(net.heap_t[0])
        pop_due(net)
    return math.inf


@kernel
def next_sample(net: Net) -> float:
    """When the next sample is to be taken (s)."""
    if net.n_samples >= net.times.shape[0]:
        return math.inf
    return float((net.times[net.n_samples] - net.time) / net.step)


@kernel
def go_through(net: Net, begun: int) -> int:
    """Transitions and samples of the step in order of time; ``begun``: the slice."""
    grain = 4.0 * EPS * max(abs(net.time), net.step) / net.step
    while True:
        end = next_end(net)
        at = next_sample(net)
        until = net.until
        final = net.time + until * net.step >= net.end - 8.0 * EPS * abs(net.end)
        if at <= until + grain:
            left = net.left[net.n_samples] == 1
            edge = end + grain if left else end - grain
            # the right-hand value at the end of a step belongs to the next one
            if at < edge and (left or final or at < until - grain):
                sample(net, min(max(at, 0.0), until))
                continue
        if end > until:
            return DONE
        if net.n_events >= net.events.shape[0]:
            return FULL
        if net.n_here >= net.limit:
            return CROWDED
        net.n_here += 1
        c = net.heap_c[0]
        pop_due(net)
        if taylor_change(net, c, end) == 1:
            return WIDE
        if slice_over(begun):
            return SLICE_OVER


@kernel
def end_account(net: Net) -> None:
    """Close the account of groups; what lies behind the point where the step is to end is given up."""
    until = net.until
    pay_groups(net, until)
    if until < 1.0:
        net.n_shorter += 1
        rescale(net, until)
        net.until = 1.0


@kernel
def finish_step(net: Net) -> int:
    """The state at the end of the step."""
    if net.until == 0.0:
        net.until = 1.0
        net.phase = BEGIN
        net.n_once += 1
        return DONE if net.n_once <= PATIENCE + net.mode.shape[0] else TOO_SHORT
    n = net.q.shape[0]
    end_account(net)
    h = net.step
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
    net.n_once = 0
    at = net.n_steps
    net.steps[at, 0] = net.time
    net.steps[at, 1] = h
    net.n_steps = at + 1
    stop = net.stops[net.n_stop]
    t = net.time + h
    if net.leaps_to > 0.0:  # the same time wherever the leap began
        t, net.leaps_to = net.leaps_to, 0.0
    if t >= stop - 8.0 * EPS * abs(stop):
        t = stop
        net.n_stop += 1
        net.phase = SETTLE
    else:
        net.phase = BEGIN
    net.time = t
    if sound != 0.0:
        return NOT_FINITE
    return CREEPS if creeps(net) else DONE


@kernel
def creeps(net: Net) -> bool:
    """Whether steps have been next to nothing for long, beside what structure and prescribed functions allow."""
    t, h = net.time, net.step
    if h >= SLIGHT * net.longest or not has_planes(net):
        net.n_creep = 0
    else:
        if net.n_creep == 0:
            net.crept = t - h
        net.n_creep += 1
    if net.n_creep <= MANY:
        return False
    net.n_creep = 0
    return bool(t - net.crept < MANY * SLIGHT * follow_signals(net, t, net.longest))


@kernel
def list_may_be_full(net: Net) -> bool:
    """Whether the list of transitions might not hold those with which a step begins."""
    return bool(has_planes(net) and net.n_events + net.mode.shape[0] > net.events.shape[0])


@run_entry
@long_loops
def drive_taylor(net: Net, until: int) -> int:
    """Step until the end, until an array is full, a slice is over, or ``until`` steps are done in all."""
    begun = ticks()
    while True:
        if net.phase == SETTLE:
            if net.n_stop >= net.stops.shape[0]:
                return DONE
            set_window(net)
            if net.n_stop > 0 and net.series.shape[0] > 0:
                if net.n_events + net.mode.shape[0] > net.events.shape[0]:
                    return FULL
                settle(net, True, False)
            net.phase = BEGIN
        if net.phase == BEGIN:
            if net.n_steps >= net.steps.shape[0] or list_may_be_full(net):
                return FULL
            if net.n_steps >= until:
                return PAUSE
            busy = begin_step(net)
            # a start from rest may take some steps that are nothing; more of them are no way to get on.  Towards a pole
            # they come down to last digits of the time, and there were millions of them
            still = net.step <= NOTHING * EPS * abs(net.time)
            net.stalled = net.stalled + 1 if still else 0
            if net.stalled > PATIENCE or not net.step > 0.0:
                return TOO_SHORT
            if busy:
                find_ends(net)
            else:
                net.n_heap = 0
            net.supply += belt_work(net, 0.0)
            count_rest(net, 0.0, 1.0)
            net.phase = INSIDE
        code = go_through(net, begun)
        if code != DONE:
            return code
        code = finish_step(net)
        if code != DONE:
            return code
        if slice_over(begun):
            return SLICE_OVER
