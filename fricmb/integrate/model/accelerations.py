"""Everything at one instant: relative velocities, forces, accelerations and powers of a given state and modes."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.lapack import solve_real
from fricmb.integrate.model.forces import Scratch, belt_velocity, normal_force, powers, set_instant, structure_force
from fricmb.integrate.model.friction_cone import stick_limit
from fricmb.integrate.model.friction_discs import share
from fricmb.integrate.model.law_values import coefficient, magnitude, smooth_force
from fricmb.integrate.model.problem_structs import Packed, Ports
from fricmb.integrate.model.state import INFINITE, NEGATIVE, State
from fricmb.integrate.model.structure import Structure
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, SLIP, STICK, Codes, Floats, Pivots

#: Softening of redundant contacts at rest, and rounds of refinement that take it out again (SOFT^rounds < round-off).
SOFT, REFINEMENTS = 1e-4, 5


@kernel
def kinematics(packed: Packed, s: Scratch, y: State) -> None:
    """X, relative velocities g, their prescribed rates, and normal forces (0 where open)."""
    n = y.q.shape[0]
    ports = packed.ports
    nu = s.ddu.shape[0]
    set_instant(packed.signals, s, y.t, y.q, y.v)
    for a in range(y.g.shape[0]):
        value = -belt_velocity(ports, s, n, a)
        size = abs(value)
        for b in range(n):
            value += ports.W[b, a] * y.v[b]
            size += abs(ports.W[b, a] * y.v[b])
        y.g[a] = value
        y.size[a] = size
        rate = 0.0
        for j in range(nu):
            rate += ports.Wu[a, j] * s.ddu[j]
        y.wd[a] = rate
    for k in range(y.mode.shape[0]):
        load = 0.0 if y.mode[k] == OPEN else normal_force(ports, packed.normals, k, s)
        y.N[k] = 0.0 if load < 0.0 else load  # what is no number stays none


@kernel
def known_forces(packed: Packed, s: Scratch, y: State) -> None:
    """Forces of slipping and smooth contacts (stuck ones 0), and relative accelerations a0 under them."""
    ports = packed.ports
    n = y.q.shape[0]
    y.fault = 0.0
    structure_force(packed.structure, packed.elements, packed.spread, s, y.f)
    for k in range(y.mode.shape[0]):
        row0 = ports.row[k]
        d = ports.row[k + 1] - row0
        if ports.law[k] == LAW_SMOOTH:
            z0 = ports.z_start[k]
            nz = ports.z_start[k + 1] - z0
            smooth_force(packed.laws, k, s, y.g, row0, d, y.N[k], y.z, z0, nz)
            for a in range(d):
                y.F[row0 + a] = s.out[a]
            for a in range(nz):
                y.zd[z0 + a] = s.out[d + a]
        else:
            r = magnitude(ports.row, k, y.g)
            mu = 0.0
            if y.mode[k] == SLIP:
                mu = coefficient(ports, packed.laws, k, s, r, y.N[k])[0]
                if mu < 0.0:
                    y.fault = NEGATIVE
            for a in range(row0, row0 + d):
                # not g/|g|: close to r = 0 the direction in g is lost in round-off, and the stages know it
                y.F[a] = -mu * y.N[k] * y.n[a]
        for a in range(row0, row0 + d):
            for i in range(n):
                y.f[i] += ports.W[i, a] * y.F[a]
        if ports.acts[k]:
            for i in range(n):
                y.f[i] += ports.Wn[i, k] * (y.N[k] - ports.N0[k])
    free_acceleration(packed, y)


@kernel
def accelerate(structure: Structure, f: Floats, a: Floats) -> None:
    """A = M^-1 f, both (n,)."""
    start, index, Minv = structure.Minv_start, structure.Minv_index, structure.Minv
    for i in range(a.shape[0]):
        value = 0.0
        for e in range(start[i], start[i + 1]):
            value += Minv[e] * f[index[e]]
        a[i] = value


@kernel
def free_acceleration(packed: Packed, y: State) -> None:
    """A = M^-1 f and a0 = W^T a - w'."""
    n = y.q.shape[0]
    accelerate(packed.structure, y.f, y.a)
    for a in range(y.g.shape[0]):
        value = -y.wd[a]
        for i in range(n):
            value += packed.ports.W[i, a] * y.a[i]
        y.a0[a] = value


