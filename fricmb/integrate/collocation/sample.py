"""States anywhere in a run on an exact structure, from the rows of its steps and the inputs kept beside them."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.collocation.block_motion import between_nodes
from fricmb.integrate.collocation.blocks_in_step import load_at_start, start_blocks
from fricmb.integrate.collocation.motion_in_step import gains_at, input_series
from fricmb.integrate.compile.kernel import entry, kernel
from fricmb.integrate.model.accelerations import complete
from fricmb.integrate.model.forces import Scratch, set_instant
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.output.hermite_output import state_of_row, write_sample
from fricmb.integrate.output.slip_direction import point_slip
from fricmb.integrate.output.states_between import shares
from fricmb.integrate.problem import SLIP, Codes2, Floats, Floats2, Ints, Pivots
from fricmb.integrate.run.breakpoints import set_window_around
from fricmb.integrate.step.exact_structure import Exact


@kernel
def open_step(
    packed: Packed, s: Scratch, y: State, ex: Exact, left: Floats, right: Floats, at: int, P: Floats2, series: Floats2,
    gain: Floats2,
) -> None:  # fmt: skip
    """Make ready for samples of the step from row ``left`` to row ``right``."""
    n = y.q.shape[0]
    for i in range(n):
        y.q[i] = left[1 + i]
        y.v[i] = left[1 + n + i]
    set_instant(packed.signals, s, left[0], y.q, y.v)
    load_at_start(packed, s, y.q, ex.f)
    start_blocks(ex, y.v)
    for c in range(P.shape[0]):
        for x in range(P.shape[1]):
            P[c, x] = right[at + 1 + c * P.shape[1] + x]
    input_series(ex, P, right[at], series, gain)


@kernel
def states_inside(ex: Exact, left: Floats, right: Floats, before: int, at: int, theta: float, z: Floats) -> None:
    """States from those in row ``left`` at ``before`` and those of the nodes, in row ``right`` from ``at`` on."""
    n_s, nz = ex.tab.c.shape[0], z.shape[0]
    points, share = np.zeros(n_s + 1), np.empty(n_s + 1)
    for x in range(n_s):
        points[x + 1] = ex.tab.c[x]
    shares(points, theta, share)
    for a in range(nz):
        z[a] = share[0] * left[before + a]
        for x in range(n_s):
            z[a] += share[x + 1] * right[at + x * nz + a]


@kernel
def integral_of_nodes(ex: Exact, row: Floats, at: int, width: int, theta: float) -> float:
    """Integral from 0 to theta of the polynomial through the node values."""
    n_s = ex.tab.c.shape[0]
    value = 0.0
    for r in range(n_s - 1, -1, -1):
        c = 0.0
        for x in range(n_s):
            c += ex.monomial[r, x] * row[at + x * width]
        value = value * theta + c / (r + 1.0)
    return value * theta


@kernel
def strongest(nodes: Floats, c: Floats, taken: float, first: float, last: float) -> float:
    """The force of largest size: at the nodes ``c`` of a step of which the part ``taken`` was, and at its two ends.

    The polynomial through the nodes may pass 0 where they do not.  Behind a transition that cut the step short they say
    what no contact does: under a load that has passed 0 friction drives there.
    """
    best = first if abs(first) > abs(last) else last
    for x in range(nodes.shape[0]):
        if c[x] <= taken and abs(nodes[x]) > abs(best):
            best = nodes[x]
    return float(best)


@kernel
def inside_step(
    row: Ints, y: State, ex: Exact, left: Floats, right: Floats, at: int, tau: float, P: Floats2, series: Floats2,
    dq: Floats, dv: Floats,
) -> None:  # fmt: skip
    """State at tau after row ``left``, with forces that tell the directions of slip."""
    n, nz = y.q.shape[0], y.z.shape[0]
    h = right[at]
    theta = tau / h
    gains_at(ex, h, tau, series, dq, dv)
    for i in range(n):
        y.q[i] = left[1 + i] + dq[i]
        y.v[i] = left[1 + n + i] + dv[i]
    states = at + 1 + P.shape[0] * P.shape[1]
    if nz > 0:
        states_inside(ex, left, right, 1 + 3 * n, states, theta, y.z)
    width = y.rate.shape[0]
    rates = states + nz * P.shape[1]
    # powers are known over the step as it was taken, which a transition may have cut short
    span = right[0] - left[0]
    if abs(span - h) < 1e-9 * h:
        span = h
    for i in range(width):
        y.work[i] = left[at - 2 * width + i] + span * integral_of_nodes(ex, right, rates + i, width, tau / span)
    for a in range(y.F.shape[0]):
        y.F[a] = between_nodes(ex.monomial, P[a], theta)
    for c in range(y.mode.shape[0]):
        if row[c + 1] - row[c] == 1 and y.mode[c] == SLIP:
            ends = 1 + 3 * n + 2 * nz + row[c]
            y.F[row[c]] = strongest(P[row[c]], ex.tab.c, span / h, left[ends], right[ends])


@entry
def sample_exact(
    packed: Packed, s: Scratch, y: State, ex: Exact, values: Floats2, modes: Codes2, stops: Floats, index: Ints,
    t: Floats, side: Floats, out: Floats2, out_mode: Codes2, sizes: Pivots, pivots: Pivots,
) -> None:  # fmt: skip
    """Rows [t, q, v, z, F, N, g, work] at times t within the rows ``index`` and their right neighbours.

    ``side``: a time in the interval between breakpoints that each belongs to.
    """
    n, nz, m, nc = y.q.shape[0], y.z.shape[0], y.F.shape[0], y.mode.shape[0]
    width = nc + 2
    at = 1 + 3 * n + 2 * nz + m + nc + 2 * width
    at_F = 1 + 3 * n + 2 * nz
    n_s = ex.tab.c.shape[0]
    P = np.zeros((ex.P.shape[0], n_s))
    series = np.zeros((2 * ex.w2.shape[1], n_s + 1))
    gain = np.zeros((2, n_s + 1))
    dq, dv = np.zeros(n), np.zeros(n)
    opened = -1
    for j in range(t.shape[0]):
        k = index[j]
        left = values[k]
        right = values[min(k + 1, values.shape[0] - 1)]
        tau = t[j] - left[0]
        inside = tau > 0.0 and right[0] > left[0]
        set_window_around(stops, s.window, side[j])
        if inside:
            for c in range(nc):
                y.mode[c] = modes[k, c]
                y.N[c] = left[at_F + m + c]
            if k != opened:
                open_step(packed, s, y, ex, left, right, at, P, series, gain)
            inside_step(packed.ports.row, y, ex, left, right, at, tau, P, series, dq, dv)
            y.t = t[j]
            point_slip(packed, s, y)
            complete(packed, s, y, sizes, pivots)
        else:
            state_of_row(packed, s, y, left, modes[k], t[j])
        opened = k if inside else -1
        write_sample(packed, s, y, out[j], out_mode[j])
