"""Loops of contacts: while all of one stick, only sums of their forces are determined."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.friction_cone import friction_size
from fricmb.integrate.problem import Floats, Ints, Problem
from fricmb.integrate.timestepping.layout import CAUGHT, HELD
from fricmb.integrate.timestepping.room import Run

#: More rows of contacts than this are not looked at: the search costs their cube.
MANY = 200
#: Part of its limit that a contact has left which may hold more: beyond what forces change by in a step.
SPARE = 0.05


def loops_of(problem: Problem) -> tuple[Ints, Ints]:
    """The loop (n_c,) that each contact is in, or -1, and how many rows of each are independent (n_loops,)."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    loop, none = np.full(problem.n_c, -1, dtype=np.int64), np.zeros(0, dtype=np.int64)
    if not 2 <= problem.m <= MANY:
        return loop, none
    entries = problem.contacts.csr("W")
    touched, dof = np.unique(entries.rows, return_inverse=True)
    W = np.zeros((problem.m, touched.size))
    W[entries.index, dof] = entries.value
    U, rank = _left(W)
    if rank == problem.m:
        return loop, none
    # rows that take part in the same dependences
    within = np.abs(U[:, rank:] @ U[:, rank:].T) > 1e-8
    _, label = connected_components(csr_array(within.astype(float)), directed=False)
    owner = problem.contacts.of_row
    ranks: list[int] = []
    for number in np.unique(label[within.diagonal()]):
        own = label == number
        loop[owner[own]] = len(ranks)
        ranks.append(_left(W[own])[1])
    return loop, np.array(ranks, dtype=np.int64)


def _left(W: Floats) -> tuple[Floats, int]:
    """Left singular vectors (m, m) of rows W (m, .) scaled to one length, and their rank."""
    size = np.linalg.norm(W, axis=1, keepdims=True)
    # of a factor that has the same: rows are few, but may be long
    factor = np.linalg.qr((W / np.where(size > 0.0, size, 1.0)).T).R.T
    U, s, _ = np.linalg.svd(factor, full_matrices=True)
    return U, int(np.count_nonzero(s > 1e-10 * s.max(initial=0.0)))


@kernel
def count_held(run: Run, two: int) -> None:
    """How many rows of each loop are held in this step, and how many of its contacts could hold more."""
    if run.held.shape[0] == 0:
        return
    for k in range(run.held.shape[0]):
        run.held[k] = 0
        run.spare[k] = 0
    for c in range(run.status.shape[0]):
        k = run.loop[c]
        if k >= 0 and (run.status[c] == HELD or run.status[c] == CAUGHT):
            run.held[k] += run.row[c + 1] - run.row[c]
            if friction_size(run.row, c, run.F[two]) < (1.0 - SPARE) * run.brake[c]:
                run.spare[k] += 1


@kernel
def shares(run: Run, c: int) -> bool:
    """Whether others may take over what a contact cannot hold: more rows of its loop are held than are independent."""
    k = run.loop[c]
    return bool(k >= 0 and run.held[k] > run.rank[k] and run.spare[k] > 0)
