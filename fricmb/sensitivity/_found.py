"""What the parts of a scene say at the times of a moment."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.integrate.problem import Floats
from fricmb.sensitivity._dual import Dual
from fricmb.sensitivity._motions import Row

#: Slopes by row and column, each a number or (n_t,).
Entries = dict[tuple[int, int], Any]


@dataclass(frozen=True, kw_only=True)
class Held:
    """A constraint of a joint: what stays 0, its rate, its second rate without accelerations, and its row."""

    value: Dual
    rate: Dual
    drift: Dual
    row: Row


class Found:
    """Forces and slip with their slopes, put together over the parts.

    Attributes
    ----------
    force : (n, n_t)
        On the degrees of freedom, without friction of what sticks; ``slopes`` by (degree of freedom, column), those
        that are the same at all times as ``constant`` (n, columns) beside them.
    rate : (n_z, n_t)
        Of the states of laws; ``rate_slopes`` by (state, column).
    g, drift, N : dict
        Of contacts by number: slip velocity and its drift (one Dual a direction), normal force before the cut at 0.
    limit : dict
        Of contacts that may stick: the largest force at rest.
    rows : dict
        Of contacts by number: rows of their directions.
    held : list of Held
        Constraints of joints.
    """

    def __init__(self, n: int, n_z: int, columns: int, count: int) -> None:
        self.columns = columns
        self.force: Floats = np.zeros((n, count))
        self.slopes: Entries = {}
        self.constant: Floats | None = None
        self.rate: Floats = np.zeros((n_z, count))
        self.rate_slopes: Entries = {}
        self.g: dict[int, list[Dual]] = {}
        self.drift: dict[int, list[Dual]] = {}
        self.N: dict[int, Dual] = {}
        self.limit: dict[int, Dual] = {}
        self.rows: dict[int, list[Row]] = {}
        self.held: list[Held] = []

    def push(self, row: Row, force: Dual) -> None:
        """A force on a motion, to the degrees of freedom behind it."""
        for i, c in row:
            own = force.times(c) if isinstance(c, Dual) else force * c
            self.force[i] += own.value
            for j, slope in own.slopes.items():
                self.add_slope(i, j, slope)

    def add_slope(self, i: int, j: int, slope: Any) -> None:
        """Slope of the force on a degree of freedom."""
        held = self.slopes.get((i, j))
        self.slopes[i, j] = slope if held is None else held + slope

    def put_rate(self, row: int, rate: Dual) -> None:
        """The rate of a state."""
        self.rate[row] = rate.value
        for j, slope in rate.slopes.items():
            self.rate_slopes[row, j] = slope

    def force_slopes(self) -> Floats:
        """Slopes of the forces (n, columns, n_t)."""
        found = self.dense(self.slopes, len(self.force))
        if self.constant is not None:
            found += self.constant[:, :, None]
        return found

    def dense(self, entries: Entries, rows: int) -> Floats:
        """Slopes as an array (rows, columns, n_t)."""
        found = np.zeros((rows, self.columns, self.force.shape[1]))
        for place, slope in entries.items():
            found[place] = slope
        return found


def whole(duals: list[Dual], count: int, columns: int) -> tuple[Floats, Floats]:
    """Values (n_t, len) and slopes (n_t, len, columns) as arrays."""
    values, slopes = np.zeros((count, len(duals))), np.zeros((count, len(duals), columns))
    for i, dual in enumerate(duals):
        values[:, i] = dual.value
        for j, slope in dual.slopes.items():
            slopes[:, i, j] = slope
    return values, slopes


def total(slopes: Floats, S: Floats, n_y: int) -> Floats:
    """Total derivatives from partial ones: parameters have the last columns of S, initial values those before."""
    found = slopes[..., :n_y] @ S
    given = slopes[..., n_y:-1]
    found[..., found.shape[-1] - given.shape[-1] :] += given
    return np.asarray(found, dtype=float)


def masked(dual: Dual, where: Any) -> Dual:
    """The value where a condition holds, 0 elsewhere."""
    return Dual(
        value=np.where(where, dual.value, 0.0), slopes={j: np.where(where, s, 0.0) for j, s in dual.slopes.items()}
    )


def at(value: Any, i: int) -> float:
    """Of a number or (n_t,) the value at time i."""
    return float(value) if np.ndim(value) == 0 else float(value[i])
