"""Impacts at one instant one after another: each contact that approaches has its own, until none does.

The fastest is first.  In a chain of bodies that touch the impact of one end runs through to the other, as it does where
contacts are stiff and waves leave one before the next is pressed; all together would share it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from fricmb.integrate.implicit.impacts.impact_law import ROUND_OFF, Answer, Hit
from fricmb.integrate.problem import Ints

#: Impacts at one instant; what still approaches behind them is brought to rest together.
TURNS = 400


def solve_in_turn(hit: Hit, solve: Callable[[Hit], Answer | None]) -> Answer | None:
    """The impulses of all impacts together, each by a law; what has to come to rest does so together."""
    if hit.normal.size == 1 or hit.forced.any():
        return solve(hit)
    size = float(np.abs(hit.rate).max(initial=0.0))
    rate, impulse, others = hit.rate.copy(), np.zeros(hit.rate.size), False
    for _ in range(TURNS):
        i = int(np.argmin(rate[hit.normal]))
        if rate[hit.normal[i]] >= -ROUND_OFF * size:
            return Answer(impulse=impulse, rate=rate, others=others)
        rows = _rows(hit, i)
        answer = solve(_alone(replace(hit, rate=rate), i, rows))
        if answer is None:
            return None
        impulse[rows] += answer.impulse
        rate = rate + hit.D[:, rows] @ answer.impulse
        rate[rows] = answer.rate
        others = others or answer.others
    last = solve(replace(hit, rate=rate, e=np.zeros_like(hit.e)))
    if last is None:
        return None
    return Answer(impulse=impulse + last.impulse, rate=last.rate, others=others or last.others)


def _rows(hit: Hit, i: int) -> Ints:
    """Rows of one contact."""
    rows = [hit.normal[i]] if hit.tangential[i] < 0 else [hit.normal[i], hit.tangential[i]]
    return np.array(rows, dtype=np.int64)


def _alone(hit: Hit, i: int, rows: Ints) -> Hit:
    """The problem of one contact."""
    one = slice(i, i + 1)
    return Hit(
        D=hit.D[np.ix_(rows, rows)], rate=hit.rate[rows], normal=np.array([0]),
        tangential=np.array([1 if rows.size > 1 else -1]), e=hit.e[one], e_t=hit.e_t[one], mu=hit.mu[one],
        forced=hit.forced[one], given=hit.given[one],
    )  # fmt: skip
