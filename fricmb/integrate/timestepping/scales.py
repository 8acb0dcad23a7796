"""What errors are measured by, in each of the parts of a problem that touch nowhere."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.exchange import with_arrays
from fricmb.integrate.problem import Floats, Ints
from fricmb.integrate.timestepping.room import Run


def with_parts(run: Run, part: Ints | None) -> Run:
    """The same run, told which part each degree of freedom (n,) belongs to; None: it is one."""
    if part is None:
        return run
    # a contact belongs where its first degree of freedom does; one without any touches no motion
    contact = np.repeat(_owners(run), np.diff(run.w_start))
    part_of = np.zeros(len(run.row) - 1, dtype=np.int64)
    part_of[contact[::-1]] = part[run.w_dof[::-1]]
    count = int(part.max(initial=0)) + 1
    return with_arrays(
        run, part=part.astype(np.int64), part_of=part_of, largest=np.zeros((count, 3)),
        events=np.zeros(count, dtype=np.int64),
    )  # fmt: skip


def _owners(run: Run) -> Ints:
    """Contact (m,) of each row."""
    found: Ints = np.repeat(np.arange(len(run.row) - 1), np.diff(run.row))
    return found


def _largest(part: Ints, values: Floats, count: int) -> Floats:
    """The largest value in each part, 0 where there is none."""
    found = np.zeros(count)
    np.maximum.at(found, part, values)
    return found


def add_floors(run: Run, span: float) -> None:
    """Scales of velocity and position that friction brings about in a radian of the fastest mode, a tenth of them."""
    n, count = len(run.load), len(run.largest)
    rows = np.repeat(np.arange(n), np.diff(run.start))
    mass = np.bincount(rows, run.mass * (rows == run.column), n)
    fastest = np.sqrt(_largest(run.part, np.bincount(rows, np.abs(run.stiff), n) / mass, count))
    time = np.full(count, 0.1 * span)
    springs = fastest > 0.0
    time[springs] = np.minimum(time[springs], 1.0 / fastest[springs])
    normal = np.where(run.var == 1, 0.0, run.N)
    contact = np.repeat(_owners(run), np.diff(run.w_start))
    push = np.zeros(n)
    np.maximum.at(push, run.w_dof, np.abs(run.w_coef) * (np.abs(run.mu_s) * normal)[contact])
    largest = _largest(run.part, push / mass, count)
    run.floor_v[:] += (0.1 * largest * time)[run.part]
    run.floor_q[:] += (0.1 * largest * time**2)[run.part]
