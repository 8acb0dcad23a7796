"""What least squares say about their parameters: covariance, and which of them cannot be told apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricmb.integrate.problem import Floats

#: Columns of the Jacobian whose condition is above this depend on one another as far as can be told.
_SINGULAR = 1e9
#: Above this a note says which parameters go together.
_CLOSE = 1e3
#: A parameter takes part in a direction with at least this share.
_SHARE = 0.1


@dataclass(frozen=True, kw_only=True)
class Uncertainty:
    """Covariance (n_p, n_p) for errors of size 1, condition, and notes."""

    covariance: Floats
    condition: float
    notes: tuple[str, ...]


def uncertainty(J: Floats, names: tuple[str, ...]) -> Uncertainty:
    """From the Jacobian of the residuals; its columns are scaled, so that units have no influence."""
    size = np.linalg.norm(J, axis=0)
    blind = [name for name, s in zip(names, size, strict=True) if s == 0.0]
    notes = [f"{name} has no influence on what was measured" for name in blind]
    scale = np.where(size > 0.0, size, 1.0)
    _, s, right = np.linalg.svd(J / scale, full_matrices=True)
    s = np.concatenate([s, np.zeros(len(names) - s.size)])
    lost = (s <= s[0] / _SINGULAR) | (s == 0.0)
    condition = float(s[0] / s[-1]) if s[-1] > 0.0 and not lost.any() else np.inf
    for value, direction in zip(s, right, strict=True):
        together = [n for n, share in zip(names, direction, strict=True) if abs(share) > _SHARE and n not in blind]
        if value < s[0] / _CLOSE and len(together) > 1:
            apart = "cannot be told apart" if value <= s[0] / _SINGULAR else "are hard to tell apart"
            notes.append(f"{' and '.join(together)} {apart} by what was measured (condition {_ratio(s[0], value)})")
    inverse = np.where(lost, 0.0, 1.0 / np.where(lost, 1.0, s))
    half = right.T * inverse / scale[:, None]
    covariance = half @ half.T
    for i in range(len(names)):
        if (lost & (np.abs(right[:, i]) > _SHARE)).any():
            covariance[i, i] = np.inf
    return Uncertainty(covariance=covariance, condition=condition, notes=tuple(notes))


def _ratio(largest: float, value: float) -> str:
    return f"{largest / value:.1e}" if value > 0.0 else "inf"
