"""Autoregressive models by Burg's method, and the choice of their order."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: Prediction error, relative to the signal's power, below which what is left is round-off: the model ends there.
ROUND_OFF = 1e-13

#: What is made smallest over the order m, from the number of samples n and the variance s of the prediction error.
CRITERIA: MappingProxyType[str, Callable[[int, Floats, Floats], Floats]] = MappingProxyType(
    {
        # H. Akaike, Ann. Inst. Statist. Math. 21 (1969) 407
        "FPE": lambda n, m, s: s * (n + m + 1) / (n - m - 1),
        # H. Akaike, IEEE Trans. Automat. Control 19 (1974) 716
        "AIC": lambda n, m, s: n * np.log(s) + 2 * m,
        # J. Rissanen, Automatica 14 (1978) 465
        "MDL": lambda n, m, s: n * np.log(s) + m * np.log(n),
    }
)


@dataclass(frozen=True)
class Autoregression:
    """Model ``sum_k a[k] x[t-k] = e[t]``, a[0] = 1, with the variance of the prediction error e."""

    a: Floats
    variance: float

    @property
    def order(self) -> int:
        """Number of coefficients after the first."""
        return len(self.a) - 1

    def density(self, omega: Floats, dt: float) -> Floats:
        """One-sided density over omega."""
        response = np.polynomial.polynomial.polyval(np.exp(-1j * omega * dt), self.a)
        density: Floats = self.variance * dt / np.pi / np.abs(response) ** 2
        return density


def burg(x: Floats, order: int, criterion: str | None = None) -> Autoregression:
    """Fit by Burg's recursion, up to ``order``.

    With a criterion the order is the one at which that is smallest.  The recursion ends early where the signal is
    predicted to round-off (a few sines without noise): more coefficients would fit the round-off and spoil the model.

    Notes
    -----
    J. P. Burg, Maximum entropy spectral analysis, 37th meeting of the Society of Exploration Geophysicists (1967).
    """
    reflections, variances = _recursion(x, order)
    count = len(reflections)
    if criterion is not None and count:
        m = np.arange(1, count + 1)
        value = CRITERIA[criterion](len(x), m.astype(float), np.maximum(variances[1:], np.finfo(float).tiny))
        count = 1 + int(np.argmin(value))
    return Autoregression(_coefficients(reflections[:count]), float(variances[count]))


def _recursion(x: Floats, order: int) -> tuple[Floats, Floats]:
    """Reflection coefficients (m,) and variances (m+1,)."""
    forward, backward = x[1:].copy(), x[:-1].copy()
    start = float(x @ x) / len(x)
    reflections: list[float] = []
    variances = [start]
    for _ in range(order):
        norm = float(forward @ forward + backward @ backward)
        if norm <= 0.0:
            break
        k = -2.0 * float(forward @ backward) / norm
        variance = variances[-1] * (1.0 - k**2)
        if variance <= ROUND_OFF * start and reflections:
            break
        reflections.append(k)
        variances.append(variance)
        forward, backward = (forward + k * backward)[1:], (backward + k * forward)[:-1]
    return np.array(reflections), np.array(variances)


def _coefficients(reflections: Floats) -> Floats:
    """Levinson's recursion."""
    a = np.zeros(len(reflections) + 1)
    a[0] = 1.0
    for m, k in enumerate(reflections, start=1):
        a[1 : m + 1] += k * a[m - 1 :: -1][:m]
    return a
