"""LU factors that are kept: of the small dense systems of contacts, solved with again while Newton converges."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.lapack import dgetrf, dgetrs
from fricmb.integrate.problem import Floats, Floats2, Pivots

#: Rows up to which elimination here is faster than a call of LAPACK.
SMALL = 24


@kernel
def lu_factor(a: Floats2, sizes: Pivots, pivots: Pivots) -> bool:
    """Overwrite a (n, n) by its LU factors with row pivoting; False where it is singular."""
    n = a.shape[0]
    if n > SMALL:
        sizes[0] = n
        sizes[2] = 0
        # LAPACK reads columns; factors of the transpose would share loads otherwise between redundant contacts
        for i in range(n):
            for j in range(i):
                x = a[i, j]
                a[i, j] = a[j, i]
                a[j, i] = x
        dgetrf((sizes[:1], sizes[:1], a, sizes[:1], pivots, sizes[2:]))
        return bool(sizes[2] == 0)
    for k in range(n):
        best, top = k, abs(a[k, k])
        for i in range(k + 1, n):
            if abs(a[i, k]) > top:
                best, top = i, abs(a[i, k])
        if not top > 0.0:
            return False
        pivots[k] = best
        if best != k:
            for j in range(n):
                x = a[k, j]
                a[k, j] = a[best, j]
                a[best, j] = x
        line = a[k, k + 1 :]
        for i in range(k + 1, n):
            x = a[i, k] / a[k, k]
            a[i, k] = x
            if x != 0.0:
                row = a[i, k + 1 :]
                for j in range(line.shape[0]):
                    row[j] -= x * line[j]
    return True


@kernel
def lu_solve(a: Floats2, b: Floats, sizes: Pivots, pivots: Pivots) -> None:
    """Overwrite b (n,) by the solution for the matrix whose factors are in a."""
    n = a.shape[0]
    if n > SMALL:
        sizes[0] = n
        sizes[1] = 1
        sizes[2] = 0
        sizes[3] = ord("N")
        dgetrs((sizes[3:], sizes[:1], sizes[1:], a, sizes[:1], pivots, b, sizes[:1], sizes[2:]))
        return
    for k in range(n):
        i = pivots[k]
        if i != k:
            x = b[k]
            b[k] = b[i]
            b[i] = x
    for i in range(1, n):
        x = b[i]
        for j in range(i):
            x -= a[i, j] * b[j]
        b[i] = x
    for i in range(n - 1, -1, -1):
        x = b[i]
        for j in range(i + 1, n):
            x -= a[i, j] * b[j]
        b[i] = x / a[i, i]
