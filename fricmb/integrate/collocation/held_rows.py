"""Stuck rows held by the tables: for a pattern of modes and a rung of the ladder what sticks is eliminated once.

With relative velocities g = b + G F over all nodes, s rows that stick and f rows that do not, g_s = 0 gives

    F_s = -H b_s - X F_f,   H = G_ss^-1,   X = H G_sf,
    g_f = (b_f - G_fs H b_s) + (G_ff - G_fs X) F_f.

So Newton's method is left with the contacts that slip; where all stick, a step is one product.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.lapack import solve_rows
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.problem import LAW_CONSTANT, OPEN, STICK, Codes, Floats, Ints
from fricmb.integrate.step.contact_unknowns import PortState
from fricmb.integrate.step.coulomb_newton import dot
from fricmb.integrate.step.exact_structure import Exact, rung_below
from fricmb.integrate.step.one_step_room import OneStep

#: Columns of ``Exact.held_for``.
PATTERN, RUNG = range(2)


@kernel
def pattern_of(packed: Packed, mode: Codes) -> int:
    """Which contacts stick, by bits; 0 where none does, or where friction is not constant or loads are shared."""
    ports = packed.ports
    pattern = 0
    if ports.soft > 0.0 or mode.shape[0] > 60:
        return 0
    for k in range(mode.shape[0]):
        if ports.law[k] != LAW_CONSTANT or ports.var[k] >= 0:
            return 0
        if mode[k] == STICK:
            pattern |= 1 << k
    return pattern


@kernel
def list_rows(packed: Packed, mode: Codes, n_s: int, into: Ints) -> int:
    """Rows that stick, at all nodes, into ``into``, those that do not behind them; returns how many stick."""
    m = packed.ports.row[mode.shape[0]]
    count = 0
    for sticks in (True, False):
        for i in range(n_s):
            for k in range(mode.shape[0]):
                if (mode[k] == STICK) == sticks:
                    for a in range(packed.ports.row[k], packed.ports.row[k + 1]):
                        into[count] = i * m + a
                        count += 1
        if sticks:
            stuck = count
    return stuck


@kernel
def eliminate_stuck(ex: Exact, w: PortState, place: int, stuck: int) -> bool:
    """Fill a place of ``held`` from G; ``ex.rows`` holds the rows.  False where forces in stick are not determined."""
    H, X, E = ex.held[place, 0], ex.held[place, 1], ex.held[place, 2]
    n = w.G.shape[0]
    rows = ex.rows
    a = np.empty(stuck * stuck)
    b = np.zeros((n, stuck))
    for i in range(stuck):
        for j in range(stuck):
            a[i * stuck + j] = w.G[rows[i], rows[j]]
        b[i, i] = 1.0
        for j in range(stuck, n):
            b[j, i] = w.G[rows[i], rows[j]]
    if not solve_rows(a, b, stuck, w.sizes, w.pivots):
        return False
    H[:, :] = 0.0
    X[:, :] = 0.0
    E[:, :] = 0.0
    for i in range(stuck):
        for j in range(stuck):
            H[rows[i], rows[j]] = b[j, i]
        for j in range(stuck, n):
            X[rows[i], rows[j]] = b[j, i]
    for i in range(stuck, n):
        for j in range(stuck, n):
            value = w.G[rows[i], rows[j]]
            for k in range(stuck):
                value -= w.G[rows[i], rows[k]] * b[j, k]
            E[rows[i], rows[j]] = value
    return True


@kernel
def place_of(packed: Packed, one: OneStep, mode: Codes, pattern: int, h: float) -> int:
    """Place of ``held`` for a pattern and a rung, filled if it was not; -1 where there is none."""
    ex = one.exact
    rung = rung_below(h)
    count = ex.held.shape[0]
    place = 0
    while place < count and (ex.held_for[place, PATTERN] != pattern or ex.held_for[place, RUNG] != rung):
        place += 1
    if count == 0:
        return -1
    if place == count:
        place = ex.held_next % count
        ex.held_next += 1
        ex.held_for[place, PATTERN] = 0
        stuck = list_rows(packed, mode, one.w.F.shape[0], ex.rows)
        if not eliminate_stuck(ex, one.w, place, stuck):
            return -1
        ex.held_for[place, PATTERN] = pattern
        ex.held_for[place, RUNG] = rung
    return int(place)


@kernel
def hold_rows(ex: Exact, w: PortState, place: int, mode: Codes, free: Codes, first: Floats) -> None:
    """Leave the equations of what does not stick, with modes ``free``.

    ``first`` (s m,): forces of what sticks as long as nothing else acts.
    """
    n_s, m = w.F.shape[0], w.F.shape[1]
    H = ex.held[place, 0]
    gb = w.gb.reshape(w.gb.size)
    for x in range(n_s * m):
        first[x] = -dot(H[x], gb)
    for x in range(n_s * m):
        # what slips has no row in H
        w.rhs[x] = dot(w.G[x], first)
    for x in range(n_s * m):
        gb[x] += w.rhs[x]
    w.G[:] = ex.held[place, 2]
    for k in range(mode.shape[0]):
        free[k] = OPEN if mode[k] == STICK else mode[k]


@kernel
def give_held_forces(packed: Packed, ex: Exact, w: PortState, place: int, mode: Codes, first: Floats) -> None:
    """Forces of what sticks, after those of what slips have been found; F of stuck rows must be 0."""
    n_s, m = w.F.shape[0], w.F.shape[1]
    X = ex.held[place, 1]
    F = w.F.reshape(w.F.size)
    for x in range(n_s * m):
        w.dF[x] = F[x]
    for k in range(mode.shape[0]):
        if mode[k] != STICK:
            continue
        for i in range(n_s):
            for a in range(packed.ports.row[k], packed.ports.row[k + 1]):
                x = i * m + a
                w.F[i, a] = first[x] - dot(X[x], w.dF)
                w.Fin[i, a] = w.F[i, a]
                w.g[i, a] = 0.0
