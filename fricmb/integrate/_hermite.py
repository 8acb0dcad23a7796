"""Dense output on rows: quintic Hermite polynomials in q, from values, velocities and accelerations at both ends."""

from __future__ import annotations

import numpy as np

from fricmb.integrate._field import Scratch, scratch
from fricmb.integrate._instant import State, complete, kinematics, slip_speed, state
from fricmb.integrate._kernel import entry, kernel
from fricmb.integrate._lapack import addresses
from fricmb.integrate._pack import Packed, packed_of
from fricmb.integrate._problem import SLIP, STICK, Codes, Codes2, Floats, Floats2, Ints, Pivots, Problem, Start
from fricmb.integrate._rows import INSIDE
from fricmb.integrate._trajectory import Counters, Samples, Trajectory, Transitions


@kernel
def hermite(left: Floats, right: Floats, h: float, x: float, n: int, q: Floats, v: Floats) -> None:
    """Q and v at fraction x of a step h from rows that hold [., q, v, a] from entry 1 on."""
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


@kernel
def cubic(left: Floats, right: Floats, at: int, rate: int, n: int, h: float, x: float, out: Floats) -> None:
    """Cubic Hermite interpolation of n entries from ``at`` with rates from ``rate``, without overshoot.

    Where a rate goes the way of the values, and the other one too or hardly at all, it counts at most three times their
    mean: then the cubic goes that way throughout (Fritsch and Carlson 1980).  Motion that is resolved, turning points
    included, is far from this; a state that meets its limit within a step would be drawn beyond it.
    """
    for i in range(n):
        step = right[at + i] - left[at + i]
        r0, r1 = h * left[rate + i], h * right[rate + i]
        most = 3.0 * abs(step)
        against = r0 * r1 > 0.0 and r0 * step <= 0.0  # two turning points in a step are none
        first = r0 * step >= 0.0 and (r1 * step >= 0.0 or abs(r1) < 0.25 * abs(r0))
        second = r1 * step >= 0.0 and (r0 * step >= 0.0 or abs(r0) < 0.25 * abs(r1))
        if first or against:
            r0 = 0.0 if against else min(max(r0, -most), most)
        if second or against:
            r1 = 0.0 if against else min(max(r1, -most), most)
        out[i] = left[at + i] + x * (r0 + x * (3.0 * step - 2.0 * r0 - r1 + x * (r0 + r1 - 2.0 * step)))


@kernel
def relative_velocity(packed: Packed, s: Scratch, y: State) -> None:
    """G at a row, whose forces are known: normal forces and modes stay."""
    kept = y.N.copy()
    kinematics(packed, s, y)
    for k in range(kept.shape[0]):
        y.N[k] = kept[k]


@kernel
def point_along_slip(packed: Packed, s: Scratch, y: State) -> None:
    """Directions of two-dimensional slip from the interpolated velocities, where these say anything."""
    relative_velocity(packed, s, y)
    for c in range(y.mode.shape[0]):
        row0 = packed.ports.row[c]
        if packed.ports.row[c + 1] - row0 == 2 and y.mode[c] == SLIP:
            r = slip_speed(y.g, row0, 2)
            if r > 1e-12 * (y.size[row0] + y.size[row0 + 1]):
                y.n[row0] = y.g[row0] / r
                y.n[row0 + 1] = y.g[row0 + 1] / r


@kernel
def set_window_around(stops: Floats, s: Scratch, t: float) -> None:
    """Let functions of time be evaluated inside the interval between breakpoints that begins at or before t."""
    low, high = -np.inf, np.inf
    for i in range(stops.shape[0]):
        if stops[i] <= t:
            low = max(low, stops[i] + 4e-16 * abs(stops[i]) + 1e-300)
        else:
            high = min(high, stops[i] - 4e-16 * abs(stops[i]) - 1e-300)
    s.window[0] = low
    s.window[1] = high


@kernel
def write_sample(packed: Packed, y: State, row: Floats, modes: Codes) -> None:
    """Put a state into a row [t, q, v, z, F, N, g, work], and its modes; what sticks has no slip."""
    n, nz, m, nc = y.q.shape[0], y.z.shape[0], y.F.shape[0], y.mode.shape[0]
    row[0] = y.t[0]
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


