"""Energies that a run's own quadrature does not hold: viscous loss and what drivers and forces bring in."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Protocol

import numpy as np

from fricmb.integrate.csr import is_diagonal
from fricmb.integrate.problem import Floats, Ints, Problem

#: ``states(row, tau)`` gives t, q, v, F at times since the start of rows.
States = Callable[[Ints, Floats], tuple[Floats, Floats, Floats, Floats]]


#: Damping loss and input (2, n_t) at times with the q, v and F there.
Power = Callable[[Floats, Floats, Floats, Floats], Floats]


def power_of(problem: Problem, start: Floats, rate: Floats) -> Power:
    """Damping loss and input where signals are ``start + rate t``, without the terms that are 0 at all times."""
    linear, contacts, n = problem.linear, problem.contacts, problem.n
    K, C = linear.Kx[:n, :n], linear.Cx
    turning = 0.5 * (K - K.T)
    diagonal, dampers = is_diagonal(C), np.diagonal(C)
    slide = contacts.w + contacts.Wu @ rate

    def power(t: Floats, q: Floats, v: Floats, F: Floats) -> Floats:
        speeds = np.vstack([v, np.broadcast_to(rate[:, None], (len(rate), len(t)))]) if len(rate) else v
        dashpots = np.zeros((0, len(t))) if diagonal else C @ speeds
        damping = dampers @ speeds**2 if diagonal else np.sum(speeds * dashpots, axis=0)
        supply = slide @ F
        if turning.any():
            supply -= np.sum(v * (turning @ q), axis=0)
        if len(rate):
            u = start[:, None] + rate[:, None] * t
            pulled = (dampers[n:] * rate)[:, None] if diagonal else dashpots[n:]
            springs = linear.Kx[n:] @ np.vstack([q, u]) - linear.fx[n:, None]
            supply += np.sum(v * (linear.B @ u), axis=0) + rate @ (springs + pulled)
        return np.stack([damping, supply])

    return power


#: Points of Gauss's formula by the length x of a piece (times the fastest rate).  Powers have twice the rate of the
#: motion: the error with n points is some (x/2)^(2n) / (2n)!, round-off of the whole.  The longest steps have x = 8 and
#: a little more, so that the limit is there.
POINTS = ((0.05, 3), (0.2, 4), (0.5, 5), (1.0, 6), (2.0, 8), (3.0, 10), (4.0, 11), (6.0, 14), (8.4, 16), (16.0, 22))

gauss = cache(np.polynomial.legendre.leggauss)


class Shortcut(Protocol):
    """A shorter way over a part of the pieces."""

    def advance(self, states: States, row: Ints, begin: Floats, end: Floats, found: Floats) -> Floats:
        """Add the integrals over the first part of each piece to ``found`` (2, n); returns where the rest begins."""


def integrals(
    states: States, power: Power, row: Ints, begin: Floats, end: Floats, fastest: float, at_once: int
) -> Floats:
    """Integrals (2, n) of the powers from ``begin`` to ``end`` after the start of rows, by Gauss's formula.

    Of a long run there are more points than memory holds: states are asked for at some ``at_once`` of them together.
    """
    result = np.zeros((2, len(row)))
    length = end - begin
    shorter = -np.inf
    for longest, points in POINTS:
        last = points == POINTS[-1][1]
        chosen = np.flatnonzero((length * fastest > shorter) & ((length * fastest <= longest) | last))
        shorter = longest
        if not len(chosen):
            continue
        x, w = gauss(points)
        pieces = np.maximum(1, np.ceil(length[chosen] * fastest / longest)).astype(np.int64)
        before = np.cumsum(pieces) - pieces
        total, step = int(pieces.sum()), max(1, at_once // points)
        for first in range(0, total, step):
            number = np.arange(first, min(first + step, total))
            which = np.searchsorted(before, number, side="right") - 1
            piece = (length[chosen] / pieces)[which]
            tau = begin[chosen][which, None] + piece[:, None] * ((number - before[which])[:, None] + 0.5 * (x + 1.0))
            weight = 0.5 * piece[:, None] * w
            values = power(*states(np.repeat(row[chosen][which], points), tau.ravel())) * weight.ravel()
            for i in range(2):
                result[i, chosen] += np.bincount(np.repeat(which, points), values[i], len(chosen))
    return result


def from_row_starts(
    states: States, power: Power, short: Shortcut, row: Ints, tau: Floats, fastest: float, at_once: int
) -> Floats:
    """Integrals (2, n) from the start of each row to ``tau`` after it, from one time within a row to the next."""
    order = np.lexsort((tau, row))
    at, until = row[order], tau[order]
    first = np.ones(len(at), dtype=bool)
    first[1:] = at[1:] != at[:-1]
    since = np.where(first, 0.0, np.append(0.0, until[:-1]))
    pieces = np.zeros((2, len(at)))
    rest = short.advance(states, at, since, until, pieces)
    pieces += integrals(states, power, at, rest, until, fastest, at_once)
    result = np.empty_like(pieces)
    for i in range(2):
        # sums of their own for each row: the difference of sums over all rows would not be monotone
        sums = pieces[i].tolist()
        for k in np.flatnonzero(~first).tolist():
            sums[k] += sums[k - 1]
        result[i, order] = sums
    return result
