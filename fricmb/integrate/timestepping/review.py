"""The balls of a step: radius and centre of each contact's force from the law and from where its transition falls.

The mean force of a step through a transition at the fraction s of it is s F_before + (1 - s) F_after.  A ball whose
centre is moved says so to a problem that knows but one direction of slip, that at the end.  s comes from the contact
alone, with its own compliance; the others enter through what they do to its velocity, so that s is right to O(h), the
impulse to O(h^2).
"""

from __future__ import annotations

import math

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.friction_cone import friction_size, stick_limit
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.problem import STICK
from fricmb.integrate.timestepping.break_away import break_away, pressed_in_slip, will_break
from fricmb.integrate.timestepping.friction_discs import slide_radius
from fricmb.integrate.timestepping.layout import BROKEN, CAUGHT, FREE, HELD, PASSED
from fricmb.integrate.timestepping.loops import count_held
from fricmb.integrate.timestepping.room import Run

#: Rounds in which a contact may still change between resting, passing and going on.
DECIDING = 6


@kernel
def first_balls(run: Run, one: int, two: int) -> None:
    """Status and ball of every contact at the beginning of a step."""
    for c in range(run.status.shape[0]):
        row0 = run.row[c]
        d = run.row[c + 1] - row0
        N = run.push[two, c]
        speed = magnitude(run.row, c, run.g[one])
        run.brake[c] = stick_limit(run, run.laws, c, run.s, N)
        run.slide[c] = slide_radius(run, c, speed, N)
        run.share[c] = 0.0
        if run.mode[one, c] == STICK:
            run.status[c] = HELD
            run.rho[c] = run.brake[c]
        else:
            run.status[c] = FREE
            run.rho[c] = run.slide[c]
        run.last[c] = -1.0
        run.tried[c] = 0
        for a in range(row0, row0 + d):
            run.delta[a] = 0.0
            run.away[a] = 0.0


@kernel
def come_to_rest(run: Run, one: int, two: int, c: int) -> None:
    """A contact whose slip turns round or ends: whether it is held (CAUGHT) or goes on the other way (PASSED).

    The path of g: straight under the sliding force to where it is nearest to zero, at the fraction s; then held by
    ``away``, or driven on where that is more than friction can hold.
    """
    row0 = run.row[c]
    d = run.row[c + 1] - row0
    soft = run.soft[c]
    g0 = magnitude(run.row, c, run.g[one])
    ge, ee = 0.0, 0.0
    for a in range(row0, row0 + d):
        before = -run.slide[c] * run.g[one, a] / g0
        end = run.g[two, a] + soft * (before - run.F[two, a])
        change = end - run.g[one, a]
        ge += run.g[one, a] * change
        ee += change * change
    s = min(max(-ge / ee, 0.0), 1.0 - 1e-9) if ee > 0.0 else 1.0 - 1e-9
    for a in range(row0, row0 + d):
        before = -run.slide[c] * run.g[one, a] / g0
        holding = run.F[two, a] - run.g[two, a] / soft
        run.away[a] = before + (holding - before) / (1.0 - s)
    run.share[c] = s
    run.status[c] = CAUGHT if friction_size(run.row, c, run.away) <= run.brake[c] else PASSED


@kernel
def slip_on(run: Run, one: int, two: int, c: int, turn: int) -> bool:
    """What a contact that slips at the beginning of the step does in it; whether that is news."""
    row0 = run.row[c]
    d = run.row[c + 1] - row0
    before = run.status[c]
    if before in (HELD, BROKEN) or magnitude(run.row, c, run.g[one]) == 0.0:
        return False
    if turn >= DECIDING and not (before == CAUGHT and magnitude(run.row, c, run.g[two]) > 0.0):
        return False
    along = 0.0
    for a in range(row0, row0 + d):
        along += run.g[one, a] * run.g[two, a]
    if along > 0.0 and before != PASSED:
        run.status[c] = FREE
    else:
        come_to_rest(run, one, two, c)
        if run.status[c] == PASSED and d == 1 and run.share[c] >= 1.0 - 2e-9:
            run.status[c] = FREE
    return bool(run.status[c] != before)


@kernel
def mark_jolts(run: Run) -> None:
    """Contacts at rest whose force jumps in the step: next to one with a transition, or to another one that jumps.

    Forces between bodies that stick together jump where that of a neighbour does; those of springs do not.
    """
    for i in range(run.jolt.shape[0]):
        run.jolt[i] = -1.0
    for c in range(run.status.shape[0]):
        run.last[c] = -1.0
        if run.status[c] in (CAUGHT, PASSED, BROKEN):
            spread(run, c, min(max(run.share[c], 0.0), 1.0))
    again = True
    while again:
        again = False
        for c in range(run.status.shape[0]):
            if run.status[c] != HELD:
                continue
            latest = run.last[c]
            for a in range(run.row[c], run.row[c + 1]):
                for e in range(run.w_start[a], run.w_start[a + 1]):
                    latest = max(latest, run.jolt[run.w_dof[e]])
            if latest > run.last[c]:
                run.last[c] = latest
                again = True
                spread(run, c, latest)


