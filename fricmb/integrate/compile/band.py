"""Banded matrices, real and complex: factors with row pivoting by LAPACK, and solving with them.

Entry (i, j) of a matrix with ``half`` diagonals on either side stands at ``2 half + i - j`` in column j, which is
3 half + 1 long: space for the rows that pivoting brings.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.lapack import dgbtrf, dgbtrs, zgbtrf, zgbtrs
from fricmb.integrate.problem import Complexes, Floats, Pivots


def band_sizes(n: int, half: int) -> Pivots:
    """What the routines read: n, diagonals below and above, length of a column, right-hand sides, fault, 'N'."""
    return np.array([n, half, half, 3 * half + 1, 1, 0, ord("N")], np.int32)


@kernel
def factor_band(ab: Floats | Complexes, pivots: Pivots, sizes: Pivots) -> bool:
    """Factor in place; False where the matrix is singular."""
    n, kl, ku, ld, info = sizes[0:1], sizes[1:2], sizes[2:3], sizes[3:4], sizes[5:6]
    if np.iscomplexobj(ab):
        zgbtrf((n, n, kl, ku, ab, ld, pivots, info))
    else:
        dgbtrf((n, n, kl, ku, ab, ld, pivots, info))
    return bool(sizes[5] == 0)


@kernel
def solve_band(ab: Floats | Complexes, pivots: Pivots, sizes: Pivots, b: Floats | Complexes) -> None:
    """Overwrite b (n,) by the solution for the matrix whose factors are in ``ab``."""
    n, kl, ku, ld, one, info = sizes[0:1], sizes[1:2], sizes[2:3], sizes[3:4], sizes[4:5], sizes[5:6]
    if np.iscomplexobj(ab):
        zgbtrs((sizes[6:7], n, kl, ku, one, ab, ld, pivots, b, n, info))
    else:
        dgbtrs((sizes[6:7], n, kl, ku, one, ab, ld, pivots, b, n, info))


@kernel
def spread_of_pivots(ab: Floats, sizes: Pivots) -> float:
    """Smallest over largest pivot magnitude of a factored matrix: a cheap sign of near singularity."""
    length = sizes[3]
    diagonal = sizes[1] + sizes[2]
    low, high = np.inf, 0.0
    for j in range(sizes[0]):
        value = abs(ab[j * length + diagonal])
        low = min(low, value)
        high = max(high, value)
    return low / high if high > 0.0 else 0.0
