"""Elements and contacts between bodies along letters, put into the arrays of a system all at once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from typing import Any

import numpy as np

from fricmb.equations import element_groups
from fricmb.integrate.problem import Floats, Ints
from fricmb.scene import Element, Part, Scene
from fricmb.scene._lines import MOVING, Rows, lines_of

#: Fewer parts than this are put into arrays one by one, which is faster for them.
FEW = 64


@dataclass(frozen=True, kw_only=True)
class LinedStores:
    """Potentials ``k e^2/2 - f e + constant`` of elements of one coordinate ``e = q[a] - q[b]`` (-1: no such end)."""

    names: tuple[str, ...]
    a: Ints
    b: Ints
    k: Floats
    f: Floats
    constant: Floats

    def each(self, q: Floats) -> Iterator[tuple[str, Floats]]:
        """Name and energy (n_t,) of each that stores anything, at positions q (n, n_t)."""
        held = np.concatenate([q, np.zeros((1, q.shape[1]))])
        for i in np.flatnonzero((self.k != 0.0) | (self.f != 0.0) | (self.constant != 0.0)).tolist():
            e = held[self.a[i]] - held[self.b[i]]
            yield self.names[i], 0.5 * self.k[i] * e * e - self.f[i] * e + self.constant[i]


@dataclass
class Entries:
    """Entries of the constant matrices of many elements, places and values in arrays; ``f``: constant forces."""

    K: list[tuple[Ints, Ints, Floats]] = field(default_factory=list)
    C: list[tuple[Ints, Ints, Floats]] = field(default_factory=list)
    f: list[tuple[Ints, Floats]] = field(default_factory=list)
    stores: list[LinedStores] = field(default_factory=list)

    def add(self, names: tuple[str, ...], a: Ints, b: Ints, numbers: Sequence[Floats]) -> None:
        """Elements with ends a and b, and their stiffness, force, damping and constant potential."""
        k, f, c, constant = numbers
        both = (a >= 0) & (b >= 0)
        for value, held in ((k, self.K), (c, self.C)):
            for i, j, sign, which in ((a, a, 1.0, a >= 0), (b, b, 1.0, b >= 0), (a, b, -1.0, both), (b, a, -1.0, both)):
                which = which & (value != 0.0)
                held.append((i[which], j[which], sign * value[which]))
        for i, sign in ((a, 1.0), (b, -1.0)):
            which = (i >= 0) & (f != 0.0)
            self.f.append((i[which], sign * f[which]))
        self.stores.append(LinedStores(names=names, a=a, b=b, k=k, f=f, constant=constant))


@dataclass(frozen=True, kw_only=True)
class Chosen:
    """What of a scene is built, and in which way.

    Attributes
    ----------
    single : list of Part
        Parts that are put into arrays one by one; contacts are in ``runs``.
    lined : (k,) bool or None
        Which elements of ``lines_of(scene)`` are built; None: none of them in bulk.
    runs : list of (list of Contact, Rows or None)
        Contacts in the order of the scene; with rows those that are put into arrays together.
    place : (n_scene,) int
        Place in the built arrays of each degree of freedom of the scene, and -1 behind the last for no end.
    """

    single: list[Any]
    lined: Any
    runs: list[tuple[list[Any], Rows | None]]
    place: Ints


def choose(scene: Scene, parts: Sequence[Part], dofs: Sequence[str]) -> Chosen:
    """Which parts are put into arrays together."""
    from fricmb.scene import Contact

    none = np.zeros(0, dtype=np.int64)
    if len(parts) < FEW:
        rubbing = [part for part in parts if isinstance(part, Contact)]
        single = [part for part in parts if not isinstance(part, Contact)]
        return Chosen(single=single, lined=None, runs=[(rubbing, None)], place=none)
    lines = lines_of(scene)
    built = np.ones(len(scene.parts), dtype=np.bool_)
    place = np.arange(len(scene.dof_names) + 1)
    if len(parts) < len(scene.parts):
        held = {part.name for part in parts}
        built = np.array([part.name in held for part in scene.parts], dtype=np.bool_)
    if len(dofs) < len(scene.dof_names):
        index = {name: i for i, name in enumerate(dofs)}
        place = np.array([index.get(name, -1) for name in scene.dof_names] + [-1], dtype=np.int64)
    place[-1] = -1
    others = [scene.parts[i] for i in lines.others if built[i]]
    odd = [i for i in lines.others if built[i] and isinstance(scene.parts[i], Contact)]
    plain = lines.contacts
    runs: list[tuple[list[Any], Rows | None]] = []
    places = np.unique(plain.at[built[plain.at]])
    whole = sorted([*((i, False) for i in odd), *((i, True) for i in places.tolist())])
    for together, group in groupby(whole, key=lambda item: item[1]):
        at = [i for i, _ in group]
        contacts = [scene.parts[i] for i in at]
        runs.append((contacts, _between(plain, at[0], at[-1], built) if together else None))
    single = [part for part in others if not isinstance(part, Contact)]
    return Chosen(single=single, lined=built[lines.elements.at], runs=runs, place=place)


def _between(rows: Rows, first: int, last: int, built: Any) -> Rows:
    low, high = np.searchsorted(rows.at, [first, last + 1])
    kept = low + np.flatnonzero(built[rows.at[low:high]])
    return Rows(at=rows.at[kept], a=rows.a[kept], b=rows.b[kept])


def built_places(ends: Ints, place: Ints) -> Ints:
    """Places in the built arrays of ends; -1 for what is no degree of freedom of them."""
    return place[np.maximum(ends, -1)]


def add_lines(entries: Entries, scene: Scene, chosen: Chosen) -> list[Element]:
    """The chosen elements; returned are those that are not linear for their numbers."""
    if chosen.lined is None:
        return []
    rows = lines_of(scene).elements
    odd: list[Any] = []
    for group in element_groups(scene):
        terms = group.terms
        rest = np.array([t.rest for t in terms], dtype=np.bool_)[group.which]
        built = chosen.lined[group.index]
        odd += [scene.parts[i] for i in rows.at[group.index[built & rest]].tolist()]
        index, which = group.index[built & ~rest], group.which[built & ~rest]
        if not index.size:
            continue
        sums = [[float(sum(v for _, _, v in e)) for e in (t.K, t.f, t.C)] + [t.constant] for t in terms]
        numbers = np.array(sums, dtype=float).T[:, which]
        names = tuple([scene.parts[i].name for i in rows.at[index].tolist()])
        a, b = (built_places(ends[index], chosen.place) for ends in (rows.a, rows.b))
        entries.add(names, a, b, list(numbers))
    return odd


def prescribed(ends: Ints) -> list[tuple[int, Any]]:
    """Prescribed motions among ends: number of each, and which ends it is."""
    return [(MOVING - code, ends == code) for code in np.unique(ends[ends <= MOVING]).tolist()]
