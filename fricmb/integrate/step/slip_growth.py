"""Growth of slip where friction falls with speed: steps must not be longer than it takes.

Where mu' < 0 a small slip speed grows like e^(lambda t), lambda = -mu'(r) N n.D n less what dampers take.  An implicit
formula whose step is long beside 1/lambda has another solution, far from the start, in which the growth is over before
it has begun; no polynomial through its stages shows that.
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.law_values import coefficient, magnitude, smooth_force
from fricmb.integrate.model.problem_structs import Packed, Table
from fricmb.integrate.model.state import State
from fricmb.integrate.problem import LAW_CONSTANT, LAW_SMOOTH, SLIP, Floats, Ints
from fricmb.integrate.run.room_protocols import Laws
from fricmb.integrate.step.one_step_room import OneStep

#: Longest step, in times by which slip grows e-fold; part of the largest slip speed in a step below which none matters.
LONGEST, LEAST = 1.0, 1e-12


@kernel
def damped(packed: Packed, k: int) -> float:
    """Rate at which dampers alone would take the slip of contact k away (of the diagonal: at most that)."""
    structure, ports = packed.structure, packed.ports
    rate = 0.0
    for a in range(ports.row[k], ports.row[k + 1]):
        value = 0.0
        for i in range(structure.mobility.shape[0]):
            if ports.W[i, a] != 0.0:
                value += (ports.W[i, a] * structure.mobility[i]) ** 2 * structure.C[structure.own[i]]
        value /= max(ports.D[a, a], 1e-290)
        rate = value if a == ports.row[k] else min(rate, value)
    return float(max(rate, 0.0))


@kernel
def drive(laws: Table, row: Ints, z_start: Ints, s: Scratch, k: int, g: Floats, N: float, z: Floats, h: float) -> float:
    """Part of the slope of a smooth law's force by velocity that drives, along the velocity; states follow within h."""
    row0, z0 = row[k], z_start[k]
    d, nz = row[k + 1] - row0, z_start[k + 1] - z0
    smooth_force(laws, k, s, g, row0, d, N, z, z0, nz)
    width = d + 1 + nz
    speed = magnitude(row, k, g)
    value = 0.0
    for a in range(d):
        for b in range(d):
            weight = g[row0 + a] * g[row0 + b] / speed**2 if speed > 0.0 else (1.0 if a == b == 0 else 0.0)
            slope = s.out[d + nz + a * width + b]
            for i in range(nz):
                own = s.out[d + nz + (d + i) * width + d + 1 + i]
                led = s.out[d + nz + (d + i) * width + b]
                slope += s.out[d + nz + a * width + d + 1 + i] * led / max(1.0 / h - own, 1e-290)
            value += weight * slope
    return float(value)


@kernel
def fall_between(ports: Laws, laws: Table, k: int, s: Scratch, low: float, high: float, N: float) -> float:
    """Largest slope by which friction of contact k falls between two slip speeds, looked at by factors of 2.

    A law that is flat at rest and falls within a speed far below those of the stages shows its fall at none of them.
    """
    value = 0.0
    r = high
    while r > max(low, LEAST * high):
        value = max(value, -coefficient(ports, laws, k, s, r, N)[1] * N)
        r *= 0.5
    return float(value)


@kernel
def fall_of(packed: Packed, s: Scratch, y: State, one: OneStep, k: int, h: float) -> float:
    """Largest slope by which friction of contact k falls with slip speed within a step."""
    ports, w = packed.ports, one.w
    if ports.law[k] == LAW_SMOOTH:
        value = drive(packed.laws, ports.row, ports.z_start, s, k, y.g, y.N[k], y.z, h)
        for j in range(w.r.shape[0]):
            value = max(value, drive(packed.laws, ports.row, ports.z_start, s, k, w.g[j], w.N[j, k], w.z[j], h))
        return float(value)
    low = high = magnitude(ports.row, k, y.g)
    load = y.N[k]
    value = -coefficient(ports, packed.laws, k, s, low, load)[1] * load
    for j in range(w.r.shape[0]):
        value = max(value, -coefficient(ports, packed.laws, k, s, w.r[j, k], w.N[j, k])[1] * w.N[j, k])
        low, high, load = min(low, w.r[j, k]), max(high, w.r[j, k]), max(load, w.N[j, k])
    return float(max(value, fall_between(ports, packed.laws, k, s, low, high, load)))


@kernel
def growth(packed: Packed, s: Scratch, y: State, one: OneStep, h: float) -> float:
    """Length of the step from y, whose stages are solved, in units of the longest that sees slip grow."""
    ports = packed.ports
    worst = 0.0
    for k in range(y.mode.shape[0]):
        if y.mode[k] != SLIP or ports.law[k] == LAW_CONSTANT:
            continue
        row0 = ports.row[k]
        d = ports.row[k + 1] - row0
        fall = fall_of(packed, s, y, one, k, h)
        if fall <= 0.0:
            continue
        light = 0.0
        for a in range(row0, row0 + d):
            light = max(light, ports.D[a, a])
        worst = max(worst, h * (fall * light - damped(packed, k)) / LONGEST)
    return float(worst)


@kernel
def too_long(ratio: float, order: int) -> float:
    """The error of a step that is too long to see slip grow, such that control by ``order`` shortens it; else 0.

    ``ratio``: its ``growth``.
    """
    return float(ratio**order) if ratio > 1.0 else 0.0
