"""Which degrees of freedom the structure couples, and an order of them that keeps matrices narrow."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from fricmb.plan._links import Flags, Links
from fricmb.scene import MatrixElement
from fricmb.values import value_of

Pairs = NDArray[np.int64]

#: An element on more degrees of freedom than this (a spring at a point of a body with many modes) fills the matrices.
WIDE = 64


def coupling(links: Links, inside: Flags, dof_names: Sequence[str]) -> Pairs | None:
    """Places of degrees of freedom that elements couple directly, (2, n_pairs); None: all with all.

    Contacts apart: their forces stand outside the structure.
    """
    acting = inside & ~links.idle & ~links.rubs
    matrices = [i for i in np.flatnonzero(acting).tolist() if isinstance(links.parts[i], MatrixElement)]
    place = {name: i for i, name in enumerate(dof_names)} if matrices else {}
    found: list[Pairs] = [_pattern(links.parts[i], place) for i in matrices]
    acting[matrices] = False
    sizes = np.where(acting, np.diff(links.start), 0)
    if sizes.max(initial=0) > WIDE:
        return None
    for size in np.unique(sizes[sizes > 1]).tolist():
        dofs = links.dofs[links.start[:-1][sizes == size][:, None] + np.arange(size)]
        found.extend(dofs[:, pair].T for pair in combinations(range(size), 2))
    return np.concatenate([np.zeros((2, 0), dtype=np.int64), *found], axis=1)


def _pattern(part: Any, place: dict[str, int]) -> Pairs:
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
    return (found.tolist(), narrow) if narrow < width else (declared, width)


def _bandwidth(pairs: Pairs) -> int:
    return int(np.abs(pairs[0] - pairs[1]).max(initial=0))
