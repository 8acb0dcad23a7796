"""Forces of a system at many states at once, its contacts slipping."""

from __future__ import annotations

import numpy as np

from fricmb.analysis._errors import Floats
from fricmb.integrate.model.table_values import arguments, evaluate
from fricmb.integrate.problem import LAW_COEFFICIENT, LAW_SMOOTH, NORMAL_CONSTANT, Elements
from fricmb.system import System

#: Steps of Newton's method for law states.
_STEPS = 4


def forces(system: System, t: Floats, q: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
    """Forces (n, n_t) on the degrees of freedom, F (m, n_t) and slip g (m, n_t) on the rows of the contacts.

    Law states are those of slip that goes on as it is.

    Parameters
    ----------
    t : (n_t,)
    q, v : (n, n_t)
    """
    problem, contacts = system.problem, system.problem.contacts
    X, force, g = without_contacts(system, system.signals(t), t, q, v)
    F = np.zeros_like(g)
    for k in range(problem.n_c):
        rows = slice(int(contacts.row[k]), int(contacts.row[k + 1]))
        N = normal_force(system, k, X)
        F[rows] = _friction(system, k, g[rows], N)
        force = force + contacts.W[:, rows] @ F[rows] + contacts.Wn[:, k, None] * (N - contacts.N0[k])
    return force, F, g


def without_contacts(system: System, u: Floats, t: Floats, q: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
    """Instants X (., n_t), forces (n, n_t) of all but contacts on the degrees of freedom, and slip g (m, n_t).

    ``u`` (3, n_u, n_t): signals, and their rates.
    """
    n, linear, contacts = system.problem.n, system.problem.linear, system.problem.contacts
    X = np.concatenate([t[None], q, v, u[0], u[1]])
    force: Floats = linear.fx[:n, None] - linear.Kx[:n] @ np.concatenate([q, u[0]]) + linear.B @ u[0]
    force -= linear.Cx[:n] @ np.concatenate([v, u[1]])
    _add_elements(system.problem.elements, X, force)
    return X, force, contacts.W.T @ v - contacts.w[:, None] - contacts.Wu @ u[1]


def _add_elements(elements: Elements, X: Floats, force: Floats) -> None:
    """Add forces of elements at the instants X (., n_t) to ``force`` (n, n_t)."""
    for k in range(len(elements.table.address)):
        first, last = int(elements.f_start[k]), int(elements.f_start[k + 1])
        x = arguments(elements.table, k, X)
        out = evaluate(elements.table, k, x, (last - first) * (1 + x.shape[1]) + 3)
        for b in range(last - first):
            spread = slice(int(elements.spread_start[first + b]), int(elements.spread_start[first + b + 1]))
            np.add.at(force, elements.spread_dof[spread], np.outer(elements.spread_coefficient[spread], out[b]))


def normal_force(system: System, k: int, X: Floats) -> Floats:
    """Normal force (n_t,), 0 where the contact is open."""
    contacts = system.problem.contacts
    if contacts.normal[k] == NORMAL_CONSTANT:
        return np.full(X.shape[1], float(contacts.N[k]))
    x = arguments(contacts.normal_table, k, X)
    return np.asarray(np.maximum(evaluate(contacts.normal_table, k, x, 3 + x.shape[1])[0], 0.0))


def _friction(system: System, k: int, g: Floats, N: Floats) -> Floats:
    """Friction (d, n_t) of a contact that slips."""
    contacts, d = system.problem.contacts, len(g)
    r = np.linalg.norm(g, axis=0)
    if contacts.law[k] == LAW_SMOOTH:
        n_z = int(contacts.z_start[k + 1] - contacts.z_start[k])
        size, z = d + n_z, np.zeros((n_z, N.size))
        for _ in range(_STEPS if n_z else 0):
            out = evaluate(contacts.law_table, k, np.vstack([g, N[None], z]).T, size + size * (size + 1))
            J = out[size:].reshape(size, size + 1, -1)[d:, d + 1 :]
            step = np.linalg.pinv(np.moveaxis(J, -1, 0)) @ out[d:size].T[..., None]
            z = z - step[..., 0].T
        return evaluate(contacts.law_table, k, np.vstack([g, N[None], z]).T, size + size * (size + 1))[:d]
    mu = coefficient(system, k, r, N)
    return np.asarray(-mu * N * np.divide(g, r, out=np.zeros_like(g), where=r > 0.0))


def coefficient(system: System, k: int, r: Floats, N: Floats) -> Floats:
    """Coefficient of friction (n_t,) of a contact that slips at speeds r under loads N."""
    contacts = system.problem.contacts
    if contacts.law[k] == LAW_COEFFICIENT:
        return np.asarray(evaluate(contacts.law_table, k, np.array([r, N]).T, 3)[0])
    return np.full_like(r, contacts.mu_0[k])
