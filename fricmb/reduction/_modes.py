"""What a reduction gives: frequencies, damping, shapes at points, and what was neglected."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: Modal damping off the diagonal below this part of the diagonal counts as round-off.
PROPORTIONAL = 1e-9


@dataclass(frozen=True, kw_only=True)
class Reduced:
    """A structure in modes of unit modal mass.

    Attributes
    ----------
    frequencies : (n,)
        Angular, rising; the residual ones last.
    damping_ratios : (n,)
        Of the diagonal of the modal damping; 0 for rigid modes.
    damping : (n, n) or None
        The whole modal damping matrix where it is not diagonal or damps rigid modes.
    shapes : dict of str to (d, n)
        Rows of the mode shapes at the points.
    residual : int
        How many of the last modes are residual vectors.
    neglected : float
        Share of the static flexibility at the points that truncated modes carry (and residual vectors replace).
    """

    frequencies: Floats
    damping_ratios: Floats
    damping: Floats | None
    shapes: dict[str, Floats]
    residual: int = 0
    neglected: float = 0.0


def split_damping(C: Floats, omega: Floats) -> tuple[Floats, Floats | None]:
    """Damping ratios (n,), and the matrix itself where ratios do not say all (coupled, rigid or driven modes)."""
    diagonal = np.diagonal(C)
    elastic = omega > 0.0
    ratios = np.divide(diagonal, 2.0 * omega, out=np.zeros_like(omega), where=elastic)
    size = float(np.abs(C).max(initial=0.0))
    off = float(np.abs(C - np.diag(diagonal)).max(initial=0.0))
    rigid = (np.abs(diagonal[~elastic]) > PROPORTIONAL * size).any()
    # ratios are no negative numbers: a C that drives is kept as a matrix
    drives = (diagonal < -PROPORTIONAL * size).any()
    if off <= PROPORTIONAL * size and not rigid and not drives:
        return np.maximum(ratios, 0.0), None
    return np.maximum(ratios, 0.0), C


def ritz(vectors: Floats, K: Floats, M: Floats) -> tuple[Floats, Floats]:
    """Frequencies (r,) and M-orthonormal combinations of vectors (n, r') that are nearly dependent, strongest first.

    ``K`` and ``M`` (r', r') are the matrices in the vectors.
    """
    scale = 1.0 / np.sqrt(np.maximum(np.diagonal(M), np.finfo(float).tiny))
    values, basis = np.linalg.eigh(M * scale[:, None] * scale)
    held = values > 1e-10 * values.max(initial=0.0)
    white = scale[:, None] * basis[:, held] / np.sqrt(values[held])
    w2, turn = np.linalg.eigh(white.T @ K @ white)
    return np.sqrt(np.maximum(w2, 0.0)), vectors @ (white @ turn)
