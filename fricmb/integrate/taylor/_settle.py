"""Modes at the start of a run and where something prescribed jumps."""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import entry, kernel
from fricmb.integrate.problem import EVENT_REVERSAL, EVENT_SLIP, EVENT_STICK, SLIP, STICK
from fricmb.integrate.taylor._change import MARGIN, hold_force, keep_event, set_mode
from fricmb.integrate.taylor._coupled_settle import coupled_settle
from fricmb.integrate.taylor._layout import LONGEST, N_STOP, NOISE, STEP, TIME
from fricmb.integrate.taylor._net import Net
from fricmb.integrate.taylor._series import belt_grain, belt_value, displacement, relative, signal_series, taylor_series

EPS = 2.3e-16


@kernel
def set_window(net: Net) -> None:
    """Functions of time are evaluated between the stops around the present time."""
    t = net.x[TIME]
    low = net.stops[net.i[N_STOP] - 1] if net.i[N_STOP] > 0 else t
    high = net.stops[net.i[N_STOP]]
    net.window[0] = low + 2.0 * EPS * abs(low) + 1e-300
    net.window[1] = high - 2.0 * EPS * abs(high) - 1e-300


@kernel
def settle(net: Net, given: bool) -> None:
    """Modes at the start and (``given``) behind a breakpoint, from velocities or, where these are 0, forces.

    Changes behind a breakpoint are transitions.
    """
    if net.coupled.F.shape[0] > 0:
        coupled_settle(net, given, net.places)
        return
    before_it = net.x[STEP]
    h = min(net.x[LONGEST], net.stops[net.i[N_STOP]] - net.x[TIME])
    net.x[STEP] = h
    signal_series(net, net.x[TIME], h)
    taylor_series(net, h, net.places)
    for c in range(net.mode.shape[0]):
        g = relative(net, c, 0.0, h)
        held = hold_force(net, c, 0.0, h)
        here = displacement(net, c, 0.0, h)
        was, before = net.mode[c], net.sigma[c]
        if was == SLIP and given:
            net.loss[c] += net.slip[c] * abs(here - net.mark[c])
        net.mark[c] = here
        # a belt that starts from rest does so at a time that is round-off away
        noise = net.x[NOISE] + 1e-12 * (abs(belt_value(net, c, 0.5)) + abs(belt_value(net, c, 1.0)))
        if given and was == STICK:
            # it has moved with the belt as powers of s have
            noise += belt_grain(net, c, before_it)
        if abs(g) > noise:
            set_mode(net, c, SLIP, math.copysign(1.0, g))
        elif abs(held) <= net.stick[c] * (1.0 + MARGIN):
            set_mode(net, c, STICK, before)
        else:
            set_mode(net, c, SLIP, -math.copysign(1.0, held))
        if given and (net.mode[c] != was or (was == SLIP and net.sigma[c] != before)):
            kind = EVENT_STICK if net.mode[c] == STICK else (EVENT_SLIP if was == STICK else EVENT_REVERSAL)
            keep_event(net, net.x[TIME], c, kind)


@entry
def settle_start(net: Net) -> None:
    """Modes at the start of a run."""
    set_window(net)
    settle(net, False)
