"""Uniqueness of the friction forces, singular positions, and the triggers of transitions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fricmb.integrate._kernel import kernel
from fricmb.integrate._laws import coefficient
from fricmb.integrate._problem import LAW_SMOOTH, NORMAL_LAW, OPEN, SLIP, STICK, Codes, Floats, Ints, Problem
from fricmb.integrate._room import block, room
from fricmb.integrate.constrained._band import spread_of_pivots
from fricmb.integrate.constrained._field import call_joint, friction_at
from fricmb.integrate.constrained._pack import Mech, Moving, mechanism_of
from fricmb.integrate.constrained._state import ALL, Instant, State, instant_matrix, solve_instant


class Watch(NamedTuple):
    """What is watched along a run.

    ``margin`` (n_c,): 1 + mu n dN/dF of every port that slips, which must stay above 0; ``pivot`` (2,): smallest over
    largest pivot now and at the start; ``trigger`` (n_c + n_j, 2): functions that must not fall below 0; ``size`` (2,)
    running maxima of slip velocity and force.
    """

    margin: Floats
    pivot: Floats
    trigger: Floats
    old: Floats
    size: Floats
    lam: Floats


def watch_of(problem: Problem) -> Watch:
    """Rooms for the problem."""
    m = mechanism_of(problem)
    count = 2 * problem.n_c + len(m.joints.port)
    return room(Watch(
        np.ones(problem.n_c), np.zeros(2), np.ones(count), np.ones(count), np.zeros(2), np.zeros(m.n_rows + 1)
    ))  # fmt: skip


#: Directions of the reaction for which the margin of a joint is looked at.
AROUND = 16


@block
def margins(mech: Mech, k: Moving, w: Instant, y: State, out: Watch, address: Ints) -> float:
    """Margins of all ports that slip; returns the least.

    One port's force F follows its load, F = -mu n N(lam), and lam answers F by dlam/dF: the force is unique as long as
    1 + mu n dN/dlam dlam/dF > 0 for every direction that the reaction may take (for a single port: Genot and Brogliato
    1999; Klarbring 1990).  Where it vanishes there is no solution or there are several.
    """
    n, m, n_c = y.q.shape[0], y.lam.shape[0], y.F.shape[0]
    port, joint = mech.port, mech.joint
    least = 1.0
    for c in range(n_c):
        out.margin[c] = 1.0
        j = port.joint[c]
        if j < 0 or y.mode[c] != SLIP or port.law[c] == LAW_SMOOTH:
            continue
        # dlam/dF: the other ports as they are, this one's force given
        mode = y.mode[c]
        y.mode[c] = OPEN
        code = instant_matrix(mech, k, w, y, ALL, mech.address)
        y.mode[c] = mode
        if code != 0:
            out.margin[c] = -1.0
            return -1.0
        for i in range(w.r.shape[0]):
            w.r[i] = 0.0
        w.r[n + m + c] = 1.0
        solve_instant(mech, w)
        n_x = joint.n_x[j]
        rows = joint.row[j + 1] - joint.row[j]
        at = friction_at(n_x, rows) + n_x + n_x * n_x
        mu, _, by_load = coefficient(port, port.laws, c, k.s, y.n[c] * y.g[c], max(y.N[c], 0.0))  # type: ignore[arg-type]
        factor = mu + by_load * max(y.N[c], 0.0)
        for i in range(rows):
            out.lam[joint.row[j] + i] = y.lam[joint.row[j] + i]
        around = 1 if joint.one_sided[j] else AROUND
        for d in range(around):
            if around > 1:
                for i in range(rows):
                    angle = 2.0 * np.pi * (d + 0.13) / AROUND
                    out.lam[joint.row[j] + i] = np.cos(angle) if i == 0 else np.sin(angle)
            call_joint(mech, k, j, out.lam, 0, mech.address)
            answer = 0.0
            for i in range(rows):
                answer += k.out[at + 1 + i] * w.r[n + joint.row[j] + i]
            out.margin[c] = min(out.margin[c], 1.0 + factor * y.n[c] * answer)
        least = min(least, out.margin[c])
    return least


@kernel
def triggers(
    mech: Mech, out: Watch, mode: Codes, direction: Floats, F: Floats, N: Floats, g: Floats, lam: Floats
) -> None:
    """Functions that fall below 0 where a mode ends: two a port, one a joint."""
    port, joint = mech.port, mech.joint
    n_c = mode.shape[0]
    for c in range(n_c):
        out.trigger[2 * c] = 1.0
        out.trigger[2 * c + 1] = 1.0
        if port.normal[c] == NORMAL_LAW:
            out.trigger[2 * c + 1] = -N[c] if mode[c] == OPEN else N[c]
        if port.law[c] == LAW_SMOOTH or mode[c] == OPEN:
            continue
        if mode[c] == STICK:
            out.trigger[2 * c] = port.mu_s[c] * max(N[c], 0.0) - abs(F[c])
        else:
            out.trigger[2 * c] = direction[c] * g[c]
    for j in range(joint.port.shape[0]):
        out.trigger[2 * n_c + j] = lam[joint.row[j]] if joint.one_sided[j] else 1.0


@kernel
def pivots_of(mech: Mech, w: Instant) -> float:
    """Smallest over largest pivot of the factored matrix of the instant."""
    return spread_of_pivots(mech.order.sizes, w.ab)
