"""A stiff or extreme scene whose answer is known: what is run and how its error is told."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

import fricmb as fm
from fricmb.bench._reference import Floats
from fricmb.solution import Solution

#: Tolerance of all runs of the grid, and by what factor the error may exceed it times the problem's own growth.
RTOL, FACTOR = 1e-6, 100.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Extreme:
    """One scene of the grid.

    Attributes
    ----------
    group : str
        What is extreme.
    value : str
        How much.
    build : callable
        Makes the scene.
    t_end : float
    error : callable
        Largest scaled error of a solution against the closed form; infinite for a transition that is missing or made
        up.
    growth : float
        How much the scene itself magnifies relative errors.
    steps : tuple of float
        Steps for integrators with a fixed one; empty: they are left out.
    """

    group: str
    value: str
    build: Callable[[], fm.Scene]
    t_end: float
    error: Callable[[Solution], float]
    growth: float = 1.0
    steps: tuple[float, ...] = ()

    @property
    def name(self) -> str:
        """Group and value."""
        return f"{self.group}: {self.value}"

    @property
    def allowed(self) -> float:
        """Largest error that counts as correct."""
        return FACTOR * RTOL * self.growth


def scaled(got: Floats, true: Floats) -> float:
    """Largest difference over the largest true value (over 1 where that is 0)."""
    largest = float(np.abs(true).max())
    return float(np.abs(np.asarray(got) - true).max()) / (largest if largest > 0.0 else 1.0)


def times_of(sol: Solution, *kinds: str) -> Floats:
    """Times of the events of these kinds."""
    return np.array([event.t for event in sol.events if event.kind in kinds])


def same_times(sol: Solution, true: ArrayLike, duration: float, *kinds: str) -> float:
    """Largest difference of event times over the duration; infinite where their number differs."""
    got, expected = times_of(sol, *kinds), np.asarray(true)
    if len(got) != len(expected):
        return float("inf")
    return float(np.abs(got - expected).max()) / duration if len(expected) else 0.0
