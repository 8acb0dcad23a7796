"""Laws inside kernels: slip coefficient and smooth force of a contact."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.template import call
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.problem_structs import Table
from fricmb.integrate.problem import LAW_COEFFICIENT, Floats, Ints
from fricmb.integrate.run.room_protocols import Laws


@kernel
def coefficient(ports: Laws, laws: Table, k: int, s: Scratch, r: float, N: float) -> tuple[float, float, float]:
    """mu, dmu/dr, dmu/dN at slip speed r; constant for r < 0, where iterates may pass.

    (Continued along its slope a falling law would have a second solution there at large steps.)
    """
    if ports.law[k] != LAW_COEFFICIENT:
        return ports.mu_0[k], 0.0, 0.0
    s.x[0] = max(r, 0.0)
    s.x[1] = N
    call(laws.address[k], s.x, 0, laws.p, laws.p_start[k], s.out, 0)
    return s.out[0], 0.0 if r < 0.0 else s.out[1], s.out[2]


@kernel
def magnitude(row: Ints, k: int, x: Floats) -> float:
    """Length of x (m,) over the directions of contact k, its rows ``row[k]:row[k+1]``; without over- or underflow."""
    first = row[k]
    if row[k + 1] - first == 1:
        return float(abs(x[first]))
    size = hypotenuse(x[first], x[first + 1])
    return float(size if row[k + 1] - first == 2 else hypotenuse(size, x[first + 2]))


#: Squares within which a root of their sum has lost no digits.
TINY, HUGE = 1e-280, 1e280


@kernel
def hypotenuse(a: float, b: float) -> float:
    """Root of a^2 + b^2 as ``np.hypot`` has it, whose call costs as much as the law of a contact."""
    square = a * a + b * b
    return float(np.sqrt(square) if TINY < square < HUGE else np.hypot(a, b))


@kernel
def along(row: Ints, k: int, n: Floats, x: Floats) -> float:
    """The part of x along the direction n of contact k."""
    value = 0.0
    for a in range(row[k], row[k + 1]):
        value += n[a] * x[a]
    return float(value)


@kernel
def point_along(row: Ints, k: int, x: Floats, sense: float, n: Floats) -> None:
    """Make n, over the directions of contact k, that of x, or the opposite (``sense`` -1); where x is 0 it stays."""
    size = magnitude(row, k, x)
    for a in range(row[k], row[k + 1] if size > 0.0 else row[k]):
        n[a] = sense * x[a] / size


@kernel
def smooth_force(
    laws: Table, k: int, s: Scratch, g: Floats, g0: int, d: int, N: float, z: Floats, z0: int, nz: int
) -> None:
    """Force, state rates and Jacobian of a smooth law into s.out (layout: see Contacts.law)."""
    for a in range(d):
        s.x[a] = g[g0 + a]
    s.x[d] = N
    for a in range(nz):
        s.x[d + 1 + a] = z[z0 + a]
    call(laws.address[k], s.x, 0, laws.p, laws.p_start[k], s.out, 0)
