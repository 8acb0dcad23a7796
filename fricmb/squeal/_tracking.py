"""Modes followed over a grid of places: along the first parameter, and from there along the second."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from fricmb.analysis._track import SIMILAR, Pairs, match
from fricmb.squeal._place import Complexes, Place

#: A shape that is less like the one before, and an eigenvalue that is farther off in parts of its size, is another one.
_LIKE, _NEAR = 0.3, 0.05
#: How often a step between two places is halved at most.
_HALVINGS = 2

#: A place between two others: numbers of these, and the share of the way.
Between = Callable[[tuple[int, int], tuple[int, int], float], Place]
Numbers = NDArray[np.int64]


class Tracking:
    """Numbers of modes at each place.

    Parameters
    ----------
    places : list of lists of Place
    between : callable
        Makes further places on the way between two neighbours; called as often as there are places, at most.
    """

    def __init__(self, places: Sequence[Sequence[Place]], between: Between) -> None:
        self.places, self.between = places, between
        self.left = sum(len(row) for row in places)
        self.count = 0
        self.numbers: list[list[Numbers]] = [[] for _ in places]
        for i, row in enumerate(places):
            for j in range(len(row)):
                self.numbers[i].append(self._numbered(i, j))

    def table(self, of: Callable[[Place], NDArray[np.generic]], dtype: type) -> NDArray[np.generic]:
        """A value of each mode at each place (n_a, n_b, count, ...), nan where the mode is not there."""
        first = next((of(p) for row in self.places for p in row if p.eigenvalues.size), np.zeros(0))
        found = np.full((len(self.places), len(self.places[0]), self.count, *first.shape[1:]), np.nan, dtype)
        for i, row in enumerate(self.places):
            for j, place in enumerate(row):
                if place.eigenvalues.size:
                    found[i, j, self.numbers[i][j]] = of(place)
        return found

    def _numbered(self, i: int, j: int) -> Numbers:
        """The numbers of the modes of a place, from a neighbour that has some."""
        here = self.places[i][j]
        for a, b in ((i, j - 1), (i - 1, j)):
            if min(a, b) >= 0 and self.places[a][b].eigenvalues.size:
                known = self.numbers[a][b]
                order = self._order((a, b), (i, j), (0.0, self.places[a][b]), (1.0, here), _HALVINGS)
                return self._taken(known, order, here.eigenvalues.size)
        return self._fresh(here.eigenvalues.size)

    def _order(
        self, a: tuple[int, int], b: tuple[int, int], low: tuple[float, Place], high: tuple[float, Place], halvings: int
    ) -> Numbers:
        """Which mode at one end continues each mode of the other, -1 for none."""
        order, least = match(_pairs(low[1]), _pairs(high[1]))
        if least < SIMILAR and halvings and self.left > 0:
            self.left -= 1
            middle = 0.5 * (low[0] + high[0])
            half = middle, self.between(a, b, middle)
            if half[1].eigenvalues.size:
                first = self._order(a, b, low, half, halvings - 1)
                second = self._order(a, b, half, high, halvings - 1)
                return np.where(first >= 0, second[first], -1)
        return _only_likely(order, low[1], high[1])

    def _taken(self, known: Numbers, order: Numbers, size: int) -> Numbers:
        found = np.full(size, -1, np.int64)
        found[order[order >= 0]] = known[order >= 0]
        found[found < 0] = self._fresh(int((found < 0).sum()))
        return found

    def _fresh(self, size: int) -> Numbers:
        self.count += size
        return np.arange(self.count - size, self.count)


def _pairs(place: Place) -> Pairs:
    return place.eigenvalues, place.shapes


def _only_likely(order: Numbers, known: Place, new: Place) -> Numbers:
    """Without those that were put together because nothing else was left."""
    found = order.copy()
    for i in np.flatnonzero(order >= 0):
        k = order[i]
        like = abs(np.vdot(known.shapes[i], new.shapes[k])) ** 2
        far = abs(known.eigenvalues[i] - new.eigenvalues[k]) > _NEAR * abs(known.eigenvalues[i])
        if like < _LIKE and far:
            found[i] = -1
    return found


def moving_most(shapes: Complexes, dofs: Sequence[str]) -> str:
    """The degree of freedom that moves most in a shape (n_dof,)."""
    return dofs[int(np.argmax(np.abs(shapes)))] if len(dofs) else ""
