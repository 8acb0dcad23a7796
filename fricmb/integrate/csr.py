"""Sparse matrices of a problem: plain arrays by rows, so that small scenes need no library of their own for them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

_Floats = NDArray[np.float64]
_Ints = NDArray[np.int64]


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
        order = np.lexsort((j, i))
        i, j, v = i[order], j[order], v[order]
        first = np.ones(len(i), dtype=bool)
        first[1:] = (i[1:] != i[:-1]) | (j[1:] != j[:-1])
        place = np.cumsum(first) - 1
        total = np.bincount(place, v, int(first.sum())) if len(v) else np.zeros(0)
        return cls.in_order(i[first], j[first], np.asarray(total, dtype=float), shape)

    @classmethod
    def in_order(cls, rows: _Ints, columns: _Ints, values: _Floats, shape: tuple[int, int]) -> Csr:
        """From places that rise, row by row, each of them once, and their values."""
        start = np.zeros(shape[0] + 1, dtype=np.int64)
        np.cumsum(np.bincount(rows, minlength=shape[0]), out=start[1:])
        return cls(shape, start, columns, values)

    @classmethod
    def of_dense(cls, matrix: Any) -> Csr:
        """The non-zeros of a dense matrix."""
        dense = np.asarray(matrix, dtype=float)
        rows, columns = np.nonzero(dense)
        return cls.in_order(rows, columns, dense[rows, columns], (dense.shape[0], dense.shape[1]))

    @cached_property
    def rows(self) -> _Ints:
        """Row of every entry."""
        return np.repeat(np.arange(self.shape[0]), np.diff(self.start))

    def dense(self) -> _Floats:
        """All of it.

        Raises
        ------
        MemoryError
            Above some 4 GB: nothing that takes large scenes may ask for this.
        """
        if self.shape[0] * self.shape[1] > 5e8:
            raise MemoryError(f"a matrix of {self.shape[0]} x {self.shape[1]} was asked for as a dense one")
        full = np.zeros(self.shape)
        full[self.rows, self.index] = self.value
        return full

    def transposed(self) -> Csr:
        """Rows and columns exchanged."""
        return Csr.of_entries(self.index, self.rows, self.value, (self.shape[1], self.shape[0]))

    def block(self, rows: slice, columns: slice) -> Csr:
        """A contiguous part."""
        (r0, r1, _), (c0, c1, _) = rows.indices(self.shape[0]), columns.indices(self.shape[1])
        i = self.rows
        keep = (i >= r0) & (i < r1) & (self.index >= c0) & (self.index < c1)
        return Csr.in_order(i[keep] - r0, self.index[keep] - c0, self.value[keep], (r1 - r0, c1 - c0))

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


def on_one_pattern(matrices: Sequence[Csr], *also: tuple[_Ints, _Ints]) -> tuple[_Ints, _Ints, list[_Floats]]:
    """Matrices of one shape over their joint pattern, places ``also`` in it: start, index, values of each."""
    rows = np.concatenate([*(A.rows for A in matrices), *(i for i, _ in also)])
    columns = np.concatenate([*(A.index for A in matrices), *(j for _, j in also)])
    pattern = Csr.of_entries(rows, columns, np.zeros(len(rows)), matrices[0].shape)
    width = max(pattern.shape[1], 1)
    key = pattern.rows * width + pattern.index
    values = [np.zeros(len(key)) for _ in matrices]
    for A, value in zip(matrices, values, strict=True):
        value[np.searchsorted(key, A.rows * width + A.index)] = A.value
    return pattern.start, pattern.index, values


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
