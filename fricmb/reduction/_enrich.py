"""A basis that holds complex modes: growth rates of squealing structures need more than modes without friction.

Galerkin's method with the modes of a structure without friction gives growth rates that converge slowly with their
number; with the real and imaginary parts of complex modes at a few samples of the parameters it gives eigenvalues
there, and near there, to many digits: N. Gräbner, V. Mehrmann, S. Quraishi, C. Schröder, U. von Wagner, Numerical
methods for parametric model reduction in the simulation of disk brake squeal, ZAMM 96 (2016) 1388-1405.  The complex
modes are improved from those of the present basis by residual inverse iteration: A. Neumaier, SIAM J. Numer. Anal. 22
(1985) 914-923.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from fricmb.reduction._factor import Solve, factor
from fricmb.reduction._modes import Floats

Complexes = NDArray[np.complex128]

#: Modes that are improved with one factor of the dynamic stiffness.
BAND = 24
#: Times that modes of a band are improved at most.
SWEEPS = 4
#: Gram eigenvalue, relative, below which a direction of the basis counts as one that is there already.
DEPENDENT = 1e-9


@dataclass(frozen=True, kw_only=True)
class Pencil:
    """``lambda^2 M + lambda C + K`` at one sample of the parameters; sparse, real, K need not be symmetric."""

    M: Any
    C: Any
    K: Any

    def apply(self, values: Complexes, X: Complexes, *, adjoint: bool = False) -> Complexes:
        """``Q(lambda_j) x_j`` by columns, or ``Q(lambda_j)^H x_j``."""
        if adjoint:
            w = values.conj()
            return np.asarray(w**2 * (self.M.T @ X) + w * (self.C.T @ X) + self.K.T @ X)
        return np.asarray(values**2 * (self.M @ X) + values * (self.C @ X) + self.K @ X)

    def reduced(self, V: Floats) -> tuple[Floats, Floats, Floats]:
        """Its matrices in a basis."""
        return V.T @ (self.M @ V), V.T @ (self.C @ V), V.T @ (self.K @ V)


@dataclass(frozen=True, kw_only=True)
class Pairs:
    """Oscillations of a pencil in a basis: eigenvalues (k,), right and left vectors (m, k), relative errors (k,)."""

    values: Complexes
    right: Complexes
    left: Complexes
    errors: Floats


def enriched(
    modes: Floats, pencils: Sequence[Pencil], M: Any, flexible: Solve, top: float, tolerance: float
) -> tuple[Floats, list[float]]:
    """Vectors (n, r) to put beside real modes, and the relative error of eigenvalues that is left at each sample.

    Parameters
    ----------
    modes : (n, m)
        Real modes and residual vectors, orthonormal in M.
    pencils : sequence of Pencil
        The samples; between them, halfway, is looked as well, and improved where it is needed.
    M : sparse (n, n)
    flexible : function
        Solves with the stiffness without friction: weighs the residuals.
    top : float
        Angular frequency up to which modes are wanted.
    tolerance : float
        Of eigenvalues, relative.
    """
    V = modes
    for pencil in pencils:
        found = pairs(pencil, V, flexible, top)
        if (found.errors > tolerance).any():
            V = _with_modes_of(pencil, V, M, flexible, top, tolerance)
    return V[:, modes.shape[1] :], [float(pairs(p, V, flexible, top).errors.max(initial=0.0)) for p in pencils]


def _with_modes_of(pencil: Pencil, V: Floats, M: Any, flexible: Solve, top: float, tolerance: float) -> Floats:
    """The basis with the complex modes of a sample."""
    basis = V
    found = pairs(pencil, basis, flexible, top)
    for _ in range(SWEEPS):
        wrong = np.flatnonzero(found.errors > tolerance)
        if not wrong.size:
            break
        wrong = wrong[np.argsort(found.values.imag[wrong])]
        for band in np.array_split(wrong, -(-wrong.size // BAND)):
            shift = 1j * float(np.mean(found.values.imag[band]))
            solve = factor((shift**2 * pencil.M + shift * pencil.C + pencil.K).tocsc().astype(complex))
            D = solve(pencil.apply(found.values[band], _spanned(basis, found.right[:, band])))
            basis = added(basis, np.hstack([D.real, D.imag]), M)
        found = pairs(pencil, basis, flexible, top)
    # what was only on the way is left out again
    X = _spanned(basis, found.right)
    return added(V, np.hstack([X.real, X.imag]), M)


def _spanned(V: Floats, x: Complexes) -> Complexes:
    """Vectors of a basis, which may have grown since, times coordinates."""
    return np.asarray(V[:, : x.shape[0]] @ x)


def pairs(pencil: Pencil, V: Floats, flexible: Solve, top: float) -> Pairs:
    """Oscillations up to an angular frequency, and how far their eigenvalues may be off, relative.

    With the residuals r and s of the right and the left vector, ``s^H K^-1 r / (y^H Q' x)`` is what is missing in an
    eigenvalue, but for terms of higher order and the share of frequencies that the basis lacks.
    """
    Mr, Cr, Kr = pencil.reduced(V)
    m = V.shape[1]
    A = np.block([[np.zeros((m, m)), np.eye(m)], [-np.linalg.solve(Mr, Kr), -np.linalg.solve(Mr, Cr)]])
    values, left, right = scipy.linalg.eig(A, left=True, right=True)
    kept = (values.imag > 1e-9 * top) & (values.imag <= 1.02 * top)
    values, x = values[kept], right[:m, kept]
    # (z, w)^H A = lambda (z, w)^H: the left vector of the quadratic problem is M^-T w
    y = np.linalg.solve(Mr.T, left[m:, kept])
    x, y = x / np.linalg.norm(x, axis=0), y / np.linalg.norm(y, axis=0)
    r = pencil.apply(values, V @ x)
    s = pencil.apply(values, V @ y, adjoint=True)
    bent = flexible(np.hstack([r.real, r.imag]))
    bent = bent[:, : values.size] + 1j * bent[:, values.size :]
    slope = np.sum(y.conj() * (Mr @ x * (2.0 * values) + Cr @ x), axis=0)
    missing = np.abs(np.sum(s.conj() * bent, axis=0))
    errors = missing / np.maximum(np.abs(slope * values), np.finfo(float).tiny)
    return Pairs(values=values, right=x, left=y, errors=errors)


def added(V: Floats, more: Floats, M: Any) -> Floats:
    """A basis with more directions, orthonormal in M; those that it has already are left out."""
    more = more / np.maximum(np.sqrt(np.sum(more * (M @ more), axis=0)), np.finfo(float).tiny)
    for _ in range(2):
        more = more - V @ (V.T @ (M @ more))
    sizes, turn = np.linalg.eigh(more.T @ (M @ more))
    kept = sizes > DEPENDENT
    fresh = more @ (turn[:, kept] / np.sqrt(sizes[kept]))
    fresh = fresh - V @ (V.T @ (M @ fresh))
    return np.hstack([V, fresh])
