"""Modes from mass, damping and stiffness matrices, dense or sparse."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import scipy.linalg
import scipy.sparse
from scipy.sparse.linalg import splu

from fricmb.errors import SceneError, shown
from fricmb.reduction._factor import factor
from fricmb.reduction._modes import Floats, Reduced, ritz, split_damping
from fricmb.reduction._pencil import DENSE, SHIFT, lowest_modes, sparse
from fricmb.values import is_sparse

#: Relative asymmetry that counts as round-off.
SYMMETRIC = 1e-9


def reduce_matrices(
    label: str, M: Any, K: Any, C: Any, points: Mapping[str, Any], n_axes: int, n_modes: int | None, residual: bool
) -> Reduced:
    """Modes of ``M q'' + C q' + K q = f``.

    Parameters
    ----------
    label : str
        Who asks, for messages.
    M, K, C : (n, n) array or scipy sparse
        Symmetric, M positive definite, K positive semidefinite; C may be anything, or None.
    points : dict of str to (n_axes,) int or (n_axes, n)
        Degree of freedom along each axis, or the rows that give the displacement from all degrees of freedom.
    n_axes : int
    n_modes : int or None
        How many modes, lowest first; None: all.
    residual : bool
        Whether to add residual vectors of the points for the modes that are left out.

    Raises
    ------
    SceneError
    """
    M, K = _checked(label, "M", M), _checked(label, "K", K)
    n = M.shape[0]
    _same_shape(label, "K", K, n)
    _symmetric(label, "M", M)
    _symmetric(label, "K", K)
    _positive_definite(label, M)
    if C is not None:
        C = _checked(label, "C", C)
        _same_shape(label, "C", C, n)
    rows = {name: displacement_rows(label, name, value, n_axes, n) for name, value in points.items()}
    whole = isinstance(n_modes, int | np.integer) and not isinstance(n_modes, bool)
    if n_modes is not None and not (whole and 1 <= n_modes <= n):
        raise SceneError(
            f"{label}: n_modes must be an integer from 1 to {n} (rows of M), or None;"
            f" got {shown(n_modes)}"
        )
    found = lowest_modes(label, M, K, count=n if n_modes is None else n_modes)
    omega, modes = np.sqrt(found.omega2), found.shapes
    neglected, extra = 0.0, 0
    if residual and omega.size < n:
        added, more, neglected = residual_vectors(M, K, omega, modes, np.vstack(list(rows.values())))
        omega, modes, extra = np.concatenate([omega, added]), np.hstack([modes, more]), added.size
    full = np.zeros((omega.size, omega.size)) if C is None else modes.T @ (C @ modes)
    ratios, damping = split_damping(full, omega)
    shapes = {name: row @ modes for name, row in rows.items()}
    return Reduced(
        frequencies=omega, damping_ratios=ratios, damping=damping, shapes=shapes, residual=extra, neglected=neglected
    )


def residual_vectors(M: Any, K: Any, omega: Floats, modes: Floats, rows: Floats) -> tuple[Floats, Floats, float]:
    """Frequencies and modes of the residual vectors of loads along ``rows``; the share of flexibility they carry."""
    loads = rows.T - M @ (modes @ (modes.T @ rows.T))
    shift = SHIFT * float(K.diagonal().sum()) / float(M.diagonal().sum())
    solve = _solver(K, M, shift)
    x = solve(loads)
    x = solve(loads + shift * (M @ x))  # takes the shift out again, to its square
    x -= modes @ (modes.T @ (M @ x))
    left = np.maximum(np.sum(rows.T * x, axis=0), 0.0)
    kept = np.sum(np.divide((rows @ modes) ** 2, omega**2, out=np.zeros_like(rows @ modes), where=omega > 0.0), axis=1)
    share = np.divide(left, left + kept, out=np.zeros_like(left), where=left + kept > 0.0)
    x = x[:, left > 1e-14 * (left + kept)]
    if x.shape[1] == 0:
        return np.zeros(0), np.zeros((M.shape[0], 0)), 0.0
    frequencies, more = ritz(x, x.T @ (K @ x), x.T @ (M @ x))
    return frequencies, more, float(share.max())


def _solver(K: Any, M: Any, shift: float) -> Callable[[Floats], Floats]:
    """Solves with K + shift M."""
    if is_sparse(K) or is_sparse(M):
        return factor((sparse(K) + shift * sparse(M)).tocsc())
    held = scipy.linalg.cho_factor(K + shift * M)
    return lambda b: np.asarray(scipy.linalg.cho_solve(held, b))


# ---- checks


def _checked(label: str, name: str, value: Any) -> Any:
    """A square float matrix of finite numbers."""
    try:
        given: Any = value.tocsr() if is_sparse(value) else np.array(value)
        kind = given.dtype.kind
        matrix = given.astype(float) if kind in "iuf" else None
    except (TypeError, ValueError):
        matrix, kind = None, "O"
    if matrix is None:
        got = "complex ones" if kind == "c" else repr(value)
        raise SceneError(f"{label}: {name} must be a matrix of real numbers, got {got}")
    if len(matrix.shape) != 2 or matrix.shape[0] != matrix.shape[1] or matrix.shape[0] == 0:
        raise SceneError(f"{label}: {name} must be a square matrix, got shape {matrix.shape}")
    entries = matrix.tocoo() if is_sparse(matrix) else None
    wrong = np.argwhere(~np.isfinite(matrix if entries is None else entries.data))
    if wrong.size:
        at = tuple(wrong[0]) if entries is None else (entries.coords[0][wrong[0, 0]], entries.coords[1][wrong[0, 0]])
        i, j = int(at[0]), int(at[1])
        raise SceneError(f"{label}: {name} must hold finite numbers; {name}[{i}, {j}] = {matrix[i, j]}")
    return matrix


def _same_shape(label: str, name: str, matrix: Any, n: int) -> None:
    if matrix.shape != (n, n):
        raise SceneError(f"{label}: {name} must have the shape of M, {(n, n)}; got {matrix.shape}")


def _symmetric(label: str, name: str, matrix: Any) -> None:
    difference = abs(matrix - matrix.T)
    worst = float(difference.max())
    if worst > SYMMETRIC * float(abs(matrix).max()):
        place = difference.argmax()
        i, j = divmod(int(place), matrix.shape[0])
        raise SceneError(
            f"{label}: {name} must be symmetric; {name}[{i}, {j}] and {name}[{j}, {i}] differ by {worst:.3g}"
        )


def _positive_definite(label: str, M: Any) -> None:
    """Refuse a mass matrix with a pivot that is not positive; the message names the row."""
    n = M.shape[0]
    bad = np.flatnonzero(~(M.diagonal() > 0.0))
    if bad.size:
        raise SceneError(f"{label}: M must be positive definite; M[{bad[0]}, {bad[0]}] = {M.diagonal()[bad[0]]:.3g}")
    scale = 1.0 / np.sqrt(M.diagonal())
    if is_sparse(M):
        scaled = _scaled(M, scale)
        try:
            found = splu(scaled.tocsc(), diag_pivot_thresh=0.0, options={"SymmetricMode": True})
            pivots = found.U.diagonal()
        except RuntimeError:
            pivots = np.zeros(1)
        good = bool((pivots > n * np.finfo(float).eps).all())
    else:
        good = bool(np.linalg.eigvalsh(M * scale[:, None] * scale)[0] > n * np.finfo(float).eps)
    if not good:
        raise SceneError(
            f"{label}: M must be positive definite; it is singular or indefinite (massless degrees of freedom:"
            " fm.fe.FEModel and ModalBody.from_fe)"
        )


def displacement_rows(label: str, name: str, value: Any, n_axes: int, n: int) -> Floats:
    """Rows (n_axes, n) that give the displacement of a point."""
    accepted = f"{n_axes} degree(s) of freedom (0 to {n - 1}), or a matrix of shape ({n_axes}, {n})"
    given = value.toarray() if is_sparse(value) else np.asarray(value)
    if given.dtype.kind in "iu" and given.shape in ((n_axes,), () if n_axes == 1 else (n_axes,)):
        places = np.atleast_1d(given)
        if (places < 0).any() or (places >= n).any():
            raise SceneError(f"{label}: points[{name!r}] must be {accepted}; got {shown(value)}")
        return np.eye(n)[places] if n <= DENSE else _unit_rows(places, n)
    if given.dtype.kind not in "iuf" or given.shape not in ((n_axes, n), (n,) if n_axes == 1 else (n_axes, n)):
        got = f"an array of shape {given.shape}" if given.dtype.kind in "iuf" and given.shape else repr(value)
        raise SceneError(f"{label}: points[{name!r}] must be {accepted}; got {got}")
    if not np.isfinite(given).all():
        raise SceneError(f"{label}: points[{name!r}] must hold finite numbers")
    return given.reshape(n_axes, n).astype(float)


def _unit_rows(places: Sequence[int] | Any, n: int) -> Floats:
    rows = np.zeros((len(places), n))
    rows[np.arange(len(places)), places] = 1.0
    return rows


def _scaled(A: Any, scale: Floats) -> Any:
    side = scipy.sparse.diags(scale)
    return side @ A @ side

