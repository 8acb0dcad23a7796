"""Frequencies and damping ratios of the linear structure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricmb.errors import SceneError
from fricmb.integrate.array_cache import cached_by_content
from fricmb.integrate.problem import Floats


def check_mass(M: Floats, dofs: Sequence[str]) -> None:
    """Refuse a mass matrix that is not positive definite; the message names the degree of freedom at fault.

    Raises
    ------
    SceneError
    """
    diagonal = np.diagonal(M)
    if np.count_nonzero(M) == np.count_nonzero(diagonal):
        check_masses(diagonal, dofs)
        return
    scale = np.sqrt(np.maximum(np.abs(diagonal), np.finfo(float).tiny))
    values, vectors = np.linalg.eigh(M / scale[:, None] / scale[None, :])
    if not values[0] > 1e-13 * values[-1]:
        worst = int(np.argmax(np.abs(vectors[:, 0])))
        kind = "singular" if values[0] > -1e-13 * abs(values[-1]) else "indefinite"
        raise SceneError(
            f"the mass matrix is {kind} (smallest scaled eigenvalue {values[0]:.3g}); the degree of freedom most"
            f" concerned is {dofs[worst]!r}"
        )


def check_masses(masses: Floats, dofs: Sequence[str]) -> None:
    """Refuse masses that are not positive."""
    bad = np.flatnonzero(~(masses > 0.0))
    if bad.size:
        raise SceneError(f"{dofs[int(bad[0])]}: the mass must be > 0, got {masses[bad[0]]:g}")


@cached_by_content
def spectrum(M: Floats, K: Floats, C: Floats) -> tuple[Floats, Floats]:
    """Angular frequencies (n,), rising, and damping ratios (n,) of the structure without friction.

    Of the symmetric part of K; damping ratios from the diagonal of C in modal form, 0 for rigid modes.
    """
    n = len(M)
    stiffness, damping = _scaled(M, 0.5 * (K + K.T), 0.5 * (C + C.T))
    damped = bool(damping.any())
    if n <= _SMALL:
        values, vectors = np.linalg.eigh(stiffness)
        rate = np.einsum("ij,ij->j", vectors, damping @ vectors) if damped else np.zeros(n)
    else:
        values = _eigenvalues(stiffness)
        rate = np.zeros(n)
        if damped:
            # first-order perturbation: the eigenvalues of K + eps C move by eps times the modal damping
            eps = 1e-6 * max(float(np.abs(stiffness).max()), 1e-300) / float(np.abs(damping).max())
            rate = (_eigenvalues(stiffness + eps * damping) - values) / eps
    return _sorted(values, rate)


def uncoupled_spectrum(mass: Floats, stiffness: Floats, damping: Floats) -> tuple[Floats, Floats]:
    """The same of degrees of freedom that no spring or damper ties together, all (n,)."""
    return _sorted(stiffness / mass, damping / mass)


def _sorted(values: Floats, rate: Floats) -> tuple[Floats, Floats]:
    floor = 1e-13 * max(float(np.abs(values).max(initial=0.0)), np.finfo(float).tiny)
    omega = np.sqrt(np.where(np.abs(values) > floor, np.abs(values), 0.0))
    order = np.argsort(omega, kind="stable")
    omega, rate = omega[order], rate[order]
    return omega, np.divide(rate, 2.0 * omega, out=np.zeros(len(omega)), where=omega > 0.0)


#: Up to this size all eigenvectors cost nothing that matters.
_SMALL = 64


def _scaled(M: Floats, K: Floats, C: Floats) -> tuple[Floats, Floats]:
    """K and C in coordinates in which M is the identity."""
    if np.count_nonzero(M) == len(M):
        factor = 1.0 / np.sqrt(np.diagonal(M))
        return K * factor[:, None] * factor, C * factor[:, None] * factor
    inverse = np.linalg.inv(np.linalg.cholesky(M))
    return inverse @ K @ inverse.T, inverse @ C @ inverse.T


def _eigenvalues(A: Floats) -> Floats:
    """Eigenvalues (n,), rising, of a symmetric matrix that may be banded."""
    from scipy.linalg import eigvals_banded

    rows, columns = np.nonzero(A)
    width = int(np.abs(rows - columns).max(initial=0))
    if width == 0:
        return np.sort(np.diagonal(A))
    if 8 * width > len(A):
        return np.asarray(np.linalg.eigvalsh(A), dtype=float)
    band = np.array([np.pad(np.diagonal(A, -k), (0, k)) for k in range(width + 1)])
    return np.asarray(eigvals_banded(band, lower=True), dtype=float)
