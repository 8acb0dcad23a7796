"""Modes at the start of a run and where something prescribed jumps."""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import kernel, run_entry
from fricmb.integrate.event_kinds import EVENT_REVERSAL, EVENT_SLIP, EVENT_STICK
from fricmb.integrate.problem import SLIP, STICK
from fricmb.integrate.taylor.account import displacement, lose_sliding
from fricmb.integrate.taylor.groups import SECOND
from fricmb.integrate.taylor.landing import let_go, set_planar
from fricmb.integrate.taylor.layout import EPS, GOES_ON
from fricmb.integrate.taylor.network import Net
from fricmb.integrate.taylor.polynomials import hold_force, relative_row, slip_speed
from fricmb.integrate.taylor.series import taylor_series
from fricmb.integrate.taylor.signals import belt_grain, belt_value, signal_series
from fricmb.integrate.taylor.turning import MARGIN, keep_event, set_mode

#: Relative velocity that a contact may have got in stick, of the largest velocity of its ends: round-off of its steps.
DRIFT = 1e-11
#: Part of the force that it can hold which is round-off.
HELD = 64.0 * EPS


@kernel
def set_window(net: Net) -> None:
    """Functions of time are evaluated between the stops around the present time."""
    t = net.time
    low = net.stops[net.n_stop - 1] if net.n_stop > 0 else t
    high = net.stops[net.n_stop]
    net.window[0] = low + 2.0 * EPS * abs(low) + 1e-300
    net.window[1] = high - 2.0 * EPS * abs(high) - 1e-300


@kernel
def speed_noise(net: Net, row: int, given: bool, before_it: float) -> float:
    """Relative velocities of a row that are none; ``before_it``: length of the step before."""
    # a belt that starts from rest does so at a time that is round-off away
    noise = net.noise + 1e-12 * (abs(belt_value(net, row, 0.5)) + abs(belt_value(net, row, 1.0)))
    if given and net.mode[row] == STICK:
        # it has moved with the belt as powers of s have, and with its other end but for round-off of many steps
        noise += belt_grain(net, row, before_it)
        for e in range(net.row_start[row], net.row_start[row + 1]):
            noise += DRIFT * abs(net.row_coef[e]) * net.top[net.row_dof[e]]
        # where nothing moves at all, what forces that hold each other up leave of themselves
        noise += HELD * net.stick[row] * net.compliance[row] * before_it
    return float(noise)


@kernel
def direction_of(net: Net, c: int) -> int:
    """STICK, or the direction of slip; of a contact in two directions 1 for any."""
    if net.mode[c] == STICK:
        return int(STICK)
    return 1 if net.groups.planar[c] >= 0 else int(net.sigma[c])


@kernel
def look_at_speeds(net: Net, given: bool, before_it: float) -> None:
    """Modes from velocities alone: what moves slips, what has no slip speed rests for now.

    ``before_it``: length of the step before.
    """
    for c in range(net.mode.shape[0]):
        planar = net.groups.planar[c]
        if planar == SECOND:
            continue
        g, across, noise = slip_speed(net, c, net.v, 0.0), 0.0, speed_noise(net, c, given, before_it)
        if planar >= 0:
            across = slip_speed(net, c + 1, net.v, 0.0)
            noise = max(noise, speed_noise(net, c + 1, given, before_it))
        rests = math.hypot(g, across) <= noise
        if planar >= 0 and not given and net.since[c] == GOES_ON:
            # what has broken away where the run before ended, or comes to rest there, has next to no speed
            rests = False
        net.groups.before[c] = direction_of(net, c)
        net.groups.rests[c] = 1 if rests else 0
        if planar >= 0:
            set_planar(net, c, STICK if rests else SLIP)
        else:
            set_mode(net, c, STICK if rests else SLIP, net.sigma[c] if rests else math.copysign(1.0, g))


@kernel
def release_plain(net: Net) -> None:
    """Let go plain contacts that rest and hold more than they can."""
    for c in range(net.mode.shape[0]):
        if net.plain[c] == 1 and net.mode[c] == STICK:
            held = hold_force(net, c, 0.0)
            if not abs(held) <= net.stick[c] * (1.0 + MARGIN):
                set_mode(net, c, SLIP, -math.copysign(1.0, held))


@kernel
def release_planar(net: Net, c: int) -> bool:
    """Let go contact c in two directions where it holds more than it can; whether it did."""
    x, y = net.groups.F[0, c], net.groups.F[0, c + 1]
    if net.mode[c] != STICK or math.hypot(x, y) <= net.stick[c] * (1.0 + MARGIN):
        return False
    let_go(net, c, x, y)
    return True


@kernel
def release_worst(net: Net, gi: int, again: bool) -> bool:
    """Let go the contact of a group that rests and exceeds its cone most; whether any contact changed its mode.

    ``again``: one that was let go and moves against its force is held again.
    """
    groups = net.groups
    changed = False
    worst, excess = -1, 1.0 + MARGIN
    for a in range(groups.group_start[gi], groups.group_start[gi + 1]):
        c = groups.group_contact[a]
        if groups.rests[c] == 0 or groups.planar[c] == SECOND:
            continue
        if groups.planar[c] >= 0:
            changed = release_planar(net, c) or changed
            continue
        if net.mode[c] == SLIP and again:
            if net.sigma[c] * relative_row(net, c, 1, net.step) < 0.0:
                net.mode[c] = STICK
                changed = True
        elif net.mode[c] == STICK and abs(groups.F[0, c]) > excess * net.stick[c]:
            worst = c
            excess = abs(groups.F[0, c]) / (net.stick[c] + 1e-300)
    if worst >= 0:
        set_mode(net, worst, SLIP, -math.copysign(1.0, groups.F[0, worst]))
        changed = True
    return changed


