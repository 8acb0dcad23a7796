"""Springs of which the stiffness matrix keeps no digit, beside far stiffer ones at the same place."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from fricmb.errors import SceneError
from fricmb.integrate.problem import Floats
from fricmb.system._lined import LinedStores

if TYPE_CHECKING:
    from fricmb.system._structure import Store

#: Part of a sum that is no part of it: half a rounding.
LOST = 1.1e-16


def check_digits(
    stores: Sequence[Store], lined: Sequence[LinedStores], diagonal: Floats, names: Mapping[str, int]
) -> None:
    """Refuse a spring whose stiffness is nothing beside what else acts at one of its places.

    Motion would go on without it and nothing could tell: where two masses are tied by 1e17 times the stiffness of
    what holds them, nothing holds them.  Beside a stiffer one between the same places it is no loss.

    Parameters
    ----------
    diagonal : (n,)
        Of the stiffness matrix.
    names : mapping
        Degrees of freedom and their places.

    Raises
    ------
    SceneError
        Names the spring, its stiffness and the place.
    """
    own: list[tuple[str, dict[int, float]]] | None = None
    for name, at in _suspects(stores, lined, diagonal):
        own = own if own is not None else [*_each(stores), *_each_lined(lined)]
        place = next(p for p, k in at.items() if 0.0 < abs(k) <= LOST * abs(diagonal[p]))
        if any(set(other) == set(at) and abs(other[place]) > abs(at[place]) for _, other in own):
            continue
        dof = next(dof for dof, i in names.items() if i == place)
        raise SceneError(
            f"{name}: stiffness: {at[place]:g} leaves no digit at {dof!r}, where others add up to {diagonal[place]:g};"
            " numbers have 16 digits: make one body of what the stiffest spring joins, or give it less"
        )


def _suspects(
    stores: Sequence[Store], lined: Sequence[LinedStores], diagonal: Floats
) -> Iterator[tuple[str, dict[int, float]]]:
    """Elements that are lost at one place at least, with what they add at each of theirs."""
    beside = np.append(np.abs(diagonal), 0.0)  # of an end that is no place
    for held in lined:
        k = np.abs(held.k)
        for i in np.flatnonzero((k > 0.0) & (k <= LOST * np.maximum(beside[held.a], beside[held.b]))).tolist():
            yield held.names[i], _lined(held, i)
    for name, at in _each([store for store in stores if _may_be_lost(store, float(beside.max()))]):
        if any(0.0 < abs(k) <= LOST * beside[p] for p, k in at.items()):
            yield name, at


def _may_be_lost(store: Store, most: float) -> bool:
    """Whether the least of an element is nothing beside the largest of all: matrices of many entries are not walked."""
    least = min((abs(k) for _, _, k in store.K if k != 0.0), default=np.inf)
    return least * min((c * c for row in store.rows for _, c in row.q), default=1.0) <= LOST * most


def _each(stores: Sequence[Store]) -> Iterator[tuple[str, dict[int, float]]]:
    """Each element, and what it adds to the diagonal at its places."""
    for store in stores:
        at: dict[int, float] = {}
        for i, j, k in store.K:
            other = dict(store.rows[j].q)
            for place, a in store.rows[i].q:
                at[place] = at.get(place, 0.0) + k * a * other.get(place, 0.0)
        yield store.name, at


def _each_lined(lined: Sequence[LinedStores]) -> Iterator[tuple[str, dict[int, float]]]:
    for held in lined:
        for i in range(len(held.names)):
            yield held.names[i], _lined(held, i)


def _lined(held: LinedStores, i: int) -> dict[int, float]:
    return {int(p): float(held.k[i]) for p in (held.a[i], held.b[i]) if p >= 0}
