"""Which orders of BDF may be used at a step size: growth of lightly damped oscillations.

BDF of order 3 and more amplifies oscillations on parts of the imaginary axis (Gear 1971, ch. 11; Hairer and Wanner,
Solving ODEs II, V.1).  An error of size 1e-16 in an undamped mode that a step does not resolve then grows until it
matters.  The spectrum of the scene says how fast, at a step size.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.room import room
from fricmb.integrate.csr import Csr
from fricmb.integrate.model.structure import Structure
from fricmb.integrate.problem import Floats, Floats2, Problem

MAX_ORDER = 5
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


class BdfGuard(NamedTuple):
    """What keeps BDF from growing on lightly damped oscillations, and from overlooking a transition.

    ``growth`` table of :mod:`~fricmb.integrate.methods.bdf_stability`, ``omega`` and ``decay`` spectrum of the scene.
    ``over`` (n_c+1,) how fast stuck forces came nearer to their limits in the last step, and its length.
    """

    growth: Floats2
    omega: Floats
    decay: Floats
    over: Floats


def guard_of(problem: Problem, spectrum: tuple[Floats, Floats]) -> BdfGuard:
    """Of a scene with frequencies and decay rates of the structure, ``spectrum``."""
    omega, decay = (np.ascontiguousarray(x, dtype=float) for x in spectrum)
    return room(BdfGuard(growth_table(), omega, decay, np.zeros(problem.n_c + 1)))


@lru_cache(maxsize=1)
def no_guard() -> BdfGuard:
    """Of a run in which no step is one of BDF."""
    return room(BdfGuard(np.zeros((0, 0)), np.zeros(0), np.zeros(0), np.zeros(0)))


#: Structures of more degrees of freedom are not diagonalised for this.
WHOLE = 256


def spectrum(problem: Problem, structure: Structure, K: Floats, C: Floats) -> tuple[Floats, Floats]:
    """Frequencies and decay rates of M x'' + C x' + K x = 0, without friction; K and C on the structure's pattern.

    None where a stiffness has no value, as that of a root at 0: nothing oscillates about such a place.
    """
    n = problem.n
    if not (np.isfinite(K).all() and np.isfinite(C).all()):
        return np.zeros(0), np.zeros(0)
    if n > WHOLE:
        if len(problem.omega) == n:
            return problem.omega, problem.omega * problem.zeta
        # a bound: any frequency up to it may be there
        top = np.sqrt(structure.mobility.max() * np.bincount(structure.column, np.abs(K), n).max())
        return np.concatenate([[0.0], top * np.geomspace(1e-4, 1.0, 256)]), np.zeros(257)
    inverse = Csr((n, n), structure.Minv_start, structure.Minv_index, structure.Minv).dense()
    whole_K, whole_C = (Csr((n, n), structure.first, structure.column, part).dense() for part in (K, C))
    values, shapes = np.linalg.eig(inverse @ whole_K)
    try:
        damping = np.real(np.diag(np.linalg.solve(shapes, inverse @ whole_C @ shapes)))
    except np.linalg.LinAlgError:
        damping = np.zeros(len(values))
    return np.sqrt(np.maximum(values.real, 0.0)), 0.5 * np.maximum(damping, 0.0)


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
