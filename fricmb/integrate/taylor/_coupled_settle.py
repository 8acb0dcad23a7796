"""Modes at the start of a run and behind a breakpoint, where contacts hold each other."""

from __future__ import annotations

import math

from fricmb.integrate.compile.block import block
from fricmb.integrate.problem import EVENT_REVERSAL, EVENT_SLIP, EVENT_STICK, SLIP, STICK, Ints
from fricmb.integrate.taylor._change import MARGIN, keep_event
from fricmb.integrate.taylor._coupled_series import coupled_series, relative_row
from fricmb.integrate.taylor._layout import LONGEST, N_STOP, NOISE, STEP, TIME
from fricmb.integrate.taylor._net import Net
from fricmb.integrate.taylor._series import belt_grain, belt_value, relative, signal_series


@block
def coupled_settle(net: Net, given: bool, places: Ints) -> None:
    """Modes from velocities; where these are 0, the contact that exceeds its cone most is let go, group by group.

    One that then moves against its force is held again.  ``given``: behind a breakpoint, where changes are transitions.
    """
    before_it = net.x[STEP]
    h = min(net.x[LONGEST], net.stops[net.i[N_STOP]] - net.x[TIME])
    net.x[STEP] = h
    signal_series(net, net.x[TIME], h)
    coupled_series(net, h, places)
    m = net.mode.shape[0]
    rests, was = net.coupled.touched, net.coupled.slot
    largest = 1
    for gi in range(net.coupled.n_stuck.shape[0]):
        largest = max(largest, net.coupled.group_start[gi + 1] - net.coupled.group_start[gi])
    for c in range(m):
        was[c] = STICK if net.mode[c] == STICK else int(net.sigma[c])
        g = relative(net, c, 0.0, h)
        noise = net.x[NOISE] + 1e-12 * (abs(belt_value(net, c, 0.5)) + abs(belt_value(net, c, 1.0)))
        if given and was[c] == STICK:
            # it has moved with the belt as powers of s have
            noise += belt_grain(net, c, before_it)
        rests[c] = 0 if abs(g) > noise else 1
        net.mode[c] = STICK if rests[c] else SLIP
        if rests[c] == 0:
            net.sigma[c] = math.copysign(1.0, g)
    for turn in range(4 * largest + 8):
        coupled_series(net, h, places)
        changed = False
        for gi in range(net.coupled.n_stuck.shape[0]):
            worst, excess = -1, 1.0 + MARGIN
            for a in range(net.coupled.group_start[gi], net.coupled.group_start[gi + 1]):
                c = net.coupled.group_contact[a]
                if rests[c] == 0:
                    continue
                if net.mode[c] == SLIP and turn < 2 * largest + 4:
                    if net.sigma[c] * relative_row(net, c, 1, h) < 0.0:
                        net.mode[c] = STICK
                        changed = True
                elif net.mode[c] == STICK and abs(net.coupled.F[0, c]) > excess * net.stick[c]:
                    worst = c
                    excess = abs(net.coupled.F[0, c]) / (net.stick[c] + 1e-300)
            if worst >= 0:
                net.mode[worst] = SLIP
                net.sigma[worst] = -math.copysign(1.0, net.coupled.F[0, worst])
                changed = True
        if not changed:
            break
    for c in range(m):
        now = STICK if net.mode[c] == STICK else int(net.sigma[c])
        if given and now != was[c]:
            kind = EVENT_STICK if now == STICK else (EVENT_SLIP if was[c] == STICK else EVENT_REVERSAL)
            keep_event(net, net.x[TIME], c, kind)
        was[c] = -1
        net.coupled.touched[c] = 0
