"""Directions of slip at rest, where slip in two directions begins or has just ended."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.problem import Codes, Floats
from fricmb.integrate.trajectory import Samples
from fricmb.sensitivity._equations import Equations, Field
from fricmb.sensitivity._found import at, whole
from fricmb.sensitivity._parts import refuse

#: Most steps of Newton's method, which takes five or six.
_MOST = 50
#: Accelerations below this share of what friction makes are none.
_NOTHING = 1e-12
#: Cosine of the angle up to which a direction is next to another one.
_NEAR = 0.9


def field_at_rest(
    e: Equations, samples: Samples, mode: Codes, sign: Floats, contacts: list[int], beside: Floats, passing: list[bool]
) -> Field:
    """The field with that direction of one contact at each time in which its slip begins, or has just ended.

    (mu_k N D + rho I) n = a with |n| = 1: a is the relative acceleration without its friction, rho the growth of r,
    below 0 in a landing, where directions settle.  Where a is 0 slip ends in the direction that it has had: ``beside``
    (m, n_t) are relative velocities near by.  Of several directions slip ends in that of the largest rho, unless it is
    ``passing`` rest: then in the one near by.  A load that this friction itself changes is refused.
    """
    found = sign.copy()
    for i, k in enumerate(contacts):
        found[e.rows(k), i] = 0.0
    field = e.field(samples, mode, found)
    rates = np.zeros((samples.t.size, e.columns))
    rates[:, : e.n_y], rates[:, -1] = field.y_dot, 1.0
    for k in set(contacts):
        slopes = whole(field.found.g[k], samples.t.size, e.columns)[1]
        N = field.found.N[k]
        for i in (i for i, own in enumerate(contacts) if own == k):
            W = slopes[i][:, e.n : 2 * e.n]
            D = W @ e.free(field.found, mode[:, i], i) @ W.T
            solve = _direction_near if passing[i] else _direction
            found[e.rows(k), i] = solve(
                e.contacts[k].size_at_rest(N, i) * D, slopes[i] @ rates[i], beside[e.rows(k), i]
            )
    slipping = e.field(samples, mode, found)
    for i, k in enumerate(contacts):
        before, after = (at(one.found.N[k].value, i) for one in (field, slipping))
        if abs(after - before) > 1e-9 * abs(before):
            refuse(e.contacts[k].part, "the begin or end of slip in two directions under a load that friction changes")
    return slipping


def _direction(D: Floats, a: Floats, beside: Floats) -> Floats:
    """The unit vector n with (D + rho I) n = a, by Newton's method on 1/|n| = 1, which comes from below."""
    values, vectors = np.linalg.eigh(D)
    if np.linalg.norm(a) < _NOTHING * values[-1]:
        return np.asarray(beside / np.linalg.norm(beside))
    parts = np.where(np.abs(vectors.T @ a) > 0.0, vectors.T @ a, 1e-300)
    rho = float(np.max(np.abs(parts) - values))
    n = parts / (values + rho)
    for _ in range(_MOST):
        length = float(np.linalg.norm(n))
        step = (length - 1.0) * length**2 / float(np.sum(n**2 / (values + rho)))
        if not step > 1e-16 * (abs(rho) + values[-1]):
            break
        rho += step
        n = parts / (values + rho)
    return np.asarray(vectors @ (n / np.linalg.norm(n)))


def _direction_near(D: Floats, a: Floats, beside: Floats) -> Floats:
    """The unit vector n with (D + rho I) n = a next to one that is nearly it, by Newton's method."""
    n = beside / np.linalg.norm(beside)
    rho = float(n @ (a - D @ n))
    for _ in range(_MOST):
        matrix = np.block([[D + rho * np.eye(len(n)), n[:, None]], [n[None], np.zeros((1, 1))]])
        step = np.linalg.lstsq(matrix, np.append(a - (D @ n + rho * n), 0.5 * (1.0 - n @ n)))[0]
        n, rho = n + step[:-1], rho + float(step[-1])
        if np.abs(step[:-1]).max() <= 1e-15:
            break
    unit = beside / np.linalg.norm(beside)
    # far from there it is another solution: then what is near by is as good as is known
    return np.asarray(n / np.linalg.norm(n) if n @ unit > _NEAR * np.linalg.norm(n) else unit)
