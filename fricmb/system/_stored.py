"""The energy stored in all linear elements together, in a few products of arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.integrate.problem import Floats, Ints
from fricmb.system._lined import LinedStores
from fricmb.system._structure import Store
from fricmb.system._tables import Row

#: Entries up to which coordinates of elements are taken from a dense matrix.
DENSE = 20_000
#: Coordinates that are held at a time.
COORDINATES = 1_000_000


@dataclass(frozen=True, kw_only=True)
class Stored:
    """``sum_e k_e x_i(e) x_j(e) / 2 - f x + constant`` on local coordinates ``x = R [q, u] + offset``.

    Differences of positions are taken before they are squared: the energy of a stiff spring between two bodies far away
    is theirs to the last digit.

    Attributes
    ----------
    R : (r, n + n_u), dense or scipy.sparse
    offset, f : (r,)
    i, j : (n_e,) int
    k : (n_e,)
    constant : float
    """

    R: Any
    offset: Floats
    f: Floats
    i: Ints
    j: Ints
    k: Floats
    constant: float

    def energy(self, q: Floats, u: Floats) -> Floats:
        """Energy at positions q (n, n_t) and of drivers u (n_u, n_t): (n_t,)."""
        value = np.full(q.shape[1], self.constant)
        width = max(1, COORDINATES // max(len(self.f), 1))
        for at in range(0, q.shape[1] if len(self.f) else 0, width):
            here = slice(at, at + width)
            x = self.R @ np.concatenate([q[:, here], u[:, here]]) + self.offset[:, None]
            value[here] += 0.5 * np.einsum("e,et,et->t", self.k, x[self.i], x[self.j]) - self.f @ x
        return value


def stored_of(stores: tuple[Store, ...], lined: tuple[LinedStores, ...], n: int, n_u: int) -> Stored:
    """The linear parts of all stores."""
    one = _stored_of(stores, n, n_u)
    if not lined:
        return one
    from scipy.sparse import csr_array, vstack

    a, b, k, f = (np.concatenate([getattr(many, name) for many in lined]) for name in "abkf")
    constant = one.constant + float(sum(many.constant.sum() for many in lined))
    which = np.flatnonzero((k != 0.0) | (f != 0.0))
    a, b, k, f = a[which], b[which], k[which], f[which]
    row = np.arange(which.size)
    entries = np.concatenate([np.ones(np.count_nonzero(a >= 0)), -np.ones(np.count_nonzero(b >= 0))])
    places = np.concatenate([row[a >= 0], row[b >= 0]]), np.concatenate([a[a >= 0], b[b >= 0]])
    R = csr_array((entries, places), shape=(row.size, n + n_u))
    first = len(one.f)
    return Stored(
        R=vstack([csr_array(one.R), R], format="csr"),
        offset=np.concatenate([one.offset, np.zeros(row.size)]), f=np.concatenate([one.f, f]),
        i=np.concatenate([one.i, first + row]), j=np.concatenate([one.j, first + row]),
        k=np.concatenate([one.k, k]), constant=constant,
    )  # fmt: skip


def _stored_of(stores: tuple[Store, ...], n: int, n_u: int) -> Stored:
    rows: list[Row] = []
    i: list[int] = []
    j: list[int] = []
    k: list[float] = []
    forces: list[tuple[int, float]] = []
    for store in stores:
        first = len(rows)
        rows.extend(store.rows)
        for a, b, value in store.K:
            i.append(first + a)
            j.append(first + b)
            k.append(value)
        forces += [(first + a, value) for a, _, value in store.f]
    f = np.zeros(len(rows))
    for a, value in forces:
        f[a] += value
    return Stored(
        R=_matrix(rows, n, n_u), offset=np.array([row.constant for row in rows], dtype=float), f=f,
        i=np.array(i, dtype=np.int64), j=np.array(j, dtype=np.int64), k=np.array(k, dtype=float),
        constant=float(sum(store.constant for store in stores)),
    )  # fmt: skip


def _matrix(rows: list[Row], n: int, n_u: int) -> Any:
    entries = [(a, i, c) for a, row in enumerate(rows) for i, c in row.q]
    entries += [(a, n + i, c) for a, row in enumerate(rows) for i, c in row.u]
    shape = (len(rows), n + n_u)
    if len(rows) * (n + n_u) <= DENSE:
        R = np.zeros(shape)
        for a, i, c in entries:
            R[a, i] += c
        return R
    from scipy.sparse import csr_array

    places = np.array([(a, i) for a, i, _ in entries], dtype=np.int64).reshape(-1, 2)
    values = np.array([c for _, _, c in entries], dtype=float)
    return csr_array((values, (places[:, 0], places[:, 1])), shape=shape)
