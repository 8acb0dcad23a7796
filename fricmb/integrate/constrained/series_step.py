"""The stages of a step by its Taylor series, where all but directions of slip is linear while modes stay.

With distances e and slip velocities g of the contacts, loads ``N = N0 + k e + c e'`` of those that are closed, friction
``F = -n mu N`` of those that slip, and F of those that stick such that g' = 0,

    M q'' = f - K q - C q' + sum of the loads and the friction along their rows,

where slip has several directions with u in place of n, ``g = r u`` and ``r^2 = g . g`` (:func:`turn`), each power of
time follows from those before it: a few products with the dense rows and, once a step, factors of the mobility of what
sticks.  Newton's method on the same stages factors matrices of all unknowns, and anew for every length
of a step that is tried while a transition is located; one series serves all of them, as it is a function of time.

A series of a step that is long beside the fastest period has terms that grow before they fall, and digits go with them:
such steps are left to Newton.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.long_loops import long_loops
from fricmb.integrate.constrained.dense_rows import add_forces, put_path
from fricmb.integrate.constrained.held_rows import factor_held, solve_held
from fricmb.integrate.constrained.moving import Moving
from fricmb.integrate.constrained.problem_structs import Mech
from fricmb.integrate.constrained.slip_rows import friction_coefficient, plane
from fricmb.integrate.constrained.stages import TERMS, Stages
from fricmb.integrate.constrained.state import State
from fricmb.integrate.model.forces import set_time
from fricmb.integrate.problem import NORMAL_LAW, OPEN, SLIP, STICK, Floats, Floats2

#: Terms larger than this, beside what counts as 1, take digits of the sum with them.
GROWN = 1e3
#: Part of what a step may err by that the last terms may have: forces are of lower order than velocities.
REST = 1e-3
#: Part of what a signal changes by in a step that its bends may have where it counts as a straight line.
STRAIGHT = 1e-12
#: Round-off of the last terms.
FINEST = 1e-17


@kernel
def is_known(mech: Mech, y: State, st: Stages, h: float) -> bool:
    """Whether the series that is there is that of y and reaches as far as h."""
    se = st.series
    if se.terms == 0 or not 0.0 < h <= se.length or se.begin != y.t:
        return False
    for i in range(y.q.shape[0]):
        if se.x[0, i] != y.q[i] or se.x[1, i] != se.length * y.v[i]:
            return False
    same = True
    for c in range(y.mode.shape[0]):
        same = same and se.along[c] == direction(mech, y, c)
    return same


@kernel
def direction(mech: Mech, y: State, c: int) -> float:
    """The mode of contact c as a number: the direction of its slip, 0 where it sticks, 2 where it is open.

    Slip in several directions has that of its velocity, and is 3.
    """
    if y.mode[c] == SLIP:
        return 3.0 if plane(mech, c) else float(y.n[mech.port.row[c]])
    return 0.0 if y.mode[c] == STICK else 2.0


@kernel
def put_inputs(mech: Mech, k: Moving, y: State, st: Stages, h: float) -> None:
    """Monomials of prescribed signals and of their rates in the step, by their values at its start and its stages."""
    se, n = st.series, y.q.shape[0]
    n_u, s = k.s.ddu.shape[0], st.tab.c.shape[0]
    se.bent = 0
    if n_u == 0:
        return
    for i in range(s + 1):
        set_time(mech.signals, k.s, y.t + (st.tab.c[i - 1] * h if i > 0 else 0.0), n)
        for b in range(n_u):
            se.signal[i, b] = k.s.X[1 + 2 * n + b]
            se.signal[i, n_u + b] = k.s.X[1 + 2 * n + n_u + b]
    for j in range(s + 1):
        for b in range(2 * n_u):
            # of a constant the rest is 0, not round-off
            value, size = 0.0, 0.0
            for i in range(1, s + 1):
                value += st.tab.basis[j, i] * (se.signal[i, b] - se.signal[0, b])
                size = max(size, abs(se.signal[i, b] - se.signal[0, b]))
            se.u[j, b] = value + (se.signal[0, b] if j == 0 else 0.0)
            # a position that is linear in time, and a rate that is constant, are the same in any step
            if j > (1 if b < n_u else 0) and abs(value) > STRAIGHT * size:
                se.bent = 1


@kernel
def put_structure(mech: Mech, st: Stages, j: int, h: float) -> None:
    """Term j of the forces of the linear structure into ``series.f``."""
    se, linear = st.series, mech.linear
    f = se.f
    n, n_u, up = f.shape[0], se.u.shape[1] // 2, (j + 1.0) / h
    known = j < se.u.shape[0]
    for i in range(n):
        f[i] = linear.f[i] if j == 0 else 0.0
    tied = linear.tie.shape[0] > 0
    for e in range(linear.K.shape[0]):
        i, b = linear.Ki[e], linear.Kj[e]
        if i < n:
            x = se.x[j, b] if b < n else (se.u[j, b - n] if known else 0.0)
            f[i] -= linear.K[e] * (x - linear.tie[e] * se.x[j, i] if tied else x)
    for i in range(min(n, linear.alone.shape[0])):
        f[i] -= linear.alone[i] * se.x[j, i]
    for e in range(linear.C.shape[0]):
        i, b = linear.Ci[e], linear.Cj[e]
        if i < n:
            f[i] -= linear.C[e] * (up * se.x[j + 1, b] if b < n else (se.u[j, n_u + b - n] if known else 0.0))
    for e in range(linear.B.shape[0] if known else 0):
        f[linear.Bi[e]] += linear.B[e] * se.u[j, linear.Bj[e]]


@kernel
def turn(mech: Mech, st: Stages, c: int, j: int) -> None:
    """Term j of the size and the direction of the slip of contact c: r^2 = g . g, g = r u."""
    se, first, last = st.series, mech.port.row[c], mech.port.row[c + 1]
    square = 0.0
    for a in range(first, last):
        for i in range(j + 1):
            square += se.g[i, a] * se.g[j - i, a]
    if j == 0:
        se.speed[0, c] = np.sqrt(square)
    else:
        for i in range(1, j):
            square -= se.speed[i, c] * se.speed[j - i, c]
        se.speed[j, c] = 0.5 * square / se.speed[0, c]
    for a in range(first, last):
        value = se.g[j, a]
        for i in range(1, j + 1):
            value -= se.speed[i, c] * se.unit[j - i, a]
        se.unit[j, a] = value / se.speed[0, c]


@kernel
def put_loads(mech: Mech, y: State, st: Stages, j: int, h: float) -> None:
    """Term j of loads, and what bodies feel of them into ``series.force``."""
    se, dense, port = st.series, mech.dense, mech.port
    m, n_u, up = y.F.shape[0], se.u.shape[1] // 2, (j + 1.0) / h
    for c in range(y.mode.shape[0]):
        e, rate = se.path[j, m + c], up * se.path[j + 1, m + c]
        for b in range(n_u if j < se.u.shape[0] else 0):
            e += dense.by_u[m + c, b] * se.u[j, b]
            rate += dense.by_u[m + c, b] * se.u[j, n_u + b]
        load = dense.stiff[c] * e + dense.damp[c] * rate
        if j == 0:
            load += dense.offset[m + c]
        se.N[j, c] = load
        push = (0.0 if y.mode[c] == OPEN else load) - (port.N0[c] if j == 0 else 0.0)
        se.force[m + c] = push if port.normal[c] == NORMAL_LAW else 0.0


@kernel
def put_contacts(mech: Mech, y: State, st: Stages, j: int, h: float) -> bool:
    """Term j of loads and slip velocities, and of the forces of what does not stick, added to ``series.f``.

    False where slip in several directions is too slow to have one.
    """
    se, dense, row = st.series, mech.dense, mech.port.row
    n_u, up = se.u.shape[1] // 2, (j + 1.0) / h
    put_loads(mech, y, st, j, h)
    for c in range(y.mode.shape[0]):
        for a in range(row[c], row[c + 1]):
            slip = up * se.path[j + 1, a] + (dense.offset[a] if j == 0 else 0.0)
            for b in range(n_u if j < se.u.shape[0] else 0):
                slip += dense.by_u[a, b] * se.u[j, n_u + b]
            se.g[j, a], se.F[j, a] = slip, 0.0
        turns = y.mode[c] == SLIP and plane(mech, c)
        if turns:
            turn(mech, st, c, j)
            if not se.speed[0, c] > 0.0:
                return False
        follows = dense.stiff[c] != 0.0 or dense.damp[c] != 0.0
        earlier = (j if follows else min(j, 1)) if turns else 0
        for a in range(row[c], row[c + 1] if y.mode[c] == SLIP else row[c]):
            size = se.N[j, c] * (se.unit[0, a] if turns else y.n[a])
            for i in range(earlier):
                size += se.N[i, c] * se.unit[j - i, a]
            se.F[j, a] = -se.mu[c] * size
        for a in range(row[c], row[c + 1]):
            se.force[a] = se.F[j, a]
    add_forces(dense.on, se.force, se.f)
    return True


@kernel
def hold(mech: Mech, st: Stages, j: int, h: float) -> None:
    """Term j of the forces of what sticks, added to ``series.f``: slip velocities keep their first term."""
    se, dense = st.series, mech.dense
    n_u = se.u.shape[1] // 2
    for i in range(se.f.shape[0]):
        se.acc[i] = dense.inverse[i] * se.f[i]
    put_path(dense.of, se.acc, se.force)
    held = se.held
    for i in range(held.count):
        a = held.row[i]
        value = se.force[a]
        for b in range(n_u if j + 1 < se.u.shape[0] else 0):
            value += dense.by_u[a, b] * (j + 1.0) / h * se.u[j + 1, n_u + b]
        held.side[i] = -value
    solve_held(held)
    se.force[:] = 0.0
    for i in range(held.count):
        se.F[j, held.row[i]] = se.force[held.row[i]] = held.side[i]
    add_forces(dense.on, se.force, se.f)


#: Part by which the last terms of directions of slip count beside those of velocities.
TURNED = 1e-6


@kernel
def sharpest(mech: Mech, y: State, st: Stages, j: int) -> float:
    """The largest of term j of directions of slip, by the part by which these count."""
    most = 0.0
    for c in range(y.mode.shape[0]):
        if y.mode[c] == SLIP and plane(mech, c):
            for a in range(mech.port.row[c], mech.port.row[c + 1]):
                most = max(most, TURNED * abs(st.series.unit[j, a]))
    return most


@kernel
def expand(mech: Mech, k: Moving, y: State, st: Stages, h: float, accuracy: float) -> bool:
    """The series from y for steps up to h; False where it does not converge to ``accuracy`` of what counts as 1."""
    se, dense = st.series, mech.dense
    se.terms, se.begin, se.length = 0, y.t, h
    for c in range(y.mode.shape[0]):
        se.along[c] = direction(mech, y, c)
        se.mu[c], _, _ = friction_coefficient(mech, k, c, 0.0, y.N[c])
    if not factor_held(mech, y.mode, se.held):
        return False
    put_inputs(mech, k, y, st, h)
    for i in range(y.q.shape[0]):
        se.x[0, i] = y.q[i]
        se.x[1, i] = h * y.v[i]
    put_path(dense.of, se.x[0], se.path[0])
    put_path(dense.of, se.x[1], se.path[1])
    quiet = 0
    for j in range(TERMS):
        put_structure(mech, st, j, h)
        if not put_contacts(mech, y, st, j, h):
            return False
        if se.held.count > 0:
            hold(mech, st, j, h)
        largest = sharpest(mech, y, st, j)
        for i in range(y.q.shape[0]):
            se.x[j + 2, i] = h * h / ((j + 1.0) * (j + 2.0)) * dense.inverse[i] * se.f[i]
            largest = max(largest, (j + 2.0) / h * abs(se.x[j + 2, i]) / st.scale[i])
        put_path(dense.of, se.x[j + 2], se.path[j + 2])
        if not largest < GROWN:
            return False
        quiet = quiet + 1 if largest <= max(REST * accuracy, FINEST) else 0
        if quiet >= 2 and j + 1 >= se.u.shape[0]:
            se.terms = j + 1
            return True
    return False


@kernel
def sum_up(part: Floats2, first: int, count: int, at: float, out: Floats) -> None:
    """``sum of part[first + j] at^j`` for j below ``count``."""
    out[:] = 0.0
    for j in range(first + count - 1, first - 1, -1):
        line = part[j]
        for a in range(out.shape[0]):
            out[a] = out[a] * at + line[a]


@kernel
def sum_rates(x: Floats2, order: int, count: int, at: float, h: float, out: Floats) -> None:
    """First or second derivative of ``sum of x[j] (t/h)^j``, its first ``count`` terms, at t = at h."""
    out[:] = 0.0
    for j in range(count - 1, -1, -1):
        line, factor = x[j + order], (j + 1.0) / h
        if order == 2:
            factor *= (j + 2.0) / h
        for a in range(out.shape[0]):
            out[a] = out[a] * at + factor * line[a]


@kernel
def forget_inputs(st: Stages) -> None:
    """Let a new step have a series of its own where signals bend: their monomials in a longer one may be worse."""
    if st.series.bent == 1:
        st.series.terms = 0


@block
@long_loops
def solve_by_series(mech: Mech, k: Moving, y: State, st: Stages, h: float, accuracy: float) -> bool:
    """Values at the stages of a step h from y by the series of its modes; False where it has none that is good enough.

    ``accuracy``: what is left out, of what counts as 1 in velocities.
    """
    if not is_known(mech, y, st, h) and not expand(mech, k, y, st, h, accuracy):
        return False
    se, s = st.series, st.tab.c.shape[0]
    for i in range(s):
        at = st.tab.c[i] * h / se.length
        sum_up(se.x, 0, se.terms + 2, at, st.Q[i])
        sum_rates(se.x, 1, se.terms + 1, at, se.length, st.V[i])
        sum_up(se.F, 0, se.terms, at, st.F[i])
        sum_up(se.N, 0, se.terms, at, st.N[i])
        sum_up(se.g, 0, se.terms, at, st.g[i])
    sum_rates(se.x, 2, se.terms, st.tab.c[s - 1] * h / se.length, se.length, st.acc)
    st.found, st.fresh = 0.0, 1
    return True
