"""Whether the forces of friction have a single solution: margins of joints that slip, principal minors of several."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.lu import lu_factor
from fricmb.integrate.implicit.equations.forces import call_joint, directions, friction_at, load_place, loading
from fricmb.integrate.implicit.equations.instant_matrix import ALL, instant_matrix, solve_instant
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.implicit.scene.watch import MANY, Watch
from fricmb.integrate.model.law_values import along, coefficient
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, SLIP, Floats

#: Directions of the reaction for which the margin of a joint is looked at.
AROUND = 16


@block
def margins(mech: Mech, k: Moving, w: Instant, y: State, out: Watch, whole: bool) -> float:
    """Margins of all ports that slip; returns the least.  ``whole``: also of them together, after a change of modes.

    In between the minors of all of them, and of all but one, cannot vanish unless a margin does.

    One port's force F follows its load, F = -mu n N(lam), and lam answers F by dlam/dF: the force is unique as long as
    1 + mu n dN/dlam dlam/dF > 0 for every direction that the reaction may take (for a single port: Genot and Brogliato
    1999; Klarbring 1990).  Where it vanishes there is no solution or there are several.
    """
    n, m, n_c = y.q.shape[0], y.lam.shape[0], y.mode.shape[0]
    port, joint = mech.port, mech.joint
    least = 1.0
    for c in range(n_c):
        out.margin[c] = 1.0
        j = port.joint[c]
        if j < 0 or y.mode[c] != SLIP or port.law[c] == LAW_SMOOTH:
            continue
        # dlam/dF: the other ports as they are, this one's force given
        mode = y.mode[c]
        y.mode[c] = OPEN
        regular = instant_matrix(mech, k, w, y, ALL)
        y.mode[c] = mode
        if not regular:
            out.margin[c] = -1.0
            return -1.0
        for i in range(w.r.shape[0]):
            w.r[i] = 0.0
        push(mech, y, c, w.r, n + m)
        solve_instant(mech, w)
        n_x = joint.n_x[j]
        rows = joint.row[j + 1] - joint.row[j]
        at = load_place(n_x, friction_at(n_x, rows), directions(mech, c))
        mu, _, by_load = coefficient(port, port.laws, c, k.s, along(port.row, c, y.n, y.g), max(y.N[c], 0.0))
        factor = mu + by_load * max(y.N[c], 0.0)
        first, last = loading(mech, j)
        for i in range(first, last):
            out.lam[i] = y.lam[i]
        around = 1 if joint.one_sided[joint.load_of[j]] or last - first > 2 else AROUND
        for d in range(around):
            if around > 1:
                for i in range(first, last):
                    angle = 2.0 * np.pi * (d + 0.13) / AROUND
                    out.lam[i] = np.cos(angle) if i == first else np.sin(angle)
            call_joint(mech, k, j, out.lam)
            answer = 0.0
            for i in range(first, last):
                answer += k.out[at + 1 + i - first] * w.r[n + i]
            out.margin[c] = min(out.margin[c], 1.0 + factor * answer)
        least = min(least, out.margin[c])
    if whole:
        out.together = least_minor(mech, k, w, y, out)
    return float(min(least, out.together))


@kernel
def push(mech: Mech, y: State, c: int, r: Floats, r0: int) -> None:
    """A unit force along the slip of port c as a right-hand side."""
    for a in range(mech.port.row[c], mech.port.row[c + 1]):
        r[r0 + a] = y.n[a]


@kernel
def rubs(mech: Mech, y: State, c: int) -> bool:
    """Whether port c is a joint that slips under rigid friction."""
    return bool(mech.port.joint[c] >= 0 and y.mode[c] == SLIP and mech.port.law[c] != LAW_SMOOTH)


@kernel
def least_minor(mech: Mech, k: Moving, w: Instant, y: State, out: Watch) -> float:
    """Least principal minor of ``A = 1 + mu n dN/dF`` over the joints that slip, at most MANY of them; 1 for one.

    With loads that cannot be negative, forces are unique for whatever loads act if and only if all are positive (a
    P-matrix: Cottle, Pang and Stone 1992, theorem 3.3.7).
    """
    n, m = y.q.shape[0], y.lam.shape[0]
    port, joint = mech.port, mech.joint
    count = 0
    for c in range(y.mode.shape[0]):
        if rubs(mech, y, c) and count < MANY:
            out.contacts[count] = c
            count += 1
    if count < 2:
        return 1.0
    for i in range(count):
        y.mode[out.contacts[i]] = OPEN
    regular = instant_matrix(mech, k, w, y, ALL)
    for j in range(count if regular else 0):
        for i in range(w.r.shape[0]):
            w.r[i] = 0.0
        push(mech, y, out.contacts[j], w.r, n + m)
        solve_instant(mech, w)
        for i in range(count):
            c = out.contacts[i]
            owner = port.joint[c]
            rows = joint.row[owner + 1] - joint.row[owner]
            n_x = call_joint(mech, k, owner, y.lam)
            at = load_place(n_x, friction_at(n_x, rows), directions(mech, c))
            mu, _, by_load = coefficient(port, port.laws, c, k.s, along(port.row, c, y.n, y.g), max(y.N[c], 0.0))
            answer = 0.0
            first, last = loading(mech, owner)
            for r in range(first, last):
                answer += k.out[at + 1 + r - first] * w.r[n + r]
            one = 1.0 if i == j else 0.0
            out.A[i * MANY + j] = one + (mu + by_load * max(y.N[c], 0.0)) * answer
    for i in range(count):
        y.mode[out.contacts[i]] = SLIP
    if not regular:
        return -1.0
    least = 1.0
    for subset in range(1, 1 << count):
        least = min(least, minor(out, count, subset))
    return least


@kernel
def minor(out: Watch, count: int, subset: int) -> float:
    """Determinant of the rows and columns of A in a subset (by its bits)."""
    size = 0
    for i in range(count):
        size += (subset >> i) & 1
    B = out.B[: size * size].reshape(size, size)
    row = 0
    for i in range(count):
        column = 0
        for j in range(count):
            if (subset >> i) & (subset >> j) & 1:
                B[row, column] = out.A[i * MANY + j]
                column += 1
        row += (subset >> i) & 1
    if not lu_factor(B, out.sizes, out.pivots):
        return 0.0
    value = 1.0
    for i in range(size):
        value *= B[i, i] if out.pivots[i] == i else -B[i, i]
    return value
