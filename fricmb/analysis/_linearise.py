"""Forces of a system at one state and their derivatives, from its analytic templates."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fricmb.analysis._errors import Floats
from fricmb.integrate.model.table_values import arguments, evaluate
from fricmb.integrate.problem import (
    LAW_COEFFICIENT,
    LAW_SMOOTH,
    NORMAL_CONSTANT,
    NORMAL_LAW,
    Contacts,
    Elements,
    Templates,
)
from fricmb.system import System


@dataclass(frozen=True, kw_only=True)
class Linearised:
    """Everything at one state of a system that slides at all of its contacts.

    With y = (q, v, z): ``force`` (n,) on the degrees of freedom and ``rate`` (n_z,) of the law states, and their
    derivatives ``force_y`` (n, 2n+n_z), ``rate_y`` (n_z, 2n+n_z).  ``F``, ``g`` (m,) on the rows of the contacts,
    ``r``, ``N`` (n_c,).
    """

    force: Floats
    rate: Floats
    force_y: Floats
    rate_y: Floats
    F: Floats
    g: Floats
    r: Floats
    N: Floats


@dataclass(frozen=True, kw_only=True)
class Slope:
    """What one contact does with a system at one state; over X = (t, q, v, inputs and their rates).

    ``force`` (n,) with what it adds to its static load, ``force_X`` (n, n_X), ``force_z`` (n, d_z) over its own states;
    ``rate`` (d_z,) of these with ``rate_X``, ``rate_z``; ``F``, ``g`` (d,), ``r``, ``N``.
    """

    force: Floats
    force_X: Floats
    force_z: Floats
    rate: Floats
    rate_X: Floats
    rate_z: Floats
    F: Floats
    g: Floats
    r: float
    N: float


def contact_slopes(system: System, q: Floats, v: Floats, z: Floats, t: float = 0.0) -> Iterator[Slope]:
    """Of every contact in turn; one with a load of 0 or below is open and brings no force.

    In two dimensions slip of speed r along n has ``dF/dg = -(mu' N n n^T + mu N/r (1 - n n^T))``, ``dF/dN = -mu n``.
    """
    n, contacts = system.problem.n, system.problem.contacts
    u = system.signals(np.array([t]))[:, :, 0]
    X = np.concatenate([[t], q, v, u[0], u[1]])
    g = contacts.W.T @ v - contacts.w - contacts.Wu @ u[1]
    g_X = np.zeros((g.size, X.size))
    g_X[:, 1 + n : 1 + 2 * n] = contacts.W.T
    for k in range(system.problem.n_c):
        rows = slice(int(contacts.row[k]), int(contacts.row[k + 1]))
        states = slice(int(contacts.z_start[k]), int(contacts.z_start[k + 1]))
        N, N_X = normal_at(contacts, k, X)
        r = float(np.linalg.norm(g[rows]))
        F, rate, J = friction_at(system, k, g[rows], r, N, z[states])
        # J over (g, N, z) of (F, z')
        d, W = F.size, contacts.W[:, rows]
        both_X = J[:, :d] @ g_X[rows] + np.outer(J[:, d], N_X)
        yield Slope(
            force=W @ F + contacts.Wn[:, k] * (N - contacts.N0[k]),
            force_X=W @ both_X[:d] + np.outer(contacts.Wn[:, k], N_X),
            force_z=W @ J[:d, d + 1 :],
            rate=rate,
            rate_X=both_X[d:],
            rate_z=J[d:, d + 1 :],
            F=F,
            g=g[rows],
            r=r,
            N=N,
        )


def linearise(system: System, q: Floats, v: Floats, z: Floats, t: float = 0.0) -> Linearised:
    """Forces and derivatives at a state; contacts with a load of 0 or below are open and bring none."""
    problem = system.problem
    n, n_z = problem.n, problem.n_z
    linear, contacts = problem.linear, problem.contacts
    u = system.signals(np.array([t]))[:, :, 0]
    X = np.concatenate([[t], q, v, u[0], u[1]])
    K, C, places = linear.Kx[:n], linear.Cx[:n], np.concatenate([q, u[0]])
    force = linear.fx[:n] - K @ places - C @ np.concatenate([v, u[1]]) + linear.B @ u[0]
    force_X = np.zeros((n, X.size))
    force_X[:, 1 : 1 + n] -= K[:, :n]
    force_X[:, 1 + n : 1 + 2 * n] -= C[:, :n]
    add_elements(problem.elements, X, force, force_X)
    rate, rate_X = np.zeros(n_z), np.zeros((n_z, X.size))
    force_z, rate_z = np.zeros((n, n_z)), np.zeros((n_z, n_z))
    F, g = np.zeros(problem.m), np.zeros(problem.m)
    r, N = np.zeros(problem.n_c), np.zeros(problem.n_c)
    for k, slope in enumerate(contact_slopes(system, q, v, z, t)):
        rows = slice(int(contacts.row[k]), int(contacts.row[k + 1]))
        F[rows], g[rows], r[k], N[k] = slope.F, slope.g, slope.r, slope.N
        states = slice(int(contacts.z_start[k]), int(contacts.z_start[k + 1]))
        force += slope.force
        force_X += slope.force_X
        force_z[:, states] += slope.force_z
        rate[states], rate_X[states], rate_z[states, states] = slope.rate, slope.rate_X, slope.rate_z
    state = slice(1, 1 + 2 * n)
    return Linearised(
        force=force,
        rate=rate,
        force_y=np.hstack([force_X[:, state], force_z]),
        rate_y=np.hstack([rate_X[:, state], rate_z]),
        F=F,
        g=g,
        r=r,
        N=N,
    )


def stiffness_without_friction(system: System, q: Floats, v: Floats) -> Floats:
    """Symmetric part (n, n) of the stiffness at a state: structure, nonlinear elements, normal-force laws."""
    problem, n = system.problem, system.problem.n
    u = system.signals(np.zeros(1))[:, :, 0]
    X = np.concatenate([np.zeros(1), q, v, u[0], u[1]])
    force_X = np.zeros((n, X.size))
    force_X[:, 1 : 1 + n] -= problem.linear.Kx[:n, :n]
    add_elements(problem.elements, X, np.zeros(n), force_X)
    for k in np.flatnonzero(problem.contacts.normal == NORMAL_LAW):
        force_X += np.outer(problem.contacts.Wn[:, k], normal_at(problem.contacts, int(k), X)[1])
    K = -force_X[:, 1 : 1 + n]
    return 0.5 * (K + K.T)


def slopes_of(table: Templates, k: int, n_X: int) -> Floats:
    """Slopes (n_x, n_X) of the arguments of function k."""
    first, last = int(table.x_start[k]), int(table.x_start[k + 1])
    slopes = np.zeros((last - first, n_X))
    for a in range(first, last):
        form = slice(int(table.form_start[a]), int(table.form_start[a + 1]))
        np.add.at(slopes[a - first], table.form_index[form], table.form_coefficient[form])
    return slopes


def add_elements(elements: Elements, X: Floats, force: Floats, force_X: Floats) -> None:
    """Add forces of nonlinear elements (n,) and their derivatives (n, n_X)."""
    table = elements.table
    for k in range(len(table.address)):
        first, last = int(elements.f_start[k]), int(elements.f_start[k + 1])
        slopes = slopes_of(table, k, X.size)
        n_f, n_x = last - first, len(slopes)
        out = evaluate(table, k, arguments(table, k, X[:, None]), n_f * (1 + n_x) + 3)[:, 0]
        local_X = out[n_f : n_f * (1 + n_x)].reshape(n_f, n_x) @ slopes
        for b in range(n_f):
            spread = slice(int(elements.spread_start[first + b]), int(elements.spread_start[first + b + 1]))
            for i, c in zip(elements.spread_dof[spread], elements.spread_coefficient[spread], strict=True):
                force[i] += c * out[b]
                force_X[i] += c * local_X[b]


def normal_at(contacts: Contacts, k: int, X: Floats) -> tuple[float, Floats]:
    """Normal force and its derivative by X; both 0 where the contact is open."""
    if contacts.normal[k] == NORMAL_CONSTANT:
        return float(contacts.N[k]), np.zeros(X.size)
    table = contacts.normal_table
    slopes = slopes_of(table, k, X.size)
    n_out = 1 + len(slopes) + (2 if contacts.normal[k] == NORMAL_LAW else 0)
    out = evaluate(table, k, arguments(table, k, X[:, None]), n_out)[:, 0]
    if out[0] <= 0.0:
        return 0.0, np.zeros(X.size)
    return float(out[0]), out[1 : 1 + len(slopes)] @ slopes


def friction_at(system: System, k: int, g: Floats, r: float, N: float, z: Floats) -> tuple[Floats, Floats, Floats]:
    """Force (d,), state rates (n_z,) and their Jacobian (d+n_z, d+1+n_z) over (g, N, z) of a sliding contact."""
    contacts = system.problem.contacts
    if contacts.law[k] == LAW_SMOOTH:
        d, size = g.size, g.size + z.size
        out = evaluate(contacts.law_table, k, np.concatenate([g, [N], z])[None], size + size * (size + 1))[:, 0]
        return out[:d], out[d:size], out[size:].reshape(size, size + 1)
    mu, mu_r, mu_N = float(contacts.mu_0[k]), 0.0, 0.0
    if contacts.law[k] == LAW_COEFFICIENT:
        mu, mu_r, mu_N = evaluate(contacts.law_table, k, np.array([[r, N]]), 3)[:, 0].tolist()
    direction = g / r if r > 0.0 else np.zeros(g.size)
    along = np.outer(direction, direction)
    turning = mu * N / r * (np.eye(g.size) - along) if r > 0.0 and g.size > 1 else np.zeros_like(along)
    J = np.column_stack([-(mu_r * N * along + turning), -(mu + mu_N * N) * direction])
    return -mu * N * direction, np.zeros(0), J
