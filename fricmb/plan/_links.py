"""Who acts on whom: the degrees of freedom that each part ties together, and those it only looks at."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from fricmb.scene import Part

Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True)
class Link:
    """What a part has to do with the degrees of freedom (by their places in the scene).

    Attributes
    ----------
    part : Part
    acts : tuple of int
        Degrees of freedom that feel it; it depends on them, too.
    reads : tuple of int
        Others it depends on: coordinates in an expression.
    facts : ElementFacts or None
        Of an element: which terms its numbers leave.
    idle : bool
        It acts on nothing: an element of which nothing is left, a contact without normal force.
    starts : bool
        It may set in motion what rests at the origin.
    """

    part: Part
    acts: tuple[int, ...]
    reads: tuple[int, ...]
    facts: Any = None
    idle: bool = False
    starts: bool = True


@dataclass(frozen=True, kw_only=True)
class Links:
    """All parts of a scene that act, with what they act on, in arrays over them.

    Attributes
    ----------
    n : int
        Degrees of freedom of the scene.
    parts : list of Part
        In the order of the scene; Gravity once for each body.
    at : (k,) int
        Their places in the scene.
    start, dofs : (k+1,), (nnz,) int
        Degrees of freedom of each: those that feel it, then those that it only looks at (see :class:`Link`).
    acts : (k,) int
        How many feel it.
    idle, starts, rubs : (k,) bool
        It acts on nothing; it may set bodies in motion; it is a contact.
    kinds : tuple of ElementFacts
    kind : (k,) int
        Of an element: which of ``kinds``; else -1.
    turning : (2, m) int
        Pairs of degrees of freedom of one body that turns: places of its points take all of them.
    """

    n: int
    parts: list[Part]
    at: Ints
    start: Ints
    dofs: Ints
    acts: Ints
    idle: Flags
    starts: Flags
    rubs: Flags
    kinds: tuple[Any, ...]
    kind: Ints
    turning: Ints

    @cached_property
    def owner(self) -> Ints:
        """Link of every entry of ``dofs``."""
        return np.repeat(np.arange(len(self.parts)), np.diff(self.start))

    @cached_property
    def first(self) -> Ints:
        """A degree of freedom that feels each link, -1 where none does."""
        found = np.full(len(self.parts), -1, dtype=np.int64)
        has = (self.acts > 0) & ~self.idle
        found[has] = self.dofs[self.start[:-1][has]]
        return found

    def named(self, names: Collection[str]) -> Flags:
        """Which links belong to parts of the given names."""
        if not names:
            return np.zeros(len(self.parts), dtype=np.bool_)
        return np.array([part.name in names for part in self.parts], dtype=np.bool_)

    def touched(self, which: Flags) -> set[int]:
        """Degrees of freedom of some links."""
        return set(self.dofs[which[self.owner]].tolist())

    def reaching(self, targets: Iterable[int]) -> list[int]:
        """Degrees of freedom that can influence the given ones, and these: backwards along the links."""
        n, k = self.n, len(self.parts)
        acting = np.arange(self.dofs.size) - self.start[:-1][self.owner] < self.acts[self.owner]
        acting &= ~self.idle[self.owner]
        given = np.array(sorted(set(targets)), dtype=np.int64)
        # from what feels a link to the link, from there to all that it depends on; the root is before the given ones
        source = np.concatenate([self.dofs[acting], n + self.owner, np.full(given.size, n + k), *self.turning])
        target = np.concatenate([n + self.owner[acting], self.dofs, given, *self.turning[::-1]])
        graph = coo_array((np.ones(source.size, dtype=np.int8), (source, target)), shape=(n + k + 1, n + k + 1))
        found = breadth_first_order(graph.tocsr(), n + k, return_predecessors=False)
        return np.sort(found[found < n]).tolist()  # type: ignore[no-any-return]

    @cached_property
    def labels(self) -> Ints:
        """A number for each degree of freedom, the same for those that parts tie together (n,)."""
        bound = self.first[self.owner] >= 0
        pairs = np.hstack([[self.first[self.owner[bound]], self.dofs[bound]], self.turning])
        graph = coo_array((np.ones(pairs.shape[1], dtype=np.int8), tuple(pairs)), shape=(self.n, self.n))
        found: Ints = connected_components(graph, directed=False)[1].astype(np.int64)
        return found

    def groups(self, dofs: Sequence[int]) -> list[Ints]:
        """The given degrees of freedom in groups that parts tie together, in the order of the scene."""
        return split_by(np.asarray(dofs, dtype=np.int64), self.labels[np.asarray(dofs, dtype=np.int64)])


def split_by(values: Ints, labels: Ints) -> list[Ints]:
    """Values in groups of equal labels, groups in the order of their first values."""
    if not values.size:
        return []
    _, first, inverse = np.unique(labels, return_index=True, return_inverse=True)
    rank = np.empty(first.size, dtype=np.int64)
    rank[np.argsort(first)] = np.arange(first.size)
    group = rank[inverse.ravel()]
    ends = np.cumsum(np.bincount(group))[:-1]
    return np.split(values[np.argsort(group, kind="stable")], ends)
