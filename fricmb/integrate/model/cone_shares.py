"""Shares of what a group holds, each force anywhere within its own cone: the ones with the most to spare.

A contact that cannot slip without others bears what these leave to it.  Forces F and loads N of the group are known
but for what does nothing to the motion, ``F + Z x`` and limits ``L + S x`` (shares may change the loads, as where a
ladder leans on a wall).  The group holds as long as some x has ``|F + Z x| <= L + S x`` in every cone: what is sought
is the x with the largest least margin, ``max s`` with ``|F + Z x| + s u <= L + S x``, u the size of a cone.  That is a
problem over second-order cones, and a linear one where slip has one direction.

It is solved by cutting planes (Kelley, SIAM Journal on Applied Mathematics 8, 1960, 703-712): the cone that is left
furthest gives a plane, which replaces one of the d planes that s is bounded by, as in the simplex method.  The weights
of these planes are the certificate that no more is to be had.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.compile.lu import lu_factor, lu_solve
from fricmb.integrate.problem import Codes, Floats, Floats2, Ints

#: Planes tried at most, and what margins, in the sizes of cones, are found to.
PLANES, TIGHT = 400, 1e-14
#: Margin, in sizes of cones, and share beyond which nothing is looked for: groups that jam.
FAR = 100.0
#: Margin, in sizes of cones, that is enough: with more to spare shares stay as near as may be to those there were.
ENOUGH = 1e-2


class Cones(Layout):
    """Cones of a group: cone c has rows ``row[c]:row[c+1]`` of F (m,) and Z (m, r), none where there is no friction.

    Z is what shares of size 1 bring: forces as large as what the group bears, so that no number depends on units.
    ``held`` (k,) 0 leaves a cone out; ``limit`` (k,), ``slope`` (k, r), ``size`` (k,) its limit, how that follows the
    shares, and the unit of its margin.
    """

    row: Ints
    held: Codes
    F: Floats
    Z: Floats2
    limit: Floats
    slope: Floats2
    size: Floats


@kernel
def shared(cones: Cones, x: Floats, a: int) -> float:
    """Row a of F + Z x."""
    value = cones.F[a]
    for j in range(cones.Z.shape[1]):
        value += cones.Z[a, j] * x[j]
    return float(value)


@kernel
def spare_of(cones: Cones, x: Floats, c: int) -> float:
    """Margin of cone c, in its size."""
    square, limit = 0.0, cones.limit[c]
    for a in range(cones.row[c], cones.row[c + 1]):
        square += shared(cones, x, a) ** 2
    for j in range(cones.Z.shape[1]):
        limit += cones.slope[c, j] * x[j]
    return float((limit - np.sqrt(square)) / cones.size[c])


@kernel
def tightest(cones: Cones, x: Floats) -> int:
    """The cone with the least margin; -1 where there is none."""
    found, least = -1, np.inf
    for c in range(cones.held.shape[0]):
        if cones.held[c] != 0:
            value = spare_of(cones, x, c)
            if value < least:
                found, least = c, value
    return found


@kernel
def plane_of(cones: Cones, x: Floats, c: int, plane: Floats) -> None:
    """Normal (r + 1,) of the plane that touches cone c at x."""
    r = cones.Z.shape[1]
    square = 0.0
    for a in range(cones.row[c], cones.row[c + 1]):
        square += shared(cones, x, a) ** 2
    length = max(np.sqrt(square), 1e-300)
    for j in range(r):
        plane[j] = -cones.slope[c, j]
        for a in range(cones.row[c], cones.row[c + 1]):
            plane[j] += cones.Z[a, j] * shared(cones, x, a) / length
        plane[j] /= cones.size[c]
    plane[r] = 1.0


@kernel
def solve_planes(B: Floats2, y: Floats, transposed: bool) -> bool:
    """Overwrite y by the solution for B, or its transpose."""
    d = y.shape[0]
    A = np.zeros((d, d))
    for i in range(d):
        for j in range(d):
            A[i, j] = B[j, i] if transposed else B[i, j]
    sizes, pivots = np.zeros(4, np.int32), np.zeros(d, np.int32)
    if not lu_factor(A, sizes, pivots):
        return False
    lu_solve(A, y, sizes, pivots)
    return True


@kernel
def most_spare(cones: Cones, x: Floats, weight: Floats) -> float:
    """Shares x (r,) with the most to spare, and the margin of the tightest cone, in its size; below 0: nothing holds.

    ``weight`` (k,) becomes what each cone counts for in the bound that this is the most: those
    above 0 give way together.
    """
    d = x.shape[0] + 1
    B, b, who = np.zeros((d, d)), np.zeros(d), np.full(d, -1)
    for i in range(d):
        B[i, i] = 1.0
        b[i] = FAR if i == d - 1 else FAR * (1.0 + 0.01 * i)
    at, y, plane, best = np.zeros(d), np.zeros(d), np.zeros(d), x.copy()
    most = -np.inf
    for _ in range(PLANES):
        at[:] = b
        y[:] = 0.0
        y[d - 1] = 1.0
        if not (solve_planes(B, at, False) and solve_planes(B, y, True)):
            break
        c = tightest(cones, at[: d - 1])
        spare = spare_of(cones, at[: d - 1], c)
        if spare > most:
            most = spare
            best[:] = at[: d - 1]
            weight[:] = 0.0
            for i in range(d):
                if who[i] >= 0:
                    weight[who[i]] += max(y[i], 0.0)
        beyond, wall = at[d - 1] - spare, -1
        for j in range(d - 1):
            if abs(at[j]) > 2.0 * FAR and abs(at[j]) > beyond:
                beyond, wall = abs(at[j]), j
        if beyond <= TIGHT * max(1.0, abs(spare)):
            break
        if wall >= 0:
            plane[:] = 0.0
            plane[wall] = np.sign(at[wall])
            bound = 2.0 * FAR
        else:
            plane_of(cones, at[: d - 1], c, plane)
            bound = spare - at[d - 1]
            for j in range(d):
                bound += plane[j] * at[j]
        share = plane.copy()
        solve_planes(B, share, True)
        out, least, pivot = -1, np.inf, 1e-11
        for i in range(d):
            if share[i] > pivot:
                ratio = max(y[i], 0.0) / share[i]
                if ratio < least - 1e-15 or (ratio <= least + 1e-15 and share[i] > share[out]):
                    out, least = i, ratio
        if out < 0:
            break
        B[out], b[out], who[out] = plane, bound, c if wall < 0 else -1
    x[:] = best
    return float(most)


@kernel
def nearest_enough(cones: Cones, most: float, x: Floats) -> None:
    """Shares between none and x, as little as spares ENOUGH, or all that there is to spare where that is less."""
    if most <= ENOUGH:
        return
    low, high = 0.0, 1.0
    trial = x.copy()
    for _ in range(50):
        part = 0.5 * (low + high)
        trial[:] = part * x
        if spare_of(cones, trial, tightest(cones, trial)) >= ENOUGH:
            high = part
        else:
            low = part
    x *= high
