"""Forces over friction discs: those of least energy, and shares of what redundant contacts hold together.

The problem over discs is solved by projected gradients with Nesterov's momentum, restarted where it points uphill
(O'Donoghue and Candes, Foundations of Computational Mathematics 15, 2015, 715-732); each contact in the units of its
own compliance, in which discs stay discs.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.friction_cone import friction_size
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.problem import STICK, Codes, Floats, Ints
from fricmb.integrate.run.room_protocols import Mobility

#: Gradients taken at most, residual at which they end and at which they will do, in parts of the largest force.
MOST, FINE, COARSE = 20000, 1e-13, 1e-7
#: Bounds of the common load found at most, and the part by which a new one has to be higher.
CUTS, RISE = 30, 1e-14
#: Part of the cones beyond which shares are found where a contact reaches its own, so that what gives way is told.
NEARLY = 1.0 - 1e-6
#: Speed of a contact that does not take part in the motion by which others give way, against the fastest.
SLIGHT = 1e-3


@kernel
def largest(x: Floats) -> float:
    """Largest magnitude."""
    value = 1e-300
    for a in range(x.shape[0]):
        value = max(value, abs(x[a]))
    return value


@kernel
def relative_acceleration(ports: Mobility, a0: Floats, F: Floats, a: int) -> float:
    """Row a of a0 + D F."""
    value = a0[a]
    for b in range(F.shape[0]):
        value += ports.D[a, b] * F[b]
    return float(value)


@kernel
def units(ports: Mobility, part: Codes, scale: Floats) -> float:
    """Compliances of the contacts that take part (0: not) into ``scale`` (m,); returns a bound of D in these units."""
    steep = 1e-300
    for k in range(part.shape[0]):
        for a in range(ports.row[k], ports.row[k + 1]):
            # one unit for both rows of a contact: what is a disc stays one
            other = ports.row[k] + ports.row[k + 1] - 1 - a
            scale[a] = 1.0 / max(ports.D[a, a], ports.D[other, other]) if part[k] != 0 else 0.0
    for a in range(scale.shape[0]):
        total = 0.0
        for b in range(scale.shape[0]):
            total += abs(ports.D[a, b]) * np.sqrt(scale[a] * scale[b])
        steep = max(steep, total)
    return float(steep)


@kernel
def least_energy(
    ports: Mobility, a0: Floats, part: Codes, limit: Floats, scale: Floats, steep: float, F: Floats
) -> bool:  # fmt: skip
    """Forces within discs of radius ``limit`` (n_c,) that make F D F/2 + a0 F least, from those that stand in F."""
    m = F.shape[0]
    ahead, last, step = F.copy(), F.copy(), np.zeros(m)
    speed = 1.0
    for _ in range(MOST):
        for a in range(m):
            if scale[a] > 0.0:
                step[a] = scale[a] / steep * relative_acceleration(ports, a0, ahead, a)
        for a in range(m):
            F[a] = ahead[a] - step[a]
        for k in range(limit.shape[0]):
            size = friction_size(ports.row, k, F)
            if part[k] != 0 and size > limit[k]:
                for a in range(ports.row[k], ports.row[k + 1]):
                    F[a] *= limit[k] / size
        uphill, moved = 0.0, 0.0
        for a in range(m):
            if scale[a] > 0.0:
                uphill += (ahead[a] - F[a]) * (F[a] - last[a]) / scale[a]
                moved = max(moved, abs(F[a] - ahead[a]))
        if moved * steep <= FINE * largest(F) or moved == 0.0:
            return True
        new = 1.0 if uphill > 0.0 else 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * speed * speed))
        push = 0.0 if uphill > 0.0 else (speed - 1.0) / new
        speed = new
        for a in range(m):
            ahead[a] = F[a] + push * (F[a] - last[a])
            last[a] = F[a]
    return bool(moved * steep <= COARSE * largest(F))


@kernel
def share(ports: Mobility, mode: Codes, limit: Floats, F: Floats, g: Floats) -> float:
    """Share what stuck contacts hold together so that the one most loaded, against its ``limit``, is loaded least.

    Only where one of them is beyond its limit; the sums that are determined stay what they are.  Returns the common
    load (above 1: more than they can hold), 0 where nothing has been done.  ``g`` (m,) becomes the motion in which they
    would give way: no shares F load contacts by less than gamma = -F g / sum(limit |g|) if g = W^T x for some x, which
    is the power of a motion against the most that friction can brake.  Contacts that are held to gamma give way by a
    g which improves that bound, until none does.
    """
    nc, m = mode.shape[0], F.shape[0]
    beyond = False
    part = np.zeros(nc, np.int8)
    for k in range(nc):
        if mode[k] == STICK:
            part[k] = 1
            beyond = beyond or friction_size(ports.row, k, F) > limit[k]
    if not beyond:
        return 0.0
    push, X, scale, radius = np.zeros(m), np.zeros(m), np.zeros(m), np.zeros(nc)
    steep = units(ports, part, scale)
    for k in range(nc):
        for a in range(ports.row[k], ports.row[k + 1]):
            for b in range(m):
                push[a] -= ports.D[a, b] * F[b] * (1.0 if scale[b] > 0.0 else 0.0)
    load, found = 0.0, False
    trial = np.zeros(m)
    for _ in range(CUTS):
        for k in range(nc):
            radius[k] = load * limit[k]
        least_energy(ports, push, part, radius, scale, steep, X)
        power, brake, most = 0.0, 0.0, 0.0
        for k in range(nc):
            for a in range(ports.row[k], ports.row[k + 1]):
                trial[a] = relative_acceleration(ports, push, X, a) if part[k] != 0 else 0.0
                power -= F[a] * trial[a]
            most = max(most, magnitude(ports.row, k, trial))
            brake += limit[k] * magnitude(ports.row, k, trial)
        if brake == 0.0 or most <= 1e-13 * largest(push):
            break
        if power / brake <= load * (1.0 + RISE):
            break
        load = power / brake
        found = True
        g[:] = trial
    if not found:
        return 0.0
    for a in range(m):
        if scale[a] > 0.0:
            F[a] = X[a]
    return float(load)


@kernel
def least_slip(row: Ints, way: Floats) -> float:
    """Speed above which a contact slips in a motion ``way`` (m,) by which contacts give way; 0 where none does."""
    most = 0.0
    for c in range(row.shape[0] - 1):
        most = max(most, magnitude(row, c, way))
    return float(SLIGHT * most)
