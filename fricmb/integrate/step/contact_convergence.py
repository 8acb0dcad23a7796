"""When Newton's method at the contacts has converged: what a change of its unknowns, or a miss of a law, is worth."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.problem_structs import Ports
from fricmb.integrate.problem import LAW_SMOOTH, SLIP, STICK, Codes, Floats, Floats2
from fricmb.integrate.step.contact_unknowns import PortState

#: Part of the tolerance of velocities that the force of a law's state may move a contact by without being looked at.
UNFELT = 1e-6
#: Part of its largest value to which the force of a smooth law is found; least part of the tolerance asked for so.
KNOWN, FINEST = 1e-5, 1e-6
#: Round-off of forces, in parts of their size, that redundant contacts may go on to exchange.
LAST_DIGITS = 1e-15


@kernel
def round_off(w: PortState, i: int, mi: int, a: int, g: float) -> float:
    """Round-off of a relative velocity g on row a at stage i: no tolerance below it can be met.

    Forces at s nodes are known to the condition of the Radau IIA matrix, |A| |A^-1| = 1.8 s^2 in the largest row; from
    eight nodes on that is more than the rest.
    """
    s = w.F.shape[0]
    return float((2e-15 if s < 8 else 4e-16 * s * s) * (abs(g) + abs(w.Fin[i, a] * w.G[i * mi + a, i * mi + a])))


@kernel
def share_noise(line: Floats, Fin: Floats2) -> float:
    """Round-off of a velocity, from its responses ``line`` to the port inputs (stage by stage) of all stages.

    A force that alone holds a body comes to rest at one number.  Of redundant contacts each takes a part of what is
    missing and rounds it by itself; the sums miss by that, and shares move on by a last digit without an end.  A body
    that rests shows nothing but this, and no part of the little that it may move can be asked for.
    """
    noise = 0.0
    mi = Fin.shape[1]
    for j in range(Fin.shape[0]):
        for c in range(mi):
            noise += abs(line[j * mi + c] * Fin[j, c])
    return LAST_DIGITS * noise


@kernel
def speed_change(ports: Ports, w: PortState, mode: Codes, tol: Floats) -> float:
    """Largest correction of a slip speed in rhs, in units of its tolerance."""
    mi = w.Fin.shape[1]
    u1 = mi + w.z.shape[1]
    change = 0.0
    for i in range(w.F.shape[0]):
        for k in range(mode.shape[0]):
            if mode[k] == SLIP and ports.law[k] != LAW_SMOOTH:
                at = ports.row[k + 1] - 1
                change = max(change, abs(w.rhs[i * u1 + at]) / max(tol[k], round_off(w, i, mi, at, w.r[i, k])))
    return change


@kernel
def force_change(ports: Ports, w: PortState, mode: Codes, tol: Floats) -> float:
    """How far the port inputs have moved from ``gbuf``, as velocities in units of tol; inf where not finite.

    Of redundant contacts that stick only sums are determined: see :func:`creep`.
    """
    G, Fin, last = w.G, w.Fin, w.gbuf
    mi = Fin.shape[1]
    change = 0.0
    for i in range(w.F.shape[0]):
        for k in range(mode.shape[0]):
            shared = ports.soft > 0.0 and mode[k] == STICK
            for a in range(ports.row[k], ports.row[k + 1]):
                moved = abs((Fin[i, a] - last[i, a]) * G[i * mi + a, i * mi + a])
                if shared and moved < np.inf:
                    continue
                if not moved < np.inf:
                    return np.inf
                change = max(change, moved / max(tol[k], round_off(w, i, mi, a, w.g[i, a])))
            if ports.var[k] >= 0:
                a = ports.row[-1] + ports.var[k]
                push = abs(G[i * mi + ports.row[k], i * mi + ports.row[k]])
                change = max(change, abs(Fin[i, a] - last[i, a]) * push / tol[k])
    return change


@kernel
def creep(ports: Ports, w: PortState, mode: Codes, tol: Floats) -> float:
    """Largest slip velocity left, in units of its tolerance, where redundant contacts stick; rhs holds residuals.

    The shares of a load that they hold together are known to round-off over the softening alone, and move from one
    iteration to the next without an end; what they must not do is creep.
    """
    mi = w.Fin.shape[1]
    u1 = mi + w.z.shape[1]
    worst = 0.0
    for i in range(w.F.shape[0]):
        for k in range(mode.shape[0]):
            if mode[k] != STICK:
                continue
            for a in range(ports.row[k], ports.row[k + 1]):
                behind = abs(w.gb[i, a])
                for b in range(mi):
                    behind += abs(w.G[i * mi + a, i * mi + b] * w.Fin[i, b])
                worst = max(worst, abs(w.rhs[i * u1 + a]) / max(tol[k], 4e-15 * behind))
    return worst


@kernel
def state_miss(ports: Ports, w: PortState, hA: Floats2, tol: Floats, i: int, k: int, a: int, size: float) -> float:
    """Residual ``size`` of state a of contact k at stage i, in units of what is allowed.

    Allowed are the state's tolerance, a force that no velocity shows (by the largest that it has made so far, as in
    ``one_step.state_noise``), and round-off of its rate: a stiff rate (h dz'/dz large) divides a residual before it
    reaches the state.
    """
    row0, z0 = ports.row[k], ports.z_start[k]
    d, nz = ports.row[k + 1] - row0, ports.z_start[k + 1] - z0
    L, x, mi = w.L[i, k], a - z0, w.Fin.shape[1]
    felt, rate = 1e-290, 0.0
    for b in range(d):
        slope = max(abs(L[b, d + 1 + x]), w.slope[a])
        felt = max(felt, abs(w.G[i * mi + row0 + b, i * mi + row0 + b]) * slope)
        rate += abs(L[d + x, b] * w.g[i, row0 + b])
    for b in range(nz):
        rate += abs(L[d + x, d + 1 + b] * w.z[i, z0 + b])
    n_c = ports.row.shape[0] - 1
    stiff = 1.0 + abs(hA[i, i] * L[d + x, d + 1 + x])
    allowed = stiff * max(tol[n_c + a], UNFELT * tol[k] / felt)
    return float(size / (allowed + 2e-15 * (abs(w.z[i, a]) + abs(hA[i, i]) * rate) + 1e-290))


@kernel
def speed_allowed(w: PortState, tol: float, i: int, a: int) -> float:
    """Residual of slip speed that a smooth law may leave on row a at stage i: the tolerance, or a part of what it does.

    In a short step a force that is quite wrong moves nothing by more than the tolerance.  But a law that turns over
    within less than that then leaves slip on any side of rest, and the next steps have to get away from there.
    """
    mi = w.Fin.shape[1]
    done = 0.0
    for c in range(w.F.shape[1]):
        force = 0.0
        for j in range(w.F.shape[0]):
            force = max(force, abs(w.F[j, c]))
        done += force * abs(w.G[i * mi + a, i * mi + c])
    return float(min(tol, max(KNOWN * done, FINEST * tol)))


@kernel
def smooth_miss(ports: Ports, w: PortState, hA: Floats2, mode: Codes, tol: Floats) -> float:
    """Largest residual in ``rhs`` of the equations of smooth laws, in units of what is allowed.

    Corrections alone do not tell: where a bristle is bent to its limit, none of its states follows the first
    correction of the velocity, though this may have turned round.
    """
    m, nz, mi = w.F.shape[1], w.z.shape[1], w.Fin.shape[1]
    u1 = nz + mi
    miss = 0.0
    for i in range(w.F.shape[0]):
        for k in range(mode.shape[0]):
            if ports.law[k] != LAW_SMOOTH:
                continue
            for a in range(ports.row[k], ports.row[k + 1]):
                off = abs(w.rhs[i * u1 + a]) / max(speed_allowed(w, tol[k], i, a), round_off(w, i, mi, a, w.g[i, a]))
                miss = max(miss, off) if off < np.inf else np.inf
            for a in range(ports.z_start[k], ports.z_start[k + 1]):
                off = state_miss(ports, w, hA, tol, i, k, a, abs(w.rhs[i * u1 + m + a]))
                miss = max(miss, off) if off < np.inf else np.inf
    return float(miss)
