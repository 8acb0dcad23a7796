"""Patterns of the Jacobians, and which of their columns finite differences can perturb together."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy import sparse

from fricmb.dae._matrix import Banded, Dense, Ints, Matrix, Pattern, Sparse
from fricmb.integrate.compile.kernel import entry


def dense(n: int) -> Matrix:
    """All entries."""
    every = np.arange(n, dtype=np.int64)
    return Dense(
        Pattern(
            n=n,
            size=n * n,
            start=np.arange(0, n * n + 1, n, dtype=np.int64),
            rows=np.tile(every, n),
            place=np.arange(n * n, dtype=np.int64),
            groups=tuple(every[j : j + 1] for j in range(n)),
        )
    )


def banded(n: int, lower: int, upper: int) -> Matrix:
    """Row i of column j with -upper <= i - j <= lower."""
    height = 2 * lower + upper + 1
    j = np.arange(n, dtype=np.int64)
    low, high = np.maximum(0, j - upper), np.minimum(n, j + lower + 1)
    start = np.concatenate(([0], np.cumsum(high - low))).astype(np.int64)
    columns = np.repeat(j, high - low)
    rows = np.arange(start[-1]) - start[columns] + low[columns]
    width = min(lower + upper + 1, n)
    return Banded(
        Pattern(
            n=n,
            size=n * height,
            start=start,
            rows=rows,
            place=columns * height + lower + upper + rows - columns,
            groups=tuple(j[g::width] for g in range(width)),
        ),
        lower,
        upper,
    )


def sparse_matrix(structure: Any) -> Matrix:
    """Where ``structure`` (scipy sparse) has entries; the diagonal need not be among them."""
    entries = sparse.csc_array(structure)
    entries.sum_duplicates()
    entries.sort_indices()
    n = entries.shape[0]
    start, rows = entries.indptr.astype(np.int64), entries.indices.astype(np.int64)
    by_row = sparse.csr_array(entries)
    number = _colour(start, rows, by_row.indptr.astype(np.int64), by_row.indices.astype(np.int64))
    order = np.argsort(number, kind="stable")
    ends = np.cumsum(np.bincount(number))[:-1]
    groups = tuple(np.asarray(g, dtype=np.int64) for g in np.split(order, ends))
    return Sparse(Pattern(n=n, size=len(rows), start=start, rows=rows, place=np.arange(len(rows)), groups=groups))


@entry
def _colour(start: Ints, rows: Ints, row_start: Ints, row_columns: Ints) -> Ints:
    """Number the columns so that two with a common row differ: each takes the lowest number free, in order."""
    n = len(start) - 1
    number = np.full(n, -1, np.int64)
    taken_by = np.full(n + 1, -1, np.int64)
    for j in range(n):
        for p in range(start[j], start[j + 1]):
            row = rows[p]
            for q in range(row_start[row], row_start[row + 1]):
                other = number[row_columns[q]]
                if other >= 0:
                    taken_by[other] = j
        colour = 0
        while taken_by[colour] == j:
            colour += 1
        number[j] = colour
    return number
