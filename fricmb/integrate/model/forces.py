"""Forces of the structure, their Jacobian, normal forces and powers at one instant."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.compile.template import call
from fricmb.integrate.model.problem_structs import Packed, Ports, Spread, Table
from fricmb.integrate.model.structure import Structure
from fricmb.integrate.problem import Codes, Floats, Problem


class Scratch(Layout):
    """X = [t, q, v, u, u'], the second derivatives of the signals, and space for one template's call.

    ``window`` (2,): the interval between two breakpoints on whose inner side functions of time are evaluated.
    """

    X: Floats
    ddu: Floats
    x: Floats
    out: Floats
    window: Floats


def longest_call(problem: Problem) -> tuple[int, int]:
    """Most numbers that a template of the problem takes, and most that one gives."""
    directions = int(np.max(np.diff(problem.contacts.row), initial=2))
    states = int(np.max(np.diff(problem.contacts.z_start), initial=0)) + 1 + directions
    n_x = max(8, states + 2)
    for templates in (problem.elements.table, problem.bends.table, problem.contacts.normal_table):
        n_x = max(n_x, int(np.max(np.diff(templates.x_start), initial=0)))
    n_f = int(np.max(np.diff(problem.elements.f_start), initial=0))
    n_b = int(np.max(np.diff(problem.bends.start), initial=0))
    return n_x, max(8 + n_f * (n_x + 4), 2 + n_x, states * (states + 3) + 4, n_b)


def scratch_of(problem: Problem) -> Scratch:
    """Empty arrays for evaluating the given problem; with a mechanism X has its extended coordinates."""
    coordinates = problem.n if problem.mechanism is None else problem.mechanism.n_y
    X, ddu = np.zeros(1 + 2 * coordinates + 2 * problem.n_u), np.zeros(problem.n_u)
    x, out = (np.zeros(size) for size in longest_call(problem))
    return Scratch(X, ddu, x, out, np.array([-np.inf, np.inf]))


@kernel
def set_time(signals: Table, s: Scratch, t: float, n: int) -> None:
    """Put the time and the prescribed signals into X."""
    nu = s.ddu.shape[0]
    t = min(max(t, s.window[0]), s.window[1])
    s.X[0] = t
    for j in range(nu):
        s.x[0] = t
        call(signals.address[j], s.x, 0, signals.p, signals.p_start[j], s.out, 0)
        s.X[1 + 2 * n + j] = s.out[0]
        s.X[1 + 2 * n + nu + j] = s.out[1]
        s.ddu[j] = s.out[2]


@kernel
def set_instant(signals: Table, s: Scratch, t: float, q: Floats, v: Floats) -> None:
    """Put time, prescribed signals and state into X."""
    n = q.shape[0]
    set_time(signals, s, t, n)
    for i in range(n):
        s.X[1 + i] = q[i]
        s.X[1 + n + i] = v[i]


@kernel
def gather(table: Table, i: int, X: Floats, x: Floats) -> int:
    """Arguments of function i; returns their number."""
    first = table.x_start[i]
    last = table.x_start[i + 1]
    for a in range(first, last):
        value = table.form_constant[a]
        for j in range(table.form_start[a], table.form_start[a + 1]):
            value += table.form_coefficient[j] * X[table.form_index[j]]
        x[a - first] = value
    return int(last - first)


@kernel
def evaluate(table: Table, i: int, s: Scratch) -> int:
    """Call function i at X: arguments in ``s.x``, what it gives in ``s.out``; returns the number of arguments."""
    count = gather(table, i, s.X, s.x)
    call(table.address[i], s.x, 0, table.p, table.p_start[i], s.out, 0)
    return count


@kernel
def structure_force(structure: Structure, elements: Table, spread: Spread, s: Scratch, f: Floats) -> None:
    """All forces on the dofs at X but those of the contacts, into f (n,)."""
    n = f.shape[0]
    nu = s.ddu.shape[0]
    start, index, K, C, tie = structure.first, structure.column, structure.K, structure.C, structure.tie
    q, v, u, du = s.X[1 : 1 + n], s.X[1 + n : 1 + 2 * n], s.X[1 + 2 * n : 1 + 2 * n + nu], s.X[1 + 2 * n + nu :]
    for i in range(n):
        value = structure.f[i]
        if tie.shape[0] == 0:
            for e in range(start[i], start[i + 1]):
                value -= K[e] * q[index[e]] + C[e] * v[index[e]]
        else:
            # stiff springs between dofs by the difference of these: what they do to both is equal to the last digit
            for e in range(start[i], start[i + 1]):
                value -= K[e] * (q[index[e]] - tie[e] * q[i]) + C[e] * v[index[e]]
            value -= structure.alone[i] * q[i]
        for j in range(nu):
            value -= structure.Ku[i, j] * u[j] + structure.Cu[i, j] * du[j]
            value += structure.B[i, j] * u[j]
        f[i] = value
    element_forces(elements, spread, s, f)


@kernel
def element_forces(elements: Table, spread: Spread, s: Scratch, f: Floats) -> None:
    """Add the forces of nonlinear elements at X to f."""
    for k in range(elements.address.shape[0]):
        evaluate(elements, k, s)
        for b in range(spread.f_start[k], spread.f_start[k + 1]):
            for j in range(spread.start[b], spread.start[b + 1]):
                f[spread.dof[j]] += spread.coefficient[j] * s.out[b - spread.f_start[k]]


@kernel
def element_powers(elements: Table, spread: Spread, s: Scratch) -> tuple[float, float]:
    """What nonlinear elements lose and bring in at X."""
    loss, supply = 0.0, 0.0
    for k in range(elements.address.shape[0]):
        n_x = evaluate(elements, k, s)
        n_f = spread.f_start[k + 1] - spread.f_start[k]
        loss += s.out[n_f * (1 + n_x) + 1]
        supply += s.out[n_f * (1 + n_x) + 2]
    return loss, supply


@kernel
def entry_at(structure: Structure, i: int, j: int) -> int:
    """Where the pattern keeps row i, column j, which must be in it."""
    e = structure.first[i]
    while structure.column[e] != j:
        e += 1
    return int(e)


@kernel
def structure_jacobian(structure: Structure, elements: Table, spread: Spread, s: Scratch, K: Floats, C: Floats) -> None:
    """K = -df/dq and C = -df/dv of :func:`structure_force` at X, on the structure's pattern."""
    n = structure.f.shape[0]
    K[:] = structure.K
    C[:] = structure.C
    for k in range(elements.address.shape[0]):
        n_x = evaluate(elements, k, s)
        n_f = spread.f_start[k + 1] - spread.f_start[k]
        x0 = elements.x_start[k]
        for b in range(n_f):
            for a in range(n_x):
                slope = s.out[n_f + b * n_x + a]
                for j in range(elements.form_start[x0 + a], elements.form_start[x0 + a + 1]):
                    at = elements.form_index[j] - 1
                    if at < 0 or at >= 2 * n:
                        continue
                    row0 = spread.f_start[k] + b
                    for i in range(spread.start[row0], spread.start[row0 + 1]):
                        value = slope * elements.form_coefficient[j] * spread.coefficient[i]
                        if at < n:
                            K[entry_at(structure, spread.dof[i], at)] -= value
                        else:
                            C[entry_at(structure, spread.dof[i], at - n)] -= value


@kernel
def normal_force(ports: Ports, normals: Table, k: int, s: Scratch) -> float:
    """Normal force of contact k at X, before max(0, .)."""
    if ports.var[k] < 0:
        return float(ports.N[k])
    evaluate(normals, k, s)
    return float(s.out[0])


@kernel
def normal_gradient(normals: Table, k: int, s: Scratch, Nq: Floats, Nv: Floats) -> None:
    """Gradient of the normal force of contact k with respect to q and v (n,)."""
    n = Nq.shape[0]
    for i in range(n):
        Nq[i] = 0.0
        Nv[i] = 0.0
    n_x = evaluate(normals, k, s)
    x0 = normals.x_start[k]
    for a in range(n_x):
        for j in range(normals.form_start[x0 + a], normals.form_start[x0 + a + 1]):
            at = normals.form_index[j] - 1
            if 0 <= at < n:
                Nq[at] += s.out[1 + a] * normals.form_coefficient[j]
            elif n <= at < 2 * n:
                Nv[at - n] += s.out[1 + a] * normals.form_coefficient[j]


@kernel
def belt_velocity(ports: Ports, s: Scratch, n: int, a: int) -> float:
    """Prescribed part w + Wu u' of the relative velocity in row a at X."""
    nu = s.ddu.shape[0]
    value = ports.w[a]
    for j in range(nu):
        value += ports.Wu[a, j] * s.X[1 + 2 * n + nu + j]
    return float(value)


@kernel
def stored_by_damped(damped: Codes, normals: Table, s: Scratch) -> float:
    """Energy stored at X by all contacts whose normal force has damping."""
    stored = 0.0
    for k in range(damped.shape[0]):
        if damped[k]:
            evaluate(normals, k, s)
            stored += s.out[3]
    return stored


@kernel
def powers(packed: Packed, s: Scratch, F: Floats, N: Floats, g: Floats, out: Floats) -> None:
    """Powers at X: friction loss of every contact (n_c,), damping loss, input; into out (n_c + 2,).

    The damping loss is short of what contacts with damping store (:func:`stored_by_damped`).  Input is what drivers,
    forces of time, slides and the antisymmetric part of K bring in.
    """
    structure = packed.structure
    ports = packed.ports
    n = structure.f.shape[0]
    nu = s.ddu.shape[0]
    nc = ports.law.shape[0]
    u0 = 1 + 2 * n
    damping = 0.0
    supply = 0.0
    for k in range(nc):
        loss = 0.0
        for a in range(ports.row[k], ports.row[k + 1]):
            loss -= F[a] * g[a]
            supply += F[a] * belt_velocity(ports, s, n, a)
        out[k] = loss
        if ports.acts[k]:
            # the bodies feel N - N0 along e: stored dV/de e', the rest is lost; a driven end brings the difference in;
            # of one with damping all counts as lost here, and what is stored is taken off in the end
            evaluate(packed.normals, k, s)
            rate = s.x[1]
            felt = 0.0
            for i in range(n):
                felt += ports.Wn[i, k] * s.X[1 + n + i]
            push = N[k] - ports.N0[k]
            damping -= (push if ports.damped[k] else push + s.out[4]) * rate
            supply += push * (felt - rate)
    start, index, C, Ka = structure.first, structure.column, structure.C, structure.Ka
    q, v = s.X[1 : 1 + n], s.X[1 + n : 1 + 2 * n]
    for i in range(n):
        vi = v[i]
        for e in range(start[i], start[i + 1]):
            damping += vi * C[e] * v[index[e]]
            supply -= vi * Ka[e] * q[index[e]]
        for j in range(nu):
            damping += vi * structure.Cu[i, j] * s.X[u0 + nu + j]
            supply += vi * structure.B[i, j] * s.X[u0 + j]
    for j in range(nu):
        dashpot = 0.0
        force = -structure.fd[j]
        for i in range(n):
            dashpot += structure.Cd[j, i] * s.X[1 + n + i]
            force += structure.Kd[j, i] * s.X[1 + i]
        for i in range(nu):
            dashpot += structure.Cd[j, n + i] * s.X[u0 + nu + i]
            force += structure.Kd[j, n + i] * s.X[u0 + i]
        damping += s.X[u0 + nu + j] * dashpot
        supply += s.X[u0 + nu + j] * (force + dashpot)
    lost, gained = element_powers(packed.elements, packed.spread, s)
    out[nc] = damping + lost
    out[nc + 1] = supply + gained
