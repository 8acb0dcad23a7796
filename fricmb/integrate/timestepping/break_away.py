"""Where in a step a contact that is held breaks away, and the mean force that this leaves it."""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.friction_cone import friction_size, stick_limit_slope
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.timestepping.friction_discs import slide_radius
from fricmb.integrate.timestepping.layout import BROKEN
from fricmb.integrate.timestepping.loops import shares
from fricmb.integrate.timestepping.room import Run


@kernel
def will_break(run: Run, one: int, two: int, c: int, t: float, h: float) -> bool:
    """Whether the line through the last holding force and that of this step passes that of the limit in the step."""
    gap = t + 0.5 * h - run.when[one, c]
    if run.known[one, c] == 0 or gap <= 0.0 or run.last[c] >= 0.0 or run.tried[c] == 1:
        return False
    if shares(run, c):
        return False  # what is more than it holds goes over to others, until the step itself says that these cannot
    for a in range(run.row[c], run.row[c + 1]):
        run.gf[a] = run.F[two, a] + 0.5 * h / gap * (run.F[two, a] - run.hold[one, a])
    limit = run.brake[c] + 0.5 * h / gap * (run.brake[c] - run.grip[one, c])
    # what is held at its limit stays there: what the contacts are solved to is no reason to slip
    return bool(friction_size(run.row, c, run.gf) > limit + 2.0 * run.residual * run.brake[c])


@kernel
def first_crossing(aa: float, ab: float, bb: float) -> float:
    """The first positive root of aa x^2 + 2 ab x + bb, which is negative at 0; 0 where there is none."""
    if not bb < 0.0:
        return 0.0
    root = math.sqrt(max(0.0, ab * ab - aa * bb))
    # the same root in both forms, each where nothing cancels
    if ab > 0.0:
        return float(-bb / (ab + root))
    return float((root - ab) / aa) if aa > 0.0 else 0.0


@kernel
def pressed_in_slip(run: Run, one: int, c: int, t: float, h: float, N: float) -> float:
    """Normal force in the middle of the slip that begins in the step, on the line of the limit; N: of the step."""
    gap = t + 0.5 * h - run.when[one, c]
    if run.var[c] == 0 or run.known[one, c] == 0 or gap <= 0.0:
        return N
    later = 0.5 * h * max(run.share[c], 0.0) / gap
    slope = stick_limit_slope(run, run.laws, c, run.s, N)
    return float(max(0.0, N + later * (run.brake[c] - run.grip[one, c]) / max(slope, 1e-300)))


@kernel
def break_by_jolt(run: Run, one: int, two: int, c: int, t: float, h: float) -> None:
    """A contact that another one's transition tears off: held until then by what held it before, if that is known."""
    row0 = run.row[c]
    d = run.row[c + 1] - row0
    s = run.last[c] if run.known[one, c] == 1 else 0.0
    size = magnitude(run.row, c, run.away)
    run.share[c] = s
    slide = slide_radius(run, c, 0.0, pressed_in_slip(run, one, c, t, h, run.push[two, c]))
    for a in range(row0, row0 + d):
        slip = run.away[a] / size * slide if size > 0.0 else 0.0
        run.away[a] = s * (run.hold[one, a] - slip)


@kernel
def break_away(run: Run, one: int, two: int, c: int, t: float, h: float) -> None:
    """When the holding force reached its limit: on the lines of both, through the last step and this one.

    ``away`` becomes the mean force less that of slip all along: (mean hold - slip) s, s the fraction held.
    """
    row0 = run.row[c]
    d = run.row[c + 1] - row0
    middle = t + 0.5 * h
    rise_of_limit = run.brake[c] - run.grip[one, c]
    run.status[c] = BROKEN
    for a in range(row0, row0 + d):
        run.away[a] = run.F[two, a] - run.g[two, a] / run.soft[c]  # what would have held it
    s = 0.0
    gap = middle - run.when[one, c]
    if run.last[c] >= 0.0:
        break_by_jolt(run, one, two, c, t, h)
        return
    if run.known[one, c] == 1 and gap > 0.0:
        limit = run.grip[one, c]
        aa, ab, bb = -(rise_of_limit**2), -limit * rise_of_limit, -(limit**2)
        for a in range(row0, row0 + d):
            rise = run.away[a] - run.hold[one, a]
            aa += rise * rise
            ab += rise * run.hold[one, a]
            bb += run.hold[one, a] ** 2
        x = first_crossing(aa, ab, bb)
        if x > 0.0:
            s = min(max((run.when[one, c] + x * gap - t) / h, -1.0), 1.0)
            # half of what is held lies before the middle of the time held
            y = x - 0.5 * max(s, 0.0) * h / gap
            size = 0.0
            for a in range(row0, row0 + d):
                rise = run.away[a] - run.hold[one, a]
                run.gf[a] = run.hold[one, a] + y * rise
                run.away[a] = run.hold[one, a] + x * rise
                size = math.hypot(size, run.away[a])
            run.share[c] = s
            # slip begins at speed 0
            slide = slide_radius(run, c, 0.0, pressed_in_slip(run, one, c, t, h, run.push[two, c]))
            for a in range(row0, row0 + d):
                slip = run.away[a] / size * slide if size > 0.0 else 0.0
                run.away[a] = s * (run.gf[a] - slip)
            return
    for a in range(row0, row0 + d):
        run.away[a] = 0.0
    run.share[c] = s
