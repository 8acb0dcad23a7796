"""Functions of time that are pieces of polynomials: tables, which kernels read by their address.

A measured series of a million samples is one table: it is looked up, not compiled.  Of a table t_0 < ... < t_(n-1)
there are n + 1 pieces, the first before t_0 and the last from t_(n-1) on.  On piece i with the anchor b_i the integral
of the integral of the function is ``a_i0 + a_i1 (x - b_i) + a_i2 (x - b_i)^2 + ...``; the function is its second
derivative: so the motion under a measured acceleration is a table, too.
"""

from __future__ import annotations

import hashlib
import math
import weakref
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fricmb.integrate.problem import Floats

#: Numbers before the edges of a table: address of the function that reads it, edges, coefficients of a piece, edges per
#: time if they were evenly spaced.
HEAD = 4
#: A derivative that jumps by less than this part of its largest value does not jump: round-off of coefficients.
ROUND_OFF = 1e-9
#: Orders of derivative: the function, and so on; the lowest is the integral of its integral.
VALUE, SLOPE, LOWEST = 0, 1, -2

_tables: weakref.WeakValueDictionary[int, Table] = weakref.WeakValueDictionary()
_by_digest: weakref.WeakValueDictionary[str, Table] = weakref.WeakValueDictionary()


class Table:
    """Pieces of polynomials; made by :func:`table_of`.

    Attributes
    ----------
    edge : (n,)
    given : (n + 1, d + 1)
        Coefficients of the function, from the lowest power on.
    coefficient : (n + 1, d + 3)
        Of the integral of its integral.
    domain : (float, float)
        Where the function is known: runs outside are refused.
    digest : str
        Of the content.
    """

    def __init__(self, edge: Floats, given: Floats, domain: tuple[float, float], digest: str) -> None:
        self.domain, self.digest, self.given = domain, digest, given
        given.setflags(write=False)
        coefficient = _integrated(edge, _integrated(edge, given))
        n, width = edge.size, coefficient.shape[1]
        self._flat = np.concatenate([
            [0.0, float(n), float(width), (n - 1) / (edge[-1] - edge[0]) if n > 1 else 0.0],
            edge, coefficient.ravel(),
        ])  # fmt: skip
        self._flat.setflags(write=False)
        self.edge = self._flat[HEAD : HEAD + n]
        self.coefficient = self._flat[HEAD + n :].reshape(n + 1, width)
        self._pyramids: dict[int, list[tuple[Floats, Floats]]] = {}

    @property
    def address(self) -> int:
        """Where kernels find it."""
        return int(self._flat.ctypes.data)

    def open(self) -> None:
        """Let kernels read it: tells it where the function is that does."""
        if self._flat[0] == 0.0:
            from fricmb.integrate.signals.series_value import lookup

            self._flat.setflags(write=True)
            self._flat[0] = float(lookup.address)
            self._flat.setflags(write=False)

    def piece_at(self, x: Floats) -> NDArray[np.int64]:
        """The piece that each time is in."""
        return np.searchsorted(self.edge, x, side="right")

    def anchor(self, piece: NDArray[np.int64]) -> Floats:
        """Where the powers of pieces begin."""
        found: Floats = self.edge[np.maximum(piece - 1, 0)]
        return found

    def value(self, x: Floats, order: int = VALUE) -> Floats:
        """The function at times of any shape, or its derivative; order -1 is the integral, -2 its integral."""
        x = np.asarray(x, dtype=float)
        piece = self.piece_at(x)
        return self._derivative(x - self.anchor(piece), piece, order - LOWEST)

    def _derivative(self, s: Floats, piece: NDArray[np.int64], m: int) -> Floats:
        found = np.zeros(s.shape)
        for j in range(self.coefficient.shape[1] - 1, m - 1, -1):
            found = found * s + self.coefficient[piece, j] * math.perm(j, m)
        return found

    def breaks(self, order: int) -> tuple[Floats, Floats]:
        """Edges at which a derivative up to some order jumps, and others at which a higher one does."""
        hard = np.zeros(self.edge.size, dtype=bool)
        for k in range(min(order, self.degree) + 1):
            hard |= self.jumps(k) != 0.0
        soft = np.zeros(self.edge.size, dtype=bool)
        for k in range(order + 1, self.degree + 1):
            soft |= self.jumps(k) != 0.0
        return self.edge[hard], self.edge[soft & ~hard]

    def jumps(self, order: int) -> Floats:
        """By how much a derivative jumps at each edge (n,); 0 where that is round-off."""
        left, right = np.arange(self.edge.size), np.arange(1, self.edge.size + 1)
        before = self._derivative(self.edge - self.anchor(left), left, order - LOWEST)
        after = self._derivative(np.zeros(self.edge.size), right, order - LOWEST)
        size = max(np.abs(before).max(), np.abs(after).max())
        jump = after - before
        return np.where(np.abs(jump) > ROUND_OFF * size, jump, 0.0)

    @property
    def degree(self) -> int:
        """Of the pieces."""
        return int(self.given.shape[1]) - 1

    def ranges(self, low: Floats, high: Floats, order: int) -> tuple[Floats, Floats]:
        """Bounds of a derivative on intervals of time (k,)."""
        if order > self.degree:
            return np.zeros(low.size), np.zeros(low.size)
        first, last = self.piece_at(low), self.piece_at(high)
        least, most = _of_polynomials(self, first, low, np.where(first == last, high, self._end(first)), order)
        one = _of_polynomials(self, last, np.where(first == last, low, self.anchor(last)), high, order)
        least, most = np.minimum(least, one[0]), np.maximum(most, one[1])
        for level, (small, large) in enumerate(self._pyramid(order)):
            # pieces strictly between: bottom up, as in a tree of halves
            first, last = (first + 1, last) if level == 0 else (first, last)
            open_ = first < last
            odd = open_ & (first % 2 == 1)
            least, most = _taken(least, most, small, large, first, odd)
            first = first + odd
            odd = (first < last) & (last % 2 == 1)
            least, most = _taken(least, most, small, large, last - 1, odd)
            last = last - odd
            first, last = first // 2, last // 2
        return least, most

    def _end(self, piece: NDArray[np.int64]) -> Floats:
        """Where a piece ends; of the last one where it begins."""
        found: Floats = self.edge[np.minimum(piece, self.edge.size - 1)]
        return found

    def _pyramid(self, order: int) -> list[tuple[Floats, Floats]]:
        """Bounds on single pieces, on two of them, on four, ..."""
        if order not in self._pyramids:
            piece = np.arange(self.edge.size + 1)
            begin = self.anchor(piece)
            levels = [_of_polynomials(self, piece, begin, np.maximum(self._end(piece), begin), order)]
            while levels[-1][0].size > 1:
                small, large = levels[-1]
                if small.size % 2:
                    small, large = np.append(small, small[-1]), np.append(large, large[-1])
                levels.append((np.minimum(small[::2], small[1::2]), np.maximum(large[::2], large[1::2])))
            self._pyramids[order] = levels
        return self._pyramids[order]


