"""The iteration matrix dF/dy + c dF/dyp: storage, factors, solution.  Dense, banded (LAPACK) or sparse (SuperLU).

Both Jacobians and the matrix are flat arrays of one layout; a *pattern* lists, column by column, the rows that may be
other than 0 and where they stand, so that whoever fills the Jacobians need not know the layout.
"""

from __future__ import annotations

import warnings
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse
from scipy.linalg import lapack
from scipy.sparse.linalg import splu

from fricmb.errors import ArgumentError
from fricmb.integrate.problem import Floats

Ints = np.ndarray[Any, np.dtype[np.int64]]


@dataclass(frozen=True, kw_only=True)
class Pattern:
    """Which entries exist: ``rows[start[j]:start[j + 1]]`` of column j, kept at ``place`` in the flat storage.

    ``groups``: columns that share no row, one array for each group; finite differences perturb them together.
    """

    n: int
    size: int
    start: Ints
    rows: Ints
    place: Ints
    groups: tuple[Ints, ...]


class Matrix(ABC):
    """Storage of both Jacobians and factors of their combination."""

    def __init__(self, pattern: Pattern) -> None:
        self.pattern = pattern
        self.dy = np.zeros(pattern.size)
        self.dyp = np.zeros(pattern.size)
        self.store = np.zeros(pattern.size)
        self.columns = np.repeat(np.arange(pattern.n), np.diff(pattern.start))

    @abstractmethod
    def factor(self, c: float) -> bool:
        """Factor dF/dy + c dF/dyp; False if it is singular or not finite."""

    @abstractmethod
    def solve(self, right: Floats) -> None:
        """Solve in place."""

    def as_sparse(self, values: Floats) -> Any:
        """One of the Jacobians as a scipy sparse array."""
        p = self.pattern
        return sparse.csc_array((values[p.place], (p.rows, self.columns)), shape=(p.n, p.n))

    def put(self, values: Floats, given: Any, name: str) -> None:
        """Copy a user's dense or sparse Jacobian into the storage.

        Raises
        ------
        ArgumentError
            Its shape is not (n, n), or it has entries outside the pattern.
        """
        p = self.pattern
        is_sparse = sparse.issparse(given)
        try:
            matrix: Any = sparse.csc_array(given) if is_sparse else np.asarray(given, dtype=float)
        except (TypeError, ValueError):
            raise ArgumentError(f"`jac` must return two matrices of numbers; {name} is none.") from None
        if matrix.shape != (p.n, p.n):
            raise ArgumentError(f"`jac` must return two matrices of shape ({p.n}, {p.n}); {name} is {matrix.shape}.")
        if is_sparse:
            matrix.sum_duplicates()
            self._put_sparse(values, matrix, name)
        else:
            values[p.place] = matrix[p.rows, self.columns]

    def _put_sparse(self, values: Floats, entries: Any, name: str) -> None:
        p = self.pattern
        values[:] = 0.0
        columns = np.repeat(np.arange(p.n), np.diff(entries.indptr))
        keys, wanted = self.columns * p.n + p.rows, columns * p.n + entries.indices
        at = np.searchsorted(keys, wanted)
        found = (at < len(keys)) & (keys[np.minimum(at, len(keys) - 1)] == wanted)
        if not found.all() and np.any(entries.data[~found] != 0.0):
            k = int(np.flatnonzero(~found & (entries.data != 0.0))[0])
            where = f"[{entries.indices[k]}, {columns[k]}]"
            raise ArgumentError(f"{name} has an entry at {where}, outside the sparsity or bandwidth that was given.")
        values[p.place[at[found]]] = entries.data[found]


class Dense(Matrix):
    """Full columns."""

    def __init__(self, pattern: Pattern) -> None:
        super().__init__(pattern)
        self.square = self.store.reshape(pattern.n, pattern.n)
        self.pivots = np.zeros(pattern.n, dtype=np.int32)

    def factor(self, c: float) -> bool:
        np.multiply(self.dyp, c, out=self.store)
        self.store += self.dy
        if not np.isfinite(self.store.sum()):
            return False
        _, self.pivots, info = lapack.dgetrf(self.square.T, overwrite_a=1)
        return bool(info == 0)

    def solve(self, right: Floats) -> None:
        x, _ = lapack.dgetrs(self.square.T, self.pivots, right, overwrite_b=1)
        if x is not right:
            right[:] = x


class Banded(Matrix):
    """Columns of the band, with the space that LAPACK wants above."""

    def __init__(self, pattern: Pattern, lower: int, upper: int) -> None:
        super().__init__(pattern)
        self.lower, self.upper = lower, upper
        self.band = self.store.reshape(pattern.n, 2 * lower + upper + 1)
        self.pivots = np.zeros(pattern.n, dtype=np.int32)

    def factor(self, c: float) -> bool:
        np.multiply(self.dyp, c, out=self.store)
        self.store += self.dy
        if not np.isfinite(self.store.sum()):
            return False
        _, self.pivots, info = lapack.dgbtrf(self.band.T, self.lower, self.upper, overwrite_ab=1)
        return bool(info == 0)

    def solve(self, right: Floats) -> None:
        x, _ = lapack.dgbtrs(self.band.T, self.lower, self.upper, right, self.pivots, overwrite_b=1)
        if x is not right:
            right[:] = x


class Sparse(Matrix):
    """Compressed columns, factored by SuperLU."""

    def factor(self, c: float) -> bool:
        np.multiply(self.dyp, c, out=self.store)
        self.store += self.dy
        if not np.isfinite(self.store.sum()):
            return False
        p = self.pattern
        matrix = sparse.csc_matrix((self.store, p.rows.astype(np.int32), p.start.astype(np.int32)), shape=(p.n, p.n))
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                self.factors = splu(matrix)
        except RuntimeError:
            return False
        return True

    def solve(self, right: Floats) -> None:
        right[:] = self.factors.solve(right)
