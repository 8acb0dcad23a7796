"""What impulses do to velocities: the mass matrix with what holds both ways, solved for impulses along given rows."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.integrate.mechanism import Mechanism
from fricmb.integrate.problem import Floats

#: Unknowns up to which dense matrices are solved.
DENSE = 400


class ImpulseMatrix:
    """Of a mechanism, whose mass matrix is constant."""

    def __init__(self, mechanism: Mechanism) -> None:
        self._entries, self._n = mechanism.M, mechanism.n

    def momentum(self, v: Floats) -> Floats:
        """``M v`` (n,)."""
        found = np.zeros(self._n)
        np.add.at(found, self._entries.row, self._entries.value * v[self._entries.column])
        return found

    def answers(self, held: Floats, rows: Floats) -> tuple[Floats, Floats]:
        """Changes of velocities (n, r) by unit impulses along rows (r, n), and impulses (m, r) of rows held (m, n)."""
        n, m = self._n, len(held)
        right = np.zeros((n + m, len(rows)))
        right[:n] = rows.T
        x = self._dense(held, right) if n + m <= DENSE else self._sparse(held, right)
        return x[:n], -x[n:]

    def _dense(self, held: Floats, right: Floats) -> Floats:
        n, m = self._n, len(held)
        K = np.zeros((n + m, n + m))
        np.add.at(K, (self._entries.row, self._entries.column), self._entries.value)
        K[:n, n:], K[n:, :n] = held.T, held
        return np.asarray(np.linalg.solve(K, right), dtype=float)

    def _sparse(self, held: Floats, right: Floats) -> Floats:
        from scipy.sparse import bmat, csc_matrix
        from scipy.sparse.linalg import splu

        M = csc_matrix((self._entries.value, (self._entries.row, self._entries.column)), shape=(self._n, self._n))
        G = csc_matrix(held)
        blocks: Any = [[M, G.T], [G, None]]
        return np.asarray(splu(bmat(blocks, format="csc")).solve(right), dtype=float)
