"""Where along the first parameter sliding becomes unstable or stable again, for each value of the second."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fricmb.analysis._crossings import crossings
from fricmb.analysis._track import Pairs, _sorted
from fricmb.squeal._place import Complexes, Floats, Place, Places


@dataclass(frozen=True, kw_only=True)
class Threshold:
    """A critical value.

    Attributes
    ----------
    at : dict of str to float
        Values of the parameters there, the critical one first.
    kind : {"flutter", "self-excitation", "divergence"}
    frequency : float
        Angular frequency; 0 for divergence.
    unstable_above : bool
        Whether sliding is unstable for larger values of the first parameter.
    """

    at: Mapping[str, float]
    kind: str
    frequency: float
    unstable_above: bool

    @property
    def over(self) -> str:
        """The parameter that is critical."""
        return next(iter(self.at))

    @property
    def value(self) -> float:
        """Its critical value."""
        return self.at[self.over]


def thresholds(
    places: Places, over: str, values: Floats, others: Mapping[str, float], known: Sequence[Place], one: bool
) -> list[Threshold]:
    """Critical values along one parameter; what happens twice between two neighbouring values is not seen.

    Parameters
    ----------
    known : sequence of Place
        At each of the values.
    one : bool
        Whether there is a single degree of freedom, which does not flutter.
    """
    solve = _solver(places, over, others)
    found: list[Threshold] = []
    for part in _stretches(known):
        if len(part) < 2:
            continue
        pairs = [_whole(known[i].eigenvalues) for i in part]
        for c in crossings(solve, values[part], pairs, places=1):
            if c.frequency > places.highest:
                continue
            kind = "self-excitation" if c.kind == "flutter" and one else c.kind
            rises = c.unstable_above == bool(values[-1] > values[0])
            at = {over: c.value, **others}
            found.append(Threshold(at=at, kind=kind, frequency=c.frequency, unstable_above=rises))
    return found


def _stretches(known: Sequence[Place]) -> list[list[int]]:
    """Places that follow one another and have steady sliding."""
    parts: list[list[int]] = [[]]
    for i, place in enumerate(known):
        if place.eigenvalues.size:
            parts[-1].append(i)
        else:
            parts.append([])
    return parts


def _whole(kept: Complexes) -> Pairs:
    """With the other one of each oscillation, and no vectors."""
    values = np.concatenate([kept, kept[kept.imag > 0.0].conj()])
    return _sorted((values, np.zeros((values.size, 0), complex)))


def _solver(places: Places, over: str, others: Mapping[str, float]) -> Callable[[float], Pairs]:
    """Eigenvalues over one parameter, those that a study keeps."""

    def solve(value: float) -> Pairs:
        values = np.linalg.eigvals(places.steady({over: value, **others}).matrix()).astype(complex)
        return _whole(values[places.kept(values)])

    return solve
