"""Ends of slip in two directions: derivatives followed to a short time before, and extrapolated to the landing."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from fricmb.integrate.problem import SLIP, Floats, Ints
from fricmb.sensitivity._equations import Equations
from fricmb.sensitivity._phases import Phases

#: Slip ends where its speed is below this share of that in the middle of a step; of the time that it lasts,
#: what is left out before its end, and the farthest from there that is looked at for the time of the landing.
_TINY, _LAST, _FAR = 1e-4, 1e-8, 1e-3
#: Share of the largest slip speed below which slip that passes rest is close to it.
_CLOSE = 1e-4

#: Contacts, and in which stretches (n_k,) their slip begins from rest, and ends.
Rests = list[tuple[int, Any, Any]]


def left_out(e: Equations, phases: Phases, rests: Rests) -> Floats:
    """Time (n_k,) that is left out before the end of a stretch in which slip in two directions ends, else 0."""
    found = np.zeros(phases.t.size - 1)
    for k, _, ends in rests:
        if e.contacts[k].d > 1:
            found = np.where(ends, np.maximum(found, _LAST * _lasting(phases.t, phases.mode[k])), found)
    return found


def passes(e: Equations, rests: Rests) -> list[tuple[int, int]]:
    """Contacts whose slip in two directions comes to rest and sets out again at once, and the stretch it begins."""
    wide = [rest for rest in rests if e.contacts[rest[0]].d > 1]
    return [(k, int(j) + 1) for k, begins, ends in wide for j in np.flatnonzero(ends[:-1] & begins[1:])]


def near_misses(
    e: Equations, phases: Phases, sample: Any, passed: list[tuple[int, int]]
) -> Iterator[tuple[int, float, float]]:
    """Contacts whose slip in two directions passes rest closely, when, and how closely over their largest speed.

    ``passed``: what comes to rest (:func:`passes`), and does not count.
    """
    wide = [k for k, contact in e.contacts.items() if contact.d > 1 and not contact.smooth]
    if not wide:
        return
    g = sample(phases.t).g
    for k in wide:
        r, slips = np.linalg.norm(g[e.rows(k)], axis=0), phases.mode[k] == SLIP
        inner, most = r[1:-1], max(float(r.max()), 1e-300)
        rests = np.isin(np.arange(1, r.size - 1), [phase for own, phase in passed if own == k])
        lowest = ~rests & (inner <= r[:-2]) & (inner < r[2:]) & slips[:-1] & slips[1:]
        for j in np.flatnonzero(lowest & (inner > 0.0) & (inner < _CLOSE * most)):
            yield k, float(phases.t[j + 1]), float(inner[j]) / most


def at_rest(e: Equations, phases: Phases, sample: Any) -> Rests:
    """Where slip under rigid friction begins from rest, and ends."""
    h = np.diff(phases.t)
    hard = [k for k, contact in e.contacts.items() if not contact.smooth]
    found: Rests = []
    if not hard:
        return found
    g = sample(np.concatenate([phases.t, phases.t[:-1] + 0.5 * h])).g
    for k in hard:
        r = np.linalg.norm(g[e.rows(k)], axis=0)
        edges, middles, slips = r[: h.size + 1], r[h.size + 1 :], phases.mode[k] == SLIP
        found.append((k, slips & (edges[:-1] <= _TINY * middles), slips & (edges[1:] <= _TINY * middles)))
    return found


def places_before(t: float, rest: float, mesh: Floats) -> Ints:
    """Steps of a mesh (those before a landing at t), about rest, 2 rest, 4 rest, ... before it, nearest first."""
    far = rest * 2.0 ** np.arange(1 + int(np.log2(_FAR / _LAST)))
    near = np.clip(np.searchsorted(mesh, t - far), 1, mesh.size - 1)
    near = near - (mesh[near] - (t - far) > (t - far) - mesh[near - 1])
    return np.asarray(np.unique(near)[::-1])


def extrapolated(tau: Floats, values: Floats) -> Floats:
    """What values (k, ..., n_t, n) at times tau (k, n_t) > 0 tend to at 0, by the polynomials through all k of them."""
    return np.asarray(np.einsum("kt,k...tn->...tn", _weights(tau), values))


def _weights(tau: Floats) -> Floats:
    """Of the values at times tau (k, n_t) in what they tend to."""
    apart = tau[None] - tau[:, None]
    shares = np.where(apart == 0.0, 1.0, tau[None] / np.where(apart == 0.0, 1.0, apart))
    return np.asarray(np.prod(shares, axis=1))


def settled(tau: Floats, values: Floats, noise: Floats) -> tuple[Floats, Floats]:
    """Limits at tau = 0 of values (n_t, n), and how sure they are (n,); ``noise``: of the values.

    Far from a landing powers of tau that no polynomial has are in the way, near it errors of the dense output, which
    count the more the smaller r is: extrapolations from three neighbours each are taken where they differ least, and
    noise, which extrapolation makes larger, is small.
    """
    if tau.size < 5:
        best, less = (extrapolated(tau[:k, None], values[:k, None])[0] for k in (3, 2))
        return best, np.maximum(np.abs(best - less), noise[0])
    count = tau.size - 2
    times, held, loud = (np.array([x[k : k + count] for k in range(3)]) for x in (tau, values, noise))
    found = extrapolated(times, held)
    louder = np.einsum("kt,ktn->tn", np.abs(_weights(times)), loud)
    apart = np.abs(np.diff(found, axis=0))
    off = np.maximum(np.maximum(apart[:-1], apart[1:]), louder[1:-1])
    best = np.argmin(off, axis=0)
    columns = np.arange(values.shape[1])
    return found[best + 1, columns], off[best, columns]


def _lasting(t: Floats, mode: Any) -> Floats:
    """Of each stretch the time that the mode in it lasts."""
    first = np.flatnonzero(np.concatenate([[True], mode[1:] != mode[:-1]]))
    lengths = np.diff(np.append(t[first], t[-1]))
    found: Floats = np.repeat(lengths, np.diff(np.append(first, mode.size)))
    return found
