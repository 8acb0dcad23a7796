"""The nonlinear problem left when an implicit step is condensed to its contacts, for given modes.

At every stage i the relative velocities are affine in the port forces of all stages, ``g_i = gb_i + sum_j G_ij dF_j``
with dF = F - F_old, and so are varying normal forces.  Unknowns per contact: slip (dtheta, r) with g = r n and
F = -mu(r) N n, which is regular at r = 0; stick F with g = 0; smooth law g and its states z; and N where it varies.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block, declared
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.lu import lu_factor, lu_solve
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.problem_structs import Ports, Table
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, SLIP, STICK, Codes, Floats, Floats2, Floats4
from fricmb.integrate.step.contact_convergence import creep, force_change, smooth_miss, speed_change
from fricmb.integrate.step.contact_unknowns import PortState, evaluate_ports

#: Iterations after which corrections of slip under smooth laws are limited, and the part of its speed at which slip may
#: turn round in one of them.
PLAIN_CORRECTIONS, TURNED = 3, 0.1
#: Angle to which directions of slip are found: close to landing they decide, and no velocity shows their error.
DIRECTION = 1e-9


@kernel
def port_residual(ports: Ports, w: PortState, hA: Floats2, mode: Codes) -> None:
    """Residuals of the port equations, negated, into rhs; unknowns stage by stage: rows, z, N."""
    G, Fin, Fo, dF, rhs, gb = w.G, w.Fin, w.Fo, w.dF, w.rhs, w.gb
    s = w.F.shape[0]
    m = w.F.shape[1]
    nz = w.z.shape[1]
    mi = Fin.shape[1]
    u1 = nz + mi
    for j in range(s):
        for c in range(mi):
            dF[j * mi + c] = Fin[j, c] - Fo[j, c]
    for i in range(s):
        for k in range(mode.shape[0]):
            row0 = ports.row[k]
            d = ports.row[k + 1] - row0
            smooth = ports.law[k] == LAW_SMOOTH
            for a in range(d + 1 if ports.var[k] >= 0 else d):
                out = row0 + a if a < d else m + ports.var[k]
                at = i * u1 + (out if a < d else out + nz)
                if mode[k] == OPEN and (a == d or not smooth):
                    rhs[at] = 0.0
                    continue
                value = gb[i, out] - (w.g[i, out] if a < d else w.N[i, k])
                gain = G[i * mi + out]
                for c in range(dF.shape[0]):
                    value += gain[c] * dF[c]
                if mode[k] == STICK and a < d and gain[i * mi + out] == 0.0:
                    value = -w.F[i, out]  # across a guide: what sticks there bears nothing
                rhs[at] = value
            for a in range(ports.z_start[k], ports.z_start[k + 1]):
                value = w.psi_z[a] - w.z[i, a]
                for j in range(s):
                    value += hA[i, j] * w.zd[j, a]
                rhs[i * u1 + m + a] = value


@kernel
def port_jacobian(ports: Ports, w: PortState, hA: Floats2, mode: Codes) -> None:
    """Jacobian of the port equations at the present unknowns."""
    J, G, L, n = w.J, w.G, w.L, w.n
    s = w.F.shape[0]
    m = w.F.shape[1]
    nz = w.z.shape[1]
    mi = w.Fin.shape[1]
    u1 = nz + mi
    J[:, :] = 0.0
    for i in range(s):
        for k in range(mode.shape[0]):
            row0 = ports.row[k]
            d = ports.row[k + 1] - row0
            z0 = ports.z_start[k]
            nzk = ports.z_start[k + 1] - z0
            smooth = ports.law[k] == LAW_SMOOTH
            for a in range(d + 1 if ports.var[k] >= 0 else d):
                out = row0 + a if a < d else m + ports.var[k]
                at = i * u1 + (out if a < d else out + nz)
                if mode[k] == OPEN and (a == d or not smooth):
                    J[at, at] = 1.0
                    continue
                if mode[k] == STICK and a < d and G[i * mi + out, i * mi + out] == 0.0:
                    J[at, at] = 1.0
                    continue
                fill_row(ports, L, G[i * mi + out], J[at], mode, s, m, nz, mi)
                if a == d or smooth:
                    J[at, at] += 1.0
                elif mode[k] == STICK:
                    J[at, at] -= ports.soft * G[i * mi + out, i * mi + out]
                elif mode[k] == SLIP:
                    J[at, i * u1 + row0 + d - 1] += n[i, out]
                    if d == 2:
                        tangent = -n[i, row0 + 1] if a == 0 else n[i, row0]
                        # softened likewise: of redundant contacts at r = 0 only the sum of the forces is determined
                        load = np.sqrt(L[i, k, 0, 0] ** 2 + L[i, k, 1, 0] ** 2)
                        held = ports.soft * G[i * mi + out, i * mi + out] * load
                        J[at, i * u1 + row0] += (w.r[i, k] + held) * tangent
            for a in range(nzk):
                at = i * u1 + m + z0 + a
                for j in range(s):
                    for b in range(d):
                        J[at, j * u1 + row0 + b] -= hA[i, j] * L[j, k, d + a, b]
                    if ports.var[k] >= 0:
                        J[at, j * u1 + m + nz + ports.var[k]] -= hA[i, j] * L[j, k, d + a, d]
                    for b in range(nzk):
                        J[at, j * u1 + m + z0 + b] -= hA[i, j] * L[j, k, d + a, d + 1 + b]
                J[at, at] += 1.0


@kernel
def fill_row(
    ports: Ports, L: Floats4, gains: Floats, line: Floats, mode: Codes, s: int, m: int, nz: int, mi: int
) -> None:
    """Subtract from a line of the Jacobian how one output follows the unknowns of all contacts and stages."""
    u1 = nz + mi
    for j in range(s):
        gain = gains[j * mi : (j + 1) * mi]
        into = line[j * u1 : (j + 1) * u1]
        for k in range(mode.shape[0]):
            smooth = ports.law[k] == LAW_SMOOTH
            if mode[k] == OPEN and not smooth:
                continue
            row0 = ports.row[k]
            d = ports.row[k + 1] - row0
            for b in range(d):
                x = gain[row0 + b]
                if x == 0.0:
                    continue
                for c in range(d):
                    into[row0 + c] -= x * L[j, k, b, c]
                if ports.var[k] >= 0 and mode[k] != OPEN:
                    into[m + nz + ports.var[k]] -= x * L[j, k, b, d]
                if smooth:
                    z0 = ports.z_start[k]
                    for c in range(ports.z_start[k + 1] - z0):
                        into[m + z0 + c] -= x * L[j, k, b, d + 1 + c]
            if ports.var[k] >= 0 and mode[k] != OPEN:
                into[m + nz + ports.var[k]] -= gain[m + ports.var[k]]


@kernel
def limit_turn(ports: Ports, w: PortState, i: int, k: int, at: int) -> None:
    """Let slip under a smooth law that a correction turns round go on slowly.

    Under friction that goes with the logarithm of slip speed Newton overshoots from above the solution to far on the
    other side, and back, without end; from below it comes near from one side.
    """
    along = size = new = 0.0
    for a in range(ports.row[k + 1] - ports.row[k]):
        g, to = w.g[i, ports.row[k] + a], w.g[i, ports.row[k] + a] + w.rhs[at + a]
        along += g * to
        size += g * g
        new += to * to
    if along < 0.0 and new > TURNED * TURNED * size:
        part = TURNED * np.sqrt(size / new)
        for a in range(ports.row[k + 1] - ports.row[k]):
            g = w.g[i, ports.row[k] + a]
            w.rhs[at + a] = part * (g + w.rhs[at + a]) - g


@kernel
def update_ports(ports: Ports, w: PortState, mode: Codes, limited: bool) -> float:
    """Add the Newton correction in rhs to the unknowns; returns the largest turn of a direction (limited to 0.5).

    ``limited``: slip under smooth laws does not turn round at once (:func:`limit_turn`).
    """
    m = w.F.shape[1]
    nz = w.z.shape[1]
    u1 = nz + w.Fin.shape[1]
    turn = 0.0
    for i in range(w.F.shape[0]):
        for k in range(mode.shape[0]):
            row0 = ports.row[k]
            d = ports.row[k + 1] - row0
            at = i * u1 + row0
            if ports.law[k] == LAW_SMOOTH:
                if limited:
                    limit_turn(ports, w, i, k, at)
                for a in range(d):
                    w.g[i, row0 + a] += w.rhs[at + a]
                for a in range(ports.z_start[k], ports.z_start[k + 1]):
                    w.z[i, a] += w.rhs[i * u1 + m + a]
            elif mode[k] == STICK:
                for a in range(d):
                    w.F[i, row0 + a] += w.rhs[at + a]
            elif mode[k] == SLIP:
                w.r[i, k] += w.rhs[at + d - 1]
                if d == 2:
                    angle = min(0.5, max(-0.5, w.rhs[at]))
                    turn = max(turn, abs(w.rhs[at]))
                    x = w.n[i, row0] - angle * w.n[i, row0 + 1]
                    y = w.n[i, row0 + 1] + angle * w.n[i, row0]
                    size = np.sqrt(x * x + y * y)
                    w.n[i, row0] = x / size
                    w.n[i, row0 + 1] = y / size
            if ports.var[k] >= 0 and mode[k] != OPEN:
                w.N[i, k] += w.rhs[i * u1 + m + nz + ports.var[k]]
    return turn


@declared
def plain_ports(ports: Ports, laws: Table, s: Scratch, w: PortState, hA: Floats2, mode: Codes, tol: Floats) -> int:
    """:func:`solve_ports` where coefficients of friction and normal forces are constant; see ``coulomb_newton``."""
    raise NotImplementedError


@kernel
def solve_ports(ports: Ports, laws: Table, s: Scratch, w: PortState, hA: Floats2, mode: Codes, tol: Floats) -> int:
    """Newton on the port unknowns from their present values; ``tol`` (n_c + n_z,) on relative velocities and states.

    Returns the number of iterations, or -1 where it does not converge.
    """
    if w.plain == 1:
        return plain_ports(ports, laws, s, w, hA, mode, tol)
    return general_ports(ports, laws, s, w, hA, mode, tol)


@block
def general_ports(ports: Ports, laws: Table, s: Scratch, w: PortState, hA: Floats2, mode: Codes, tol: Floats) -> int:
    """:func:`solve_ports` by a Jacobian, the factors of which are kept while directions hardly turn."""
    if w.rhs.shape[0] == 0:
        return 0
    evaluate_ports(ports, laws, s, w, mode)
    linear = all_linear(ports, mode)
    smooth = some_smooth(ports)
    renew = True
    close = not some_stick(mode)
    last, last_turn = np.inf, np.inf
    for iteration in range(25):
        port_residual(ports, w, hA, mode)
        if renew:
            port_jacobian(ports, w, hA, mode)
            if not lu_factor(w.J, w.sizes, w.pivots):
                return -1
        lu_solve(w.J, w.rhs, w.sizes, w.pivots)
        change = speed_change(ports, w, mode, tol)
        turn = update_ports(ports, w, mode, iteration >= PLAIN_CORRECTIONS)
        for i in range(w.F.shape[0]):
            for c in range(w.Fin.shape[1]):
                w.gbuf[i, c] = w.Fin[i, c]
        evaluate_ports(ports, laws, s, w, mode)
        change = max(change, force_change(ports, w, mode, tol))
        if ports.soft > 0.0:
            port_residual(ports, w, hA, mode)
            change = max(change, creep(ports, w, mode, tol))
        if not change < np.inf:
            return -1
        # softening leaves a part of itself behind, which a second iteration takes away
        if linear and (ports.soft == 0.0 or iteration > 0):
            return iteration + 1
        rate = max(change / last, turn / last_turn) if iteration > 0 else 1.0
        # what is left of the turns: the square of the last with new factors, a part of it with old ones
        left = turn * (turn if renew else rate)
        good = left < DIRECTION and (change < 1.0 or (rate < 0.1 and change * rate < 0.1))
        if ports.soft > 0.0:
            # softened Jacobians are not exact, and converge as they do only where they are new
            good = change < 1.0 and turn < 0.5
        if good and smooth:
            port_residual(ports, w, hA, mode)
            good = smooth_miss(ports, w, hA, mode, tol) < 1.0
        # what sticks must not creep by what the last iteration leaves
        if good and close:
            return iteration + 1
        close = close or good
        renew = ports.soft > 0.0 or turn > 0.02 or (iteration > 0 and rate > 0.02)
        last, last_turn = max(change, 1e-300), max(turn, 1e-300)
    return -1


@kernel
def some_stick(mode: Codes) -> bool:
    """Whether some contact sticks."""
    found = False
    for k in range(mode.shape[0]):
        found = found or mode[k] == STICK
    return bool(found)


@kernel
def some_smooth(ports: Ports) -> bool:
    """Whether some contact has a law without stick."""
    found = False
    for k in range(ports.law.shape[0]):
        found = found or ports.law[k] == LAW_SMOOTH
    return bool(found)


@kernel
def all_linear(ports: Ports, mode: Codes) -> bool:
    """Whether one iteration solves the port equations: stick, or one-dimensional slip under constant friction."""
    for k in range(mode.shape[0]):
        if ports.law[k] == LAW_SMOOTH or (ports.var[k] >= 0 and mode[k] == SLIP):
            return False
        if mode[k] == SLIP and (ports.law[k] != 0 or ports.row[k + 1] - ports.row[k] == 2):
            return False
    return True