@entry
def sample_rows(
    packed: Packed, s: Scratch, y: State, values: Floats, modes: Codes, stops: Floats, index: Ints, t: Floats,
    out: Floats, out_mode: Codes, sizes: Pivots, pivots: Pivots, address: Ints,
) -> None:  # fmt: skip
    """Rows [t, q, v, z, F, N, g, work] at times t within the rows ``index`` and their right neighbours."""
    n, nz, m, nc = y.q.shape[0], y.z.shape[0], y.F.shape[0], y.mode.shape[0]
    at_z = 1 + 3 * n
    at_F = at_z + 2 * nz
    at_N = at_F + m
    at_w = at_N + nc
    for j in range(t.shape[0]):
        k = index[j]
        left = values[k]
        right = values[min(k + 1, values.shape[0] - 1)]
        h = right[0] - left[0]
        y.t[0] = t[j]
        if h > 0.0 and t[j] > left[0]:
            x = (t[j] - left[0]) / h
            hermite(left, right, h, x, n, y.q, y.v)
            cubic(left, right, at_z, at_z + nz, nz, h, x, y.z)
            cubic(left, right, at_w, at_w + nc + 2, nc + 2, h, x, y.work)
        else:
            for i in range(n):
                y.q[i] = left[1 + i]
                y.v[i] = left[1 + n + i]
            for i in range(nz):
                y.z[i] = left[at_z + i]
            for i in range(nc + 2):
                y.work[i] = left[at_w + i]
        for c in range(nc):
            y.mode[c] = modes[k, c]
            y.N[c] = left[at_N + c]
            force = 0.0
            for a in range(packed.ports.row[c], packed.ports.row[c + 1]):
                force += left[at_F + a] ** 2
            for a in range(packed.ports.row[c], packed.ports.row[c + 1]):
                y.n[a] = -left[at_F + a] / np.sqrt(force) if force > 0.0 else 0.0
        set_window_around(stops, s, left[0])
        if t[j] > left[0]:
            point_along_slip(packed, s, y)
            complete(packed, s, y, sizes, pivots, address)
        else:
            for a in range(m):
                y.F[a] = left[at_F + a]
            relative_velocity(packed, s, y)
        write_sample(packed, y, out[j], out_mode[j])


class RowTrajectory(Trajectory):
    """A run kept as rows; ``values`` (n_r, width) as in Rows, ``kind``, ``mode`` (n_r, n_c)."""

    def __init__(
        self,
        problem: Problem,
        values: Floats,
        kind: Codes,
        mode: Codes,
        transitions: Transitions,
        counters: Counters,
        end: Start,
        failure: str | None,
    ) -> None:
        self.problem = problem
        self.transitions = transitions
        self.counters = counters
        self.end = end
        self.failure = failure
        self._values = values
        self._mode = mode
        self._kind = kind
        self._times = np.ascontiguousarray(values[:, 0])
        self._steps = np.flatnonzero(kind != INSIDE)

    @property
    def t(self) -> Floats:
        """Times of the accepted steps."""
        return self._times[self._steps]

    def rows(self) -> Samples:
        """Values at the accepted steps, as they were found."""
        return self._sample(self.t, self._steps)

    def sample(self, t: Floats) -> Samples:
        """Dense output."""
        t = np.ascontiguousarray(t, dtype=float)
        return self._sample(t, np.maximum(np.searchsorted(self._times, t, side="right") - 1, 0))

    def _sample(self, t: Floats, index: Ints) -> Samples:
        problem = self.problem
        n, m, nc, nz = problem.n, problem.m, problem.n_c, problem.n_z
        out = np.zeros((len(t), 1 + 2 * n + nz + 2 * m + nc + nc + 2))
        modes = np.zeros((len(t), nc), np.int8)
        start = Start(t=0.0, q=np.zeros(n), v=np.zeros(n), z=np.zeros(nz))
        self._fill(state(problem, start), index.astype(np.int64), t, out, modes)
        ends = np.cumsum([1, n, n, nz, m, nc, m, nc, 1, 1])
        _, q, v, z, F, N, g, friction, damping, supply = np.split(np.ascontiguousarray(out.T), ends[:-1])
        return Samples(
            t=t, q=q, v=v, z=z, F=F, g=g, N=N, mode=np.ascontiguousarray(modes.T), friction_loss=friction,
            damping_loss=damping[0], input=supply[0],
        )  # fmt: skip

    def _fill(self, y: State, index: Ints, t: Floats, out: Floats2, modes: Codes2) -> None:
        """Rows of values and modes at times within the rows ``index``; ``y`` is room for a state."""
        packed, problem = packed_of(self.problem), self.problem
        sizes, pivots = np.zeros(4, np.int32), np.zeros(max(1, problem.m, problem.n), np.int32)
        sample_rows(
            packed, scratch(problem), y, self._values, self._mode, packed.breakpoints, index, t, out, modes, sizes,
            pivots, addresses("complete"),
        )  # fmt: skip
