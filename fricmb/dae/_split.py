"""Which unknowns are algebraic: the kernel of dF/dyp, its complement, and the matrix that is regular for index 1."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy import linalg, sparse
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from fricmb.errors import IntegrationError
from fricmb.integrate.problem import Floats

_LARGE_BLOCK = 1200  # unknowns coupled by dF/dyp, beyond which no singular values are computed
_LARGE = 400  # unknowns, beyond which factors are sparse
_REGULAR = 1e-13


def no_start(t: float, reason: str) -> IntegrationError:
    """The error that a start at t cannot be made, for a reason."""
    return IntegrationError(f"No consistent initial values at t = {t:g}: {reason}.", t=t, reason=reason)


class Split:
    """Kernel N of dF/dyp, its complement V, and the factors of K = [B V, A N]."""

    def __init__(self, matrix: Any, t: float) -> None:
        b = matrix.as_sparse(matrix.dyp)
        a = matrix.as_sparse(matrix.dy)
        b.eliminate_zeros()
        self.v, self.kernel = _kernel(sparse.csc_array(b), t)
        self.algebraic = self.kernel.shape[1]
        self.solve = _factors(sparse.csc_array(sparse.hstack([b @ self.v, a @ self.kernel])), self, t)

    def move(self, f: Floats) -> tuple[Floats, Floats]:
        """Newton's move for a residual: change of yp (along V) and of y (along N)."""
        x = self.solve(-f)
        k = self.v.shape[1]
        return self.v @ x[:k], self.kernel @ x[k:]

    def differential(self, yp: Floats) -> Floats:
        """The part of yp along V."""
        part: Floats = self.v @ (self.v.T @ yp)
        return part

    def names(self, of_kernel: Floats) -> str:
        """The components in which a combination of kernel vectors is largest."""
        x = np.abs(self.kernel @ of_kernel)
        largest = [f"y[{j}]" for j in np.argsort(-x)[:4] if x[j] > 0.1 * x.max()]
        return ", ".join(sorted(largest))


def _kernel(b: Any, t: float) -> tuple[Any, Any]:
    """Orthonormal bases of the complement and of the kernel of b, one connected block at a time."""
    n = b.shape[0]
    joined = sparse.block_array([[None, b], [b.T, None]], format="csr") if b.nnz else sparse.csr_array((2 * n, 2 * n))
    _, label = connected_components(joined, directed=False)
    order = np.argsort(label, kind="stable")
    blocks = np.split(order, np.flatnonzero(np.diff(label[order])) + 1)
    kept: list[Any] = []
    lost: list[Any] = []
    for block in blocks:
        rows, columns = block[block < n], block[block >= n] - n
        if not len(columns):
            continue
        if len(rows) == 0:
            lost.append((columns, np.eye(len(columns))))
        elif len(rows) == 1 and len(columns) == 1:
            kept.append((columns, np.eye(1)))
        else:
            complement, kernel = _split_block(b[rows][:, columns], t)
            kept.append((columns, complement))
            lost.append((columns, kernel))
    return _assemble(kept, n), _assemble(lost, n)


def _assemble(parts: list[tuple[Any, Floats]], n: int) -> Any:
    width = sum(block.shape[1] for _, block in parts)
    rows, columns, values, at = [], [], [], 0
    for where, block in parts:
        m = block.shape[1]
        rows.append(np.repeat(where, m))
        columns.append(np.tile(np.arange(at, at + m), len(where)))
        values.append(block.ravel())
        at += m
    if not width:
        return sparse.csc_array((n, 0))
    data = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
    return sparse.csc_array(data, shape=(n, width))


def _split_block(block: Any, t: float) -> tuple[Floats, Floats]:
    size = block.shape[1]
    if max(block.shape) > _LARGE_BLOCK:
        if block.shape[0] == size and _regular(block):
            return np.eye(size), np.zeros((size, 0))
        reason = f"dF/dyp couples {size} unknowns and is singular, too many to tell the algebraic ones; give yp0"
        raise no_start(t, reason)
    full = block.toarray()
    by_row = np.abs(full).max(axis=1)
    full = full / by_row[:, None]
    by_column = np.abs(full).max(axis=0)
    _, values, right = linalg.svd(full / by_column)
    rank = int(np.sum(values > 1e-8 * values[0]))
    kernel = right[rank:].T / by_column[:, None]
    if rank == size:
        return np.eye(size), np.zeros((size, 0))
    q, _ = linalg.qr(kernel)
    return q[:, size - rank :], q[:, : size - rank]


def _regular(block: Any) -> bool:
    try:
        factors = splu(sparse.csc_matrix(block))
    except RuntimeError:
        return False
    pivots = np.abs(factors.U.diagonal())
    return bool(pivots.min() > 1e-12 * pivots.max())


def _factors(k: Any, split: Split, t: float) -> Any:
    """A solver for K, after scaling rows and columns; raises if K is singular."""
    n = k.shape[0]
    size = abs(k)
    row = size.max(axis=1).toarray().ravel()
    if np.any(row == 0.0):
        equation = int(np.flatnonzero(row == 0.0)[0])
        raise no_start(
            t,
            f"equation {equation} has neither a derivative nor an algebraic unknown in it (index above 1 or singular)",
        )
    k = sparse.diags_array(1.0 / row) @ k
    column = abs(k).max(axis=0).toarray().ravel()
    differential = split.v.shape[1]
    if np.any(column == 0.0):
        unit = (np.arange(n) == int(np.flatnonzero(column == 0.0)[0])).astype(float)[differential:]
        raise no_start(t, f"no equation determines {split.names(unit)} (index above 1 or singular)")
    k = k @ sparse.diags_array(1.0 / column)
    if n > _LARGE:
        solve = _sparse_factors(k, t)
    else:
        solve = _dense_factors(k.toarray(), split, column, t)
    return lambda f: solve(f / row) / column


def _dense_factors(k: Floats, split: Split, column: Floats, t: float) -> Any:
    factors = linalg.lapack.dgetrf(k)
    inverse, _ = linalg.lapack.dgecon(factors[0], np.abs(k).sum(axis=0).max())
    if factors[2] > 0 or inverse < _REGULAR:
        lost = linalg.svd(k)[2][-1] / column
        part = lost[split.v.shape[1] :]
        which = split.names(part) if part.size and np.abs(part).max() > 0.0 else "the derivatives"
        raise no_start(
            t, f"F = 0 does not determine {which} (index above 1 or singular; reciprocal condition {inverse:.1e})"
        )
    return lambda f: linalg.lapack.dgetrs(factors[0], factors[1], f)[0]


def _sparse_factors(k: Any, t: float) -> Any:
    try:
        factors = splu(sparse.csc_matrix(k))
    except RuntimeError as error:
        raise no_start(t, "F = 0 does not determine all algebraic unknowns (index above 1 or singular)") from error
    pivots = np.abs(factors.U.diagonal())
    if pivots.min() < _REGULAR * pivots.max():
        raise no_start(t, "F = 0 does not determine all algebraic unknowns (index above 1 or singular)")
    return factors.solve