def _taken(
    least: Floats, most: Floats, small: Floats, large: Floats, at: NDArray[np.int64], where: NDArray[np.bool_]
) -> tuple[Floats, Floats]:
    place = np.clip(at, 0, small.size - 1)
    return np.where(where, np.minimum(least, small[place]), least), np.where(
        where, np.maximum(most, large[place]), most
    )


def _of_polynomials(
    table: Table, piece: NDArray[np.int64], low: Floats, high: Floats, order: int
) -> tuple[Floats, Floats]:
    """Bounds of a derivative of given pieces from one time to another: its Taylor series about the middle."""
    anchor = table.anchor(piece)
    middle, half = 0.5 * (low + high) - anchor, 0.5 * (high - low)
    centre = table._derivative(middle, piece, order - LOWEST)
    reach = np.zeros(centre.shape)
    for j in range(1, table.degree - order + 1):
        reach += np.abs(table._derivative(middle, piece, order - LOWEST + j)) * half**j / math.factorial(j)
    return centre - reach, centre + reach


def table_of(
    edge: Floats, pieces: Floats, *, before: float | Sequence[float], after: float | Sequence[float],
    domain: tuple[float, float] = (-math.inf, math.inf),
) -> Table:  # fmt: skip
    """A table of given pieces; the same content gives the same table.

    Parameters
    ----------
    edge : (n,), rising
    pieces : (n - 1, d + 1)
        Coefficients between two edges, in powers of the time since the first of them, from the lowest on.
    before, after : float or coefficients
        The same before the first edge, in powers of the time since it, and from the last edge on.
    domain : (float, float), optional
    """
    edge = np.ascontiguousarray(edge, dtype=float)
    d = max(pieces.shape[1] - 1 if pieces.size else 0, np.size(before) - 1, np.size(after) - 1)
    c = np.zeros((edge.size + 1, d + 1))
    c[0, : np.size(before)] = before
    c[-1, : np.size(after)] = after
    c[1:-1, : pieces.shape[1] if pieces.size else 0] = pieces
    digest = hashlib.sha256()
    for part in (edge, c, np.array(domain)):
        digest.update(repr(part.shape).encode() + part.tobytes())
    name = digest.hexdigest()[:16]
    found = _by_digest.get(name)
    if found is None:
        found = Table(edge, c, domain, name)
        _by_digest[name] = _tables[found.address] = found
    return found


def _integrated(edge: Floats, c: Floats) -> Floats:
    """Coefficients of the integral from the first edge on."""
    a = np.zeros((c.shape[0], c.shape[1] + 1))
    a[:, 1:] = c / np.arange(1, c.shape[1] + 1)
    h = np.diff(edge)
    gained = np.zeros(h.size)
    for j in range(a.shape[1] - 1, 0, -1):
        gained = (gained + a[1:-1, j]) * h
    a[2:, 0] = np.cumsum(gained)
    return a


def table_at(address: float) -> Table:
    """The table at an address."""
    return _tables[int(address)]


def series_value(x: Floats, address: float, order: float) -> Floats:
    """The function in the table at an address, or its derivative; order -1 is the integral."""
    return table_at(float(np.ravel(address)[0])).value(x, int(order))
