"""Eigenvalues followed by continuity."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from fricmb.analysis._errors import AnalysisError, Floats
from fricmb.errors import shown
from fricmb.integrate.run.one_thread import one_thread

Complexes = NDArray[np.complex128]
#: Eigenvalues (m,) and their vectors (m, m) by rows, at a value of the parameter.
Pairs = tuple[Complexes, Complexes]
Solve = Callable[[float], Pairs]
#: A span of the parameter and the eigenpairs at its ends.
Isolated = tuple[tuple[float, float], list[Pairs]]

#: Growth below this share of the largest eigenvalue is round-off: undamped motion.
NEUTRAL = 1e-7
#: Least similarity (modal assurance criterion) by which two shapes count as the same, before a step is halved.
SIMILAR = 0.6
_HALVINGS = 6
#: Eigenvalues are counted at this many values at least, between those that are given.
PLACES = 48


def eigenpairs(A: Floats) -> Pairs:
    """Eigenvalues (m,) and unit eigenvectors (m, m), a row each."""
    from scipy.linalg import eig

    if not A.size:
        return np.zeros(0, complex), np.zeros((0, 0), complex)
    with one_thread():
        values, vectors = eig(A)
    return values, vectors.T / np.linalg.norm(vectors, axis=0)[:, None]


def follow(solve: Solve, values: Floats) -> list[Pairs]:
    """Eigenpairs at each value, each place in the arrays holding one mode throughout."""
    found = [_sorted(solve(float(values[0])))]
    for low, high in zip(values[:-1].tolist(), values[1:].tolist(), strict=True):
        found.append(_step(solve, low, found[-1], high, solve(high), _HALVINGS))
    return found


def refine(solve: Solve, values: Floats, found: list[Pairs], critical: list[float]) -> tuple[Floats, Complexes]:
    """Values with those between them where eigenvalues were counted, and the critical ones; eigenvalues followed there.

    Between two given values modes are followed from the first; at given values they are those found there.
    """
    parts = max(1, -(-PLACES // max(1, len(values) - 1)))
    at, rows = [float(values[0])], [found[0][0]]
    for i, (low, high) in enumerate(zip(values[:-1].tolist(), values[1:].tolist(), strict=True)):
        inner = {*np.linspace(low, high, parts + 1).tolist()[1:-1], *critical}
        here = sorted((v for v in inner if min(low, high) < v < max(low, high)), reverse=high < low)
        pairs, before = found[i], low
        for value in here:
            pairs, before = _step(solve, before, pairs, value, solve(value), _HALVINGS), value
            at.append(value)
            rows.append(pairs[0])
        at.append(high)
        rows.append(found[i + 1][0])
    return np.array(at), np.array(rows)


def _sorted(pairs: Pairs) -> Pairs:
    order = np.lexsort((pairs[0].real, pairs[0].imag))
    return pairs[0][order], pairs[1][order]


def _step(solve: Solve, low: float, known: Pairs, high: float, new: Pairs, halvings: int) -> Pairs:
    """The new pairs in the order of the known ones; over half the way first where shapes change too much."""
    order, least = match(known, new)
    if least >= SIMILAR or halvings == 0:
        return new[0][order], new[1][order]
    middle = 0.5 * (low + high)
    half = _step(solve, low, known, middle, solve(middle), halvings - 1)
    return _step(solve, middle, half, high, new, halvings - 1)


def match(known: Pairs, new: Pairs) -> tuple[NDArray[np.int64], float]:
    """Which new pair continues each known one, and the least similarity of shapes among them.

    Where there are fewer new ones than known ones, -1 stands for those that have none.
    """
    from scipy.optimize import linear_sum_assignment

    if not known[0].size or not new[0].size:
        return np.full(known[0].size, -1, np.int64), 1.0
    similar = np.abs(known[1].conj() @ new[1].T) ** 2
    scale = max(float(np.abs(known[0]).max()), 1e-300)
    distance = np.abs(known[0][:, None] - new[0]) / scale
    cost = 1.0 - similar + 4.0 * distance
    # the cheapest of each, where no two want the same, is the assignment itself
    rows, columns = np.arange(len(cost)), np.argmin(cost, axis=1)
    if np.unique(columns).size < rows.size:
        rows, columns = linear_sum_assignment(cost)
    order = np.full(known[0].size, -1, np.int64)
    order[rows] = columns
    return order, float(similar[rows, columns].min())


def checked_values(who: str, values: object) -> Floats:
    """At least one finite number (n,), rising or falling strictly."""
    try:
        found = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        found = np.zeros((0, 0))
    steps = np.diff(found) if found.ndim == 1 else np.zeros(1)
    ordered = bool((steps > 0).all() or (steps < 0).all())
    if found.ndim != 1 or not found.size or not np.isfinite(found).all() or not ordered:
        raise AnalysisError(f"{who}: values must be one or more finite numbers, rising or falling; got {shown(values)}")
    return found
