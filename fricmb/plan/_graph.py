"""Which degrees of freedom the structure couples, and an order of them that keeps matrices narrow."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from fricmb.plan._links import Link
from fricmb.scene import Contact, MatrixElement
from fricmb.values import value_of

Pairs = NDArray[np.int64]

#: An element on more degrees of freedom than this (a spring at a point of a body with many modes) fills the matrices.
WIDE = 64


def coupling(links: Sequence[Link], dof_names: Sequence[str]) -> Pairs | None:
    """Places of degrees of freedom that elements couple directly, (2, n_pairs); None: all with all.

    Contacts apart: their forces stand outside the structure.
    """
    found: list[Pairs] = []
    pairs: list[tuple[int, int]] = []
    place = {name: i for i, name in enumerate(dof_names)}
    for link in links:
        if link.idle or isinstance(link.part, Contact):
            continue
        if isinstance(link.part, MatrixElement):
            found.append(_pattern(link.part, place))
            continue
        dofs = (*link.acts, *link.reads)
        if len(dofs) > WIDE:
            return None
        pairs.extend(combinations(dofs, 2))
    found.append(np.array(pairs, dtype=np.int64).reshape(-1, 2).T)
    return np.concatenate(found, axis=1)


def _pattern(part: MatrixElement, place: dict[str, int]) -> Pairs:
    dofs = np.array([place[name] for name in part.dofs])
    held = [value_of(value).nonzero() for value in (part.M, part.C, part.K) if value is not None]
    pairs = np.concatenate([np.array([rows, columns], dtype=np.int64) for rows, columns in held], axis=1)
    found: Pairs = dofs[pairs[:, pairs[0] != pairs[1]]]
    return found


def narrow_order(pairs: Pairs | None, dofs: Sequence[int]) -> tuple[list[int], int]:
    """An order of the degrees of freedom (of places in ``dofs``) with a small half-bandwidth, and that bandwidth.

    The declared order where reverse Cuthill-McKee does not improve on it.
    """
    declared = list(range(len(dofs)))
    if pairs is None:
        return declared, max(len(dofs) - 1, 0)
    place = np.full(max(dofs, default=-1) + 1, -1)
    place[list(dofs)] = declared
    inside = np.all(pairs < place.size, axis=0)
    local = place[pairs[:, inside]]
    local = local[:, np.all(local >= 0, axis=0)]
    width = _bandwidth(local)
    if width <= 1:
        return declared, width
    both = np.concatenate([local, local[::-1]], axis=1)
    graph = coo_array((np.ones(both.shape[1]), (both[0], both[1])), shape=(len(dofs), len(dofs))).tocsr()
    found = reverse_cuthill_mckee(graph, symmetric_mode=True)
    back = np.empty(len(dofs), dtype=np.int64)
    back[found] = declared
    narrow = _bandwidth(back[local])
    return ([int(i) for i in found], narrow) if narrow < width else (declared, width)


def _bandwidth(pairs: Pairs) -> int:
    return int(np.abs(pairs[0] - pairs[1]).max(initial=0))
