"""Directions of slip at rest, where slip in two directions begins or has just ended."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.integrate.problem import Codes, Floats
from fricmb.integrate.run.chunked_run import take
from fricmb.integrate.trajectory import Samples
from fricmb.sensitivity._equations import Equations, Field
from fricmb.sensitivity._found import Found, whole
from fricmb.sensitivity._happenings import PASS, Happening
from fricmb.sensitivity._parts import refuse
from fricmb.sensitivity._phases import Phases

#: Most steps of Newton's method, which takes five or six; of loads that friction changes; towards the direction in
#: which slip ends, and the change at which those are over.
_MOST, _LOADS, _TURNS, _TURNED = 50, 100, 2000, 1e-6
#: Accelerations below this share of what friction makes are none; changes of directions that are round-off.
_NOTHING, _SAME = 1e-12, 1e-11
#: Where in a stretch beside rest the direction of slip is looked at, from there; at least this far, over 1 or the time:
#: collocation comes up to such an instant by ever shorter steps.
_CLOSE, _LEAST = 1e-3, 1e-10
#: How far beside a direction others are looked at.
_ASIDE = 1e-4
#: Cosine of the angle up to which a direction is next to another one.
_NEAR = 0.9


def signs_at_rest(
    e: Equations, phases: Phases, happened: list[Happening], sample: Any, samples: Samples, after: Found
) -> tuple[Floats, Floats]:
    """Signs (m, n) before and after happenings, with the direction of slip in two directions that has ended or begins.

    ``sample``: dense output; ``samples``: of the happenings; ``after``: what parts say behind them.
    """
    begin, found = np.array([one.phase for one in happened]), []
    signs = phases.sign[:, begin - 1], phases.sign[:, begin]
    for i, one in enumerate(happened):
        for k, kind in zip(one.contacts, one.kinds, strict=True):
            rests = kind in ("stick", PASS) or (kind == "slip" and not _moves_on(e, phases, after, i, k))
            if rests and e.contacts[k].d > 1:
                found += [(i, k, ends) for ends in (True, False) if kind == PASS or ends == (kind == "stick")]
    if not found:
        return signs
    numbers, contacts, ends = (list(own) for own in zip(*found, strict=True))
    phase = [happened[i].phase - end for i, _, end in found]
    beside = _beside(phases, sample, phase, ends)
    for j, (i, k, end) in enumerate(found):
        signs[not end][e.rows(k), i] = beside[e.rows(k), j] / np.linalg.norm(beside[e.rows(k), j])
    near = np.column_stack([signs[not end][:, i] for i, _, end in found])
    directions = directions_at_rest(e, take(samples, numbers), phases.mode[:, phase], near, contacts, ends)
    for n, (i, k, end) in zip(directions, found, strict=True):
        signs[not end][e.rows(k), i] = n
    return signs


def _beside(phases: Phases, sample: Any, phase: list[int], ends: list[bool]) -> Floats:
    """Slip (m, n) shortly before stretches end, or after they begin."""
    t = phases.t
    aside = [max(_CLOSE * (t[k + 1] - t[k]), _LEAST * max(1.0, t[k])) for k in phase]
    places = [t[k + 1] - x if end else t[k] + x for k, x, end in zip(phase, aside, ends, strict=True)]
    return np.asarray(sample(np.array(places)).g)


def _moves_on(e: Equations, phases: Phases, after: Found, i: int, k: int) -> bool:
    """Whether slip begins with a speed: what a contact touches has jumped."""
    g, W = whole(after.g[k], after.force.shape[1], e.columns)
    speed = float(np.abs(W[i, :, e.n : 2 * e.n]).max(axis=0) @ phases.speed) + 1e-300
    return bool(np.linalg.norm(g[i]) > 1e-3 * speed)


def directions_at_rest(
    e: Equations, samples: Samples, mode: Codes, sign: Floats, contacts: list[int], ends: list[bool]
) -> list[Floats]:
    """Directions (d,) of one contact at each time in which its slip begins, or has just ended.

    ``sign`` (m, n_t): those near by.  At rest a relative acceleration is A(n) = rho n with |n| = 1, rho being the
    growth of r, below 0 where slip ``ends``: of several solutions that which the direction near by turns into.
    A = a - mu_k N D n is linear but for loads, its own and those of others, that this friction changes: a is found
    with n.
    """
    found = sign.copy()
    for _ in range(_LOADS):
        before, field = found.copy(), e.field(samples, mode, found)
        A = accelerations(e, field, contacts)
        for i, k in enumerate(contacts):
            own, W = e.rows(k), whole(field.found.g[k], samples.t.size, e.columns)[1][i][:, e.n : 2 * e.n]
            D = e.contacts[k].size_at_rest(field.found.N[k], i) * W @ e.free(field.found, mode[:, i], i) @ W.T
            solve = _settled if ends[i] else _begun
            found[own, i] = solve(D, A[i] + D @ before[own, i], sign[own, i])
        changed = [float(np.abs(found[e.rows(k), i] - before[e.rows(k), i]).max()) for i, k in enumerate(contacts)]
        if max(changed) <= _SAME:
            return [found[e.rows(k), i] for i, k in enumerate(contacts)]
    return refuse(
        e.contacts[contacts[int(np.argmax(changed))]].part,
        "the begin or end of slip in two directions under loads that its friction changes as much",
    )


def accelerations(e: Equations, field: Field, contacts: list[int]) -> list[Floats]:
    """Relative accelerations (d,) of one contact at each time."""
    along = np.zeros((len(contacts), e.columns))
    along[:, : e.n_y], along[:, -1] = field.y_dot, 1.0
    return [whole(field.found.g[k], len(along), e.columns)[1][i] @ along[i] for i, k in enumerate(contacts)]


def across(e: Equations, samples: Samples, mode: Codes, sign: Floats, k: int, n: Floats) -> tuple[Floats, Floats]:
    """Directions across n as rows (d - 1, d), and how fast A of :func:`directions_at_rest` falls along them (d - 1, d).

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

    That climbs a^T n - n^T D n/2.  Where it comes to one along which slip does not end, this has gone on along a line
    and through rest, as long as nothing is beside it: then the vector next to it.
    """
    n = unit = beside / np.linalg.norm(beside)
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
    n = _polished(D, a, n)
    return n if n @ (a - D @ n) < 0.0 else _polished(D, a, unit)


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
