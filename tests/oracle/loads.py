"""Loads that depend on the friction that they cause."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .problem import NoLoad

Loads = np.ndarray
#: Secants are tried so often, then Newton's method.
SECANTS, NEWTON = 25, 25
#: Loads are found where they change by no more than this.
FOUND = 1e-14


def found(miss: Loads, size: Loads) -> bool:
    """Whether that is round-off."""
    return bool(np.abs(miss).max() <= FOUND * max(1.0, np.abs(size).max()))


def settled(f: Callable[[Loads], Loads], start: Loads) -> Loads:
    """Loads with ``N = f(N)``; an error where there are none, or more than one."""
    asked = before = answer = start
    for k in range(SECANTS):  # Anderson 1965, one earlier pair
        new = f(asked)
        miss = new - asked
        if found(miss, new):
            return asked
        turn = miss - (answer - before)
        share = float(miss @ turn) / max(float(turn @ turn), 1e-300) if k else 0.0
        before, asked, answer = asked, new - share * (new - answer), new
    asked = np.zeros(start.size)  # loads are convex in friction: from below Newton's method comes to the least root
    for _ in range(NEWTON):
        new = f(asked)
        miss = new - asked
        if found(miss, new):
            return asked
        asked = asked + np.linalg.solve(check_single(f, asked), miss)
    raise NoLoad("loads from reactions are not found")


def check_single(f: Callable[[Loads], Loads], N: Loads) -> np.ndarray:
    """How fast ``N - f(N)`` grows with N (a matrix); an error where it falls."""
    slope = np.eye(N.size) - derivative(f, N)
    if not np.isfinite(slope).all() or np.linalg.det(slope) <= 0.0:
        raise NoLoad("loads grow with the friction that they cause faster than friction sheds them")
    return slope


def derivative(f: Callable[[Loads], Loads], N: Loads) -> np.ndarray:
    """Of f by differences."""
    h = 1e-5 * max(1.0, np.abs(N).max())
    return np.array([(f(N + h * e) - f(N - h * e)) / (2.0 * h) for e in np.eye(N.size)]).T
