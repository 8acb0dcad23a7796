"""Slip in two directions under a set-valued law, as equations.

In stages a port has one of two forms.  Away from rest its force is ``F = -mu N g / |g|``.  Where it comes to rest or
sets out that is singular; there the direction is taken from the force, n = -F/|F|, and the rows are ``g`` at right
angles to n being 0 and ``|F| = mu(n . g) N``, regular at g = 0: as in one direction, a step beyond the end of slip ends
with a negative slip speed ``n . g``.
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.constrained._matrix import Layers, add
from fricmb.integrate.constrained._pack import Mech, Moving
from fricmb.integrate.constrained._slip import SETTING_OUT, add_load, add_slip, magnitude, slip_speed
from fricmb.integrate.model.law_values import coefficient
from fricmb.integrate.problem import Codes, Floats


@kernel
def plane_residual(
    mech: Mech, k: Moving, c: int, mode: Codes, n: Floats, F: Floats, g: Floats, rate: Floats, load: float, r: Floats,
    r0: int, full: bool,
) -> None:  # fmt: skip
    """Residuals of a port that slips in two directions."""
    port = mech.port
    a, b = port.row[c], port.row[c] + 1
    found = (full and k.form[c] == 1) or mode[c] == SETTING_OUT
    size = magnitude(port.row, c, F)
    if found and load > 0.0 and size > 0.0:
        # rate: slip velocity in a stage, its derivative where the port sets out
        along = slip_speed(port.row, c, n, F, rate) if full else 0.0
        mu, _, _ = coefficient(port, port.laws, c, k.s, along, load)  # type: ignore[arg-type]
        r[r0 + a] = (F[b] * rate[a] - F[a] * rate[b]) / size
        r[r0 + b] = size - (mu * load if full else eased(k, c, mu * load))
        return
    x, y = n[a], n[b]
    speed = magnitude(port.row, c, g)
    if full and speed > 0.0:
        x, y = g[a] / speed, g[b] / speed
    mu, _, _ = coefficient(port, port.laws, c, k.s, speed, load)  # type: ignore[arg-type]
    r[r0 + a] = F[a] + mu * load * x
    r[r0 + b] = F[b] + mu * load * y


@kernel
def eased(k: Moving, c: int, force: float) -> float:
    """Friction of a port that sets out, on the way from what held it to ``force``."""
    if k.part[0] == 1.0 or k.held[c] <= 0.0 or force <= 0.0:
        return force
    return float(force * (k.held[c] / force) ** (1.0 - k.part[0]))


@kernel
def add_found(
    mech: Mech, k: Moving, c: int, n: Floats, F: Floats, lam: Floats, load: float, x: Floats, L: Layers, row: int,
    full: bool,
) -> None:  # fmt: skip
    """Rows of a port whose direction of slip follows from its force; x: slip velocity, or its derivative."""
    port = mech.port
    a, b = port.row[c], port.row[c] + 1
    size = magnitude(port.row, c, F)
    n_a, n_b = -F[a] / size, -F[b] / size
    along = n_a * x[a] + n_b * x[b]
    mu, by_speed, by_load = coefficient(port, port.laws, c, k.s, along if full else 0.0, load)  # type: ignore[arg-type]
    add_slip(mech, k, c, 0, lam, L, row, -n_b, full, mech.address)
    add_slip(mech, k, c, 1, lam, L, row, n_a, full, mech.address)
    add(mech.order, L.A1, row, row, -n_b * along / size)
    add(mech.order, L.A1, row, row + 1, n_a * along / size)
    add(mech.order, L.A1, row + 1, row, -n_a)
    add(mech.order, L.A1, row + 1, row + 1, -n_b)
    if full and by_speed != 0.0:
        add_slip(mech, k, c, 0, lam, L, row + 1, -by_speed * load * n_a, full, mech.address)
        add_slip(mech, k, c, 1, lam, L, row + 1, -by_speed * load * n_b, full, mech.address)
    add_load(mech, k, c, lam, L, row + 1, -(mu + by_load * load), full, mech.address)


@kernel
def add_along(
    mech: Mech, k: Moving, c: int, n: Floats, lam: Floats, load: float, g: Floats, L: Layers, row: int, full: bool
) -> None:
    """Rows of a port whose direction is that of its slip velocity; at an instant it is known."""
    port = mech.port
    first = port.row[c]
    speed = magnitude(port.row, c, g)
    mu, by_speed, by_load = coefficient(port, port.laws, c, k.s, speed, load)  # type: ignore[arg-type]
    for a in range(2):
        add(mech.order, L.A1, row + a, row + a, 1.0)
        if not full or speed == 0.0:
            continue
        unit = g[first + a] / speed
        for b in range(2):
            other = g[first + b] / speed
            across = (1.0 if a == b else 0.0) - unit * other
            slope = load * (mu / speed * across + by_speed * unit * other)
            add_slip(mech, k, c, b, lam, L, row + a, slope, full, mech.address)
        if load > 0.0:
            add_load(mech, k, c, lam, L, row + a, unit * (mu + by_load * load), full, mech.address)
