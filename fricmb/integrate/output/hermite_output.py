"""Between rows: quintic Hermite polynomials in q, from values, velocities and accelerations at both ends."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import entry, kernel
from fricmb.integrate.model.accelerations import complete
from fricmb.integrate.model.forces import Scratch, stored_by_damped
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.output.slip_direction import point_slip, relative_velocity
from fricmb.integrate.output.states_between import ends_of_step, states_between
from fricmb.integrate.problem import STICK, Codes, Codes2, Floats, Floats2, Floats3, Ints, Pivots
from fricmb.integrate.run.breakpoints import set_window_around


@kernel
def hermite(left: Floats, right: Floats, h: float, x: float, n: int, q: Floats, v: Floats) -> None:
    """Q and v at fraction x of a step h from rows that hold [t, q, v, a].

    The mean velocity (q1 - q0)/h has the round-off of times and positions over h: where the velocities of both ends and
    their rates say the same but for that, they are taken.
    """
    grain = 2e-15 * max(abs(left[0]), abs(right[0])) / h
    x2, x3 = x * x, x * x * x
    x4, x5 = x2 * x2, x2 * x3
    b1 = 10.0 * x3 - 15.0 * x4 + 6.0 * x5
    s0 = x - 6.0 * x3 + 8.0 * x4 - 3.0 * x5
    s1 = -4.0 * x3 + 7.0 * x4 - 3.0 * x5
    c0 = 0.5 * (x2 - 3.0 * x3 + 3.0 * x4 - x5)
    c1 = 0.5 * (x3 - 2.0 * x4 + x5)
    d1 = 30.0 * x2 - 60.0 * x3 + 30.0 * x4
    e0 = 1.0 - 18.0 * x2 + 32.0 * x3 - 15.0 * x4
    e1 = -12.0 * x2 + 28.0 * x3 - 15.0 * x4
    f0 = 0.5 * (2.0 * x - 9.0 * x2 + 12.0 * x3 - 5.0 * x4)
    f1 = 0.5 * (3.0 * x2 - 8.0 * x3 + 5.0 * x4)
    for i in range(n):
        q0, v0, a0 = left[1 + i], left[1 + n + i], left[1 + 2 * n + i]
        q1, v1, a1 = right[1 + i], right[1 + n + i], right[1 + 2 * n + i]
        q[i] = q0 + b1 * (q1 - q0) + h * (s0 * v0 + s1 * v1) + h * h * (c0 * a0 + c1 * a1)
        v[i] = d1 * (q1 - q0) / h + e0 * v0 + e1 * v1 + h * (f0 * a0 + f1 * a1)
        alone = v0 + (3.0 * x2 - 2.0 * x3) * (v1 - v0) + h * ((x - 2.0 * x2 + x3) * a0 + (x3 - x2) * a1)
        if abs(v[i] - alone) <= grain * max(abs(v0), abs(v1)) + 1e-15 * max(abs(q0), abs(q1)) / h:
            v[i] = alone


@kernel
def write_sample(packed: Packed, s: Scratch, y: State, row: Floats, modes: Codes) -> None:
    """Put the state of X into a row [t, q, v, z, F, N, g, work], and its modes; what sticks has no slip."""
    n, nz, m, nc = y.q.shape[0], y.z.shape[0], y.F.shape[0], y.mode.shape[0]
    row[0] = y.t
    for i in range(n):
        row[1 + i] = y.q[i]
        row[1 + n + i] = y.v[i]
    for i in range(nz):
        row[1 + 2 * n + i] = y.z[i]
    at = 1 + 2 * n + nz
    for a in range(m):
        row[at + a] = y.F[a]
        row[at + m + nc + a] = y.g[a]
    for c in range(nc):
        row[at + m + c] = y.N[c]
        modes[c] = y.mode[c]
        if y.mode[c] == STICK:
            for a in range(packed.ports.row[c], packed.ports.row[c + 1]):
                row[at + m + nc + a] = 0.0
    for i in range(nc + 2):
        row[at + 2 * m + nc + i] = y.work[i]
    row[at + 2 * m + 2 * nc] -= stored_by_damped(packed.ports.damped, packed.normals, s)


@kernel
def complete_at(
    packed: Packed, s: Scratch, y: State, values: Floats2, kind: Codes, k: int, modes: Codes, t: float, sizes: Pivots,
    pivots: Pivots,
) -> None:  # fmt: skip
    """Make y the state at t between row k and the next one, with its forces and powers; ``work`` stays."""
    n, nz, m, nc = y.q.shape[0], y.z.shape[0], y.F.shape[0], y.mode.shape[0]
    at_z = 1 + 3 * n
    at_F = at_z + 2 * nz
    left, right = values[k], values[k + 1]
    h = right[0] - left[0]
    x = (t - left[0]) / h
    y.t = t
    hermite(left, right, h, x, n, y.q, y.v)
    states_between(values, kind, k, at_z, nz, t, y.z)
    for c in range(nc):
        y.mode[c] = modes[c]
        y.N[c] = left[at_F + m + c]
        first, last = packed.ports.row[c], packed.ports.row[c + 1]
        # a contact that has just closed carries nothing yet: the next row knows its direction
        known = left if magnitude(packed.ports.row, c, left[at_F : at_F + m]) > 0.0 else right
        for a in range(first, last):
            y.F[a] = known[at_F + a]
    point_slip(packed, s, y)
    complete(packed, s, y, sizes, pivots)


@kernel
def add_powers(
    packed: Packed, s: Scratch, y: State, values: Floats2, kind: Codes, k: int, modes: Codes, t: float, out: Floats2,
    sizes: Pivots, pivots: Pivots,
) -> None:  # fmt: skip
    """Add integrals of the powers (row 0 of ``out``) and of their magnitudes (row 1) from row k to t, by Gauss."""
    h = t - values[k, 0]
    for g in range(3):
        root = (g - 1.0) * np.sqrt(0.6)
        weight = h * (4.0 / 9.0 if g == 1 else 5.0 / 18.0)
        complete_at(packed, s, y, values, kind, k, modes, values[k, 0] + 0.5 * h * (1.0 + root), sizes, pivots)
        for i in range(y.rate.shape[0]):
            out[0, i] += weight * y.rate[i]
            out[1, i] += weight * abs(y.rate[i])


@kernel
def open_step(
    packed: Packed, s: Scratch, y: State, values: Floats2, kind: Codes, ends: Ints, modes: Codes2, part: Floats3,
    sizes: Pivots, pivots: Pivots,
) -> None:  # fmt: skip
    """Integrals of the powers from row ``ends[0]``, where a step starts, up to every row of it until ``ends[1]``."""
    part[0] = 0.0
    for k in range(ends[0], ends[1]):
        part[k + 1 - ends[0]] = part[k - ends[0]]
        add_powers(packed, s, y, values, kind, k, modes[k], values[k + 1, 0], part[k + 1 - ends[0]], sizes, pivots)


@kernel
def work_at(
    packed: Packed, s: Scratch, y: State, values: Floats2, kind: Codes, at_w: int, ends: Ints, part: Floats3, k: int,
    modes: Codes, t: float, sizes: Pivots, pivots: Pivots,
) -> None:  # fmt: skip
    """Energies at t after row k: those where the step starts and the integral of the powers of the dense output.

    What that misses of the step's own energies at its end (less than the step errs by) is spread along with the
    magnitude of the power: what is lost never comes back, and where there is no power nothing changes.
    """
    since = part[k - ends[0]].copy()
    add_powers(packed, s, y, values, kind, k, modes, t, since, sizes, pivots)
    whole = part[ends[1] - ends[0]]
    left, right = values[ends[0]], values[ends[1]]
    for i in range(y.work.shape[0]):
        missing = right[at_w + i] - left[at_w + i] - whole[0, i]
        share = since[1, i] / whole[1, i] if whole[1, i] > 0.0 else (t - left[0]) / (right[0] - left[0])
        y.work[i] = left[at_w + i] + since[0, i] + missing * share


@kernel
def state_of_row(packed: Packed, s: Scratch, y: State, row: Floats, modes: Codes, t: float) -> None:
    """Make y the state of a row, as it was found."""
    n, nz, m, nc = y.q.shape[0], y.z.shape[0], y.F.shape[0], y.mode.shape[0]
    at_z = 1 + 3 * n
    at_F = at_z + 2 * nz
    y.t = t
    for i in range(n):
        y.q[i] = row[1 + i]
        y.v[i] = row[1 + n + i]
    for i in range(nz):
        y.z[i] = row[at_z + i]
    for i in range(nc + 2):
        y.work[i] = row[at_F + m + nc + i]
    for c in range(nc):
        y.mode[c] = modes[c]
        y.N[c] = row[at_F + m + c]
    for a in range(m):
        y.F[a] = row[at_F + a]
    relative_velocity(packed, s, y)


@entry
def sample_rows(
    packed: Packed, s: Scratch, y: State, values: Floats2, kind: Codes, modes: Codes2, stops: Floats, index: Ints,
    t: Floats, side: Floats, part: Floats3, out: Floats2, out_mode: Codes2, power: Floats2, sizes: Pivots,
    pivots: Pivots,
) -> None:  # fmt: skip
    """Rows [t, q, v, z, F, N, g, work] at times t within the rows ``index`` and their right neighbours.

    ``side``: a time in the interval between breakpoints that each belongs to; ``part``: space for the rows of a step,
    of no length where energies are not asked for; ``power`` (n_t, n_c + 2): the powers, or of no width.
    """
    n, nz, m, nc = y.q.shape[0], y.z.shape[0], y.F.shape[0], y.mode.shape[0]
    at_F = 1 + 3 * n + 2 * nz
    at_w = at_F + m + nc
    ends = np.full(2, -1)
    for j in range(t.shape[0]):
        k = index[j]
        left = values[k]
        set_window_around(stops, s.window, side[j])
        if t[j] > left[0] and k + 1 < values.shape[0] and values[k + 1, 0] > left[0]:
            if part.shape[0] > 0:
                if ends_of_step(values, kind, k, ends):
                    open_step(packed, s, y, values, kind, ends, modes, part, sizes, pivots)
                work_at(packed, s, y, values, kind, at_w, ends, part, k, modes[k], t[j], sizes, pivots)
            complete_at(packed, s, y, values, kind, k, modes[k], t[j], sizes, pivots)
        else:
            state_of_row(packed, s, y, left, modes[k], t[j])
        write_sample(packed, s, y, out[j], out_mode[j])
        for i in range(power.shape[1]):
            power[j, i] = y.rate[i]