@kernel
def fill_response(ports: Ports, y: State, codes: Codes, zero: bool, size: int, soft: float) -> None:
    """D over the rows of the contacts whose code is 0 (``zero``) or is not, its diagonal softened, into ``y.J``.

    A row across a guide answers to no force: its softening is that of the row that answers most, so that it bears
    nothing where nothing moves across, and is beyond any cone where something does.
    """
    most = 0.0
    for a in range(ports.D.shape[0]):
        most = max(most, ports.D[a, a])
    i = 0
    for k in range(codes.shape[0]):
        if (codes[k] == 0) != zero:
            continue
        for a in range(ports.row[k], ports.row[k + 1]):
            j = 0
            for x in range(codes.shape[0]):
                if (codes[x] == 0) != zero:
                    continue
                for b in range(ports.row[x], ports.row[x + 1]):
                    y.J[i * size + j] = ports.D[a, b]
                    if a == b:
                        y.J[i * size + j] += soft * (ports.D[a, a] if ports.D[a, a] > 0.0 else most)
                    j += 1
            i += 1


@kernel
def solve_response(ports: Ports, y: State, codes: Codes, zero: bool, size: int, sizes: Pivots, pivots: Pivots) -> bool:
    """Solve D x = ``y.rhs`` in place over the rows of the contacts whose code is 0 (``zero``) or is not.

    Where D is singular (redundant contacts): the least-norm solution, by Tikhonov's regularisation with iterative
    refinement.  What the softening leaves falls by its size in each round, and shares of the load are equal to
    round-off over softening.
    """
    if ports.soft == 0.0:
        fill_response(ports, y, codes, zero, size, 0.0)
        return bool(solve_real(y.J, y.rhs, size, sizes, pivots) == 0)
    b, x = y.rhs[:size].copy(), np.zeros(size)
    for _ in range(REFINEMENTS):
        fill_response(ports, y, codes, zero, size, 0.0)
        for i in range(size):
            value = b[i]
            for j in range(size):
                value -= y.J[i * size + j] * x[j]
            y.rhs[i] = value
        fill_response(ports, y, codes, zero, size, SOFT)
        if solve_real(y.J, y.rhs, size, sizes, pivots) != 0:
            return False
        for i in range(size):
            x[i] += y.rhs[i]
    for i in range(size):
        y.rhs[i] = x[i]
    return True


@kernel
def stuck_forces(packed: Packed, y: State, sizes: Pivots, pivots: Pivots) -> bool:
    """Forces of stuck contacts from zero relative acceleration, D F = -a0; adds them to f and a."""
    ports = packed.ports
    size = 0
    for k in range(y.mode.shape[0]):
        if y.mode[k] == STICK:
            for a in range(ports.row[k], ports.row[k + 1]):
                y.rhs[size] = -y.a0[a]
                size += 1
    if size == 0:
        return True
    for i in range(size):
        if not abs(y.rhs[i]) < np.inf:
            y.fault = INFINITE
            return False
    if not solve_response(ports, y, y.mode, True, size, sizes, pivots):
        return False
    i = 0
    for k in range(y.mode.shape[0]):
        if y.mode[k] != STICK:
            continue
        for a in range(ports.row[k], ports.row[k + 1]):
            y.F[a] = y.rhs[i]
            i += 1
            for b in range(y.q.shape[0]):
                y.f[b] += ports.W[b, a] * y.F[a]
    free_acceleration(packed, y)
    return True


@kernel
def hold_limits(packed: Packed, s: Scratch, N: Floats, limit: Floats) -> None:
    """Forces up to which contacts stick (n_c,)."""
    for k in range(limit.shape[0]):
        smooth = packed.ports.law[k] == LAW_SMOOTH
        limit[k] = 0.0 if smooth else stick_limit(packed.ports, packed.laws, k, s, N[k])


@kernel
def share_load(packed: Packed, s: Scratch, mode: Codes, N: Floats, F: Floats, g: Floats, part: float) -> float:
    """Share what redundant stuck contacts hold so that none is beyond ``part`` of its cone: see ``share``."""
    limit = np.zeros(mode.shape[0])
    hold_limits(packed, s, N, limit)
    limit *= part
    return float(share(packed.ports, mode, limit, F, g))


@block
def complete(packed: Packed, s: Scratch, y: State, sizes: Pivots, pivots: Pivots) -> bool:
    """All that follows from t, q, v, z, modes and directions.  False: redundant stuck contacts, or see ``fault``."""
    kinematics(packed, s, y)
    known_forces(packed, s, y)
    if not stuck_forces(packed, y, sizes, pivots):
        return False
    if packed.ports.soft > 0.0:
        share_load(packed, s, y.mode, y.N, y.F, y.way, 1.0)
    powers(packed, s, y.F, y.N, y.g, y.rate)
    return True


@kernel
def slip_rate(packed: Packed, y: State, k: int) -> float:
    """Rate of the slip speed of contact k in its direction, n . (W^T a - w')."""
    value = 0.0
    for a in range(packed.ports.row[k], packed.ports.row[k + 1]):
        rate = -y.wd[a]
        for i in range(y.q.shape[0]):
            rate += packed.ports.W[i, a] * y.a[i]
        value += y.n[a] * rate
    return value
