"""Growth of slip where friction falls with speed: steps must not be longer than it takes.

Where mu' < 0 a small slip speed grows like e^(lambda t), lambda = -mu'(r) N n.D n less what dampers take.  An implicit
formula whose step is long beside 1/lambda has another solution, far from the start, in which the growth is over before
it has begun; no polynomial through its stages shows that.
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.between.felt import Felt
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.law_values import coefficient, magnitude, smooth_force
from fricmb.integrate.model.problem_structs import Table
from fricmb.integrate.problem import LAW_CONSTANT, LAW_SMOOTH, SLIP, Floats, Ints
from fricmb.integrate.run.room_protocols import AtContacts, AtNodes, Laws, LawsWithStates

#: Longest step, in times by which slip grows e-fold; part of the largest slip speed in a step below which none matters.
LONGEST, LEAST = 1.0, 1e-12


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
def slip_ahead(row: Ints, k: int, n: Floats, g: Floats) -> float:
    """Slip speed of contact k; in one direction below 0 where a step has gone on beyond the end of its slip."""
    return float(n[row[k]] * g[row[k]] if row[k + 1] - row[k] == 1 else magnitude(row, k, g))


@kernel
def fall_at(
    ports: LawsWithStates, laws: Table, s: Scratch, felt: Felt, k: int, n: Floats, g: Floats, N: Floats, z: Floats,
    h: float,
) -> float:  # fmt: skip
    """Slope by which friction of contact k falls with slip speed."""
    load = max(N[k], felt.least[k])
    if ports.law[k] == LAW_SMOOTH:
        return drive(laws, ports.row, ports.z_start, s, k, g, load, z, h)
    return float(-coefficient(ports, laws, k, s, slip_ahead(ports.row, k, n, g), load)[1] * abs(load))


@kernel
def fall_of(
    ports: LawsWithStates, laws: Table, s: Scratch, y: AtContacts, w: AtNodes, felt: Felt, k: int, h: float
) -> float:
    """Largest slope by which friction of contact k falls with slip speed within a step."""
    value = fall_at(ports, laws, s, felt, k, y.n, y.g, y.N, y.z, h)
    low = high = slip_ahead(ports.row, k, y.n, y.g)
    load = abs(y.N[k])
    for j in range(w.g.shape[0]):
        value = max(value, fall_at(ports, laws, s, felt, k, y.n, w.g[j], w.N[j], w.z[j], h))
        speed = slip_ahead(ports.row, k, y.n, w.g[j])
        low, high, load = min(low, speed), max(high, speed), max(load, abs(w.N[j, k]))
    if ports.law[k] != LAW_SMOOTH:
        value = max(value, fall_between(ports, laws, k, s, low, high, load))
    return float(value)


@kernel
def growth(ports: LawsWithStates, laws: Table, s: Scratch, y: AtContacts, w: AtNodes, felt: Felt, h: float) -> float:
    """Length of the step from y, whose nodes are solved, in units of the longest that sees slip grow.

    Bodies count as if they had no joints: they are heavier with them, and slip grows slower.
    """
    worst = 0.0
    for k in range(y.mode.shape[0]):
        if y.mode[k] != SLIP or ports.law[k] == LAW_CONSTANT:
            continue
        fall = fall_of(ports, laws, s, y, w, felt, k, h)
        if fall <= 0.0:
            continue
        light = 0.0
        for a in range(ports.row[k], ports.row[k + 1]):
            light = max(light, felt.free[a])
        worst = max(worst, h * (fall * light - felt.damped[k]) / LONGEST)
    return float(worst)


@kernel
def too_long(ratio: float, order: int) -> float:
    """The error of a step that is too long to see slip grow, such that control by ``order`` shortens it; else 0.

    ``ratio``: its ``growth``.
    """
    return float(ratio**order) if ratio > 1.0 else 0.0
