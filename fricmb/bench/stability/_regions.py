"""Stability regions of the formulas as the integrators have them: their coefficients are read out of the code.

A formula is applied to y' = lambda y with step h, z = h lambda; it is stable where no solution grows.  BDF: roots zeta
of sum_j (1 - 1/zeta)^j / j = z (Hairer and Wanner, Solving ODEs II, III.1, V.1).  Radau IIA:
R(z) = 1 + z b (I - z A)^-1 1.  The exact transfer of ``collocation``: exp(z), up to the step lengths where it is used.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricmb.bench._reference import Floats
from fricmb.integrate.formulas.backward_differences import MAX_ORDER
from fricmb.integrate.formulas.tableau import radau
from fricmb.integrate.implicit.bdf.bdf_stability import backward_polynomial

Complexes = NDArray[np.complex128]
ComplexFloats = NDArray[np.complexfloating[Any, Any]]

STAGES = range(2, 10)


def bdf_growth(k: int, z: Complexes | ComplexFloats) -> Floats:
    """Largest amplification a step of BDF of order k, for each z."""
    polynomial = backward_polynomial(k).astype(complex)
    out = np.empty(z.shape)
    for i, value in np.ndenumerate(z):
        shifted = polynomial.copy()
        shifted[0] -= value
        roots = np.roots(shifted[::-1])
        smallest = np.abs(roots).min()
        out[i] = 1.0 / smallest if smallest > 0.0 else np.inf
    return out


def radau_growth(s: int, z: Complexes | ComplexFloats) -> Floats:
    """|R(z)| of Radau IIA with s stages."""
    tableau = radau(s)
    out = np.empty(z.shape)
    for i, value in np.ndenumerate(z):
        stages = np.linalg.solve(np.eye(s) - value * tableau.A, np.ones(s))
        out[i] = abs(1.0 + value * (tableau.b @ stages))
    return out


def axis_table() -> list[dict[str, float | str]]:
    """Behaviour on the imaginary axis of each formula: largest growth, where, and the loss at small z."""
    w = np.linspace(0.02, 12.0, 600)
    z = 1j * w
    rows: list[dict[str, float | str]] = []
    formulas = [(f"BDF {k}", bdf_growth(k, z)) for k in range(1, MAX_ORDER + 1)]
    formulas += [(f"Radau IIA, {s} stages", radau_growth(s, z)) for s in STAGES]
    for name, growth in formulas:
        worst = int(growth.argmax())
        unstable = w[growth > 1.0 + 1e-12]
        rows.append(
            {
                "formula": name,
                "largest growth a step": float(growth[worst]),
                "at h omega": float(w[worst]),
                "unstable from": float(unstable[0]) if len(unstable) else float("nan"),
                "to": float(unstable[-1]) if len(unstable) else float("nan"),
                "loss a radian at h omega = 0.5": float(-np.log(np.interp(0.5, w, growth)) / 0.5),
            }
        )
    return rows


def angle(k: int) -> float:
    """Largest alpha in degrees for which BDF of order k is A(alpha)-stable, from its boundary locus."""
    theta = np.linspace(1e-4, np.pi, 20_000)
    difference = 1.0 - np.exp(-1j * theta)
    z = sum(difference**j / j for j in range(1, k + 1))
    left = z[z.real < 0.0]
    if not len(left):
        return 90.0
    return float(np.degrees(np.abs(np.arctan2(np.abs(left.imag), -left.real)).min()))
