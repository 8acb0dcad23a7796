"""Directions of slip at rest, where slip in two directions begins or has just ended."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.problem import Codes, Floats
from fricmb.integrate.run.chunked_run import take
from fricmb.integrate.trajectory import Samples
from fricmb.sensitivity._equations import Equations, Field
from fricmb.sensitivity._found import whole
from fricmb.sensitivity._parts import refuse

#: Most steps of Newton's method, which takes five or six; of loads that friction changes; towards the direction in
#: which slip ends, and the change at which those are over.
_MOST, _LOADS, _TURNS, _TURNED = 50, 100, 2000, 1e-6
#: Accelerations below this share of what friction makes are none; changes of directions that are round-off.
_NOTHING, _SAME = 1e-12, 1e-11
#: How far beside a direction others are looked at.
_ASIDE = 1e-4
#: Cosine of the angle up to which a direction is next to another one.
_NEAR = 0.9


def field_at_rest(
    e: Equations, samples: Samples, mode: Codes, sign: Floats, contacts: list[int], beside: Floats, ends: list[bool]
) -> Field:
    """The field with that direction of one contact at each time in which its slip begins, or has just ended.

    There its relative acceleration is A(n) = rho n with |n| = 1, rho being the growth of r, below 0 where slip
    ``ends``: of several solutions in the one that the direction ``beside`` (m, n_t) turns into.  A = a - mu_k N D n is
    linear but for loads, its own and those of others, that this friction changes: the rest a is found with n, in turn.
    """
    found = sign.copy()
    for i, k in enumerate(contacts):
        found[e.rows(k), i] = 0.0
    field = e.field(samples, mode, found)
    for _ in range(_LOADS):
        before = found.copy()
        A = accelerations(e, field, contacts)
        for i, k in enumerate(contacts):
            own, W = e.rows(k), whole(field.found.g[k], samples.t.size, e.columns)[1][i][:, e.n : 2 * e.n]
            D = e.contacts[k].size_at_rest(field.found.N[k], i) * W @ e.free(field.found, mode[:, i], i) @ W.T
            solve = _settled if ends[i] else _begun
            found[own, i] = solve(D, A[i] + D @ before[own, i], beside[own, i])
        changed = [float(np.abs(found[e.rows(k), i] - before[e.rows(k), i]).max()) for i, k in enumerate(contacts)]
        if max(changed) <= _SAME:
            return field
        field = e.field(samples, mode, found)
    return refuse(
        e.contacts[contacts[int(np.argmax(changed))]].part,
        "the begin or end of slip in two directions under loads that its friction changes as much",
    )


def put(field: Field, i: int, own: Field, j: int) -> None:
    """Time number j of a field into another's time number i."""
    field.a[i], field.a_slopes[i] = own.a[j], own.a_slopes[j]
    field.rate[i], field.rate_slopes[i] = own.rate[j], own.rate_slopes[j]
    for k, (F, slopes) in own.F.items():
        field.F[k][0][i], field.F[k][1][i] = F[j], slopes[j]


def accelerations(e: Equations, field: Field, contacts: list[int]) -> list[Floats]:
    """Relative accelerations (d,) of one contact at each time."""
    along = np.zeros((len(contacts), e.columns))
    along[:, : e.n_y], along[:, -1] = field.y_dot, 1.0
    return [whole(field.found.g[k], len(along), e.columns)[1][i] @ along[i] for i, k in enumerate(contacts)]


def across(e: Equations, samples: Samples, mode: Codes, sign: Floats, k: int, n: Floats) -> tuple[Floats, Floats]:
    """Directions across n as rows (d - 1, d), and how fast A of :func:`field_at_rest` falls along them (d - 1, d).

    ``samples``, ``mode``, ``sign``: of one time.
    """
    sides = np.linalg.svd(n[None])[2][1:]
    beside = np.concatenate([n + _ASIDE * sides, n - _ASIDE * sides])
    own = np.zeros(len(beside), dtype=np.int64)
    signs = sign[:, own]
    signs[e.rows(k)] = (beside / np.linalg.norm(beside, axis=1)[:, None]).T
    more, less = np.reshape(
        accelerations(e, e.field(take(samples, own), mode[:, own], signs), [k] * own.size), (2, len(sides), n.size)
    )
    return sides, (less - more) / (2.0 * _ASIDE)


def _begun(D: Floats, a: Floats, beside: Floats) -> Floats:
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


def _settled(D: Floats, a: Floats, beside: Floats) -> Floats:
    """The unit vector n with (D + rho I) n = a into which a direction turns: r n' = (I - n n^T)(a - D n).

    That climbs a^T n - n^T D n/2.
    """
    n = beside / np.linalg.norm(beside)
    step = 1.0 / (float(np.linalg.eigvalsh(D)[-1]) + float(np.linalg.norm(a)))
    for _ in range(_TURNS):
        turns = step * (a - D @ n)
        turns -= n * float(n @ turns)
        if np.linalg.norm(turns) <= _NOTHING:  # of forces that are none, and masses that are even, any will do
            return np.asarray(n)
        n = n + turns
        n /= np.linalg.norm(n)
        if np.linalg.norm(turns) <= _TURNED:
            break
    return _polished(D, a, n)


def _polished(D: Floats, a: Floats, unit: Floats) -> Floats:
    """The unit vector n with (D + rho I) n = a next to one that is nearly it, by Newton's method."""
    n = unit
    rho = float(n @ (a - D @ n))
    for _ in range(_MOST):
        matrix = np.block([[D + rho * np.eye(len(n)), n[:, None]], [n[None], np.zeros((1, 1))]])
        step = np.linalg.lstsq(matrix, np.append(a - (D @ n + rho * n), 0.5 * (1.0 - n @ n)))[0]
        n, rho = n + step[:-1], rho + float(step[-1])
        if np.abs(step[:-1]).max() <= 1e-15:
            break
    # far from there it is another solution: then what is near by is as good as is known
    return np.asarray(n / np.linalg.norm(n) if n @ unit > _NEAR * np.linalg.norm(n) else unit)
