"""Sparse matrices of a problem: plain arrays by rows, so that small scenes need no library of their own for them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricmb.integrate.array_cache import cached_by_content

_Floats = NDArray[np.float64]
_Ints = NDArray[np.int64]


def is_diagonal(matrix: _Floats) -> bool:
    """Whether a dense matrix is square and has nothing beside its diagonal."""
    rows, columns = matrix.shape
    return bool(rows == columns and np.count_nonzero(matrix) == np.count_nonzero(np.diagonal(matrix)))


@dataclass(frozen=True)
class Csr:
    """A matrix by compressed rows.

    Attributes
    ----------
    shape : (int, int)
    start, index, value : (rows+1,) int64, (nnz,) int64, (nnz,)
        Row i has the entries ``value[start[i]:start[i+1]]`` in the columns ``index[...]``, rising.
    """

    shape: tuple[int, int]
    start: _Ints
    index: _Ints
    value: _Floats

    @classmethod
    def of_entries(cls, rows: Any, columns: Any, values: Any, shape: tuple[int, int]) -> Csr:
        """From places and values; entries of one place are added up in the order given."""
        i, j = np.asarray(rows, dtype=np.int64), np.asarray(columns, dtype=np.int64)
        v = np.asarray(values, dtype=float)
        order, place, start, index = _sorted(i, j, shape)
        total = np.bincount(place, v[order], len(index)) if len(v) else np.zeros(0)
        return cls(shape, start, index, np.asarray(total, dtype=float))

    @classmethod
    def of_dense(cls, matrix: Any) -> Csr:
        """The non-zeros of a dense matrix."""
        dense = np.asarray(matrix, dtype=float)
        rows, columns = np.nonzero(dense)
        shape = dense.shape[0], dense.shape[1]
        return cls(shape, _starts(rows, shape[0]), columns, dense[rows, columns])

    @cached_property
    def rows(self) -> _Ints:
        """Row of every entry."""
        return _rows(self.start)

    def dense(self) -> _Floats:
        """All of it.

        Raises
        ------
        MemoryError
            Above some 4 GB: nothing that takes large scenes may ask for this.
        """
        if self.shape[0] * self.shape[1] > 5e8:
            raise MemoryError(f"a matrix of {self.shape[0]} x {self.shape[1]} was requested as a dense one")
        full = np.zeros(self.shape)
        full[self.rows, self.index] = self.value
        return full

    def transposed(self) -> Csr:
        """Rows and columns exchanged."""
        return Csr.of_entries(self.index, self.rows, self.value, (self.shape[1], self.shape[0]))

    def block(self, rows: slice, columns: slice) -> Csr:
        """A contiguous part."""
        (r0, r1, _), (c0, c1, _) = rows.indices(self.shape[0]), columns.indices(self.shape[1])
        keep, start, index = _inside(self.start, self.index, (r0, r1), (c0, c1))
        return Csr((r1 - r0, c1 - c0), start, index, self.value[keep])

    def diagonal(self) -> _Floats:
        """Entries on the diagonal."""
        found = np.zeros(min(self.shape))
        mine = self.rows == self.index
        found[self.index[mine]] = self.value[mine]
        return found

    def is_diagonal(self) -> bool:
        """Whether every entry off the diagonal is 0."""
        return not np.any(self.value[self.rows != self.index])

    def is_symmetric(self) -> bool:
        """Whether it equals its transpose exactly."""
        other = self.transposed()
        return bool(np.array_equal(self.index, other.index) and np.array_equal(self.value, other.value))

    def __matmul__(self, x: _Floats) -> _Floats:
        """Product with a vector (columns,) or with several (columns, k)."""
        result = np.zeros((self.shape[0], *x.shape[1:]))
        if len(self.value) == 0:
            return result
        filled = np.flatnonzero(np.diff(self.start))
        value = self.value if x.ndim == 1 else self.value[:, None]
        result[filled] = np.add.reduceat(value * x[self.index], self.start[filled], axis=0)
        return result


# What follows from the places of entries alone: matrices that differ in values need it as well.


@cached_by_content
def _starts(rows: _Ints, count: int) -> _Ints:
    """Where each of so many rows begins, of the rows of entries."""
    start = np.zeros(count + 1, dtype=np.int64)
    np.cumsum(np.bincount(rows, minlength=count), out=start[1:])
    return start


@cached_by_content
def _rows(start: _Ints) -> _Ints:
    """The reverse: row of every entry."""
    return np.repeat(np.arange(len(start) - 1), np.diff(start))


@cached_by_content
def _sorted(i: _Ints, j: _Ints, shape: tuple[int, int]) -> tuple[_Ints, _Ints, _Ints, _Ints]:
    """Entries by rows: their order, place of each among the places, and these as starts and columns."""
    order = np.lexsort((j, i))
    i, j = i[order], j[order]
    first = np.ones(len(i), dtype=bool)
    first[1:] = (i[1:] != i[:-1]) | (j[1:] != j[:-1])
    return order, np.cumsum(first) - 1, _starts(i[first], shape[0]), j[first]


@cached_by_content
def _inside(
    start: _Ints, index: _Ints, rows: tuple[int, int], columns: tuple[int, int]
) -> tuple[_Ints, _Ints, _Ints]:
    """Which entries are in a part, and where each of its rows begins, and their columns there."""
    i = _rows(start)
    keep = np.flatnonzero((i >= rows[0]) & (i < rows[1]) & (index >= columns[0]) & (index < columns[1]))
    return keep, _starts(i[keep] - rows[0], rows[1] - rows[0]), index[keep] - columns[0]


def on_one_pattern(matrices: Sequence[Csr], *also: tuple[_Ints, _Ints]) -> tuple[_Ints, _Ints, list[_Floats]]:
    """Matrices of one shape over their joint pattern, places ``also`` in it: start, index, values of each."""
    rows = np.concatenate([*(A.rows for A in matrices), *(i for i, _ in also)])
    columns = np.concatenate([*(A.index for A in matrices), *(j for _, j in also)])
    order, place, start, index = _sorted(rows, columns, matrices[0].shape)
    at = np.empty(len(order), dtype=np.int64)
    at[order] = place
    values, first = [np.zeros(len(index)) for _ in matrices], 0
    for A, value in zip(matrices, values, strict=True):
        value[at[first : first + len(A.index)]] = A.value
        first += len(A.index)
    return start, index, values


class LazyMatrices:
    """Attributes that are held as :class:`Csr` and become dense arrays when something asks for them by name."""

    _held: dict[str, Csr]

    def __getattr__(self, name: str) -> Any:
        held = self.__dict__.get("_held", {})
        if name not in held:
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
        matrix = held[name].dense()
        object.__setattr__(self, name, matrix)
        return matrix
