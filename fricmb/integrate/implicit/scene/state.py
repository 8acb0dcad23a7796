"""The state of a scene at one instant, and space for its accelerations and reactions."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.band import length_of
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.implicit.equations.jacobian_layers import Layers
from fricmb.integrate.implicit.scene.dense_rows import has_dense_rows
from fricmb.integrate.implicit.scene.problem_structs import mech_of
from fricmb.integrate.implicit.scene.structure import mechanism_of
from fricmb.integrate.problem import Codes, Floats, Floats2, Ints, Pivots, Problem, Start


class State(Layout):
    """``t`` time, q, v, z; what follows: a (n,), lam (m,), F, g, n (m_p,) per row of ports; N, mode (n_c,); zd.

    ``ga`` (m_p,) derivatives of slip velocities; ``work``, ``rate`` (n_c+2,) energies and powers: friction of every
    port, damping, input.
    """

    t: float
    q: Floats
    v: Floats
    z: Floats
    a: Floats
    lam: Floats
    F: Floats
    N: Floats
    g: Floats
    ga: Floats
    zd: Floats
    mode: Codes
    n: Floats
    work: Floats
    rate: Floats


def state_of(problem: Problem) -> State:
    """An empty state: at the origin, at rest, slipping."""
    m, nc, rows, nz = mechanism_of(problem), problem.n_c, problem.m, problem.n_z
    return State(
        0.0, np.zeros(m.n), np.zeros(m.n), np.zeros(nz), np.zeros(m.n), np.zeros(m.n_rows), np.zeros(rows),
        np.zeros(nc), np.zeros(rows), np.zeros(rows), np.zeros(nz), np.ones(nc, np.int8), np.zeros(rows),
        np.zeros(nc + 2), np.zeros(nc + 2),
    )  # fmt: skip


def set_out(y: State, start: Start) -> None:
    """Bring an empty state to a start; forces and modes are still to be found."""
    y.t, y.q[:], y.v[:], y.z[:] = start.t, start.q, start.v, start.z
    if start.mode is not None:
        y.mode[:] = start.mode
    if start.direction is not None:
        y.n[:] = start.direction


class Held(Layout):
    """The first ``count`` of ``row`` (m,) stick: ``factor`` (m, m) of their mobility, ``side`` (m,) space.

    ``stamp``: of the rows that the factors are of, 0 where there are none.
    """

    stamp: int
    count: int
    row: Ints
    factor: Floats2
    side: Floats


def held_of(rows: int) -> Held:
    """Space for so many."""
    return Held(0, 0, np.zeros(rows, np.int64), np.zeros((rows, rows)), np.zeros(rows))


class Instant(Layout):
    """What is needed to solve at one instant: the matrix and its factors, right-hand side (size,), rates of X.

    ``other`` (n,): accelerations to compare with, sizes of groups.  ``mode`` (n_c,) of the factors, where they are
    ``kept`` (see ``instant_matrix``).  ``held`` what sticks at dense rows.
    """

    L: Layers
    ab: Floats
    pivots: Pivots
    r: Floats
    x: Floats
    ddy: Floats
    other: Floats
    mode: Codes
    kept: int
    held: Held


def instant_of(problem: Problem) -> Instant:
    """Arrays for the problem."""
    order = mech_of(problem).order
    size, length = len(order.place), length_of(order.sizes)
    layers = Layers(np.zeros(length), np.zeros(length), np.zeros(length))
    m = mechanism_of(problem)
    return Instant(
        layers, np.zeros(length), np.zeros(size, np.int32), np.zeros(size), np.zeros(size), np.zeros(m.n_y),
        np.zeros(m.n), np.zeros(problem.n_c, np.int8), 0, held_of(problem.m if has_dense_rows(problem, m) else 0),
    )  # fmt: skip
