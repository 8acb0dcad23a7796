"""The mechanism of any problem: that of one with joints or bodies that turn, or a linear structure as one without."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricmb.integrate.csr import Csr
from fricmb.integrate.mechanism import APART, Entries, Joints, Mechanism, Places
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import Codes, Ints, Problem, Templates


def mechanism_of(problem: Problem) -> Mechanism:
    """The mechanism of a problem; a linear structure is one whose G has no rows."""
    if problem.mechanism is not None:
        return problem.mechanism
    return once_per(problem, "without joints", lambda: _without_joints(problem))


def _without_joints(problem: Problem) -> Mechanism:
    linear = problem.linear
    return Mechanism(
        n=problem.n,
        n_places=0,
        M=_entries(linear.csr("M")),
        K=_entries(linear.csr("Kx")),
        C=_entries(linear.csr("Cx")),
        B=_entries(linear.csr("B")),
        f=linear.fx,
        places=Places(),
        joints=Joints(),
        slip=_slip_forms(problem),
    )


def _entries(matrix: Csr) -> Entries:
    """Those of a matrix that are not 0."""
    some = np.flatnonzero(matrix.value)
    return Entries(row=matrix.rows[some], column=matrix.index[some], value=matrix.value[some])


def _slip_forms(problem: Problem) -> Templates:
    """Slip coordinate and slip velocity in every row, as forms in X = [t, q, v, u, u']."""
    contacts, n, n_u, rows = problem.contacts, problem.n, problem.n_u, problem.m
    W, Wu = contacts.csr("W").transposed(), contacts.csr("Wu")
    # of each row first the entries of q and u, then those of v and u'
    row = np.concatenate([2 * W.rows, 2 * Wu.rows, 2 * W.rows + 1, 2 * Wu.rows + 1])
    index = np.concatenate([1 + W.index, 1 + 2 * n + Wu.index, 1 + n + W.index, 1 + 2 * n + n_u + Wu.index])
    coefficient = np.concatenate([W.value, -Wu.value, W.value, -Wu.value])
    order = np.argsort(row, kind="stable")
    return Templates(
        address=np.zeros(problem.n_c, np.int64),
        p_start=np.zeros(problem.n_c + 1, np.int64),
        x_start=2 * np.asarray(contacts.row, np.int64),
        form_start=_starts(np.bincount(row, minlength=2 * rows)),
        form_index=index[order].astype(np.int64),
        form_coefficient=coefficient[order],
        form_constant=np.zeros(2 * rows),
    )


def _starts(counts: Ints) -> Ints:
    return np.concatenate(([0], np.cumsum(counts))).astype(np.int64)


def with_open(problem: Problem, opened: Codes) -> Problem:
    """The problem with some of the joints that may open open (n_j,), the others held; on arrays of its own."""
    m = mechanism_of(problem)
    dropped, may = m.joints.dropped.copy(), m.joints.hands_over != 0
    rows = m.joints.row[:-1][may]
    dropped[rows] = np.where(opened[may] != 0, APART, np.where(dropped[rows] == APART, 0, dropped[rows]))
    return replace(problem, mechanism=replace(m, joints=replace(m.joints, dropped=dropped)))
