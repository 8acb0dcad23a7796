"""A model of many degrees of freedom, with friction and gyroscopic parts, in few coordinates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fricmb.errors import SceneError
from fricmb.reduction._enrich import Pencil, enriched
from fricmb.reduction._factor import factor
from fricmb.reduction._matrices import residual_vectors
from fricmb.reduction._modes import Floats, Reduced, split_damping
from fricmb.reduction._pencil import SHIFT, lowest_modes


@dataclass(frozen=True, kw_only=True)
class ReducedModel(Reduced):
    """A structure in modes and what a basis of squeal adds to them.

    Attributes
    ----------
    parts : dict of str to (n, n)
        Matrices beside mass, damping and stiffness, in the same coordinates.
    errors : tuple of float
        Largest relative error of eigenvalues at each sample, estimated from the residuals of the quadratic problem.
    """

    parts: dict[str, Floats] = field(default_factory=dict)
    errors: tuple[float, ...] = ()


def reduce_model(
    label: str,
    matrices: Mapping[str, Any],
    parts: Mapping[str, Any],
    rows: Mapping[str, Floats],
    *,
    count: int | None,
    top: float | None,
    residual: bool,
    samples: Sequence[Mapping[str, tuple[str, float]]] = (),
    structural_at: float | None = None,
    tolerance: float = 1e-6,
) -> ReducedModel:
    """Modes, residual vectors and complex modes of a model.

    Parameters
    ----------
    label : str
        Who asks, for messages.
    matrices : dict
        M, K symmetric; C, H optional, or None.
    parts : dict of str to sparse
    rows : dict of str to (n_axes, n)
        Displacements of the points.
    count, top : int and float, optional
        Number of modes, or the angular frequency up to which they are taken; both: whichever is less.
    residual : bool
    samples : sequence of dict
        Of parts: the matrix that each is added to ("M", "C" or "K"), and its factor there.
    structural_at : float, optional
        Angular frequency at which structural damping is turned into viscous; by default each mode's own.
    tolerance : float
        Of eigenvalues at the samples, relative.

    Raises
    ------
    SceneError
    """
    M, K, C, H = matrices["M"], matrices["K"], matrices.get("C"), matrices.get("H")
    found = lowest_modes(label, M, K, count=count, up_to=top)
    omega, modes = np.sqrt(found.omega2), found.shapes
    if omega.size == 0:
        raise SceneError(f"{label}: there is no mode up to the given frequency")
    basis, neglected = modes, 0.0
    if residual and rows and omega.size < M.shape[0]:
        _, more, neglected = residual_vectors(M, K, omega, modes, np.vstack(list(rows.values())))
        basis = np.hstack([modes, more])
    errors: list[float] = []
    if samples:
        highest = float(omega[-1]) if top is None else top
        pencils = [_at(M, K, C, H, parts, sample, structural_at or 0.5 * highest) for sample in samples]
        shift = SHIFT * float(K.diagonal().sum()) / float(M.diagonal().sum())
        flexible = factor((K + shift * M).tocsc())
        more, errors = enriched(basis, pencils, M, flexible, highest, tolerance)
        basis = np.hstack([basis, more])
    extra = basis.shape[1] - omega.size
    if extra:
        # the modes are orthogonal in K to all that was added: only that is turned
        more = basis[:, omega.size :]
        w2, turn = np.linalg.eigh(more.T @ (K @ more))
        omega, basis = np.concatenate([omega, np.sqrt(np.maximum(w2, 0.0))]), np.hstack([modes, more @ turn])
    damping = np.zeros((omega.size, omega.size)) if C is None else basis.T @ (C @ basis)
    if H is not None:
        damping = damping + _structural(basis.T @ (H @ basis), omega, structural_at)
    ratios, full = split_damping(damping, omega)
    return ReducedModel(
        frequencies=omega,
        damping_ratios=ratios,
        damping=full,
        shapes={name: row @ basis for name, row in rows.items()},
        residual=extra,
        neglected=neglected,
        parts={name: basis.T @ (matrix @ basis) for name, matrix in parts.items()},
        errors=tuple(errors),
    )


def _at(
    M: Any, K: Any, C: Any, H: Any, parts: Mapping[str, Any], sample: Mapping[str, tuple[str, float]], omega: float
) -> Pencil:
    """The matrices at one sample."""
    empty = 0.0 * K
    held = {"M": M, "C": empty if C is None else C, "K": K}
    if H is not None:
        held["C"] = held["C"] + H / omega
    for name, (target, value) in sample.items():
        held[target] = held[target] + value * parts[name]
    return Pencil(M=held["M"].tocsr(), C=held["C"].tocsr(), K=held["K"].tocsr())


def _structural(H: Floats, omega: Floats, at: float | None) -> Floats:
    """Viscous damping of the same loss at one frequency, or at each mode's own; rigid modes have none."""
    if at is not None:
        return H / at
    inverse = np.divide(1.0, np.sqrt(omega), out=np.zeros_like(omega), where=omega > 0.0)
    return H * inverse[:, None] * inverse