@kernel
def spread(run: Run, c: int, share: float) -> None:
    """A jump at contact c is felt by its degrees of freedom."""
    for a in range(run.row[c], run.row[c + 1]):
        for e in range(run.w_start[a], run.w_start[a + 1]):
            run.jolt[run.w_dof[e]] = max(run.jolt[run.w_dof[e]], share)


@kernel
def hold_on(run: Run, one: int, two: int, c: int, t: float, h: float) -> None:
    """Whether a contact that sticks at the beginning of the step breaks away in it; one that did so in vain is held."""
    end = magnitude(run.row, c, run.g[two])
    if run.status[c] == HELD:
        if end > 0.0 or will_break(run, one, two, c, t, h):
            break_away(run, one, two, c, t, h)
    elif run.status[c] == BROKEN and end == 0.0 and run.tried[c] == 0:
        run.status[c] = HELD
        run.tried[c] = 1


@kernel
def choose_statuses(run: Run, one: int, two: int, t: float, h: float, turn: int) -> None:
    """What contacts do in this step, from forces and relative velocities found so far.

    Those that slip first: what the others have to hold is known only with it.
    """
    news = False
    for c in range(run.status.shape[0]):
        if slip_on(run, one, two, c, turn):
            news = True
    mark_jolts(run)
    count_held(run, two)
    for c in range(0 if news and turn < DECIDING else run.status.shape[0]):
        hold_on(run, one, two, c, t, h)


@kernel
def turned(run: Run, one: int, two: int, c: int) -> bool:
    """Centre for a direction of slip that turns in the step: mean force along the middle velocity."""
    row0 = run.row[c]
    e0, e1 = run.g[two, row0], run.g[two, row0 + 1]
    m0, m1 = 0.5 * (e0 + run.g[one, row0]), 0.5 * (e1 + run.g[one, row0 + 1])
    end, middle = math.hypot(e0, e1), math.hypot(m0, m1)
    if min(end, min(middle, magnitude(run.row, c, run.g[one]))) <= 2.0 * run.soft[c] * run.rho[c]:
        return False
    run.delta[row0] = run.rho[c] * (e0 / end - m0 / middle)
    run.delta[row0 + 1] = run.rho[c] * (e1 / end - m1 / middle)
    return True


@kernel
def mean_speed(run: Run, one: int, two: int, c: int) -> float:
    """Slip speed at which the coefficient of the step is taken."""
    row0 = run.row[c]
    d = run.row[c + 1] - row0
    start, end = magnitude(run.row, c, run.g[one]), magnitude(run.row, c, run.g[two])
    if run.status[c] != FREE or start == 0.0:
        s = run.share[c] if run.status[c] != BROKEN else 0.0
        return float(0.5 * (s * start + (1.0 - s) * end))
    total = 0.0
    for a in range(row0, row0 + d):
        total += (0.5 * (run.g[one, a] + run.g[two, a])) ** 2
    return math.sqrt(total)


@block
def review_balls(run: Run, one: int, two: int, t: float, h: float, turn: int) -> float:
    """New balls from what was found; returns their largest change relative to the largest radius."""
    worst = 0.0
    largest = 1e-300
    for c in range(run.status.shape[0]):
        run.brake[c] = stick_limit(run, run.laws, c, run.s, run.push[two, c])
        largest = max(largest, run.brake[c])
    choose_statuses(run, one, two, t, h, turn)
    for c in range(run.status.shape[0]):
        row0 = run.row[c]
        d = run.row[c + 1] - row0
        N = run.push[two, c]
        old = run.rho[c]
        old0 = run.delta[row0]
        old1 = run.delta[row0 + d - 1]
        status = run.status[c]
        if status in (HELD, CAUGHT):
            run.rho[c] = run.brake[c]
            if status == CAUGHT:
                run.slide[c] = slide_radius(run, c, mean_speed(run, one, two, c), N)
            for a in range(row0, row0 + d):
                run.delta[a] = 0.0
        else:
            pressed = pressed_in_slip(run, one, c, t, h, N) if status == BROKEN else N
            run.slide[c] = slide_radius(run, c, mean_speed(run, one, two, c), pressed)
            run.rho[c] = run.slide[c]
            s = run.share[c]
            size = magnitude(run.row, c, run.away)
            for a in range(row0, row0 + d):
                run.delta[a] = 0.0
                if status == BROKEN:
                    run.delta[a] = run.away[a]
                elif status == PASSED:
                    before = -run.slide[c] * run.g[one, a] / magnitude(run.row, c, run.g[one])
                    after = run.slide[c] * run.away[a] / size
                    run.delta[a] = s * (before - after)
            if status == FREE and d == 2:
                turned(run, one, two, c)
        change = abs(run.rho[c] - old) + abs(run.delta[row0] - old0) + abs(run.delta[row0 + d - 1] - old1)
        worst = max(worst, change)
    return float(worst / largest)
