"""A body beside measurements: likeness of shapes, differences of frequencies and damping, and of responses."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from fricmb._facade import facade
from fricmb.measure._types import Complexes, Floats, Frf

if TYPE_CHECKING:
    from fricmb.plot._comparison import ComparisonPlots


@dataclass(frozen=True, kw_only=True, eq=False)
class Comparison:
    """Result of :meth:`ModalBody.compare`.

    Attributes
    ----------
    mac : (k_body, k_test)
        Modal assurance criterion: 1 for shapes that are alike at the points compared, 0 for orthogonal ones; empty
        without modes.
    pairs : tuple of (int, int)
        Modes of the body and of the test that belong together, by likeness and nearness of frequency.
    frequencies : ((k_body,), (k_test,))
        Angular.
    frequency_differences, damping_differences : (n_pairs,)
        Relative of the body to the test, and of damping ratios.
    responses : tuple of (Frf, array)
        Measured ones and those of the body at the same frequencies.
    r2 : tuple of float
        Coefficient of determination R^2 of each response, in decibels.
    """

    mac: Floats
    pairs: tuple[tuple[int, int], ...]
    frequencies: tuple[Floats, Floats]
    frequency_differences: Floats
    damping_differences: Floats
    responses: tuple[tuple[Frf, Complexes], ...] = ()
    r2: tuple[float, ...] = field(default=())

    def __str__(self) -> str:
        rows = [f"{'body':>6} {'test':>6} {'Hz':>12} {'difference':>11} {'damping':>10} {'MAC':>6}"]
        for (i, j), df, dz in zip(self.pairs, self.frequency_differences, self.damping_differences, strict=True):
            hertz = self.frequencies[1][j] / (2.0 * np.pi)
            rows.append(f"{i + 1:6} {j + 1:6} {hertz:12.6g} {100 * df:10.3f}% {dz:+10.2e} {self.mac[i, j]:6.3f}")
        for (frf, _), r2 in zip(self.responses, self.r2, strict=True):
            rows.append(f"{frf.node}.{frf.axis} over {frf.reference}.{frf.reference_axis}: R^2 {r2:.4f}")
        return "\n".join(rows)

    @property
    @facade
    def plot(self) -> ComparisonPlots:
        """Pictures: ``found.plot.mac()``, ``found.plot.responses()``."""


def assurance(a: Complexes | Floats, b: Complexes | Floats) -> Floats:
    """Modal assurance criterion (k_a, k_b) of shapes by columns (n, k)."""
    top = np.abs(a.conj().T @ b) ** 2
    sizes = np.outer(np.sum(np.abs(a) ** 2, axis=0), np.sum(np.abs(b) ** 2, axis=0))
    found: Floats = np.divide(top, sizes, out=np.zeros_like(top), where=sizes > 0.0)
    return found


def paired(mac: Floats, body: Floats, test: Floats) -> tuple[tuple[int, int], ...]:
    """Pairs of modes, each once, by likeness and nearness of frequency; alike by less than a half are none."""
    from scipy.optimize import linear_sum_assignment

    if not mac.size:
        return ()
    distance = np.abs(np.log(np.maximum(body, 1e-12)[:, None] / np.maximum(test, 1e-12)))
    rows, columns = linear_sum_assignment(-mac + np.minimum(distance, 2.0))
    kept = [(int(i), int(j)) for i, j in zip(rows, columns, strict=True) if mac[i, j] >= 0.5]
    return tuple(sorted(kept, key=lambda pair: pair[1]))


def likeness(measured: Complexes, computed: Complexes) -> float:
    """R^2 of magnitudes in decibels, where both are finite."""
    kept = np.isfinite(measured) & np.isfinite(computed) & (np.abs(measured) > 0.0) & (np.abs(computed) > 0.0)
    a, b = 20 * np.log10(np.abs(measured[kept])), 20 * np.log10(np.abs(computed[kept]))
    total = float(np.sum((a - a.mean()) ** 2))
    return 1.0 - float(np.sum((a - b) ** 2)) / total if total > 0.0 else float(np.allclose(a, b))
