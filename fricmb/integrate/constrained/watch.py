"""Uniqueness of the friction forces, singular positions, and the triggers of transitions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.room import room
from fricmb.integrate.constrained.accelerations import ALL, Instant, State, instant_matrix, solve_instant
from fricmb.integrate.constrained.band_lapack import spread_of_pivots
from fricmb.integrate.constrained.forces import call_joint, directions, friction_at, load_place, move
from fricmb.integrate.constrained.problem_structs import Mech, Moving, mechanism_of
from fricmb.integrate.constrained.slip_rows import lack, slip_speed, spare
from fricmb.integrate.model.law_values import coefficient
from fricmb.integrate.problem import LAW_SMOOTH, NORMAL_LAW, OPEN, SLIP, STICK, Codes, Floats, Floats2, Ints, Problem


class Watch(NamedTuple):
    """What is watched along a run.

    ``margin`` (n_c,): 1 + mu n dN/dF of every port that slips, which must stay above 0; ``together`` (1,) the least
    principal minor of the same for several of them (``which``, ``A``, ``B`` room for it).  ``sigma`` (4,): least
    singular value of G M^-1/2 now, at the start, a step before, and that step's length; ``weak`` (m,) its direction.
    ``trigger`` (3 n_c + n_j,): what must not fall below 0; ``inner`` (s + 1, 3 n_c + n_j) the same at the start and the
    stages of a step, ``where`` (1,) the part of the step at which only the polynomial through these is below 0, else 1;
    ``values`` (s,) and ``series`` (s + 1,) of one of them; ``gap`` (n_j,) of open joints, ``opened`` (1,) how many
    there are; ``bends`` (n_j,), ``kinked`` (n_c,), ``kink``, ``side`` (m,): see ``load_kinks``; ``size`` (3,) running
    maxima of slip velocity, force and position.
    """

    margin: Floats
    together: Floats
    which: Ints
    A: Floats
    B: Floats
    sigma: Floats
    weak: Floats
    trigger: Floats
    inner: Floats2
    where: Floats
    values: Floats
    series: Floats
    gap: Floats
    opened: Ints
    bends: Ints
    kinked: Ints
    kink: Floats
    side: Floats
    size: Floats
    lam: Floats


def watch_of(problem: Problem, stages: int) -> Watch:
    """Rooms for the problem and steps of so many stages."""
    m = mechanism_of(problem)
    count = 3 * problem.n_c + len(m.joints.port)
    return room(Watch(
        np.ones(problem.n_c), np.ones(1), np.zeros(MANY, np.int64), np.zeros(MANY * MANY), np.zeros(MANY * MANY),
        np.zeros(4), np.random.default_rng(1).standard_normal(m.n_rows), np.ones(count),
        np.ones((stages + 1, count)), np.ones(1), np.zeros(stages), np.zeros(stages + 1), np.zeros(len(m.joints.port)),
        np.array([int((m.joints.dropped == 2).sum())]), np.zeros(len(m.joints.port), np.int64),
        np.zeros(problem.n_c, np.int64), np.zeros(m.n_rows + 1), np.zeros(m.n_rows + 1), np.zeros(3),
        np.zeros(m.n_rows + 1),
    ))  # fmt: skip


#: Inverse iterations where nothing is known of the direction.
TURNS = 20
#: Joints that slip at once and are looked at together.
MANY = 8
#: Directions of the reaction for which the margin of a joint is looked at.
AROUND = 16


@block
def margins(mech: Mech, k: Moving, w: Instant, y: State, out: Watch, whole: bool, address: Ints) -> float:
    """Margins of all ports that slip; returns the least.  ``whole``: also of them together, after a change of modes.

    In between the minors of all of them, and of all but one, cannot vanish unless a margin does.

    One port's force F follows its load, F = -mu n N(lam), and lam answers F by dlam/dF: the force is unique as long as
    1 + mu n dN/dlam dlam/dF > 0 for every direction that the reaction may take (for a single port: Genot and Brogliato
    1999; Klarbring 1990).  Where it vanishes there is no solution or there are several.
    """
    n, m, n_c = y.q.shape[0], y.lam.shape[0], y.mode.shape[0]
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
        push(mech, y, c, w.r, n + m)
        solve_instant(mech, w)
        n_x = joint.n_x[j]
        rows = joint.row[j + 1] - joint.row[j]
        at = load_place(n_x, friction_at(n_x, rows), directions(mech, c))
        mu, _, by_load = coefficient(port, port.laws, c, k.s, along(mech, y, c), max(y.N[c], 0.0))  # type: ignore[arg-type]
        factor = mu + by_load * max(y.N[c], 0.0)
        for i in range(rows):
            out.lam[joint.row[j] + i] = y.lam[joint.row[j] + i]
        around = 1 if joint.one_sided[j] or rows > 2 else AROUND
        for d in range(around):
            if around > 1:
                for i in range(rows):
                    angle = 2.0 * np.pi * (d + 0.13) / AROUND
                    out.lam[joint.row[j] + i] = np.cos(angle) if i == 0 else np.sin(angle)
            call_joint(mech, k, j, out.lam, 0, mech.address)
            answer = 0.0
            for i in range(rows):
                answer += k.out[at + 1 + i] * w.r[n + joint.row[j] + i]
            out.margin[c] = min(out.margin[c], 1.0 + factor * answer)
        least = min(least, out.margin[c])
    if whole:
        out.together[0] = least_minor(mech, k, w, y, out)
    return float(min(least, out.together[0]))


@kernel
def push(mech: Mech, y: State, c: int, r: Floats, r0: int) -> None:
    """A unit force along the slip of port c as a right-hand side."""
    for a in range(mech.port.row[c], mech.port.row[c + 1]):
        r[r0 + a] = y.n[a]


@kernel
def along(mech: Mech, y: State, c: int) -> float:
    """Slip speed of port c along its direction."""
    speed = 0.0
    for a in range(mech.port.row[c], mech.port.row[c + 1]):
        speed += y.n[a] * y.g[a]
    return float(speed)


@kernel
def rubs(mech: Mech, y: State, c: int) -> bool:
    """Whether port c is a joint that slips under rigid friction."""
    return bool(mech.port.joint[c] >= 0 and y.mode[c] == SLIP and mech.port.law[c] != LAW_SMOOTH)


@kernel
def least_minor(mech: Mech, k: Moving, w: Instant, y: State, out: Watch) -> float:
    """Least principal minor of ``A = 1 + mu n dN/dF`` over the joints that slip, at most MANY of them; 1 for one.

    With loads that cannot be negative, forces are unique for whatever loads act if and only if all are positive (a
    P-matrix: Cottle, Pang and Stone 1992, theorem 3.3.7).
    """
    n, m = y.q.shape[0], y.lam.shape[0]
    port, joint = mech.port, mech.joint
    count = 0
    for c in range(y.mode.shape[0]):
        if rubs(mech, y, c) and count < MANY:
            out.which[count] = c
            count += 1
    if count < 2:
        return 1.0
    for i in range(count):
        y.mode[out.which[i]] = OPEN
    code = instant_matrix(mech, k, w, y, ALL, mech.address)
    for j in range(count if code == 0 else 0):
        for i in range(w.r.shape[0]):
            w.r[i] = 0.0
        push(mech, y, out.which[j], w.r, n + m)
        solve_instant(mech, w)
        for i in range(count):
            c = out.which[i]
            owner = port.joint[c]
            rows = joint.row[owner + 1] - joint.row[owner]
            n_x = call_joint(mech, k, owner, y.lam, 0, mech.address)
            at = load_place(n_x, friction_at(n_x, rows), directions(mech, c))
            mu, _, by_load = coefficient(port, port.laws, c, k.s, along(mech, y, c), max(y.N[c], 0.0))  # type: ignore[arg-type]
            answer = 0.0
            for r in range(rows):
                answer += k.out[at + 1 + r] * w.r[n + joint.row[owner] + r]
            one = 1.0 if i == j else 0.0
            out.A[i * MANY + j] = one + (mu + by_load * max(y.N[c], 0.0)) * answer
    for i in range(count):
        y.mode[out.which[i]] = SLIP
    if code != 0:
        return -1.0
    least = 1.0
    for subset in range(1, 1 << count):
        least = min(least, minor(out, count, subset))
    return least


@kernel
def minor(out: Watch, count: int, subset: int) -> float:
    """Determinant of the rows and columns of A in a subset (by its bits)."""
    size = 0
    for i in range(count):
        if (subset >> i) & 1:
            column = 0
            for j in range(count):
                if (subset >> j) & 1:
                    out.B[size * MANY + column] = out.A[i * MANY + j]
                    column += 1
            size += 1
    value = 1.0
    for p in range(size):
        best = p
        for i in range(p + 1, size):
            if abs(out.B[i * MANY + p]) > abs(out.B[best * MANY + p]):
                best = i
        pivot = out.B[best * MANY + p]
        if pivot == 0.0:
            return 0.0
        value *= pivot if best == p else -pivot
        for j in range(p, size):
            x = out.B[best * MANY + j]
            out.B[best * MANY + j] = out.B[p * MANY + j]
            out.B[p * MANY + j] = x
        for i in range(p + 1, size):
            x = out.B[i * MANY + p] / pivot
            for j in range(p, size):
                out.B[i * MANY + j] -= x * out.B[p * MANY + j]
    return value


@kernel
def gaps(mech: Mech, k: Moving, y: State, out: Watch) -> None:
    """Distances of open joints at a state."""
    joint = mech.joint
    move(mech, k, y.t[0], y.q, y.v, mech.address)
    for j in range(joint.port.shape[0]):
        if joint.hands_over[j] and joint.dropped[joint.row[j]] == 2:
            call_joint(mech, k, j, y.lam, 0, mech.address)
            out.gap[j] = k.out[0]


@kernel
def triggers(
    mech: Mech, k: Moving, out: Watch, mode: Codes, direction: Floats, F: Floats, N: Floats, g: Floats, lam: Floats,
    at_end: bool,
) -> None:  # fmt: skip
    """Functions that fall below 0 where a mode ends: two a port, one a joint (open joints: at the end of steps).

    Behind them one a port whose load has a kink in the present step.  Slip almost without load may turn as it likes.
    """
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
            out.trigger[2 * c] = spare(mech, k, c, F, N, k.borne[0])
        else:
            out.trigger[2 * c] = slip_speed(port.row, c, direction, F, g) + out.size[0] * lack(N[c], k.borne[0])
    for j in range(joint.port.shape[0]):
        out.trigger[2 * n_c + j] = lam[joint.row[j]] if joint.one_sided[j] else 1.0
        if joint.hands_over[j] and joint.dropped[joint.row[j]] == 2:
            out.trigger[2 * n_c + j] = out.gap[j] if at_end else 1.0
    kinks = 2 * n_c + joint.port.shape[0]
    for c in range(n_c):
        out.trigger[kinks + c] = 1.0
        if out.kinked[c] != 0:
            j, value = port.joint[c], 0.0
            for r in range(joint.row[j], joint.row[j + 1]):
                value += out.kink[r] * lam[r]
            out.trigger[kinks + c] = value


@kernel
def pivots_of(mech: Mech, w: Instant) -> float:
    """Smallest over largest pivot of the factored matrix of the instant."""
    return spread_of_pivots(mech.order.sizes, w.ab)


@kernel
def least_singular(mech: Mech, w: Instant, out: Watch, turns: int) -> float:
    """Least singular value of ``G M^-1/2`` by inverse iteration; the matrix without friction is factored.

    One turn follows its direction from step to step.  It is proportional to the distance from a singular position.
    """
    m = out.weak.shape[0]
    if m == 0:
        return 1.0
    n = mech.order.place.shape[0] - mech.port.row[-1] - mech.port.z_start[-1] - m
    length = 0.0
    for _ in range(turns):
        length = 0.0
        for i in range(m):
            if mech.joint.dropped[i] != 0:
                out.weak[i] = 0.0
            length += out.weak[i] * out.weak[i]
        for i in range(w.r.shape[0]):
            w.r[i] = 0.0
        for i in range(m):
            w.r[n + i] = out.weak[i] / np.sqrt(max(length, 1e-300))
        solve_instant(mech, w)
        length = 0.0
        for i in range(m):
            out.weak[i] = w.r[n + i]
            length += out.weak[i] * out.weak[i]
    return float(length**-0.25) if length > 0.0 else 1.0
