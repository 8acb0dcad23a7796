"""Slip in two or three directions under a set-valued law, as equations.

In stages a port has one of two forms.  Away from rest its force is ``F = -mu N g / |g|``.  Where it comes to rest or
sets out that is singular; there the direction is taken from the force, n = -F/|F|, and the rows are ``g`` at right
angles to n being 0 and ``|F| = mu(n . g) N``, regular at g = 0: as in one direction, a step beyond the end of slip ends
with a negative slip speed ``n . g``.

That g is parallel to F reads ``F_m g_i - F_i g_m = 0`` for every direction i but one, m (:func:`largest_part`), whose
row is free for the size of the force.
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.equations.jacobian_layers import Layers, add
from fricmb.integrate.implicit.equations.slip_rows import (
    SETTING_OUT,
    add_load,
    add_slip,
    friction_coefficient,
    slip_speed,
)
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.problem import Codes, Floats, Ints


@kernel
def largest_part(row: Ints, c: int, n: Floats) -> int:
    """The direction along which port c slips most; of two the last."""
    most = row[c + 1] - 1
    for a in range(row[c], row[c + 1] if row[c + 1] - row[c] > 2 else row[c]):
        most = a if abs(n[a]) > abs(n[most]) else most
    return int(most)


@kernel
def plane_residual(
    mech: Mech, k: Moving, c: int, mode: Codes, n: Floats, F: Floats, g: Floats, rate: Floats, load: float, r: Floats,
    r0: int, full: bool,
) -> None:  # fmt: skip
    """Residuals of a port that slips in several directions."""
    port = mech.port
    first, last = port.row[c], port.row[c + 1]
    found = load > 0.0 and ((full and k.form[c] == 1) or mode[c] == SETTING_OUT)
    size = magnitude(port.row, c, F) if found else 0.0
    if size > 0.0:
        # rate: slip velocity in a stage, its derivative where the port sets out
        along = slip_speed(port.row, c, n, F, rate) if full else 0.0
        mu, _, _ = friction_coefficient(mech, k, c, along, load)
        m = largest_part(port.row, c, n)
        for a in range(first, last):
            r[r0 + a] = (F[m] * rate[a] - F[a] * rate[m]) / size
        r[r0 + m] = size - (mu * load if full else eased(k, c, mu * load))
        return
    speed = magnitude(port.row, c, g)
    mu, _, _ = friction_coefficient(mech, k, c, speed, load)
    for a in range(first, last):
        r[r0 + a] = F[a] + mu * load * (g[a] / speed if full and speed > 0.0 else n[a])


@kernel
def eased(k: Moving, c: int, force: float) -> float:
    """Friction of a port that sets out, on the way from what held it to ``force``."""
    if k.part == 1.0 or k.held[c] <= 0.0 or force <= 0.0:
        return force
    return float(force * (k.held[c] / force) ** (1.0 - k.part))


@kernel
def eased_slope(k: Moving, c: int, force: float) -> float:
    """Derivative of :func:`eased` by ``force``: the load may fall steeply on the way."""
    if k.part == 1.0 or k.held[c] <= 0.0 or force <= 0.0:
        return 1.0
    return float(k.part * eased(k, c, force) / force)


@kernel
def add_found(
    mech: Mech, k: Moving, c: int, n: Floats, F: Floats, lam: Floats, load: float, x: Floats, L: Layers, row: int,
    full: bool,
) -> None:  # fmt: skip
    """Rows of a port whose direction of slip follows from its force; x: slip velocity, or its derivative.

    Along a direction that joints block there is no slip, and its force is told by x alone, being parallel to it.  Where
    x is still 0 a trifle stands for it in the matrix, so that forces along that direction, which do nothing, stay.
    """
    port = mech.port
    first, d = port.row[c], port.row[c + 1] - port.row[c]
    size = magnitude(port.row, c, F)
    along = 0.0
    for a in range(first, first + d):
        along -= F[a] / size * x[a]
    mu, by_speed, by_load = friction_coefficient(mech, k, c, along if full else 0.0, load)
    m = largest_part(port.row, c, n) - first
    n_m = -F[first + m] / size
    apart = along if abs(along) > k.slight[c] else k.slight[c]
    for a in range(d):
        n_a = -F[first + a] / size
        add(mech.order, L.A1, row + m, row + a, -n_a)
        if full and by_speed != 0.0:
            add_slip(mech, k, c, a, lam, L, row + m, -by_speed * load * n_a, full)
        if a == m:
            continue
        add_slip(mech, k, c, a, lam, L, row + a, -n_m, full)
        add_slip(mech, k, c, m, lam, L, row + a, n_a, full)
        add(mech.order, L.A1, row + a, row + a, -n_m * apart / size)
        add(mech.order, L.A1, row + a, row + m, n_a * apart / size)
    slope = 1.0 if full else eased_slope(k, c, mu * load)
    add_load(mech, k, c, lam, L, row + m, -slope * (mu + by_load * load), full)


@kernel
def add_along(
    mech: Mech, k: Moving, c: int, n: Floats, lam: Floats, load: float, g: Floats, L: Layers, row: int, full: bool
) -> None:
    """Rows of a port whose direction is that of its slip velocity; at an instant that is known, and given by n."""
    port = mech.port
    first, d = port.row[c], port.row[c + 1] - port.row[c]
    speed = magnitude(port.row, c, g)
    mu, by_speed, by_load = friction_coefficient(mech, k, c, speed, load)
    turns = full and speed > 0.0
    for a in range(d):
        add(mech.order, L.A1, row + a, row + a, 1.0)
        unit = g[first + a] / speed if turns else n[first + a]
        for b in range(d if turns else 0):
            other = g[first + b] / speed
            across = (1.0 if a == b else 0.0) - unit * other
            slope = load * (mu / max(speed, k.slight[c]) * across + by_speed * unit * other)
            add_slip(mech, k, c, b, lam, L, row + a, slope, full)
        if load > 0.0:
            add_load(mech, k, c, lam, L, row + a, unit * (mu + by_load * load), full)
