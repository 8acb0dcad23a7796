"""One combination of stick and slip at an instant: put to the contacts, solved for, and what contradicts it."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.equations.accelerations import react, weighed
from fricmb.integrate.implicit.equations.instant_matrix import NONE, instant_matrix, solve_instant
from fricmb.integrate.implicit.equations.slip_rows import (
    SETTING_OUT,
    SLIGHT,
    aim,
    guided,
    lack,
    lightness,
    plane,
    slip_speed,
    spare,
)
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.model.friction_cone import stick_limit
from fricmb.integrate.model.law_values import magnitude, point_along
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, SLIP, STICK, Codes

#: What a port does at the instant decided on: it slips on (or is open), comes to rest, has rested; LENT to rest while
#: round-off of its slip is taken away (``transition``); IN_LOOP with the others of a loop.
SLIPS_ON, ARRIVES, RESTED, LENT, IN_LOOP = 0, 1, 2, 3, 4
#: Round-off of forces beside the limit of sticking.
SLACK = 1e-10
#: Round-off of slip accelerations beside the largest: in trees, and in loops, whose Jacobians are softened.
CREEP, CREEP_IN_LOOPS = 1e-12, 1e-9
#: Steps from the forces that hold to those of slip, where directions of slip are to be found.
STEPS_OUT = 6
#: Slip accelerations that friction could bring beside those there are, for which joints are asked.
FAR_MORE = 10.0


@kernel
def at_rest(mech: Mech, y: State, c: int, part: Codes) -> bool:
    """Whether port c takes part in the decision."""
    return bool(part[c] != SLIPS_ON and mech.port.law[c] != LAW_SMOOTH and y.mode[c] != OPEN)


@kernel
def wrong(mech: Mech, k: Moving, y: State, c: int, a_scale: float) -> float:
    """By how much port c contradicts its mode (0: not at all); y is complete."""
    if y.mode[c] == STICK:
        row = mech.port.row
        for a in range(row[c], row[c + 1]):
            if abs(y.ga[a]) > CREEP_IN_LOOPS * a_scale and guided(mech, c, a - row[c]):
                return float(1.0 + abs(y.ga[a]) / a_scale)  # no force keeps it from slipping across its guide
        limit = stick_limit(mech.port, mech.port.laws, c, k.s, max(y.N[c], 0.0))
        force = magnitude(mech.port.row, c, y.F)
        over = -spare(mech, k, c, y.F, y.N)
        return over / max(limit, 1e-300) if over > SLACK * max(limit, force) else 0.0
    against = -slip_speed(mech.port.row, c, y.n, y.F, y.ga) / a_scale - lack(mech, k, c, y.N[c])
    return against if against > (CREEP_IN_LOOPS if mech.port.soft[c] > 0.0 else CREEP) else 0.0


@kernel
def still(mech: Mech, k: Moving, y: State, c: int, a_scale: float) -> bool:
    """Whether others hold port c, which would slip but cannot without them: then it sticks."""
    if y.mode[c] != SLIP or k.looped[c] == 0 or lack(mech, k, c, y.N[c]) > 0.0:
        return False
    return bool(slip_speed(mech.port.row, c, y.n, y.F, y.ga) < CREEP_IN_LOOPS * a_scale)


@kernel
def release(mech: Mech, k: Moving, y: State, c: int) -> None:
    """Let port c slip, against the force that has held it."""
    row = mech.port.row
    if not plane(mech, c):
        y.mode[c] = SLIP
        y.n[row[c]] = -1.0 if y.F[row[c]] > 0.0 else 1.0
        return
    y.mode[c] = SETTING_OUT
    force = magnitude(row, c, y.F)
    k.held[c] = force
    k.slight[c] = 0.0
    for a in range(row[c + 1] - row[c]):
        k.slight[c] += SLIGHT * force * lightness(mech, k, c, a, y.lam, mech.mass)
    for a in range(row[c], row[c + 1]):
        y.n[a] = -y.F[a] / force if force > 0.0 else (1.0 if a == row[c] else 0.0)


@kernel
def hold(mech: Mech, y: State, c: int, anew: bool) -> None:
    """Let port c stick; ``anew``: by no force yet.

    Of ports that hold more than there is to hold Newton's changes are of least norm, so forces are, too, if they come
    from 0; what they were before says nothing.
    """
    y.mode[c] = STICK
    for a in range(mech.port.row[c], mech.port.row[c + 1] if anew else mech.port.row[c]):
        y.F[a] = 0.0


@kernel
def ease(mech: Mech, k: Moving, w: Instant, y: State) -> bool:
    """As ``react``; where ports set out in a plane, along a path from the forces that held them.

    Along it slip accelerations grow from 0 on the side where friction brakes; a root on the other is not met.
    """
    some = False
    for c in range(y.mode.shape[0]):
        some = some or y.mode[c] == SETTING_OUT
    for part in range(1, STEPS_OUT if some else 1):
        k.part = part / STEPS_OUT
        if not react(mech, k, w, y, False):
            k.part = 1.0
            return False
    k.part = 1.0
    return bool(react(mech, k, w, y, False))


@kernel
def set_out(mech: Mech, y: State) -> None:
    """Ports that set out slip from now on, in the direction found; one without load follows its acceleration."""
    row = mech.port.row
    for c in range(y.mode.shape[0]):
        if y.mode[c] == SETTING_OUT:
            y.mode[c] = SLIP
            aim(mech, y.mode, y.F, y.n)
            if magnitude(row, c, y.F) == 0.0:
                point_along(row, c, y.ga, 1.0, y.n)


@kernel
def answer_at(mech: Mech, k: Moving, w: Instant, y: State, first: int, last: int) -> None:
    """Changes of slip velocities by unit forces in rows first to last, joints holding, into ``k.answer``.

    From the kinetic energy of the motion: where a joint blocks one, the round-off of that counts by its square.
    """
    n, m, linear = y.q.shape[0], y.lam.shape[0], mech.linear
    if not instant_matrix(mech, k, w, y, NONE):
        return
    for a in range(first, last):
        w.r[:] = 0.0
        w.r[n + m + a] = 1.0
        solve_instant(mech, w)
        k.answer[a] = 0.0
        for e in range(linear.M.shape[0]):
            k.answer[a] += linear.M[e] * w.r[linear.Mi[e]] * w.r[linear.Mj[e]]


@kernel
def most_light(mech: Mech, k: Moving, y: State) -> float:
    """Largest lightness of a port in one of its directions."""
    value = 0.0
    for c in range(y.mode.shape[0]):
        for a in range(mech.port.row[c + 1] - mech.port.row[c]):
            value = max(value, lightness(mech, k, c, a, y.lam, mech.mass))
    return value


@kernel
def largest_acceleration(mech: Mech, k: Moving, w: Instant, y: State) -> float:
    """Scale of slip accelerations: those there are, those of bodies as ports feel them, what friction could bring.

    Joints are asked for only where friction could bring far more without them: a light body that they keep from turning
    would make everything else look like round-off.
    """
    row = mech.port.row
    value = max(1e-290, float(np.sqrt(most_light(mech, k, y)) * weighed(mech, y.a)))
    for a in range(y.ga.shape[0]):
        value = max(value, abs(y.ga[a]))
    there = value
    for c in range(y.mode.shape[0]):
        for a in range(row[c], row[c + 1]):
            could = abs(y.F[a]) * lightness(mech, k, c, a - row[c], y.lam, mech.mass)
            if could > FAR_MORE * there:
                if k.answer[a] < 0.0:
                    answer_at(mech, k, w, y, row[c], row[c + 1])
                if k.answer[a] >= 0.0:
                    could = min(could, abs(y.F[a]) * k.answer[a])
            value = max(value, could)
    return float(value)
