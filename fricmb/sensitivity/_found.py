"""What the parts of a scene say at the times of a moment."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.integrate.problem import Floats
from fricmb.sensitivity._dual import Dual
from fricmb.sensitivity._motions import Row


class Found:
    """Forces and slip with their slopes, put together over the parts.

    Attributes
    ----------
    force : (n, n_t); slopes : (n_t, n, columns)
        On the degrees of freedom, without friction of what sticks.
    rate : (n_z, n_t); rate_slopes : (n_t, n_z, columns)
        Of the states of laws.
    g, drift, N : dict
        Of contacts by number: slip velocity and its drift (one Dual a direction), normal force before the cut at 0.
    limit : dict
        Of contacts that may stick: the largest force at rest.
    rows : dict
        Of contacts by number: rows of their directions.
    """

    def __init__(self, n: int, n_z: int, columns: int, count: int) -> None:
        self.force: Floats = np.zeros((n, count))
        self.slopes: Floats = np.zeros((count, n, columns))
        self.rate: Floats = np.zeros((n_z, count))
        self.rate_slopes: Floats = np.zeros((count, n_z, columns))
        self.g: dict[int, list[Dual]] = {}
        self.drift: dict[int, list[Dual]] = {}
        self.N: dict[int, Dual] = {}
        self.limit: dict[int, Dual] = {}
        self.rows: dict[int, list[Row]] = {}

    def push(self, row: Row, force: Dual) -> None:
        """A force on a motion, to the degrees of freedom behind it."""
        for i, c in row:
            self.force[i] += c * force.value
            for j, slope in force.slopes.items():
                self.slopes[:, i, j] += c * slope

    def put_rate(self, row: int, rate: Dual) -> None:
        """The rate of a state."""
        self.rate[row] = rate.value
        for j, slope in rate.slopes.items():
            self.rate_slopes[:, row, j] = slope


def whole(duals: list[Dual], count: int, columns: int) -> tuple[Floats, Floats]:
    """Values (n_t, len) and slopes (n_t, len, columns) as arrays."""
    values, slopes = np.zeros((count, len(duals))), np.zeros((count, len(duals), columns))
    for i, dual in enumerate(duals):
        values[:, i] = dual.value
        for j, slope in dual.slopes.items():
            slopes[:, i, j] = slope
    return values, slopes


def masked(dual: Dual, where: Any) -> Dual:
    """The value where a condition holds, 0 elsewhere."""
    return Dual(
        value=np.where(where, dual.value, 0.0), slopes={j: np.where(where, s, 0.0) for j, s in dual.slopes.items()}
    )
