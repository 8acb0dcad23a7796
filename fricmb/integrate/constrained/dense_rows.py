"""Slip and loads of contacts as dense rows, where all but the directions of slip is linear while modes stay.

Contacts of an elastic body feel all of its modes: each of their rows is full.  As templates of forms they cost a call
and two lists of indices each; as columns of one matrix they cost what they multiply.
"""

from __future__ import annotations

import itertools

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.compile.long_loops import long_loops
from fricmb.integrate.mechanism import Mechanism
from fricmb.integrate.model.table_values import evaluate
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import LAW_CONSTANT, NORMAL_CONSTANT, NORMAL_LAW, Floats, Floats2, Problem


class DenseRows(Layout):
    """Rows of slip, then of distances, r = m + n_c of them: ``of`` (n, r) by coordinates, ``on`` (r, n) turned.

    Slip velocities: ``g = of' v + by_u u' + offset``.  Distances: ``e = of' q + by_u u``, and loads ``N = offset +
    stiff e + damp e'`` (``stiff``, ``damp`` (n_c,)).  ``inverse`` (n,) of the diagonal mass matrix; ``mobility`` (m, m)
    slip accelerations by unit forces.  ``stamp``: a number of its own.  Without rows where a scene is not of this kind.
    """

    of: Floats2
    on: Floats2
    by_u: Floats2
    offset: Floats
    stiff: Floats
    damp: Floats
    inverse: Floats
    mobility: Floats2
    stamp: int


@block
@long_loops
def put_path(of: Floats2, x: Floats, out: Floats) -> None:
    """``of' x``, column by column."""
    out[:] = 0.0
    for i in range(x.shape[0]):
        share, line = x[i], of[i]
        for a in range(out.shape[0]):
            out[a] += share * line[a]


@block
@long_loops
def add_forces(on: Floats2, force: Floats, f: Floats) -> None:
    """Add forces (r,) along all rows."""
    for a in range(force.shape[0]):
        if force[a] != 0.0:
            share, line = force[a], on[a]
            for i in range(f.shape[0]):
                f[i] += share * line[i]


_stamps = itertools.count(1)

#: Rows of contacts from which on dense ones pay, and the part of them that is not 0; numbers in a matrix of them.
FEW, FULL, MOST = 4, 0.5, 1e6


def dense_rows(problem: Problem, m: Mechanism) -> DenseRows:
    """The rows of a problem, or none."""
    return once_per(problem, "dense rows", lambda: _made(problem, m) or _none())


def has_dense_rows(problem: Problem, m: Mechanism) -> bool:
    """Whether the problem is one of many rows whose equations are linear while modes stay."""
    return bool(dense_rows(problem, m).inverse.size)


def _none() -> DenseRows:
    empty, flat = np.zeros((0, 0)), np.zeros(0)
    return DenseRows(empty, empty, empty, flat, flat, flat, flat, empty, 0)


def _made(problem: Problem, m: Mechanism) -> DenseRows | None:
    contacts, n, n_u = problem.contacts, problem.n, problem.n_u
    if problem.mechanism is not None or problem.elements.table.address.size or problem.n_z:
        return None
    if problem.m < FEW or n * (problem.m + problem.n_c) > MOST:
        return None
    if (contacts.law != LAW_CONSTANT).any() or (m.M.row != m.M.column).any() or m.least_mass.size:
        return None
    if not (contacts.straight.size and contacts.straight.all()):
        return None
    mass = np.zeros(n)
    mass[m.M.row] = m.M.value
    W, Wu = np.asarray(contacts.W), np.asarray(contacts.Wu)
    if np.count_nonzero(W) < FULL * W.size or not (mass > 0.0).all():
        return None
    loads = _loads(problem)
    if loads is None:
        return None
    P, Pu, offset, stiff, damp = loads
    of = np.hstack([W, P.T])
    return DenseRows(
        np.ascontiguousarray(of), np.ascontiguousarray(of.T), np.vstack([-Wu.reshape(problem.m, n_u), Pu]),
        np.concatenate([-contacts.w, offset]), stiff, damp, 1.0 / mass, np.ascontiguousarray(W.T @ (W / mass[:, None])),
        next(_stamps),
    )  # fmt: skip


def _loads(problem: Problem) -> tuple[Floats, Floats, Floats, Floats, Floats] | None:
    """Distances by q and u, loads at distance 0, and their slopes; None where they are not those of springs."""
    contacts, n, n_u = problem.contacts, problem.n, problem.n_u
    table = contacts.normal_table
    P, Pu = np.zeros((problem.n_c, n)), np.zeros((problem.n_c, n_u))
    offset, stiff, damp = np.where(contacts.normal == NORMAL_CONSTANT, contacts.N, 0.0), *np.zeros((2, problem.n_c))
    for c in np.flatnonzero(contacts.normal == NORMAL_LAW).tolist():
        value, by_e, by_rate, *_ = (float(x[0]) for x in evaluate(table, c, np.zeros((1, 2)), 5))
        if value != contacts.N0[c]:
            return None  # what bodies feel beside its potential would be work of nobody
        x0 = int(table.x_start[c])
        X = np.zeros((2, 1 + 2 * n + 2 * n_u))
        for row in range(2):
            form = slice(int(table.form_start[x0 + row]), int(table.form_start[x0 + row + 1]))
            np.add.at(X[row], table.form_index[form], table.form_coefficient[form])
        distance, rate = (np.split(line[1:], (n, 2 * n, 2 * n + n_u)) for line in X)
        P[c], Pu[c] = distance[0], distance[2]
        same = np.array_equal(P[c], rate[1]) and np.array_equal(Pu[c], rate[3])
        if not same or np.count_nonzero(X) != 2 * np.count_nonzero(P[c]) + 2 * np.count_nonzero(Pu[c]):
            return None
        if table.form_constant[x0 + 1] != 0.0:
            return None
        stiff[c], damp[c] = by_e, by_rate
        offset[c] = value + by_e * table.form_constant[x0]
    return P, Pu, offset, stiff, damp
