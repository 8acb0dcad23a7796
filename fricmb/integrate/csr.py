"""Sparse matrices of a problem: plain arrays by rows, so that small scenes need no library of their own for them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

_Floats = NDArray[np.float64]
_Ints = NDArray[np.int64]
_T = TypeVar("_T")

#: Entries and rows up to which what follows from places alone is kept: matrices that differ in values need it as well.
SMALL = 4096


@lru_cache(maxsize=512)
def _known(shape: tuple[int, int], first: bytes, second: bytes) -> dict[Any, Any]:
    """What is known of places; never written to but to add something."""
    return {}


def _found(known: dict[Any, Any], key: Any, find: Callable[[], _T]) -> _T:
    if key not in known:
        known[key] = find()
    found: _T = known[key]
    return found


def _known_of(shape: tuple[int, int], first: _Ints, second: _Ints) -> dict[Any, Any]:
    if max(len(first), len(second)) > SMALL:
        return {}
    return _known(shape, first.tobytes(), second.tobytes())


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
        known = _known_of(shape, i, j)
        order, place, start, index = _found(known, "sorted", lambda: _sorted(i, j, shape))
        total = np.bincount(place, v[order], len(index)) if len(v) else np.zeros(0)
        return cls(shape, start, index, np.asarray(total, dtype=float))

    @classmethod
    def in_order(cls, rows: _Ints, columns: _Ints, values: _Floats, shape: tuple[int, int]) -> Csr:
        """From places that rise, row by row, each of them once, and their values."""
        return cls(shape, _starts(rows, shape[0]), columns, values)

    @classmethod
    def of_dense(cls, matrix: Any) -> Csr:
        """The non-zeros of a dense matrix."""
        dense = np.asarray(matrix, dtype=float)
        rows, columns = np.nonzero(dense)
        shape = dense.shape[0], dense.shape[1]
        start = _found(_known_of(shape, rows, columns), "start", lambda: _starts(rows, shape[0]))
        return cls(shape, start, columns, dense[rows, columns])

    @cached_property
    def _places(self) -> dict[Any, Any]:
        """What is known of the places."""
        return _known_of(self.shape, self.start, self.index)

    @cached_property
    def rows(self) -> _Ints:
        """Row of every entry."""
        return _found(self._places, "rows", lambda: np.repeat(np.arange(self.shape[0]), np.diff(self.start)))

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
        i, shape = self.rows, (r1 - r0, c1 - c0)

        def find() -> tuple[_Ints, _Ints, _Ints]:
            keep = np.flatnonzero((i >= r0) & (i < r1) & (self.index >= c0) & (self.index < c1))
            return keep, _starts(i[keep] - r0, shape[0]), self.index[keep] - c0

        keep, start, index = _found(self._places, (r0, r1, c0, c1), find)
        return Csr(shape, start, index, self.value[keep])

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


def _starts(rows: _Ints, count: int) -> _Ints:
    """Where each of so many rows begins, of the rows of entries."""
    start = np.zeros(count + 1, dtype=np.int64)
    np.cumsum(np.bincount(rows, minlength=count), out=start[1:])
    return start


def _sorted(i: _Ints, j: _Ints, shape: tuple[int, int]) -> tuple[_Ints, _Ints, _Ints, _Ints]:
    """Entries by rows: their order, place of each among the places, and these as starts and columns."""
    order = np.lexsort((j, i))
    i, j = i[order], j[order]
    first = np.ones(len(i), dtype=bool)
    first[1:] = (i[1:] != i[:-1]) | (j[1:] != j[:-1])
    return order, np.cumsum(first) - 1, _starts(i[first], shape[0]), j[first]


def on_one_pattern(matrices: Sequence[Csr], *also: tuple[_Ints, _Ints]) -> tuple[_Ints, _Ints, list[_Floats]]:
    """Matrices of one shape over their joint pattern, places ``also`` in it: start, index, values of each."""
    rows = np.concatenate([*(A.rows for A in matrices), *(i for i, _ in also)])
    columns = np.concatenate([*(A.index for A in matrices), *(j for _, j in also)])
    known = _known_of(matrices[0].shape, rows, columns)
    lengths = tuple([len(A.index) for A in matrices])

    def find() -> tuple[_Ints, _Ints, list[_Ints]]:
        pattern = Csr.of_entries(rows, columns, np.zeros(len(rows)), matrices[0].shape)
        width = max(pattern.shape[1], 1)
        key = pattern.rows * width + pattern.index
        return pattern.start, pattern.index, [np.searchsorted(key, A.rows * width + A.index) for A in matrices]

    start, index, places = _found(known, ("pattern", lengths), find)
    values = [np.zeros(len(index)) for _ in matrices]
    for A, value, place in zip(matrices, values, places, strict=True):
        value[place] = A.value
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
