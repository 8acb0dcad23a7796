"""Which orders of BDF may be used at a step size: growth of lightly damped oscillations.

BDF of order 3 and more amplifies oscillations on parts of the imaginary axis (Gear 1971, ch. 11; Hairer and Wanner,
Solving ODEs II, V.1).  An error of size 1e-16 in an undamped mode that a step does not resolve then grows until it
matters.  The spectrum of the scene says how fast, at a step size.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.formulas.backward_differences import MAX_ORDER
from fricmb.integrate.problem import Floats, Floats2

#: z = h omega of the table's columns.
SPACING, COLUMNS = 0.02, 600


def backward_polynomial(k: int) -> Floats:
    """Coefficients of sum_{j=1..k} (1 - x)^j / j, x the shift back by a step: BDF of order k, lowest power first."""
    total = np.zeros(k + 1)
    power = np.ones(1)
    for j in range(1, k + 1):
        power = np.convolve(power, [1.0, -1.0])
        total[: j + 1] += power / j
    return total


@lru_cache(maxsize=1)
def growth_table() -> Floats:
    """Log of the largest amplification a step (orders 0 to 5 by z = 0, 0.02, ...), 0 where there is none."""
    table = np.zeros((MAX_ORDER + 1, COLUMNS))
    for k in range(3, MAX_ORDER + 1):
        polynomial = backward_polynomial(k)
        for i in range(1, COLUMNS):
            shifted = polynomial.astype(complex)
            shifted[0] -= 1j * SPACING * i
            # roots in x = 1/zeta: the amplification is 1 / min |x|
            table[k, i] = max(0.0, -np.log(np.min(np.abs(np.roots(shifted[::-1])))))
    return table


class BdfGuard(Layout):
    """What keeps BDF from growing on lightly damped oscillations, as far as the spectrum of the scene tells.

    ``growth`` table of this module, ``omega`` and ``decay`` of the oscillations.
    """

    growth: Floats2
    omega: Floats
    decay: Floats


def guard_of(spectrum: tuple[Floats, Floats]) -> BdfGuard:
    """Of a scene with frequencies and decay rates of the structure, ``spectrum``."""
    omega, decay = (np.ascontiguousarray(x, dtype=float) for x in spectrum)
    return BdfGuard(growth_table(), omega, decay)


@lru_cache(maxsize=1)
def no_guard() -> BdfGuard:
    """Of a run in which every order may be used."""
    return BdfGuard(np.zeros((0, 0)), np.zeros(0), np.zeros(0))


#: Structures of more degrees of freedom are not diagonalised for this.
WHOLE = 256


def spectrum(M: Floats2, C: Floats2, K: Floats2) -> tuple[Floats, Floats]:
    """Frequencies and decay rates of M x'' + C x' + K x = 0, without friction.

    None where a stiffness has no value, as that of a root at 0: nothing oscillates about such a place.
    """
    if not (np.isfinite(K).all() and np.isfinite(C).all()):
        return np.zeros(0), np.zeros(0)
    values, shapes = np.linalg.eig(np.linalg.solve(M, K))
    try:
        damping = np.real(np.diag(np.linalg.solve(shapes, np.linalg.solve(M, C) @ shapes)))
    except np.linalg.LinAlgError:
        damping = np.zeros(len(values))
    return np.sqrt(np.maximum(values.real, 0.0)), 0.5 * np.maximum(damping, 0.0)


def spectrum_within(mass: Floats, stiffness: Floats) -> tuple[Floats, Floats]:
    """Frequencies up to a bound, any of which may be there undamped: masses, and sums of magnitudes of rows of K."""
    if not np.isfinite(stiffness).all():
        return np.zeros(0), np.zeros(0)
    top = np.sqrt((stiffness / mass).max())
    return np.concatenate([[0.0], top * np.geomspace(1e-4, 1.0, 256)]), np.zeros(257)


@kernel
def admissible(guard: BdfGuard, k: int, h: float, left: float) -> bool:
    """Whether round-off in every oscillation stays small under order k at step h for the rest of the run."""
    if k < 3:
        return True
    for j in range(guard.omega.shape[0]):
        x = guard.omega[j] * h / SPACING
        i = int(min(x, COLUMNS - 1.0))
        growth = guard.growth[k, i]
        if i + 1 < COLUMNS:
            growth += (x - i) * (guard.growth[k, i + 1] - growth)
        if (growth / h - guard.decay[j]) * left > 2.0:
            return False
    return True
