"""The beginning of a step: how long it is, its polynomials, and whether a contact comes to rest with it."""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.formulas.step_control import step_factor
from fricmb.integrate.signals.longest_steps import longest_from
from fricmb.integrate.taylor.fresh import all_series, lose_fresh
from fricmb.integrate.taylor.idle import idle_step
from fricmb.integrate.taylor.landing import land_all, take_off
from fricmb.integrate.taylor.layout import EPS, WORK
from fricmb.integrate.taylor.network import Net, has_planes
from fricmb.integrate.taylor.polynomials import rescale
from fricmb.integrate.taylor.quiet import leap
from fricmb.integrate.taylor.signals import ROUNDING, signal_series

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
    floor = 0.01 * net.fastest
    for j in range(n):
        work[j] = (P * abs(last[j]) + (P - 1) * abs(before[j])) / (net.top[j] + floor)
    worst, sound = 0.0, 0.0
    for j in range(n):
        worst = max(worst, work[j])
        sound += 0.0 * work[j]
    # comparisons pass over what is no number
    return float(worst / (h * net.tol)) if sound == 0.0 else math.inf


@kernel
def follow_signals(net: Net, t: float, h: float) -> float:
    """A step of at most h over which prescribed functions are polynomials; 0 where they have no value."""
    fine = max(0.1 * net.tol, ROUNDING)
    last = math.inf
    for _ in range(60):
        error = signal_series(net, t, h)
        # what a shorter step does not make smaller is round-off of the function's values
        if error <= fine or 0.5 * last < error < NO_ROUNDING:
            break
        last = error
        # where a function has no value its error is no number
        h *= max(0.3, step_factor(error / fine, 8.0, 0.9)) if error < math.inf else 0.3
        if not error < math.inf and h <= EPS * max(abs(t), net.longest):
            return 0.0
    return h


@kernel
def begin_step(net: Net) -> bool:
    """Choose the step and make its polynomials; False for an idle one, which has no transitions inside."""
    wanted = net.next_step
    busy = choose_step(net)
    while lose_fresh(net):
        net.next_step = wanted
        busy = choose_step(net)
    return busy


@kernel
def choose_step(net: Net) -> bool:
    """The same, with slip that began a short time ago taken for what it is told to be."""
    t = net.time
    stop = net.stops[net.n_stop]
    left = stop - t
    take_off(net)
    h = min(net.next_step, net.longest, longest_from(net.edge, net.within, t))
    if h > left * (1.0 - 1e-9):
        h = left
    elif h > 0.5 * left:
        h = 0.5 * left
    for _ in range(60):
        h = follow_signals(net, t, h)
        net.step = h
        net.until = net.allowed = 1.0
        if h == 0.0:
            return False
        busy = all_series(net, h)
        rest = land_all(net, h) if has_planes(net) else math.inf
        if rest < math.inf:
            h = follow_signals(net, t, min(h, rest))
            net.step = h
            busy = all_series(net, h)
        if not busy and net.series.shape[0] == 0:
            idle = idle_step(net, min(left, longest_from(net.edge, net.within, t)))
            if idle > h:
                rescale(net, idle / h)
                net.step = idle
                return False
        if net.quiet_edge.shape[0] > 1 and leap(net, h, left):
            return False
        error = tail_error(net, h)
        if error < BEYOND and net.allowed > BRIEF:
            break
        # a part of such a step is no good either: its polynomials are made again for a shorter one
        net.n_shorter += 1
        h *= 0.1
    order = net.Q.shape[0] - 2.0
    factor = min(1.5, step_factor(error, order, 0.95))
    if error > 1.0 or net.allowed < 1.0:
        net.n_shorter += 1
        rescale(net, min(factor, net.allowed))
        factor = 1.0
    net.next_step = net.step * factor
    if rest < math.inf:
        net.next_step = net.longest
    return True
