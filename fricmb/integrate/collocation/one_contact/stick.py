"""Stick in closed form: the time at which the force of a stuck contact reaches its cone.

The force is a sum of the structure's own motions, so its second derivative has a bound at every instant; steps that
this bound allows never pass a root, whatever happens between, and close in on it quadratically.  The cone
is that of ``model/friction_cone``, written with its rate.
"""

from __future__ import annotations

import math

from fricmb.integrate.collocation.block_motion import fundamental
from fricmb.integrate.collocation.one_contact.room import Run
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.run.slices import slice_over

#: What a search for a release finds that is no time: none, that its slice is over, that it does not end.
NEVER, AGAIN, NO_END = -1.0, -2.0, -3.0
#: Looks of one search.
MOST_LOOKS = 1e8
#: Looks after which it is asked whether the force can get there at all: again and again, and the first time.
OFTEN, FIRST = 256.0, 32.0


@kernel
def stuck_force(run: Run, t: float, b: int, horizon: float) -> float:
    """Force and rate of the stuck rows at t into ``out``; returns a bound of the second derivative.

    ``free`` holds the force at the start and its slope beside the blocks' part.
    """
    m = run.belt.shape[0]
    for a in range(m):
        run.out[0, a] = run.free[a, 0] + run.free[a, 1] * t
        run.out[1, a] = run.free[a, 1]
        run.out[2, a] = 0.0
    for j in range(b):
        x0, x1, x2 = fundamental(run.w2[1, j], run.damp[1, j], t)
        du = run.v[j] * t + run.a[j] * x1 + run.k[j] * x2
        dv = run.a[j] * x0 + run.k[j] * x1
        acceleration = run.a[j] * (1.0 - run.damp[1, j] * x0 - run.w2[1, j] * x1) + run.k[j] * x0
        jerk = run.k[j] - run.w2[1, j] * dv
        w = math.sqrt(abs(run.w2[1, j]))
        if run.w2[1, j] > 0.0 and run.damp[1, j] >= 0.0:
            size = math.sqrt(acceleration * acceleration + jerk * jerk / run.w2[1, j])
            slope = (w + run.damp[1, j]) * size
        elif run.damp[1, j] > 0.0:
            size = max(abs(acceleration), abs(jerk) / run.damp[1, j])
            slope = abs(jerk) + run.damp[1, j] * size
        else:
            # growing or free: no step is longer than the horizon, short against 1/(w + |d|)
            size = 3.0 * abs(acceleration)
            if jerk != 0.0:
                size += 3.0 * abs(jerk) * horizon
            slope = 3.0 * (abs(jerk) + (w + abs(run.damp[1, j])) * size)
        for a in range(m):
            run.out[0, a] += run.hold_u[a, j] * du + run.hold_v[a, j] * dv
            run.out[1, a] += run.hold_u[a, j] * (run.v[j] + dv) + run.hold_v[a, j] * acceleration
            run.out[2, a] += abs(run.hold_u[a, j]) * size + abs(run.hold_v[a, j]) * slope
    bound = 0.0
    for a in range(m):
        bound += run.out[2, a] * run.out[2, a]
    return math.sqrt(bound)


