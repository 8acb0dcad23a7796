"""The state of a run at one instant, and space for what follows from it."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.problem import SLIP, Codes, Floats, Problem, Start

#: What can be wrong with a state: see State.fault.
NEGATIVE, INFINITE = 1.0, 2.0


class State(Layout):
    """The state of a run with all that follows from it; ``t`` time, ``n`` (m,) directions of slip.

    ``a`` (n,) accelerations, ``zd`` (n_z,) rates, ``work`` and ``rate`` (n_c+2,) energies and powers (see ``powers``).
    ``a0`` (m,) relative accelerations without the forces of stuck contacts, ``size`` (m,)
    sums of magnitudes behind g (its round-off), ``wd`` (m,) rates of the prescribed part.
    ``fault``: NEGATIVE where a slip coefficient has turned so, INFINITE where an acceleration has.
    ``low`` (n,): what the last additions to q have lost to round-off.  ``way`` (m,): see ``share``.
    """

    t: float
    q: Floats
    v: Floats
    z: Floats
    zd: Floats
    F: Floats
    N: Floats
    n: Floats
    g: Floats
    a: Floats
    f: Floats
    mode: Codes
    work: Floats
    rate: Floats
    a0: Floats
    size: Floats
    wd: Floats
    J: Floats
    rhs: Floats
    fault: float
    low: Floats
    way: Floats


def state_of(problem: Problem) -> State:
    """An empty state: at the origin, at rest, slipping."""
    n, m, nc, nz = problem.n, problem.m, problem.n_c, problem.n_z
    return State(
        0.0, np.zeros(n), np.zeros(n), np.zeros(nz), np.zeros(nz), np.zeros(m), np.zeros(nc), np.zeros(m),
        np.zeros(m), np.zeros(n), np.zeros(n), np.full(nc, SLIP, np.int8), np.zeros(nc + 2), np.zeros(nc + 2),
        np.zeros(m), np.zeros(m), np.zeros(m), np.zeros(m * m), np.zeros(m), 0.0, np.zeros(n), np.zeros(m),
    )  # fmt: skip


def set_out(y: Any, start: Start) -> None:
    """Bring an empty state, with joints or without, to a start; forces and modes are still to be found."""
    y.t, y.q[:], y.v[:], y.z[:] = start.t, start.q, start.v, start.z
    if start.mode is not None:
        y.mode[:] = start.mode
    if start.direction is not None:
        y.n[:] = start.direction


@kernel
def copy_state(source: State, target: State) -> None:
    """Make ``target`` equal to ``source``."""
    target.t = source.t
    for i in range(source.q.shape[0]):
        target.q[i] = source.q[i]
        target.v[i] = source.v[i]
        target.a[i] = source.a[i]
        target.f[i] = source.f[i]
        target.low[i] = source.low[i]
    for a in range(source.z.shape[0]):
        target.z[a] = source.z[a]
        target.zd[a] = source.zd[a]
    for a in range(source.g.shape[0]):
        target.F[a] = source.F[a]
        target.n[a] = source.n[a]
        target.g[a] = source.g[a]
        target.a0[a] = source.a0[a]
        target.size[a] = source.size[a]
        target.wd[a] = source.wd[a]
    for k in range(source.mode.shape[0]):
        target.N[k] = source.N[k]
        target.mode[k] = source.mode[k]
    for k in range(source.work.shape[0]):
        target.work[k] = source.work[k]
        target.rate[k] = source.rate[k]


@kernel
def swap_state(one: State, other: State) -> None:
    """Exchange two states but for their forces f."""
    one.t, other.t = other.t, one.t
    for a, b in (
        (one.q, other.q),
        (one.v, other.v),
        (one.a, other.a),
        (one.low, other.low),
        (one.z, other.z),
        (one.zd, other.zd),
        (one.F, other.F),
        (one.n, other.n),
        (one.g, other.g),
        (one.a0, other.a0),
        (one.size, other.size),
        (one.wd, other.wd),
        (one.N, other.N),
        (one.work, other.work),
        (one.rate, other.rate),
    ):
        exchange(a, b)
    for k in range(one.mode.shape[0]):
        mode = one.mode[k]
        one.mode[k] = other.mode[k]
        other.mode[k] = mode


@kernel
def exchange(a: Floats, b: Floats) -> None:
    """Exchange the entries of two arrays."""
    for i in range(a.shape[0]):
        kept = a[i]
        a[i] = b[i]
        b[i] = kept
