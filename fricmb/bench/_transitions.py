"""Transitions of a run beside those of the reference: which were found, how well, which are missing or made up."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricmb.bench._reference import Floats, Transitions

#: Two transitions of one kind may be this part of the run apart and still be the same one.
WINDOW = 0.02


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """``late``: largest difference of matched times (None without a match); numbers ``missed`` and ``false``."""

    late: float | None
    missed: int
    false: int


def compare(got: Transitions, true: Transitions, duration: float) -> Comparison:
    """Match transitions contact by contact, in order, so that the sum of time differences is least.

    A transition without a partner of its own kind within ``WINDOW * duration`` is missed (reference) or false (run).
    """
    late: list[float] = []
    missed = false = 0
    for contact in set(true.contact.tolist()) | set(got.contact.tolist()):
        mine, theirs = got.contact == contact, true.contact == contact
        pairs = _align(got.t[mine], got.kind[mine], true.t[theirs], true.kind[theirs], WINDOW * duration)
        late += pairs
        missed += int(theirs.sum()) - len(pairs)
        false += int(mine.sum()) - len(pairs)
    return Comparison(late=max(late) if late else None, missed=missed, false=false)


def _align(t_got: Floats, k_got: Floats, t_true: Floats, k_true: Floats, window: float) -> list[float]:
    """Differences of the matched pairs of the cheapest alignment; an unmatched transition costs half a window."""
    n, m = len(t_got), len(t_true)
    pair = np.abs(t_got[:, None] - t_true)
    pair[(k_got[:, None] != k_true) | (pair > window)] = np.inf
    cost = np.zeros((n + 1, m + 1))
    cost[:, 0], cost[0] = 0.5 * window * np.arange(n + 1), 0.5 * window * np.arange(m + 1)
    for i in range(1, n + 1):
        for j in range(1, m + 1):
            gap = min(cost[i - 1, j], cost[i, j - 1]) + 0.5 * window
            cost[i, j] = min(gap, cost[i - 1, j - 1] + pair[i - 1, j - 1])
    matched = []
    i, j = n, m
    while i and j:
        if cost[i, j] == cost[i - 1, j - 1] + pair[i - 1, j - 1]:
            matched.append(float(pair[i - 1, j - 1]))
            i, j = i - 1, j - 1
        elif cost[i, j] == cost[i - 1, j] + 0.5 * window:
            i -= 1
        else:
            j -= 1
    return matched
