"""Matrices of entries: dense ones, and sparse ones where scenes are large."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fricmb.integrate.csr import Csr
from fricmb.integrate.problem import Floats

#: Entries up to which a loop takes less time than arrays do.
FEW = 64
#: Scenes of more degrees of freedom keep sparse matrices where these are sparse.
DENSE = 256


def is_sparse(n: int, entries: int) -> bool:
    """Whether matrices over n degrees of freedom with so many entries are kept as sparse ones."""
    return n > DENSE and 8 * entries < n * n


def matrix_of(
    entries: Sequence[tuple[int, int, float]], shape: tuple[int, int], more: Sequence[tuple[Any, Any, Any]] = ()
) -> Csr:
    """A matrix of entries one by one, and of arrays of them."""
    i, j, values = _columns(entries, more)
    return Csr.of_entries(i, j, values, shape)


def dense_of(
    entries: Sequence[tuple[int, int, float]], shape: tuple[int, int], more: Sequence[tuple[Any, Any, Any]] = ()
) -> Floats:
    """The same as a dense array; entries of one place are added up in the order given, too."""
    if not entries and not more:
        return np.zeros(shape)
    rows, columns = shape
    if len(entries) <= FEW and rows * columns <= FEW**2 and not more:
        held = [0.0] * (rows * columns)
        for a, b, value in entries:
            held[a * columns + b] += value
        return np.array(held, dtype=float).reshape(shape)
    i, j, values = _columns(entries, more)
    places = np.asarray(i, dtype=np.int64) * shape[1] + np.asarray(j, dtype=np.int64)
    full: Floats = np.bincount(places, values, shape[0] * shape[1]).astype(float, copy=False).reshape(shape)
    return full


def _columns(entries: Sequence[tuple[int, int, float]], more: Sequence[tuple[Any, Any, Any]]) -> Any:
    """Rows, columns and values."""
    columns: Any = zip(*entries, strict=True) if entries else ((), (), ())
    return [np.concatenate(held) for held in zip(columns, *more, strict=True)] if more else columns
