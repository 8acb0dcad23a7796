"""Recording: a row per accepted step and per stage, a row before and after every transition."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.compile.room import room
from fricmb.integrate.model.state import State
from fricmb.integrate.problem import EVENT_SLIP, EVENT_STICK, Codes, Codes2, Floats, Floats2, Ints, Problem
from fricmb.integrate.run.room_protocols import Events

#: What a row is: a stage inside a step, the end of a step, the left and the right side of a transition.
INSIDE, STEP, BEFORE, AFTER = 0, 1, 2, 3


class Rows(Layout):
    """Space for rows: [t, q, v, a, z, z', F, N, work, rate], kinds and modes; ``used`` (2,) rows and transitions.

    ``event`` (n_e, 3): time, contact, kind.
    """

    values: Floats2
    kind: Codes
    mode: Codes2
    event: Floats2
    used: Ints


def widths(problem: Problem) -> list[int]:
    """Widths of the blocks of a row."""
    n, nc = problem.n, problem.n_c
    return [1, n, n, n, problem.n_z, problem.n_z, problem.m, nc, nc + 2, nc + 2]


def rows(problem: Problem, capacity: int, further: int = 0) -> Rows:
    """Empty space for ``capacity`` rows with ``further`` columns behind."""
    kinds = np.zeros(capacity, np.int8)
    modes = np.zeros((capacity, problem.n_c), np.int8)
    values = np.zeros((capacity, sum(widths(problem)) + further))
    # however few rows are: those of a step and of a breakpoint at its end
    events = np.zeros((capacity + 2 * problem.n_c + 2, 3))
    return room(Rows(values, kinds, modes, events, np.zeros(2, np.int64)))


@kernel
def put(row: Floats, at: int, values: Floats) -> int:
    """Copy values into a row from ``at`` on; returns the place behind."""
    for i in range(values.shape[0]):
        row[at + i] = values[i]
    return int(at + values.shape[0])


@kernel
def record(out: Rows, y: State, kind: int) -> None:
    """Add the state as a row."""
    k = out.used[0]
    row = out.values[k]
    row[0] = y.t
    at = put(row, 1, y.q)
    at = put(row, at, y.v)
    at = put(row, at, y.a)
    at = put(row, at, y.z)
    at = put(row, at, y.zd)
    at = put(row, at, y.F)
    at = put(row, at, y.N)
    at = put(row, at, y.work)
    put(row, at, y.rate)
    out.kind[k] = kind
    for i in range(y.mode.shape[0]):
        out.mode[k, i] = y.mode[i]
    out.used[0] = k + 1


#: Part of the time within which transitions are one instant (how near they are located says ``locate``).
SAME_INSTANT = 1e-14


@kernel
def record_event(out: Events, t: float, contact: int, kind: int) -> None:
    """Add a transition; a slip that ends at the instant at which it begins has not been one, and is taken back."""
    k = out.used[1]
    last = k - 1
    while kind == EVENT_STICK and last >= 0 and t - out.event[last, 0] <= SAME_INSTANT * abs(t):
        if out.event[last, 1] == contact:
            if out.event[last, 2] != EVENT_SLIP:
                break
            for i in range(last, k - 1):
                out.event[i] = out.event[i + 1]
            out.used[1] = k - 1
            return
        last -= 1
    out.event[k, 0] = t
    out.event[k, 1] = contact
    out.event[k, 2] = kind
    out.used[1] = k + 1
