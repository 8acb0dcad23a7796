"""How the matrices of implicit steps are kept: dense inverses, or banded factors in a bandwidth-reducing order.

Chosen by measured cost: the inverse of a dense matrix costs n^3 to make and n^2 to use, banded factors n half^2 and
n half.  Modes without coupled damping are a band of one diagonal, a chain has three.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.array_cache import cached_by_content
from fricmb.integrate.problem import Ints

#: Fewer degrees of freedom than this are kept dense; so are bands wider than this part of n.
SMALL, NARROW = 32, 0.15


def is_narrow(n: int, half: int) -> bool:
    """Whether steps of a structure of n degrees of freedom and this half-bandwidth keep banded factors."""
    return n >= SMALL and 3 * half + 1 <= NARROW * n


@cached_by_content
def narrow_order(rows: Ints, columns: Ints, n: int) -> tuple[Ints, int]:
    """Place (n,) of each of n unknowns in an order that keeps a matrix narrow, and its half-bandwidth there.

    By reverse Cuthill-McKee; ``rows``, ``columns``: places of the entries.  Kept by these: not to be written to.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import reverse_cuthill_mckee

    pattern = csr_array((np.ones(len(rows)), (rows, columns)), shape=(n, n))
    found = reverse_cuthill_mckee(pattern, symmetric_mode=False)
    place = np.empty(n, np.int64)
    place[found] = np.arange(n)
    return place, int(np.abs(place[rows] - place[columns]).max(initial=0))


def band_order(start: Ints, index: Ints) -> tuple[Ints, int]:
    """Place (n,) of each degree of freedom in a band, and its half-bandwidth; -1 where a dense matrix is cheaper.

    ``start``, ``index``: the pattern by rows.
    """
    n = len(start) - 1
    if n < SMALL:
        return np.arange(n), -1
    place, half = narrow_order(np.repeat(np.arange(n), np.diff(start)), index, n)
    return place, half if is_narrow(n, half) else -1
