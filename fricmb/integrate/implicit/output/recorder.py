"""Rows of a run: the values of every step at its start and its stages."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.compile.room import room
from fricmb.integrate.implicit.equations.forces import is_open
from fricmb.integrate.implicit.scene.control import Control
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import State
from fricmb.integrate.implicit.scene.structure import mechanism_of
from fricmb.integrate.implicit.stages.stages import Stages
from fricmb.integrate.problem import Codes2, Floats2, Floats3, Ints, Problem


class Record(Layout):
    """Space for steps.

    ``span`` (k, 2): start and length; ``values`` (k, s+1, 2n + n_z + n_c + 2): [q, v, z, work] at 0, c; ``force``
    (k, m + 2 m_p): [lam, F, n] at the start; ``ahead`` (k, m_p): n at the end; ``mode`` (k, n_c);
    ``opened`` (k, n_j) 1 for joints without contact;
    ``after`` (k,) 1 where a transition follows the step;
    ``event`` (n_e, 3): time, contact, kind; ``used`` (2,) steps and events.
    """

    span: Floats2
    values: Floats3
    force: Floats2
    ahead: Floats2
    mode: Codes2
    opened: Codes2
    after: Ints
    event: Floats2
    used: Ints


def width(problem: Problem) -> int:
    """Numbers that are kept of a node."""
    return 2 * problem.n + problem.n_z + problem.n_c + 2


def record_of(problem: Problem, stages: int, capacity: int) -> Record:
    """Empty space for ``capacity`` steps."""
    m, nc = mechanism_of(problem), problem.n_c
    return room(Record(
        np.zeros((capacity, 2)), np.zeros((capacity, stages + 1, width(problem))),
        np.zeros((capacity, m.n_rows + 2 * problem.m)), np.zeros((capacity, problem.m)),
        np.zeros((capacity, nc), np.int8), np.zeros((capacity, len(mechanism_of(problem).joints.port)), np.int8),
        np.zeros(capacity, np.int64), np.zeros((capacity + 8 * nc + 8, 3)), np.zeros(2, np.int64),
    ))  # fmt: skip


@block
def record_step(mech: Mech, out: Record, y: State, end: State, st: Stages, c: Control, h: float) -> None:
    """Add the step from y to end."""
    i = out.used[0]
    n, nz, nw, m, rows = y.q.shape[0], y.z.shape[0], y.work.shape[0], y.lam.shape[0], y.F.shape[0]
    s = st.tab.c.shape[0]
    out.span[i, 0] = y.t
    out.span[i, 1] = h
    out.after[i] = 0
    for j in range(s + 1):
        row = out.values[i, j]
        for a in range(n):
            row[a] = y.q[a] if j == 0 else (end.q[a] if j == s else st.Q[j - 1, a])
            row[n + a] = y.v[a] if j == 0 else (end.v[a] if j == s else st.V[j - 1, a])
        for a in range(nz):
            row[2 * n + a] = y.z[a] if j == 0 else st.z[j - 1, a]
        for a in range(nw):
            value = y.work[a]
            if j > 0:
                for b in range(s):
                    value += h * st.tab.A[j - 1, b] * c.power[b, a]
            row[2 * n + nz + a] = value
    for a in range(m):
        out.force[i, a] = y.lam[a]
    for a in range(rows):
        out.force[i, m + a] = y.F[a]
        out.force[i, m + rows + a] = y.n[a]
        out.ahead[i, a] = end.n[a]
    for a in range(y.mode.shape[0]):
        out.mode[i, a] = y.mode[a]
    for j in range(mech.joint.port.shape[0]):
        out.opened[i, j] = 1 if is_open(mech, j) else 0
    out.used[0] = i + 1


@kernel
def crowded(out: Record, n_c: int) -> bool:
    """Whether another step, its transitions and those of a breakpoint at its end might not find space."""
    return bool(out.used[0] + 2 > out.span.shape[0] or out.used[1] + 2 * n_c + 2 > out.event.shape[0])


@block
def copy_state(a: State, b: State) -> None:
    """Put state a into b."""
    b.t = a.t
    for source, target in ((a.q, b.q), (a.v, b.v), (a.a, b.a), (a.z, b.z), (a.lam, b.lam)):
        for i in range(source.shape[0]):
            target[i] = source[i]
    for source, target in ((a.F, b.F), (a.N, b.N), (a.g, b.g), (a.ga, b.ga), (a.n, b.n), (a.zd, b.zd)):
        for i in range(source.shape[0]):
            target[i] = source[i]
    for i in range(a.mode.shape[0]):
        b.mode[i] = a.mode[i]
    for i in range(a.work.shape[0]):
        b.work[i] = a.work[i]
        b.rate[i] = a.rate[i]
