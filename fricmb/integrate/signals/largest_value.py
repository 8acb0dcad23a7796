"""The largest magnitude that a function of time has in a run: what everything else about it is small beside.

Bounds alone may be too large by any factor (1/cosh is a quotient of exponentials, and has e^200 for 1), and values at
the times of a grid miss what is brief, or see the tail of a bell alone, 1e-300.  So stretches on which the bound is
more than twice the largest value known are halved, until there are none.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from fricmb.integrate.problem import Floats, Input, Problem
from fricmb.integrate.signals.jets import bounds

#: Stretches that are looked at first; most that are halved at once; halvings of one.
FIRST, MOST, DEEPEST = 64, 100_000, 40


def largest_value(given: Input, t_start: float, t_end: float) -> float:
    """The largest magnitude of a function with bounds, or less by a factor of 2 at most.

    More than that where bounds do not come down to values: of functions that cancel but for round-off, and of those
    that have a pole, of which it is what is known on stretches without one.
    """
    assert given.tape is not None
    # series of a million numbers are not kept
    return (_largest_value.__wrapped__ if given.tables else _largest_value)(given, t_start, t_end)


@lru_cache(maxsize=256)
def _largest_value(given: Input, t_start: float, t_end: float) -> float:
    edge = np.linspace(t_start, t_end, FIRST + 1)
    low, high = edge[:-1], edge[1:]
    bound = _size(given, low, high)
    finite = np.isfinite(bound)
    first, known = float(np.max(bound[finite], initial=0.0)), 0.0
    for _ in range(DEEPEST):
        middle = 0.5 * (low + high)
        value = _size(given, middle, middle)
        known = max(known, float(np.max(value[np.isfinite(value)], initial=0.0)))
        left = bound > 2.0 * known
        if not left.any():
            return known
        if left.sum() > MOST:
            break
        low, high = np.concatenate([low[left], middle[left]]), np.concatenate([middle[left], high[left]])
        bound = _size(given, low, high)
    # towards a pole there is no bound, and the size of the function there is no measure of it elsewhere
    return max(known, float(np.max(bound))) if np.isfinite(bound).all() else first


def _size(given: Input, low: Floats, high: Floats) -> Floats:
    """Bounds of the magnitude on stretches (k,)."""
    assert given.tape is not None
    return bounds(given.tape, given.parameters, low, high, 1).size(0)


def largest_forces(problem: Problem, t_start: float, t_end: float) -> Floats:
    """The largest magnitude (n_u,) in a run of each signal that is a force with bounds; 0 of others."""
    if not t_end > t_start:
        return np.zeros(problem.n_u)
    found = [
        0.0 if given is None or given.tape is None else largest_value(given, t_start, t_end)
        for given in problem.signals.forces
    ]
    return np.array(found) if found else np.zeros(problem.n_u)
