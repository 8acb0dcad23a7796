"""Banded matrices, real and complex: factors with row pivoting, and solving with them; they may have a border.

Entry (i, j) of a matrix with ``half`` diagonals on either side stands at ``2 half + i - j`` in column j, which is
3 half + 1 long: space for the rows that pivoting brings.  Wide bands are LAPACK's; in narrow ones a call of it costs
more than the arithmetic, and the same elimination is done here.

The last unknowns may be a *border* that meets all others, such as the forces of a few contacts on many modes:

    [ B  R ]     B banded, R its columns, L its rows, D the corner, a full matrix kept as a band, too;
    [ L  D ]     what is solved in the end is D - L B^-1 R.

The array holds B, then R by columns, L by rows, and D.  Rows of the border are no pivots of B.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.lapack import dgbtrf, dgbtrs, zgbtrf, zgbtrs
from fricmb.integrate.problem import Complexes, Floats, Pivots


def band_sizes(n: int, half: int, border: int = 0) -> Pivots:
    """What the routines read: n, diagonals below and above, length of a column, right-hand sides, fault, 'N'.

    The same again of the corner of a border.
    """
    own = [n, half, half, 3 * half + 1, 1, 0, ord("N")]
    far = max(border - 1, 0)
    return np.array([*own, border, far, far, 3 * far + 1, 1, 0, ord("N")], np.int32)


def length_of(sizes: Pivots) -> int:
    """Numbers that a matrix is kept as."""
    n, border = int(sizes[0]), int(sizes[CORNER])
    return n * int(sizes[3]) + 2 * n * border + border * int(sizes[CORNER + 3])


#: Where the sizes of a border's corner begin.
CORNER = 7


#: Diagonals on either side up to which loops here are faster than calls of LAPACK (mechanisms of 6 to 40 unknowns).
NARROW = 20


@kernel
def place_of(sizes: Pivots, i: int, j: int) -> int:
    """Where entry (i, j) stands."""
    n, border = int(sizes[0]), int(sizes[CORNER])
    if i < n and j < n:
        return int(j * sizes[3] + sizes[1] + sizes[2] + i - j)
    right = n * int(sizes[3])
    if i < n:
        return right + (j - n) * n + i
    if j < n:
        return right + border * n + (i - n) * n + j
    return int(right + 2 * border * n + (j - n) * sizes[CORNER + 3] + 2 * sizes[CORNER + 1] + i - j)


@kernel
def factor_band(ab: Floats | Complexes, pivots: Pivots, sizes: Pivots) -> bool:
    """Factor in place; False where the matrix is singular."""
    if not factor_plain(ab, pivots, sizes):
        return False
    border = int(sizes[CORNER])
    if border == 0:
        return True
    n = int(sizes[0])
    right = n * int(sizes[3])
    below, corner = right + border * n, right + 2 * border * n
    for c in range(border):
        line = ab[right + c * n : right + (c + 1) * n]
        solve_plain(ab, pivots, sizes, line)
        for r in range(border):
            row = ab[below + r * n : below + (r + 1) * n]
            at, total = corner + c * int(sizes[CORNER + 3]) + 2 * int(sizes[CORNER + 1]) + r - c, 0.0 * ab[0]
            for i in range(n):
                total += row[i] * line[i]
            ab[at] -= total
    return factor_plain(ab[corner:], pivots[n:], sizes[CORNER:])


@kernel
def solve_band(
    ab: Floats | Complexes, pivots: Pivots, sizes: Pivots, b: Floats | Complexes, alone: bool = False
) -> None:
    """Overwrite b (n,) by the solution for the matrix whose factors are in ``ab``.

    ``alone``: of b nothing but what belongs to the border is not 0, where there is one.
    """
    border, n = int(sizes[CORNER]), int(sizes[0])
    if border == 0:
        solve_plain(ab, pivots, sizes, b)
        return
    right = n * int(sizes[3])
    below, corner = right + border * n, right + 2 * border * n
    first, last = b[:n], b[n:]
    if not alone:
        solve_plain(ab, pivots, sizes, first)
        for r in range(border):
            row, total = ab[below + r * n : below + (r + 1) * n], 0.0 * b[0]
            for i in range(n):
                total += row[i] * first[i]
            last[r] -= total
    solve_plain(ab[corner:], pivots[n:], sizes[CORNER:], last)
    for c in range(border):
        line, x = ab[right + c * n : right + (c + 1) * n], last[c]
        for i in range(n):
            first[i] -= line[i] * x


@kernel
def factor_plain(ab: Floats | Complexes, pivots: Pivots, sizes: Pivots) -> bool:
    """Factor a matrix without a border in place."""
    if sizes[1] <= NARROW:
        return eliminate(ab, pivots, sizes)
    n, kl, ku, ld, info = sizes[0:1], sizes[1:2], sizes[2:3], sizes[3:4], sizes[5:6]
    if np.iscomplexobj(ab):
        zgbtrf((n, n, kl, ku, ab, ld, pivots, info))
    else:
        dgbtrf((n, n, kl, ku, ab, ld, pivots, info))
    return bool(sizes[5] == 0)


@kernel
def solve_plain(ab: Floats | Complexes, pivots: Pivots, sizes: Pivots, b: Floats | Complexes) -> None:
    """Solve with the factors of a matrix without a border."""
    if sizes[1] <= NARROW:
        substitute(ab, pivots, sizes, b)
        return
    n, kl, ku, ld, one, info = sizes[0:1], sizes[1:2], sizes[2:3], sizes[3:4], sizes[4:5], sizes[5:6]
    if np.iscomplexobj(ab):
        zgbtrs((sizes[6:7], n, kl, ku, one, ab, ld, pivots, b, n, info))
    else:
        dgbtrs((sizes[6:7], n, kl, ku, one, ab, ld, pivots, b, n, info))


@kernel
def size_of(x: complex) -> float:
    """What pivots are compared by: the magnitude of a real number, and of a complex one that of LAPACK."""
    return float(abs(x.real) + abs(x.imag))


@kernel
def eliminate(ab: Floats | Complexes, pivots: Pivots, sizes: Pivots) -> bool:
    """Factor a narrow band as LAPACK's ``gbtf2`` does, passing over entries that are 0; pivots are left inverted."""
    n, half, length = int(sizes[0]), int(sizes[1]), int(sizes[3])
    for j in range(n):
        for i in range(half):
            ab[j * length + i] = 0.0
    last = 0
    for j in range(n):
        diagonal = j * length + 2 * half
        below = min(half, n - 1 - j)
        p, most = 0, size_of(ab[diagonal])
        for i in range(1, below + 1):
            size = size_of(ab[diagonal + i])
            if size > most:
                p, most = i, size
        pivots[j] = j + p + 1
        if not most > 0.0:
            return False
        last = max(last, min(j + half + p, n - 1))
        for c in range(j, last + 1 if p > 0 else j):
            at = diagonal + (c - j) * (length - 1)
            ab[at], ab[at + p] = ab[at + p], ab[at]
        inverse = 1.0 / ab[diagonal]
        ab[diagonal] = inverse
        for i in range(1, below + 1):
            ab[diagonal + i] *= inverse
        for c in range(j + 1, last + 1):
            at = diagonal + (c - j) * (length - 1)
            factor = ab[at]
            if factor != 0.0:
                for i in range(1, below + 1):
                    ab[at + i] -= ab[diagonal + i] * factor
    return True