@kernel
def release_groups(net: Net) -> None:
    """Let go, group by group, what exceeds its cone until nothing does."""
    count = net.groups.n_stuck.shape[0]
    largest = 1
    for gi in range(count):
        largest = max(largest, net.groups.group_start[gi + 1] - net.groups.group_start[gi])
    for turn in range(4 * largest + 8 if count > 0 else 0):
        taylor_series(net, net.step)
        changed = False
        for gi in range(count):
            if release_worst(net, gi, turn < 2 * largest + 4):
                changed = True
        if not changed:
            break


@kernel
def is_consistent(net: Net, gi: int) -> bool:
    """Whether all contacts at rest of a group hold what they can, or move against their friction."""
    groups = net.groups
    for a in range(groups.group_start[gi], groups.group_start[gi + 1]):
        c = groups.group_contact[a]
        if groups.rests[c] == 0 or groups.planar[c] == SECOND:
            continue
        if net.mode[c] == STICK:
            held = abs(groups.F[0, c]) if groups.planar[c] < 0 else math.hypot(groups.F[0, c], groups.F[0, c + 1])
            if held > net.stick[c] * (1.0 + MARGIN):
                return False
        elif groups.planar[c] < 0 and net.sigma[c] * relative_row(net, c, 1, net.step) < 0.0:
            return False
    return True


@kernel
def hold_again(net: Net) -> None:
    """Hold those let go in one group that need not slip, as others have let go since.

    With more friction at rest than in slip both may be consistent: contacts let go only where they have to.
    """
    groups = net.groups
    for gi in range(groups.n_stuck.shape[0]):
        first, last, released = groups.group_start[gi], groups.group_start[gi + 1], 0
        for a in range(first, last):
            c = groups.group_contact[a]
            released += 1 if groups.rests[c] == 1 and groups.planar[c] < 0 and net.mode[c] == SLIP else 0
        for a in range(first, last if released > 1 else first):
            c = groups.group_contact[a]
            if released > 1 and groups.rests[c] == 1 and groups.planar[c] < 0 and net.mode[c] == SLIP:
                set_mode(net, c, STICK, net.sigma[c])
                taylor_series(net, net.step)
                if is_consistent(net, gi):
                    released -= 1
                else:
                    set_mode(net, c, SLIP, net.sigma[c])
                    taylor_series(net, net.step)


@kernel
def keep_sliding(net: Net, h: float) -> bool:
    """Let what slid when the run before ended slide on, though it has next to no speed yet, where it speeds up.

    It has just broken away.  What slows down comes to rest here.  Whether there is such a contact.
    """
    some = False
    for c in range(net.mode.shape[0]):
        if net.groups.planar[c] < 0 and net.groups.rests[c] == 1 and net.since[c] == GOES_ON:
            set_mode(net, c, SLIP, net.sigma[c])
            some = True
    if some:
        taylor_series(net, h)
    for c in range(net.mode.shape[0] if some else 0):
        if net.groups.planar[c] < 0 and net.groups.rests[c] == 1 and net.since[c] == GOES_ON:
            if net.sigma[c] * relative_row(net, c, 1, h) >= 0.0:
                net.groups.rests[c] = 0
            else:
                set_mode(net, c, STICK, net.sigma[c])
    return some


@kernel
def settle(net: Net, given: bool, known: bool) -> None:
    """Modes at the start and (``given``) behind a breakpoint, from velocities or, where these are 0, forces.

    Changes behind a breakpoint are transitions, and so are those of a run that goes on (``known``: its modes are).
    """
    before_it = net.step
    h = min(net.longest, net.stops[net.n_stop] - net.time)
    net.step = h
    for c in range(net.mode.shape[0]):
        if net.plain[c] == 1 and given:
            lose_sliding(net, c, net.q[net.first_dof[c]], 0.0)
        elif net.plain[c] == 1:
            net.mark[c] = displacement(net, c, net.q[net.first_dof[c]], 0.0)
    signal_series(net, net.time, h)
    look_at_speeds(net, given, before_it)
    if not given and known:
        keep_sliding(net, h)
    taylor_series(net, h)
    release_plain(net)
    release_groups(net)
    hold_again(net)
    for c in range(net.mode.shape[0]):
        if net.groups.planar[c] == SECOND:
            continue
        now, before = direction_of(net, c), net.groups.before[c]
        if (given or known) and now != before:
            kind = EVENT_STICK if now == STICK else (EVENT_SLIP if before == STICK else EVENT_REVERSAL)
            keep_event(net, net.time, c, kind)


@run_entry
def settle_start(net: Net, known: bool) -> None:
    """Modes at the start of a run; ``known``: they were there when another ended."""
    set_window(net)
    settle(net, False, known)
