"""Where eigenvalues cross the imaginary axis, found by counting between values at which they are known."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from fricmb.analysis._errors import AnalysisError, Floats
from fricmb.analysis._track import NEUTRAL, PLACES, Complexes, Isolated, Pairs, Solve, _sorted


@dataclass(frozen=True, kw_only=True)
class Crossing:
    """Where a mode becomes unstable, or stable again.

    Attributes
    ----------
    value : float
        Critical value of the parameter.
    kind : {"flutter", "self-excitation", "divergence"}
        Flutter: growing oscillation of two coupled modes.  Self-excitation: that of a single one, under friction that
        falls with speed.  Divergence: growth without oscillation.
    frequency : float
        Angular frequency there; 0 for divergence.
    mode : int
        Number of the mode in the result.
    unstable_above : bool
        Whether it is unstable for larger values.
    """

    value: float
    kind: str
    frequency: float
    mode: int
    unstable_above: bool


def crossings(solve: Solve, values: Floats, found: list[Pairs], places: int = PLACES) -> list[Crossing]:
    """Critical values between those given, to round-off, in rising order; eigenvalues are counted at ``places``.

    Growing eigenvalues are counted, at the values and between them, and a span is halved until its ends differ by one
    eigenvalue or one pair.  Nothing is followed: modes that meet, turn overdamped or change places do not matter.
    """
    scale = max((float(np.abs(pairs[0]).max(initial=0.0)) for pairs in found), default=0.0)
    limit = NEUTRAL * scale
    parts = max(1, -(-places // max(1, len(values) - 1)))
    result = []
    for i in range(len(values) - 1):
        at = np.linspace(values[i], values[i + 1], parts + 1).tolist()
        inner = [_sorted(solve(value)) for value in at[1:-1]]
        for low, high, *ends in zip(at[:-1], at[1:], [found[i], *inner], [*inner, found[i + 1]], strict=True):
            for span, pairs in _isolated(solve, (low, high), list(ends), limit):
                crossing = _crossing(solve, span, pairs, _changing(pairs, limit), limit)
                result.append(replace(crossing, mode=_stands(crossing, found[i + crossing.unstable_above][0])))
    return sorted(_distinct(result), key=lambda c: c.value)


def _growing(pairs: Pairs, limit: float) -> int:
    """Number of eigenvalues that grow."""
    return int((pairs[0].real > limit).sum())


def _isolated(solve: Solve, span: tuple[float, float], ends: list[Pairs], limit: float) -> list[Isolated]:
    """Spans in which one eigenvalue or one conjugate pair begins or ceases to grow, and the eigenpairs at their ends.

    A span is halved further until the eigenvalues at its ends are close enough for the pair to be told.
    """
    low, high = span
    counts = [_growing(pairs, limit) for pairs in ends]
    if counts[0] == counts[1]:
        return []
    change = abs(counts[1] - counts[0])
    middle = 0.5 * (low + high)
    narrow = middle in (low, high) or abs(high - low) <= 1e-13 * max(abs(low), abs(high))
    if narrow or (change <= 2 and _one(ends, counts, limit)):
        return [(span, ends)]
    half = _sorted(solve(middle))
    return [
        *_isolated(solve, (low, middle), [ends[0], half], limit),
        *_isolated(solve, (middle, high), [half, ends[1]], limit),
    ]


def _one(ends: list[Pairs], counts: list[int], limit: float) -> bool:
    """Whether the change between two ends is that of one real eigenvalue, or of one pair whose frequency is told."""
    single = abs(counts[1] - counts[0]) == 1
    here = [_changed(pairs, counts) for pairs in ends]
    real = [abs(value.imag) <= limit for value in here]
    if single:
        return all(real)
    steady = abs(abs(here[0].imag) - abs(here[1].imag)) <= 0.02 * max(abs(value) for value in here)
    return not any(real) and steady


def _changed(pairs: Pairs, counts: list[int]) -> complex:
    """The eigenvalue whose growth changes sign: the one after those that grow at both ends, upper one of a pair."""
    order = np.argsort(-pairs[0].real, kind="stable")
    kept = min(counts)
    value = complex(pairs[0][order[kept]])
    # of a pair in the upper half plane
    return complex(value.real, abs(value.imag))


def _changing(pairs: list[Pairs], limit: float) -> tuple[complex, complex]:
    """The eigenvalue that changes, at both ends of an isolated span."""
    counts = [_growing(end, limit) for end in pairs]
    return _changed(pairs[0], counts), _changed(pairs[1], counts)


def _stands(crossing: Crossing, eigenvalues: Complexes) -> int:
    """Which mode of a list is nearest to what crosses, among those that grow if there are any."""
    grows = eigenvalues.real > 0.0
    off = np.abs(eigenvalues - 1j * crossing.frequency) + np.where(grows | ~grows.any(), 0.0, np.abs(eigenvalues).max())
    return int(np.argmin(off))


def _crossing(
    solve: Solve, span: tuple[float, float], ends: list[Pairs], pair: tuple[complex, complex], limit: float
) -> Crossing:
    below, above = pair
    rises = above.real > limit
    quiet, loud = (below, above) if rises else (above, below)
    states = ends if rises else ends[::-1]
    partner = complex(-loud.real, loud.imag)
    other = int(np.argmin(np.abs(states[1][0] - partner)))
    meets = quiet.real >= -limit and abs(states[1][0][other] - partner) <= limit
    if not meets and quiet.real > 0.0:  # a root a hair beyond the span
        share = quiet.real / (quiet.real - loud.real)
        first, last = span if rises else span[::-1]
        value, there = first + share * (last - first), quiet
    elif not meets:
        value, there = _root(solve, span, ((below, below), (above, above)), _growth)
    else:
        order = np.argsort(np.abs(states[0][0] - complex(0.0, loud.imag)))
        calm = (complex(states[0][0][order[0]]), complex(states[0][0][order[1]]))
        pairs = (calm, (loud, partner)) if rises else ((loud, partner), calm)
        value, there = _root(solve, span, pairs, _split)
    frequency = abs(there.imag)
    kind = "divergence" if frequency <= np.sqrt(limit * max(abs(there), limit)) else "flutter"
    return Crossing(
        value=value, kind=kind, frequency=0.0 if kind == "divergence" else frequency, mode=0, unstable_above=rises
    )


def _growth(pair: tuple[complex, complex]) -> float:
    return pair[0].real


def _split(pair: tuple[complex, complex]) -> float:
    """Squared half-distance of two eigenvalues: analytic where they meet, negative for two oscillations."""
    return float((0.25 * (pair[0] - pair[1]) ** 2).real)


def _root(
    solve: Solve,
    span: tuple[float, float],
    pairs: tuple[tuple[complex, complex], tuple[complex, complex]],
    measure: Callable[[tuple[complex, complex]], float],
) -> tuple[float, complex]:
    """Where a measure of a pair of eigenvalues changes sign, and the mean of the pair there.

    The pair is followed by its sum and product, which are smooth even where its members meet.
    """
    (a, b), (at_a, at_b) = span, pairs
    single = at_a[0] == at_a[1] and at_b[0] == at_b[1]
    fa, fb = measure(at_a), measure(at_b)
    side = 0
    for count in range(200):
        if fa == 0.0 or abs(b - a) <= 1e-15 * max(abs(a), abs(b)):
            return a, 0.5 * (at_a[0] + at_a[1])
        share = fa / (fa - fb) if count % 4 < 3 and fa != fb else 0.5
        c = a + share * (b - a)
        if c in (a, b):
            c = 0.5 * (a + b)
            if c in (a, b):
                break
            share = 0.5
        at_c = _nearest(_beside(solve, c, b - a), at_a, at_b, share, single)
        fc = measure(at_c)
        if (fc > 0.0) == (fb > 0.0):
            b, at_b, fb = c, at_c, fc
            fa = fa / 2 if side == -1 else fa
            side = -1
        else:
            a, at_a, fa = c, at_c, fc
            fb = fb / 2 if side == 1 else fb
            side = 1
    return (a if abs(fa) < abs(fb) else b), 0.5 * (at_a[0] + at_a[1])


def _beside(solve: Solve, value: float, width: float) -> Complexes:
    """Eigenvalues at a value; a hair beside it where there is no equilibrium, as where it runs off to infinity."""
    try:
        return solve(value)[0]
    except AnalysisError:
        return solve(value + 1e-12 * max(abs(value), abs(width)))[0]


def _nearest(
    eigenvalues: Complexes,
    at_a: tuple[complex, complex],
    at_b: tuple[complex, complex],
    share: float,
    single: bool,
) -> tuple[complex, complex]:
    """The pair whose sum and product are nearest to those in between."""
    mean = (1 - share) * (at_a[0] + at_a[1]) + share * (at_b[0] + at_b[1])
    product = (1 - share) * at_a[0] * at_a[1] + share * at_b[0] * at_b[1]
    if single:
        found = complex(eigenvalues[np.argmin(np.abs(eigenvalues - 0.5 * mean))])
        return found, found
    scale = max(abs(at_a[0]), abs(at_b[0]), 1e-300)
    pairs = combinations(range(eigenvalues.size), 2)

    def off(pair: tuple[int, int]) -> float:
        x, y = eigenvalues[pair[0]], eigenvalues[pair[1]]
        return float(abs(x + y - mean) * scale + abs(x * y - product))

    i, j = min(pairs, key=off)
    return complex(eigenvalues[i]), complex(eigenvalues[j])


def _distinct(found: list[Crossing]) -> list[Crossing]:
    """Two modes that meet report their meeting once: the one that grows."""
    kept: list[Crossing] = []
    for crossing in found:
        twin = any(
            abs(c.value - crossing.value) <= 1e-9 * max(abs(c.value), 1e-300)
            and abs(c.frequency - crossing.frequency) <= 1e-6 * max(c.frequency, 1e-300)
            for c in kept
        )
        if not twin:
            kept.append(crossing)
    return kept
