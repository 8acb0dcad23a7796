"""The constraints at a state as a matrix, and the least change that satisfies them: before a run, in scipy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from fricmb.integrate.implicit.equations.instants import constraints
from fricmb.integrate.implicit.scene.pattern import of_pattern
from fricmb.integrate.implicit.scene.problem_structs import mech_of
from fricmb.integrate.implicit.scene.structure import mechanism_of
from fricmb.integrate.implicit.workspace import evaluation
from fricmb.integrate.mechanism import Mechanism
from fricmb.integrate.problem import Floats, Ints, Problem

#: What keeps the equations regular where constraints depend on one another, beside rows of length 1.
REGULAR = 1e-10
#: Corrections that take its effect away again: a factor REGULAR / sigma^2 each, sigma the singular values.
REFINED = 4
#: Up to so many unknowns dense matrices and factors cost less than the making of sparse ones.
DENSE = 150


@dataclass(frozen=True, kw_only=True)
class Constrained:
    """Constraints phi (m,), their rates (m,) and Jacobian G (m, n), sparse where it is large, at a state."""

    phi: Floats
    rate: Floats
    G: Any


def constraints_at(problem: Problem, t: float, q: Floats, v: Floats) -> Constrained:
    """The constraints at a state."""
    mechanism, mech, nc = mechanism_of(problem), mech_of(problem), problem.n_c
    m = mechanism.n_rows
    phi, rate = np.zeros(m), np.zeros(m)
    count = of_pattern(problem, "entries of G", lambda: _entries(mech, mechanism))
    row, column, value = np.zeros(count, np.int64), np.zeros(count, np.int64), np.zeros(count)
    F, N, g = np.zeros(problem.m), np.zeros(nc), np.zeros(problem.m)
    q, v = (np.array(x, dtype=float) for x in (q, v))
    with evaluation(problem) as workspace:
        used = constraints(mech, workspace.k, float(t), q, v, np.zeros(m), F, N, g, phi, rate, row, column, value)
    if m + problem.n <= DENSE:
        G = np.zeros((m, problem.n))
        np.add.at(G, (row[:used], column[:used]), value[:used])
        return Constrained(phi=phi, rate=rate, G=G)
    from scipy.sparse import csr_matrix

    entries = (value[:used], (row[:used], column[:used]))
    return Constrained(phi=phi, rate=rate, G=csr_matrix(entries, shape=(m, problem.n)))


def dense(G: Any) -> Floats:
    """A matrix as an array."""
    found: Floats = G if isinstance(G, np.ndarray) else G.toarray()
    return found


def _entries(mech: Any, m: Mechanism) -> int:
    """Upper bound of the number of entries of G, repeated ones included."""
    table, joint = mech.joint.table, mech.joint
    dofs = np.append(np.diff(mech.place.y_start), 0)
    index = np.asarray(table.form_index) - 1
    width = dofs[np.where((index >= 0) & (index < m.n_y), index, -1)]
    total = np.concatenate(([0], np.cumsum(width)))
    first, n_x = np.asarray(table.x_start[:-1]), np.asarray(joint.n_x)
    start = np.asarray(table.form_start)
    per_joint = total[start[first + n_x]] - total[start[first]]
    return int((per_joint * np.diff(joint.row)).sum()) + 1


def names_of_rows(m: Mechanism, rows: Ints) -> list[str]:
    """Joints that own the rows, each once; what ties one body together only where there is nothing else."""
    owner = m.joints.owners(rows)
    joints = owner[m.joints.inner[owner] == 0]
    return list(dict.fromkeys(m.joints.names[i] for i in (joints if joints.size else owner)))


def unit_rows(G: Any, weight: Floats) -> tuple[Any, Floats]:
    """``G diag(weight)`` with rows of length 1, and their lengths (1 for a row of zeros)."""
    if isinstance(G, np.ndarray):
        scaled = G * weight
        length = np.sqrt((scaled**2).sum(axis=1))
        length = np.where(length > 0.0, length, 1.0)
        return scaled / length[:, None], length
    from scipy.sparse import csr_matrix

    row = np.repeat(np.arange(G.shape[0]), np.diff(G.indptr))
    values = G.data * weight[G.indices]
    length = np.sqrt(np.bincount(row, values**2, minlength=G.shape[0]))
    length = np.where(length > 0.0, length, 1.0)
    return csr_matrix((values / length[row], G.indices, G.indptr), shape=G.shape), length


class Least:
    """Changes x of least norm with ``J x = r``, in the sense of least squares where J (m, n) lacks rank; rows of 1."""

    def __init__(self, J: Any) -> None:
        from scipy.linalg.lapack import dgetrf
        from scipy.sparse import bmat, eye
        from scipy.sparse.linalg import splu

        m, n = J.shape
        self.J = J
        self._solve: Callable[[Floats], Floats]
        if m + n <= DENSE:
            rows = dense(J)
            matrix = np.zeros((n + m, n + m), order="F")
            matrix[:n, n:], matrix[n:, :n] = rows.T, rows
            matrix.ravel("K")[:: n + m + 1] = np.append(np.ones(n), np.full(m, -REGULAR))
            self._solve = partial(_solved, *dgetrf(matrix, overwrite_a=True)[:2])
        else:
            self._solve = splu(bmat([[eye(n), J.T], [J, -REGULAR * eye(m)]], format="csc")).solve

    def change(self, r: Floats) -> Floats:
        """The change x (n,) for a right-hand side (m,)."""
        n = self.J.shape[1]
        x = np.zeros(n)
        for _ in range(REFINED):
            x += self._solve(np.concatenate([np.zeros(n), r - self.J @ x]))[:n]
        return x

    def weakest(self) -> Floats:
        """The unit vector (m,) for which ``|J^T y|`` is least, by inverse iteration."""
        m, n = self.J.shape
        y = np.random.default_rng(1).standard_normal(m)
        for _ in range(20):
            y = self._solve(np.concatenate([np.zeros(n), y / np.linalg.norm(y)]))[n:]
        unit: Floats = y / np.linalg.norm(y)
        return unit


def _solved(factors: Floats, pivots: Ints, r: Floats) -> Floats:
    """The solution for one right-hand side."""
    from scipy.linalg.lapack import dgetrs

    found: Floats = dgetrs(factors, pivots, r)[0]
    return found