@kernel
def never_leaves(run: Run, t: float, left: float) -> bool:
    """Whether the force, ``out[0]`` at t as of :func:`stuck_force`, stays within the cone for ``left`` from t on.

    Free vibration that loses energy or keeps it never swings further than it does now, and constant loads leave its
    middle where it is.  What rises in proportion to time may do so for as long as the run goes on.
    """
    m = run.belt.shape[0]
    total = 0.0
    for a in range(m):
        middle, reach = run.out[0, a], abs(run.free[a, 1]) * left
        for j in range(run.stuck_blocks):
            w2, damp = run.w2[1, j], run.damp[1, j]
            x0, x1, _ = fundamental(w2, damp, t)
            velocity = run.v[j] + run.a[j] * x0 + run.k[j] * x1
            acceleration = run.a[j] * (1.0 - damp * x0 - w2 * x1) + run.k[j] * x0
            if w2 <= 0.0 or damp < 0.0:
                if run.v[j] != 0.0 or run.a[j] != 0.0 or run.k[j] != 0.0:
                    return False
                continue
            rise = run.k[j] + w2 * run.v[j] + damp * run.a[j]
            if abs(rise) > 1e-13 * (abs(w2 * run.v[j]) + abs(damp * run.a[j])):
                return False  # its load changes
            x = -(acceleration + damp * velocity) / w2
            size = math.sqrt(x * x + velocity * velocity / w2)
            middle -= run.hold_u[a, j] * x + run.hold_v[a, j] * velocity
            reach += (abs(run.hold_u[a, j]) + abs(run.hold_v[a, j]) * math.sqrt(w2)) * size
        total += (abs(middle) + reach) ** 2
    return bool(math.sqrt(total) < run.mu_s_N * (1.0 - 1e-9))


@kernel
def safe_step(F: float, FdF: float, dF: float, bound: float, limit: float) -> float:
    """A step on which ``|F + F' t| + bound t^2/2`` cannot pass ``limit``, short of it by no more than second order."""
    slack = limit - F
    longest = dF + math.sqrt(dF * dF + 2.0 * bound * slack)
    step = 2.0 * slack / longest if longest > 0.0 else 1e300
    if F > 0.0:
        # sqrt(F^2 + x) <= F + x/(2 F)
        b = FdF / F
        a = 0.5 * (dF * dF / F + bound)
        down = b + math.sqrt(b * b + 4.0 * a * slack)
        if down > 0.0:
            step = max(step, 2.0 * slack / down)
        elif slack > 0.0:
            step = 1e300
    return step


@kernel
def release_time(run: Run, longest: float, begun: int) -> float:
    """First time in [0, longest] at which |F| reaches ``limit``; NEVER, AGAIN, or NO_END.

    A search that is called again goes on from ``run.searched``; ``run.looks`` counts its looks.
    """
    m = run.belt.shape[0]
    b = run.stuck_blocks
    limit = run.mu_s_N
    fastest = 0.0
    cap = 1e300
    for j in range(b):
        fastest = max(fastest, math.sqrt(abs(run.w2[1, j])) + abs(run.damp[1, j]))
    brief = 1.0 / fastest if fastest > 0.0 else longest
    for j in range(b):
        rate = math.sqrt(abs(run.w2[1, j])) + abs(run.damp[1, j])
        if run.w2[1, j] < 0.0 or run.damp[1, j] < 0.0:
            cap = min(cap, 0.5 / rate)
        elif run.w2[1, j] == 0.0 and run.damp[1, j] == 0.0 and run.k[j] != 0.0:
            cap = min(cap, abs(run.a[j] / run.k[j]) + brief)
    t = run.searched
    run.searched = 0.0
    while run.looks < MOST_LOOKS:
        run.looks += 1.0
        bound = stuck_force(run, t, b, cap)
        if run.looks % OFTEN == FIRST and never_leaves(run, t, longest - t):
            return NEVER
        F = 0.0
        FdF = 0.0
        dF = 0.0
        for a in range(m):
            F += run.out[0, a] * run.out[0, a]
            FdF += run.out[0, a] * run.out[1, a]
            dF += run.out[1, a] * run.out[1, a]
        F = math.sqrt(F)
        dF = math.sqrt(dF)
        least = 4e-16 * t
        if limit - F <= 2e-15 * limit:
            if FdF > 0.0:
                return t
            # on the cone and going inside (just landed, or a tangency): leave the root behind
            least = max(least, 1e-7 * min(brief, limit / max(dF, 1e-300)))
            step = least
        else:
            step = min(safe_step(F, FdF, dF, bound, limit), cap)
            if step <= least and FdF > 0.0:
                return t
            step = max(step, least)
        t += step
        if t >= longest:
            return NEVER
        if slice_over(begun):
            run.searched = t
            return AGAIN
    return NO_END
