"""Matrices as programs write them, made whole: triangles completed, complex stiffness split, numbers checked."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse
from numpy.typing import NDArray

from fricmb.errors import SceneError, shown
from fricmb.values import is_sparse

Floats = NDArray[np.float64]
Sparse = Any

#: Relative asymmetry that counts as round-off, of double and of single precision.
ROUND_OFF = {"double": 1e-9, "single": 1e-5}
#: What may be said of a matrix of which one triangle is given.
KINDS = ("symmetric", "skew", "full")


def checked(label: str, name: str, value: Any, kind: str | None = None) -> tuple[Sparse, str]:
    """A square sparse matrix (n, n) by rows, real or complex, and what was completed ("" if nothing).

    Parameters
    ----------
    label, name : str
        For messages.
    value : array_like or scipy sparse
    kind : {"symmetric", "skew", "full"}, optional
        What a triangle stands for.  By default a matrix with nothing on one side of its diagonal is a triangle, of a
        skew matrix where the diagonal is empty, too, else of a symmetric one.

    Raises
    ------
    SceneError
    """
    if kind is not None and kind not in KINDS:
        raise SceneError(f"{label}: triangles[{name!r}] must be 'symmetric', 'skew' or 'full', got {shown(kind)}")
    try:
        matrix = value.tocsr() if is_sparse(value) else scipy.sparse.csr_array(np.asarray(value))
        numeric = matrix.dtype.kind in "iufc"
    except (TypeError, ValueError):
        numeric = False
    if not numeric:
        raise SceneError(f"{label}: {name} must be a matrix of numbers, got {shown(value)}")
    matrix = scipy.sparse.csr_array(matrix.astype(complex if matrix.dtype.kind == "c" else float))
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1] or matrix.shape[0] == 0:
        raise SceneError(f"{label}: {name} must be a square matrix, got shape {matrix.shape}")
    matrix.sum_duplicates()
    wrong = np.flatnonzero(~np.isfinite(matrix.data))
    if wrong.size:
        entries = matrix.tocoo()
        i, j = int(entries.coords[0][wrong[0]]), int(entries.coords[1][wrong[0]])
        raise SceneError(f"{label}: {name} must hold finite numbers; {name}[{i}, {j}] = {matrix.data[wrong[0]]}")
    matrix.eliminate_zeros()
    return _completed(matrix, kind)


def _completed(matrix: Sparse, kind: str | None) -> tuple[Sparse, str]:
    lower, upper = scipy.sparse.tril(matrix, -1), scipy.sparse.triu(matrix, 1)
    one_sided = (lower.nnz == 0) != (upper.nnz == 0)
    if not one_sided or kind == "full":
        return matrix, ""
    side = "lower" if upper.nnz == 0 else "upper"
    if kind is None:
        kind = "symmetric" if matrix.diagonal().any() else "skew"
    sign = 1.0 if kind == "symmetric" else -1.0
    return scipy.sparse.csr_array(matrix + sign * (lower + upper).T), f"{side} triangle of a {kind} matrix completed"


def precision(matrix: Sparse) -> str:
    """Whether the entries have the digits of "single" or "double" precision."""
    data = matrix.data.view(float) if np.iscomplexobj(matrix.data) else matrix.data
    fine = data[(data != np.round(data, 3)) & np.isfinite(data)]
    if fine.size < 8:
        return "double"
    with np.errstate(over="ignore"):
        return "single" if np.mean(fine == fine.astype(np.float32)) > 0.99 else "double"


def asymmetry(matrix: Sparse) -> float:
    """Largest entry of ``A - A^T`` over that of A."""
    largest = float(abs(matrix).max())
    return float(abs(matrix - matrix.T).max()) / largest if largest > 0.0 else 0.0


def symmetric_part(matrix: Sparse) -> Sparse:
    """``(A + A^T)/2``."""
    return scipy.sparse.csr_array(0.5 * (matrix + matrix.T))
