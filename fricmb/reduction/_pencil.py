"""The lowest modes of a symmetric pencil whose mass may be semi-definite.

Degrees of freedom without mass have no frequency of their own: with ``A = K + s M`` the pencil ``M x = nu A x`` gives
them ``nu = 0`` and every other mode ``omega^2 = 1/nu - s``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg
import scipy.sparse
from scipy.sparse.linalg import LinearOperator, eigsh

from fricmb.errors import SceneError
from fricmb.reduction._factor import factor
from fricmb.reduction._modes import Floats
from fricmb.values import is_sparse

#: Up to this size, or where more than a third of the modes are wanted, all are computed by the dense solver.
DENSE = 600
#: Inertia that is added to the stiffness to make it regular, relative to K/M: rigid modes are found beside it.
SHIFT = 1e-7
#: Share of the largest ``nu`` (or of the next one) below which a direction counts as massless.
MASSLESS = 1e-13


@dataclass(frozen=True, kw_only=True)
class Modes:
    """Lowest modes: ``omega2`` (k,) rising, those of rigid modes exactly 0; ``shapes`` (n, k) of unit modal mass."""

    omega2: Floats
    shapes: Floats


def lowest_modes(label: str, M: Any, K: Any, *, count: int | None = None, up_to: float | None = None) -> Modes:
    """The lowest modes of ``K x = omega^2 M x``, M and K positive semidefinite, not both 0 on the same vector.

    Parameters
    ----------
    label : str
        Who asks, for messages.
    M, K : (n, n) array or scipy sparse
    count : int, optional
        How many; fewer where the mass has a smaller rank.
    up_to : float, optional
        Angular frequency up to which all modes are wanted.

    Raises
    ------
    SceneError
        For a stiffness that is negative somewhere, and a massless motion that nothing holds.
    """
    n = M.shape[0]
    shift = SHIFT * float(abs(K.diagonal()).sum()) / max(float(abs(M.diagonal()).sum()), 1e-300)
    shift = max(shift, 1e-300)
    if n <= DENSE or (count is not None and 3 * count > n):
        omega2, shapes = _dense_modes(label, M, K, shift)
    else:
        omega2, shapes = _sparse_modes(label, M, K, shift, count, up_to)
    kept = omega2 <= (np.inf if up_to is None else up_to**2)
    omega2, shapes = omega2[kept][:count], shapes[:, kept][:, :count]
    size = float(abs(K).sum(axis=1).max())
    round_off = 1e3 * np.finfo(float).eps * size * np.sum(shapes**2, axis=0)
    if omega2.size and omega2[0] < -max(round_off[0], 1e-6 * shift):
        raise SceneError(
            f"{label}: K must be positive semidefinite; it has a mode of omega^2 = {omega2[0]:.3g} (a structure that"
            " is unstable at rest cannot be given by modes: use MatrixElement)"
        )
    return Modes(omega2=np.where(np.abs(omega2) <= np.maximum(round_off, 1e-6 * shift), 0.0, omega2), shapes=shapes)


def _dense_modes(label: str, M: Any, K: Any, shift: float) -> tuple[Floats, Floats]:
    """All modes, of the rank of the mass."""
    M, K = dense(M), dense(K)
    if _is_definite(M):
        omega2, shapes = scipy.linalg.eigh(K, M)
        return omega2, shapes
    A = K + shift * M
    try:
        nu, shapes = scipy.linalg.eigh(M, A)
    except np.linalg.LinAlgError:
        if np.linalg.eigvalsh(A)[0] < -1e-9 * np.abs(A).max():
            raise SceneError(f"{label}: K must be positive semidefinite where there is no mass; it is not") from None
        raise _unheld(label) from None
    kept = np.flatnonzero(nu > MASSLESS * nu[-1])[::-1]
    return 1.0 / nu[kept] - shift, shapes[:, kept] / np.sqrt(nu[kept])


def _is_definite(M: Floats) -> bool:
    """Whether a mass matrix is positive definite beyond round-off."""
    diagonal = M.diagonal()
    if not (diagonal > 0.0).all():
        return False
    scale = 1.0 / np.sqrt(diagonal)
    return bool(np.linalg.eigvalsh(M * scale[:, None] * scale)[0] > 1e-10)


def _sparse_modes(
    label: str, M: Any, K: Any, shift: float, count: int | None, up_to: float | None
) -> tuple[Floats, Floats]:
    """By Lanczos steps on the inverse of ``K + shift M``; as many more as are below ``up_to``."""
    K, M = sparse(K), sparse(M)
    n = M.shape[0]
    try:
        solve = factor((K + shift * M).tocsc())
    except RuntimeError:
        raise _unheld(label) from None
    inverse = LinearOperator((n, n), matvec=solve, dtype=float)
    start = np.cos(1.0 + np.arange(n))  # the same modes, to the last digit, in every run
    k = min(n - 1, count if count is not None else 40)
    while True:
        omega2, shapes = eigsh(K, k=k, M=M, sigma=-shift, which="LM", OPinv=inverse, v0=start, tol=1e-13)
        order = np.argsort(omega2)
        omega2, shapes = omega2[order], shapes[:, order]
        if up_to is None or omega2[-1] > up_to**2 or k >= n - 1:
            return omega2, shapes
        k = min(n - 1, 2 * k)


def _unheld(label: str) -> SceneError:
    return SceneError(
        f"{label}: a motion has neither mass nor stiffness, or K is negative there; degrees of freedom that nothing"
        " holds have to be fixed"
    )


def dense(A: Any) -> Floats:
    """As an array."""
    return np.asarray(A.toarray() if is_sparse(A) else A)


def sparse(A: Any) -> Any:
    """As a sparse matrix by columns."""
    return A.tocsc() if is_sparse(A) else scipy.sparse.csc_array(A)
