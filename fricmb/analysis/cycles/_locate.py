"""Bifurcations between two cycles of one sequence of transitions, as roots along the branch."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fricmb.analysis._errors import Floats
from fricmb.analysis.cycles._cycle import as_cycle
from fricmb.analysis.cycles._predict import Point, correct, direction
from fricmb.analysis.cycles._shooting import Orbit
from fricmb.analysis.cycles._specials import Flip, Fold, NeimarkSacker, Special


@dataclass(frozen=True, kw_only=True)
class Test:
    """A number that changes its sign at a bifurcation, and whether that is what it is."""

    kind: type[Special]
    value: Callable[[Point], float]
    fits: Callable[[Point], bool]


def changes(left: Point, right: Point, goal: float) -> Iterator[Special]:
    """What happens between two neighbours on a branch, in order."""
    found = []
    for test in TESTS:
        a, b = test.value(left), test.value(right)
        if np.sign(a) * np.sign(b) < 0:
            special = _root(test, left, goal, a)
            if special is not None:
                found.append(special)
    yield from (special for _, special in sorted(found, key=lambda pair: pair[0]))


def _root(test: Test, left: Point, goal: float, a: float) -> tuple[float, Special] | None:
    """Arclength and special point where a test changes its sign."""
    from scipy.optimize import brentq

    kept: dict[float, Point] = {}

    def value(s: float) -> float:
        if s == 0.0:
            return a
        orbit = correct(left.orbit, left.over, left.p_scale, s * left.forward, left.forward, goal)
        if orbit is None:
            raise ArithmeticError
        kept[s] = Point(orbit=orbit, over=left.over, p_scale=left.p_scale, forward=_along(orbit, left))
        return test.value(kept[s])

    try:
        end = _beyond(value, a)
        s = float(brentq(value, 0.0, end, xtol=1e-11, rtol=1e-13))
        at = kept.get(s) or min(kept.items(), key=lambda item: abs(item[0] - s))[1]
    except (ArithmeticError, ValueError):
        return None
    if not test.fits(at):
        return None
    cycle = as_cycle(at.orbit)
    return s, test.kind(value=at.value, cycle=cycle, residual=max(at.orbit.miss, abs(test.value(at))))


def _beyond(value: Callable[[float], float], a: float) -> float:
    """A step along the branch behind the root."""
    s = 0.01
    while s < 1.0:
        if np.sign(value(s)) * np.sign(a) < 0:
            return s
        s *= 1.6
    raise ArithmeticError


def _along(orbit: Orbit, left: Point) -> Floats:
    ahead = direction(orbit, left.over, left.p_scale)
    return ahead if float(ahead @ left.forward) >= 0.0 else -ahead


def _flip(point: Point) -> float:
    return float(np.real(np.prod(1.0 + point.orbit.multipliers)))


def _has_flip(point: Point) -> bool:
    return bool(np.abs(point.orbit.multipliers + 1.0).min(initial=np.inf) < 1e-4)


def _torus(point: Point) -> float:
    found = point.orbit.multipliers
    pairs = np.triu_indices(found.size, 1)
    return float(np.real(np.prod(1.0 - found[pairs[0]] * found[pairs[1]])))


def _has_torus(point: Point) -> bool:
    """A complex pair on the unit circle; two real ones whose product is 1 are none."""
    found: NDArray[np.complex128] = point.orbit.multipliers
    complex_ones = found[np.abs(found.imag) > 1e-4 * np.abs(found)]
    return bool(np.abs(np.abs(complex_ones) - 1.0).min(initial=np.inf) < 1e-4)


TESTS = (
    Test(kind=Fold, value=lambda point: point.slope, fits=lambda point: True),
    Test(kind=Flip, value=_flip, fits=_has_flip),
    Test(kind=NeimarkSacker, value=_torus, fits=_has_torus),
)
