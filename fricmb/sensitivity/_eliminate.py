"""Maps of many short steps: assembled and eliminated one by one, where systems are too small for calls of LAPACK."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import entry, kernel
from fricmb.integrate.problem import Floats, Floats2, Floats3

#: Unknowns up to which elimination here is faster than a call of LAPACK.
SMALL = 64


@entry
def small_maps(A: Floats2, A2: Floats2, c: Floats, h: Floats, G: Floats3, n: int, found: Floats3) -> None:
    """Maps ``found`` (n_t, n_y, n_y + n_p) of steps, 0 before.

    ``A2`` is A A; ``G`` (n_t, s m, n_y + n_p): slopes of accelerations and rates, those of each stage together.
    """
    s = A.shape[0]
    rows, width = G.shape[1], G.shape[2]
    m = rows // s
    work = np.empty((rows, rows + width))
    for t in range(h.shape[0]):
        for i in range(s):
            for a in range(m):
                _row(work[i * m + a], A[i], A2[i], c[i], h[t], G[t, i * m + a], i * m + a, n, m)
        _eliminated(work, rows)
        _advanced(found[t], work, A[s - 1], A2[s - 1], h[t], n, m, rows)


@kernel
def _row(line: Floats, A: Floats, A2: Floats, c: float, h: float, G: Floats, number: int, n: int, m: int) -> None:
    """One equation of the stages, k - h A (G_v k + G_z k) - h^2 A^2 G_q k = G + h c G_q on velocities."""
    s, width = A.shape[0], G.shape[0]
    rows = s * m
    for j in range(s):
        near, far = -h * A[j], -h * h * A2[j]
        for b in range(n):
            line[j * m + b] = far * G[b] + near * G[n + b]
        for b in range(n, m):
            line[j * m + b] = near * G[n + b]
    line[number] += 1.0
    for b in range(width):
        line[rows + b] = G[b]
    for b in range(n):
        line[rows + n + b] += h * c * G[b]


@kernel
def _eliminated(work: Floats2, rows: int) -> None:
    """Solve by elimination with row pivoting: right-hand sides stand behind the matrix and become solutions."""
    whole = work.shape[1]
    for k in range(rows):
        best, top = k, abs(work[k, k])
        for i in range(k + 1, rows):
            if abs(work[i, k]) > top:
                best, top = i, abs(work[i, k])
        if best != k:
            for j in range(k, whole):
                x = work[k, j]
                work[k, j] = work[best, j]
                work[best, j] = x
        pivot = work[k]
        for i in range(k + 1, rows):
            own = work[i]
            x = own[k] / pivot[k]
            if x != 0.0:
                for j in range(k + 1, whole):
                    own[j] -= x * pivot[j]
    for k in range(rows - 1, -1, -1):
        pivot = work[k]
        x = 1.0 / pivot[k]
        for j in range(rows, whole):
            pivot[j] *= x
        for i in range(k):
            own = work[i]
            x = own[k]
            for j in range(rows, whole):
                own[j] -= x * pivot[j]


@kernel
def _advanced(
    found: Floats2, work: Floats2, b: Floats, b2: Floats, h: float, n: int, m: int, rows: int
) -> None:
    """The map from the stages: q + h v + h^2 sum b2 a, v + h sum b a, z + h sum b z'."""
    n_y, width = found.shape
    for i in range(n_y):
        found[i, i] = 1.0
    for i in range(n):
        found[i, n + i] += h
    for j in range(b.shape[0]):
        near, far = h * b[j], h * h * b2[j]
        for a in range(m):
            for k in range(width):
                x = work[j * m + a, rows + k]
                if a < n:
                    found[a, k] += far * x
                found[n + a, k] += near * x
