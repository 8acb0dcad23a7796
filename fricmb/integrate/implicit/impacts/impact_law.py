"""The law of impact: velocities behind an impact of all that is hit or held, with friction over its cone.

Newton's law in the form of Moreau (J. J. Moreau, Unilateral contact and dry friction in finite freedom dynamics, in
Nonsmooth Mechanics and Applications, Springer 1988): with ``xi = gamma+ + e gamma-`` in every direction,

    0 <= xi_N  complementary to  Lambda_N >= 0,      -Lambda_T in mu Lambda_N Sgn(xi_T),
    gamma+ = gamma- + D Lambda,                      D = W M^-1 W^T on the velocities that joints allow.

What is held has gamma_N- = 0, so that its own e does not act.

Poisson's law (F. Pfeiffer and C. Glocker, Multibody Dynamics with Unilateral Contacts, Wiley 1996, chapter 8) is the
same problem twice: with e = 0, then from there on with impulses ``e Lambda_N`` of the first phase that act at least.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from fricmb.integrate.problem import Floats, Ints

#: What a contact does in an impact: takes no impulse; takes one without slip, or with slip one way or the other; has
#: the impulse that is given and no more, likewise.
FREE, STICKS, FORWARD, BACKWARD = 0, 1, 2, -2
LEAVES, LEAVES_FORWARD, LEAVES_BACKWARD = 3, 4, -4
PRESSED, SLIPPING = (STICKS, FORWARD, BACKWARD), (FORWARD, BACKWARD, LEAVES_FORWARD, LEAVES_BACKWARD)
#: Round-off of velocities and impulses beside the largest.
ROUND_OFF = 1e-11
#: Energy that an impact may bring by round-off, beside the kinetic energy.
GAIN = 1e-11
#: So many combinations are all tried, and other solutions are counted; of more the first that fits is taken.
ALL, MOST = 256, 20000


@dataclass(frozen=True, kw_only=True)
class Hit:
    """What takes part in an impact: k contacts over r rows.

    Attributes
    ----------
    D : (r, r)
        Change of the rates of the rows by unit impulses along them.
    rate : (r,)
        Rates before.
    normal, tangential : (k,) int64
        Rows of each contact; -1: no friction.
    e, e_t, mu : (k,)
        Coefficients of restitution and friction.
    forced : (k,) bool
        What comes to rest with others whatever impulse that takes.
    given : (k,)
        Normal impulses that act at least.
    """

    D: Floats
    rate: Floats
    normal: Ints
    tangential: Ints
    e: Floats
    e_t: Floats
    mu: Floats
    forced: Any
    given: Floats

    @property
    def target(self) -> Floats:
        """What ``gamma+`` is less where ``xi`` vanishes (r,): ``-e gamma-``, of what leaves already 0."""
        found = np.zeros(self.rate.size)
        found[self.normal] = -self.e * np.minimum(self.rate[self.normal], 0.0)
        some = self.tangential >= 0
        found[self.tangential[some]] = -self.e_t[some] * self.rate[self.tangential[some]]
        return found


@dataclass(frozen=True, kw_only=True)
class Answer:
    """Impulses (r,), rates behind the impact (r,), and whether others fit as well."""

    impulse: Floats
    rate: Floats
    others: bool


def solve_by_poisson(hit: Hit) -> Answer | None:
    """The impulses of both phases together; None as of :func:`solve_impact`."""
    first = solve_impact(replace(hit, e=np.zeros_like(hit.e), e_t=np.zeros_like(hit.e_t)))
    if first is None:
        return None
    given = np.where(hit.forced, 0.0, hit.e * first.impulse[hit.normal])
    rate = first.rate.copy()
    rate[hit.normal] = np.where(first.impulse[hit.normal] > 0.0, np.maximum(rate[hit.normal], 0.0), rate[hit.normal])
    second = solve_impact(
        replace(hit, rate=rate, e=np.zeros_like(hit.e), e_t=np.zeros_like(hit.e_t), given=given)
    )
    if second is None:
        return None
    return Answer(
        impulse=first.impulse + second.impulse, rate=second.rate, others=first.others or second.others
    )


def solve_impact(hit: Hit) -> Answer | None:
    """The impulses; None where none fit (or where there are too many contacts to try all combinations)."""
    if hit.rate.size == 1 and hit.D[0, 0] > 0.0:
        return _alone(hit)
    found: list[Answer] = []
    size = float(np.abs(hit.rate).max(initial=0.0)) + float(np.abs(hit.D[:, hit.normal] @ hit.given).max(initial=0.0))
    rubs = np.where(hit.given > 0.0, 6.0, 4.0)
    count = int(np.prod(np.where(hit.tangential < 0, 2.0, rubs)))
    if count > MOST:
        return _pivoted(hit)
    for doing in combinations(hit):
        answer = tried(hit, doing, size)
        if answer is None:
            continue
        if all(np.abs(answer.rate - other.rate).max() > 1e-6 * size for other in found):
            found.append(answer)
        if count > ALL:
            break
    if not found and hit.forced.any():  # no friction fits what has to come to rest: it sticks
        free = replace(hit, mu=np.where(hit.forced, 1e300, hit.mu))
        held = tried(free, tuple([STICKS] * hit.normal.size), size)
        found = [] if held is None else [held]
    if not found:
        return None
    return Answer(impulse=found[0].impulse, rate=found[0].rate, others=len(found) > 1)


def _alone(hit: Hit) -> Answer:
    """One contact without friction."""
    least = -np.inf if hit.forced[0] else hit.given[0]
    impulse = np.maximum((hit.target - hit.rate) / hit.D[0, 0], least)
    return Answer(impulse=impulse, rate=hit.rate + hit.D[0] * impulse, others=False)


def combinations(hit: Hit) -> Iterator[tuple[int, ...]]:
    """What each contact may do; first that all take an impulse and stick."""
    leaving = (LEAVES, LEAVES_FORWARD, LEAVES_BACKWARD)
    every = (
        (STICKS, FREE) if t < 0 else (*PRESSED, *(leaving if given > 0.0 else (FREE,)))
        for t, given in zip(hit.tangential, hit.given, strict=True)
    )
    pairs = zip(every, hit.forced, strict=True)
    kept = (tuple(what for what in may if what in PRESSED) if forced else may for may, forced in pairs)
    return product(*kept)


def tried(hit: Hit, doing: tuple[int, ...], size: float) -> Answer | None:
    """The impulses of one combination, where they contradict nothing."""
    r, columns, rows = hit.rate.size, [], []
    target, impulse = hit.target, np.zeros(r)
    impulse[hit.normal] = hit.given
    for i, what in enumerate(doing):
        column = np.zeros(r)
        column[hit.normal[i]] = 1.0
        if what in SLIPPING:
            column[hit.tangential[i]] = -hit.mu[i] * np.sign(what)
            impulse[hit.tangential[i]] = column[hit.tangential[i]] * hit.given[i]
        if what in PRESSED:
            columns.append(column)
            rows.append(hit.normal[i])
        if what in (STICKS, LEAVES) and hit.tangential[i] >= 0:
            along = np.zeros(r)
            along[hit.tangential[i]] = 1.0
            columns.append(along)
            rows.append(hit.tangential[i])
    if rows:
        B = np.stack(columns, axis=1)
        A = hit.D[rows] @ B
        b = target[rows] - (hit.rate + hit.D @ impulse)[rows]
        u = _solution(A, b, size)
        if u is None:
            return None
        impulse += B @ u
    after = hit.rate + hit.D @ impulse
    return _checked(hit, doing, impulse, after, target, size)


def _solution(A: Floats, b: Floats, size: float) -> Floats | None:
    """Of ``A u = b``, of least norm where A is singular; None where there is none."""
    if A.shape == (1, 1) and A[0, 0] > 0.0:
        return np.asarray(b / A[0, 0], dtype=float)
    scale = np.sqrt(np.maximum(np.abs(np.diag(A)), 1e-300))
    try:
        if np.linalg.cond(A / scale[:, None] / scale) < 1e10:
            return np.asarray(np.linalg.solve(A, b), dtype=float)
    except np.linalg.LinAlgError:
        pass
    u = np.asarray(np.linalg.lstsq(A / scale[:, None], b / scale, rcond=1e-11)[0], dtype=float)
    return u if np.abs(A @ u - b).max() <= 1e-9 * size else None


def _checked(
    hit: Hit, doing: tuple[int, ...], impulse: Floats, after: Floats, target: Floats, size: float
) -> Answer | None:
    """The answer, or None where it contradicts the law."""
    xi, small = after - target, ROUND_OFF * size
    force = ROUND_OFF * float(np.abs(impulse).max(initial=0.0))
    for i, what in enumerate(doing):
        a, b = int(hit.normal[i]), int(hit.tangential[i])
        if what not in PRESSED and xi[a] < -small:
            return None
        if what == FREE:
            continue
        if impulse[a] < hit.given[i] - force and not hit.forced[i]:
            return None
        if b < 0:
            continue
        if what in (STICKS, LEAVES) and abs(impulse[b]) > hit.mu[i] * max(impulse[a], 0.0) + force:
            return None
        if what in SLIPPING and xi[b] * np.sign(what) < -small:
            return None
    return Answer(impulse=impulse, rate=after, others=False)


def _pivoted(hit: Hit) -> Answer | None:
    """Without friction, by principal pivots of least index (K. G. Murty, Opsearch 11 (1974) 103): any number."""
    if (hit.tangential >= 0).any():
        return None
    size = float(np.abs(hit.rate).max(initial=0.0))
    doing = [FREE] * hit.normal.size
    for _ in range(50 * hit.normal.size):
        answer = tried(hit, tuple(doing), size)
        if answer is not None:
            return answer
        wrong = _first_wrong(hit, doing, size)
        if wrong is None:
            return None
        doing[wrong] = STICKS if doing[wrong] == FREE else FREE
    return None


def _first_wrong(hit: Hit, doing: list[int], size: float) -> int | None:
    """The first contact that contradicts what it does."""
    on = [i for i, what in enumerate(doing) if what != FREE]
    rows, target, impulse = hit.normal[on], hit.target, np.zeros(hit.rate.size)
    impulse[hit.normal] = hit.given
    if on:
        before = (hit.rate + hit.D @ impulse)[rows]
        impulse[rows] += np.linalg.lstsq(hit.D[np.ix_(rows, rows)], target[rows] - before, rcond=1e-11)[0]
    xi = hit.rate + hit.D @ impulse - target
    for i, what in enumerate(doing):
        a = int(hit.normal[i])
        if (impulse[a] < hit.given[i]) if what != FREE else (xi[a] < -ROUND_OFF * size):
            return i
    return None
