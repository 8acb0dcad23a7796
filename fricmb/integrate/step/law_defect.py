"""Smooth laws between the nodes of a step: a kink, or a turn of the law that all nodes have missed.

The polynomials of a step are right at its nodes.  Half-way between these the law is asked again: what its force and
its rates are off from their polynomials, times the width of the gap, is an error of velocities and states that the
tails of their polynomials need not show.
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.template import call
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, Floats, Floats2
from fricmb.integrate.step.radau_step import Accuracy, OneStep, widest

#: Relative round-off of forces and rates beside their polynomials.
ROUND_OFF = 1e-14
#: Velocities below so many floors of theirs are creep.
CREEP = 1e3


@kernel
def between(line: Floats, start: float, values: Floats2, column: int) -> float:
    """Value of the polynomial through ``start`` and a column of stage values, by a line of the tableau's ``mid``."""
    value = line[0] * start
    for i in range(values.shape[0]):
        value += line[i + 1] * values[i, column]
    return float(value)


@kernel
def counted_force(off: float, size: float, stiff: float, gap: float, h: float) -> float:
    """What counts of a force that is ``off`` over a gap of a step h, less what the law itself would take back at once.

    Velocities hold the round-off of what forces do in the step, and a law of slope ``stiff`` makes forces of it.
    """
    return float(max(off - ROUND_OFF * size * (1.0 + h * stiff), 0.0) / (1.0 + gap * stiff))


@kernel
def counted_rate(off: float, size: float, slope: float, gap: float) -> float:
    """What a state is off over a gap by a rate that is ``off``; a rate falls with its state by ``slope``."""
    return float(gap * max(off - ROUND_OFF * size, 0.0) / (1.0 + gap * abs(slope)))


@kernel
def probe(packed: Packed, s: Scratch, y: State, one: OneStep, k: int, j: int) -> None:
    """Law k at the polynomials' values half-way to node j: arguments in ``s.x``, force, rates, slopes in ``s.out``."""
    w, line = one.w, one.tab.mid[j]
    row0, z0 = packed.ports.row[k], packed.ports.z_start[k]
    d, nz = packed.ports.row[k + 1] - row0, packed.ports.z_start[k + 1] - z0
    for a in range(d):
        s.x[a] = between(line, y.g[row0 + a], w.g, row0 + a)
    s.x[d] = max(between(line, y.N[k], w.N, k), 0.0) if y.mode[k] != OPEN else 0.0
    for a in range(nz):
        s.x[d + 1 + a] = between(line, y.z[z0 + a], w.z, z0 + a)
    call(packed.laws.address[k], s.x, 0, packed.laws.p, packed.laws.p_start[k], s.out, 0)


@kernel
def felt(packed: Packed, y: State, acc: Accuracy, a: int) -> float:
    """Acceleration of the velocity that is moved most, by its own scale, by a unit of force in row a.

    What creeps before anything has moved has no scale of its own yet: a steep law's round-off would be seen there.
    """
    top = widest(acc.v)
    most = 0.0
    for i in range(y.v.shape[0]):
        size = packed.structure.mobility[i] * abs(packed.ports.W[i, a])
        if size > 0.0:
            scale = max(acc.v[i], abs(y.v[i]), CREEP * acc.floor_v[i], 1e-10 * top, 1e-290)
            most = max(most, size / scale)
    return most


@kernel
def force_off(
    packed: Packed, s: Scratch, y: State, one: OneStep, k: int, j: int, a: int, gap: float, h: float
) -> float:
    """What the force of row a is off half-way to node j."""
    w = one.w
    row0 = packed.ports.row[k]
    d = packed.ports.row[k + 1] - row0
    nz = packed.ports.z_start[k + 1] - packed.ports.z_start[k]
    size = abs(y.F[row0 + a])
    for i in range(w.F.shape[0]):
        size = max(size, abs(w.F[i, row0 + a]))
    off = abs(s.out[a] - between(one.tab.mid[j], y.F[row0 + a], w.F, row0 + a))
    stiff = 0.0
    for b in range(d):
        stiff += abs(s.out[d + nz + a * (d + 1 + nz) + b])
    stiff *= packed.ports.D[row0 + a, row0 + a]
    return float(counted_force(off, size, stiff, gap, h))


@kernel
def rate_off(packed: Packed, s: Scratch, y: State, one: OneStep, k: int, j: int, a: int, gap: float) -> float:
    """What state a of contact k is off by over the gap before node j, as a stiff rate lets it."""
    w = one.w
    z0 = packed.ports.z_start[k]
    d, nz = packed.ports.row[k + 1] - packed.ports.row[k], packed.ports.z_start[k + 1] - z0
    size = abs(y.zd[z0 + a])
    for i in range(w.F.shape[0]):
        size = max(size, abs(w.zd[i, z0 + a]))
    at = d + nz + (d + a) * (d + 1 + nz)
    for b in range(d + 1 + nz):
        size = max(size, abs(s.out[at + b] * s.x[b]))
    off = abs(s.out[d + a] - between(one.tab.mid[j], y.zd[z0 + a], w.zd, z0 + a))
    return float(counted_rate(off, size, s.out[at + d + 1 + a], gap))


@kernel
def law_defect(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, h: float) -> float:
    """Largest error of a velocity or a state, by its own scale, that smooth laws leave between the nodes."""
    ports, c, w = packed.ports, one.tab.c, one.w
    worst = 0.0
    for k in range(y.mode.shape[0]):
        if ports.law[k] != LAW_SMOOTH:
            continue
        z0 = ports.z_start[k]
        for j in range(c.shape[0]):
            gap = h * (c[j] - (c[j - 1] if j > 0 else 0.0))
            probe(packed, s, y, one, k, j)
            for a in range(ports.row[k + 1] - ports.row[k]):
                off = force_off(packed, s, y, one, k, j, a, gap, h)
                if off > 0.0:
                    worst = max(worst, gap * off * felt(packed, y, acc, ports.row[k] + a))
            for a in range(ports.z_start[k + 1] - z0):
                size = max(acc.z[z0 + a], abs(y.z[z0 + a]), abs(w.z[j, z0 + a]), one.noise_z[z0 + a], 1e-290)
                worst = max(worst, rate_off(packed, s, y, one, k, j, a, gap) / size)
    return worst
