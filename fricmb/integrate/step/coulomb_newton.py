"""The port equations where every contact has constant friction and a constant normal force: fewest unknowns.

Collocation of several contacts takes these instead of :mod:`~fricmb.integrate.step.contact_newton`.

One angle a stage for slip in two dimensions, the force for stick, nothing for slip in one dimension: with
F = -mu N n and t = J n, solve t . g = 0; r = n . g follows.  Regular at r = 0, and no trigonometry.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.lapack import solve_real
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.problem_structs import Ports, Table
from fricmb.integrate.problem import OPEN, SLIP, STICK, Codes, Floats, Floats2, Ints
from fricmb.integrate.run.stop import stopped
from fricmb.integrate.step.contact_newton import some_stick
from fricmb.integrate.step.contact_unknowns import PortState


@kernel
def plain_outputs(ports: Ports, w: PortState, mode: Codes) -> None:
    """Forces of slip from directions; relative velocities g under all forces; slip speeds r = n . g."""
    n_s = w.F.shape[0]
    m = w.F.shape[1]
    for k in range(mode.shape[0]):
        if mode[k] == STICK:
            continue
        load = ports.mu_0[k] if mode[k] == SLIP else 0.0
        for i in range(n_s):
            for a in range(ports.row[k], ports.row[k + 1]):
                w.F[i, a] = -load * w.N[i, k] * w.n[i, a]
    g, F, Fo, G = w.g, w.F, w.Fo, w.G
    for i in range(n_s):
        for a in range(m):
            value = w.gb[i, a]
            for j in range(n_s):
                for c in range(m):
                    value += G[i * m + a, j * m + c] * (F[j, c] - Fo[j, c])
            g[i, a] = value
    for k in range(mode.shape[0]):
        if mode[k] == SLIP:
            for i in range(n_s):
                w.r[i, k] = 0.0
                for a in range(ports.row[k], ports.row[k + 1]):
                    w.r[i, k] += w.n[i, a] * w.g[i, a]


@kernel
def unknowns(ports: Ports, mode: Codes, k: int) -> int:
    """Unknowns of contact k at a stage."""
    d = ports.row[k + 1] - ports.row[k]
    if mode[k] == STICK:
        return int(d)
    return 1 if mode[k] == SLIP and d == 2 else 0


@kernel
def push_of(ports: Ports, w: PortState, mode: Codes, j: int, k: int, x: int, b: int) -> float:
    """Change of force b of contact k at stage j with its unknown x."""
    if mode[k] == STICK:
        return 1.0 if x == b else 0.0
    size = ports.mu_0[k] * w.N[j, k]
    row0 = ports.row[k]
    return float(size * w.n[j, row0 + 1] if b == 0 else -size * w.n[j, row0])


@kernel
def assemble_plain(ports: Ports, w: PortState, mode: Codes, size: int) -> None:
    """Residuals (negated) and Jacobian, contact by contact."""
    n_s = w.F.shape[0]
    m = w.F.shape[1]
    G, J = w.G, w.J.reshape(w.J.size)
    at = 0
    for k in range(mode.shape[0]):
        u = unknowns(ports, mode, k)
        row0 = ports.row[k]
        for i in range(n_s):
            for y in range(u):
                row = at + i * u + y
                slips = mode[k] == SLIP
                t0 = -w.n[i, row0 + 1] if slips else 1.0
                t1 = w.n[i, row0] if slips else 0.0
                o = i * m + row0 + (0 if slips else y)
                w.rhs[row] = -(t0 * w.g[i, row0] + t1 * w.g[i, row0 + 1]) if slips else -w.g[i, row0 + y]
                column = 0
                for c in range(mode.shape[0]):
                    uc = unknowns(ports, mode, c)
                    if uc == 0:
                        continue
                    c0 = ports.row[c]
                    dc = ports.row[c + 1] - c0
                    for j in range(n_s):
                        for x in range(uc):
                            value = 0.0
                            for b in range(dc):
                                gain = t0 * G[o, j * m + c0 + b]
                                if slips:
                                    gain += t1 * G[o + 1, j * m + c0 + b]
                                value += gain * push_of(ports, w, mode, j, c, x, b)
                            J[row * size + column + j * uc + x] = value
                    column += n_s * uc
                if slips:
                    # softened: of redundant contacts at r = 0 only the sum of the forces is determined
                    load = ports.mu_0[k] * w.N[i, k] * ports.soft[0] * (abs(G[o, o]) + abs(G[o + 1, o + 1]))
                    J[row * size + row] -= w.r[i, k] + load
                else:
                    J[row * size + row] += ports.soft[0] * G[o, o]
        at += n_s * u


@kernel
def move_plain(ports: Ports, w: PortState, mode: Codes, tol: Floats) -> tuple[float, float]:
    """Add the correction; returns the largest change of a relative velocity against its tolerance, and of an angle."""
    n_s = w.F.shape[0]
    m = w.F.shape[1]
    at = 0
    change = 0.0
    turn = 0.0
    for k in range(mode.shape[0]):
        u = unknowns(ports, mode, k)
        row0 = ports.row[k]
        for i in range(n_s):
            if u == 0:
                continue
            o = i * m + row0
            if mode[k] == STICK:
                for a in range(u):
                    moved = abs(w.rhs[at + i * u + a] * w.G[o + a, o + a])
                    w.F[i, row0 + a] += w.rhs[at + i * u + a]
                    change = max(change, moved / tol[k]) if moved < np.inf else np.inf
                continue
            angle = w.rhs[at + i]
            grain = 2e-15 * (abs(w.r[i, k]) + ports.mu_0[k] * w.N[i, k] * abs(w.G[o, o]))
            moved = abs(angle) * ports.mu_0[k] * w.N[i, k] * max(abs(w.G[o, o]), abs(w.G[o + 1, o + 1]))
            change = max(change, moved / max(tol[k], grain)) if moved < np.inf else np.inf
            turn = max(turn, abs(angle))
            angle = min(0.5, max(-0.5, angle))
            x = w.n[i, row0] - angle * w.n[i, row0 + 1]
            y = w.n[i, row0 + 1] + angle * w.n[i, row0]
            size = 1.0 / np.sqrt(x * x + y * y)
            w.n[i, row0] = x * size
            w.n[i, row0 + 1] = y * size
        at += n_s * u
    return change, turn


@block
def plain_ports(
    ports: Ports, laws: Table, s: Scratch, w: PortState, hA: Floats2, mode: Codes, tol: Floats, address: Ints
) -> int:
    """Stands in for :func:`solve_ports`: Newton from the present directions; its iterations, or -1."""
    n_s = w.F.shape[0]
    size = 0
    linear = True
    for k in range(mode.shape[0]):
        u = unknowns(ports, mode, k)
        size += n_s * u
        linear = linear and (u == 0 or mode[k] == STICK)
        if mode[k] == OPEN:
            for i in range(n_s):
                w.N[i, k] = 0.0
    done = -1
    close = False
    for iteration in range(25):
        if stopped():
            return -1
        plain_outputs(ports, w, mode)
        if size == 0:
            done = 1
            break
        assemble_plain(ports, w, mode, size)
        if solve_real(address[0], w.J.reshape(w.J.size), w.rhs, size, w.sizes, w.pivots) != 0:
            return -1
        change, turn = move_plain(ports, w, mode, tol)
        if not change < np.inf:
            return -1
        # what sticks must not creep by what is left: one iteration more
        good = change < 1.0 and turn < 0.03
        if (linear and (ports.soft[0] == 0.0 or iteration > 0)) or (good and (close or not some_stick(mode))):
            plain_outputs(ports, w, mode)
            done = iteration + 1
            break
        close = good
    for i in range(n_s):
        for a in range(w.F.shape[1]):
            w.Fin[i, a] = w.F[i, a]
        for k in range(mode.shape[0]):
            if mode[k] == STICK:
                for a in range(ports.row[k], ports.row[k + 1]):
                    w.g[i, a] = 0.0
            elif mode[k] == SLIP:
                for a in range(ports.row[k], ports.row[k + 1]):
                    w.g[i, a] = w.r[i, k] * w.n[i, a]
    return done
