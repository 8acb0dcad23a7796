"""Forces of the structure, their Jacobian, normal forces and powers at one instant."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.compile.template import call
from fricmb.integrate.model.problem_structs import Spread, Table
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
def stored_by_damped(damped: Codes, normals: Table, s: Scratch) -> float:
    """Energy stored at X by all contacts whose normal force has damping."""
    stored = 0.0
    for k in range(damped.shape[0]):
        if damped[k]:
            evaluate(normals, k, s)
            stored += s.out[3]
    return stored
