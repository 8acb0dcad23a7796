"""Integrals of powers along a run: by Gauss's rule on stretches that are cut until cutting them changes nothing."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from fricmb.analysis._errors import AnalysisError, Floats

if TYPE_CHECKING:
    from fricmb.solution import Solution

#: Powers (k, n_t) at the times at which a run is seen.
Powers = Callable[["Solution"], Floats]

#: Nodes and weights on 0 to 1 of the rule on each stretch between two times.
_NODES, _WEIGHTS = (0.5 * (x + 1) if i == 0 else 0.5 * x for i, x in enumerate(np.polynomial.legendre.leggauss(4)))
#: The run is cut into this many stretches at least; numbers that the run seen at all nodes holds at most.
_STRETCHES, _NUMBERS = 4000, 40_000_000
#: What cutting a stretch may change of the integral over the whole run, in parts of the run's tolerance; integrals that
#: are smaller than this part of the largest one are not looked at more closely.
_CHANGE, _SMALL = 1e-3, 1e-3


def grid(sol: Solution) -> Floats:
    """Accepted steps and transitions, long ones cut."""
    t = np.unique(np.concatenate([piece.row_motion().t for piece in sol.run.pieces]))
    longest = (t[-1] - t[0]) / _STRETCHES
    parts = np.maximum(1, np.ceil(np.diff(t) / longest)).astype(np.int64)
    first = np.cumsum(parts) - parts
    inside = np.arange(parts.sum()) - np.repeat(first, parts)
    cut = np.repeat(t[:-1], parts) + inside * np.repeat(np.diff(t) / parts, parts)
    return np.append(cut, t[-1])


def refined(sol: Solution, t: Floats, powers: Powers, who: str) -> Floats:
    """The times and others between them, so that no stretch gives more or less of ``powers`` when it is cut in two.

    A method may step over many vibrations at once, which a rule of few nodes between its steps does not see.

    Raises
    ------
    AnalysisError
        Where more vibrates than can be followed; ``who``: what was asked for.
    """
    most = max(_NUMBERS // (4 * max(1, 2 * len(sol.dof_names) + 6 * len(sol.contact_names))), 2 * len(t))
    allowed = _CHANGE * min(max(sol.stats.rtol or 0.0, 1e-11), 1e-3)

    def whole(begin: Floats, end: Floats) -> Floats:
        length = end - begin
        return over(length, powers(sol.at((begin[:, None] + length[:, None] * _NODES).ravel())))

    begin, end = t[:-1], t[1:]
    found, settled, count = whole(begin, end), [t], len(t)
    total = np.abs(found).sum(axis=1)
    while begin.size:
        middle = 0.5 * (begin + end)
        left, right = whole(begin, middle), whole(middle, end)
        total = np.maximum(total, np.abs(left).sum(axis=1) + np.abs(right).sum(axis=1))
        scale = np.maximum(total, _SMALL * total.max(initial=0.0))
        cut = (np.abs(left + right - found) > allowed * scale[:, None]).any(axis=0) & (begin < middle) & (middle < end)
        settled.append(middle[cut])
        count += int(cut.sum())
        if count > most:
            raise AnalysisError(
                f"{who}: from t = {t[0]:g} to {t[-1]:g} too much vibrates to be followed in {most} stretches; "
                "sol.energy has the sums, and a shorter run its parts"
            )
        begin, end = np.append(begin[cut], middle[cut]), np.append(middle[cut], end[cut])
        found = np.hstack([left[:, cut], right[:, cut]])
    return np.unique(np.concatenate(settled))


def nodes(t: Floats) -> Floats:
    """Nodes (4 (n_t - 1),) of the rule on the stretches between times."""
    between: Floats = t[:-1, None] + np.diff(t)[:, None] * _NODES
    return between.ravel()


def over(length: Floats, power: Floats) -> Floats:
    """Integrals (k, n) over stretches of these lengths, of powers (k, 4 n) at their nodes."""
    found: Floats = length * (power.reshape(len(power), -1, len(_WEIGHTS)) @ _WEIGHTS)
    return found


def cumulated(t: Floats, power: Floats) -> Floats:
    """Integrals (k, n_t) from the first of some times on, of powers (k, 4 (n_t - 1)) at the nodes between them."""
    steps = over(np.diff(t), power)
    total: Floats = np.concatenate([np.zeros((len(power), 1)), np.cumsum(steps, axis=1)], axis=1)
    return total
