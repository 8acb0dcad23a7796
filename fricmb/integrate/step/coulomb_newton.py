"""The port equations where every contact has constant friction and a constant normal force: fewest unknowns.

Collocation of several contacts takes these instead of :mod:`~fricmb.integrate.step.contact_newton`.

One angle a stage for slip in two dimensions, the force for stick, nothing for slip in one dimension: with
F = -mu N n and t = J n, solve t . g = 0; r = n . g follows.  Regular at r = 0, and no trigonometry.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.lanes import LANES, all_lanes, lanes, total
from fricmb.integrate.compile.lapack import solve_real
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.problem_structs import Ports, Table
from fricmb.integrate.problem import OPEN, SLIP, STICK, Codes, Floats, Floats2
from fricmb.integrate.step.contact_newton import some_stick
from fricmb.integrate.step.contact_unknowns import PortState

#: Correction, in units of what is asked for, times the turn behind it, from which on the next one is too small to
#: matter.
QUADRATIC = 1e-2


@kernel
def dot(a: Floats, b: Floats) -> float:
    """Inner product, eight terms at a time."""
    whole = b.shape[0] // LANES * LANES
    parts = all_lanes(0.0)
    for i in range(0, whole, LANES):
        parts = parts + lanes(a, i) * lanes(b, i)
    rest = 0.0
    for i in range(whole, b.shape[0]):
        rest += a[i] * b[i]
    return float(total(parts) + rest)


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
    dF = w.dF
    for j in range(n_s):
        for c in range(m):
            dF[j * m + c] = w.F[j, c] - w.Fo[j, c]
    for i in range(n_s):
        for a in range(m):
            w.g[i, a] = w.gb[i, a] + dot(w.G[i * m + a], dF)
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
def put_pushes(ports: Ports, w: PortState, mode: Codes) -> None:
    """Change of every force with the unknown of its contact at its stage, into ``gbuf``."""
    for k in range(mode.shape[0]):
        row0 = ports.row[k]
        slips = mode[k] == SLIP and ports.row[k + 1] - row0 == 2
        for j in range(w.F.shape[0]):
            if slips:
                size = ports.mu_0[k] * w.N[j, k]
                w.gbuf[j, row0] = size * w.n[j, row0 + 1]
                w.gbuf[j, row0 + 1] = -size * w.n[j, row0]
            else:
                for a in range(row0, ports.row[k + 1]):
                    w.gbuf[j, a] = 1.0 if mode[k] == STICK else 0.0


@kernel
def put_line(ports: Ports, mode: Codes, gains: Floats, n_s: int, line: Floats) -> None:
    """A line of the Jacobian: what forces at all stages do (``gains``) by the unknowns, contact by contact."""
    m = ports.row[mode.shape[0]]
    at = 0
    for k in range(mode.shape[0]):
        row0 = ports.row[k]
        d = ports.row[k + 1] - row0
        if mode[k] == STICK:
            for a in range(d):
                into = line[at + a * n_s : at + (a + 1) * n_s]
                for j in range(n_s):
                    into[j] = gains[j * m + row0 + a]
            at += d * n_s
        elif mode[k] == SLIP and d == 2:
            into = line[at : at + n_s]
            for j in range(n_s):
                into[j] = gains[j * m + row0] + gains[j * m + row0 + 1]
            at += n_s


@kernel
def assemble_plain(ports: Ports, w: PortState, mode: Codes, size: int) -> None:
    """Residuals (negated) and Jacobian; unknowns contact by contact, each stage by stage."""
    n_s = w.F.shape[0]
    m = w.F.shape[1]
    G, J, gains = w.G, w.J.reshape(w.J.size), w.dF
    put_pushes(ports, w, mode)
    push = w.gbuf.reshape(w.gbuf.size)
    at = 0
    for k in range(mode.shape[0]):
        row0 = ports.row[k]
        for y in range(unknowns(ports, mode, k)):
            for i in range(n_s):
                line = J[at * size : (at + 1) * size]
                o = i * m + row0 + y
                first = G[o]
                if mode[k] == SLIP:
                    t0, t1 = -w.n[i, row0 + 1], w.n[i, row0]
                    second = G[o + 1]
                    for x in range(gains.shape[0]):
                        gains[x] = (t0 * first[x] + t1 * second[x]) * push[x]
                    put_line(ports, mode, gains, n_s, line)
                    # softened: of redundant contacts at r = 0 only the sum of the forces is determined
                    load = ports.mu_0[k] * w.N[i, k] * ports.soft * (abs(first[o]) + abs(second[o + 1]))
                    line[at] -= w.r[i, k] + load
                    w.rhs[at] = -(t0 * w.g[i, row0] + t1 * w.g[i, row0 + 1])
                else:
                    for x in range(gains.shape[0]):
                        gains[x] = first[x] * push[x]
                    put_line(ports, mode, gains, n_s, line)
                    line[at] += ports.soft * first[o]
                    w.rhs[at] = -w.g[i, row0 + y]
                    if first[o] == 0.0:  # across a guide: what sticks there bears nothing
                        line[at] = 1.0
                        w.rhs[at] = -w.F[i, row0 + y]
                at += 1


@kernel
def move_plain(ports: Ports, w: PortState, mode: Codes, tol: Floats) -> tuple[float, float]:
    """Add the correction; returns the largest change of a relative velocity against its tolerance, and of an angle."""
    n_s = w.F.shape[0]
    m = w.F.shape[1]
    at = 0
    change = 0.0
    turn = 0.0
    for k in range(mode.shape[0]):
        row0 = ports.row[k]
        if mode[k] == STICK:
            for a in range(row0, ports.row[k + 1]):
                for i in range(n_s):
                    moved = abs(w.rhs[at] * w.G[i * m + a, i * m + a])
                    w.F[i, a] += w.rhs[at]
                    change = max(change, moved / tol[k]) if moved < np.inf else np.inf
                    at += 1
            continue
        for i in range(n_s if unknowns(ports, mode, k) > 0 else 0):
            o = i * m + row0
            angle = w.rhs[at]
            at += 1
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
    return change, turn


@block
def plain_ports(ports: Ports, laws: Table, s: Scratch, w: PortState, hA: Floats2, mode: Codes, tol: Floats) -> int:
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
        plain_outputs(ports, w, mode)
        if size == 0:
            done = 1
            break
        assemble_plain(ports, w, mode, size)
        if solve_real(w.J.reshape(w.J.size), w.rhs, size, w.sizes, w.pivots) != 0:
            return -1
        change, turn = move_plain(ports, w, mode, tol)
        if not change < np.inf:
            return -1
        # corrections fall by their squares; what sticks must not creep by what is left: one iteration more
        good = turn < 0.03 and (change < 1.0 or change * turn < QUADRATIC)
        if (linear and (ports.soft == 0.0 or iteration > 0)) or (good and (close or not some_stick(mode))):
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