@kernel
def substitute(ab: Floats | Complexes, pivots: Pivots, sizes: Pivots, b: Floats | Complexes) -> None:
    """Solve with the factors of a narrow band."""
    n, half, length = int(sizes[0]), int(sizes[1]), int(sizes[3])
    for j in range(n - 1):
        p = pivots[j] - 1
        x = b[p]
        if p != j:
            b[p] = b[j]
            b[j] = x
        if x != 0.0:
            for i in range(1, min(half, n - 1 - j) + 1):
                b[j + i] -= ab[j * length + 2 * half + i] * x
    for j in range(n - 1, -1, -1):
        x = b[j] * ab[j * length + 2 * half]
        b[j] = x
        if x != 0.0:
            for i in range(1, min(2 * half, j) + 1):
                b[j - i] -= ab[j * length + 2 * half - i] * x


@kernel
def spread_of_pivots(ab: Floats, sizes: Pivots) -> float:
    """Smallest over largest pivot magnitude of a factored matrix: a cheap sign of near singularity.

    (The same of inverses, which narrow bands hold.)
    """
    length = sizes[3]
    diagonal = sizes[1] + sizes[2]
    low, high = np.inf, 0.0
    for j in range(sizes[0]):
        value = abs(ab[j * length + diagonal])
        low = min(low, value)
        high = max(high, value)
    return low / high if high > 0.0 else 0.0
