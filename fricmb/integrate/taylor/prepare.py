"""From a problem to the arrays of a run; why a problem cannot be run this way."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager
from functools import cache, lru_cache
from typing import Any

import numpy as np

from fricmb.integrate.array_cache import cached_by_content
from fricmb.integrate.compile.exchange import with_arrays
from fricmb.integrate.compile.parallel_compile import load_blocks
from fricmb.integrate.compile.piece import Pattern
from fricmb.integrate.compile.room import room
from fricmb.integrate.csr import Csr, on_one_pattern
from fricmb.integrate.model.friction_cone import stick_limits
from fricmb.integrate.model.problem_structs import Table, table_of
from fricmb.integrate.once_per import lent_per, once_per
from fricmb.integrate.problem import Floats, Ints, Linear, Problem
from fricmb.integrate.run.workspace import empty_arrays
from fricmb.integrate.suits_taylor import against_taylor
from fricmb.integrate.taylor import change  # noqa: F401  # defines blocks that are called by name alone
from fricmb.integrate.taylor.groups import Groups
from fricmb.integrate.taylor.network import Net
from fricmb.integrate.taylor.prepare_groups import (
    against_groups,
    group_room,
    group_statics,
    legendre_rule,
    plain_contacts,
    solid,
)
from fricmb.integrate.taylor.signals import POINTS

#: A structure of at most so many diagonals is kept by diagonals.
DIAGONALS = 9
#: Most dofs that the correction of one transition may touch.
WIDEST = 8192
BLOCKS = ("taylor_series", "taylor_search", "taylor_change")


def refusal(problem: Problem) -> str | None:
    """What stands against Taylor steps for a problem, or None."""
    return once_per(problem, "taylor refusal", lambda: _refusal(problem))


def _refusal(problem: Problem) -> str | None:
    return against_taylor(problem) or against_groups(problem)


def _by_diagonals(start: Ints, index: Ints, n: int, values: Sequence[Floats]) -> tuple[Ints, list[Floats]]:
    """Offsets and matrices (d, n) by diagonals, none where they are many or mostly empty."""
    offset, diagonal, rows = _diagonals(start, index, n)
    tables = [np.zeros((len(offset), n)) for _ in values]
    if len(offset):
        for table, value in zip(tables, values, strict=True):
            table[diagonal, rows] = value
    return offset, tables


@cached_by_content
def _diagonals(start: Ints, index: Ints, n: int) -> tuple[Ints, Ints, Ints]:
    """Offsets of the diagonals, and the diagonal and the row of each entry."""
    rows = np.repeat(np.arange(n), np.diff(start))
    offset = np.unique(index - rows)
    if len(offset) > DIAGONALS or 3 * len(index) < len(offset) * n:
        offset = np.zeros(0, np.int64)
    return offset, np.searchsorted(offset, index - rows), rows


@cache
def _gauss() -> Floats:
    """Points in 0 to 1 and weights for what signals bring in."""
    at, weights = legendre_rule(8)
    return np.stack([0.5 * (at + 1.0), 0.5 * weights])


def _scaled(matrix: Csr, by: Floats) -> Csr:
    return Csr(matrix.shape, matrix.start, matrix.index, matrix.value * by[matrix.rows])


def _statics(problem: Problem) -> dict[str, Any]:
    linear, n = problem.linear, problem.n
    structure = once_per(linear, "taylor structure", lambda: _structure(linear, n))
    return {
        **structure, "signals": table_of(problem.signals.table), **_contact_arrays(problem, 1.0 / structure["mass"]),
    }  # fmt: skip


def _structure(linear: Linear, n: int) -> dict[str, Any]:
    """Arrays of the structure, per unit of mass, and what signals bring in."""
    n_u = len(linear.fx) - n
    inside, drivers = slice(0, n), slice(n, n + n_u)
    mass = linear.csr("M").diagonal()
    inverse = 1.0 / mass
    Kx, Cx, B = linear.csr("Kx"), linear.csr("Cx"), linear.csr("B")
    K, C = _scaled(Kx.block(inside, inside), inverse), _scaled(Cx.block(inside, inside), inverse)
    start, index, (k, c) = on_one_pattern([K, C], (K.index, K.rows), (C.index, C.rows))
    offset, (stiff, visc) = _by_diagonals(start, index, n, (k, c))
    damped = bool(c.any())
    if not damped:
        visc = np.zeros((0, n))
    Ku, Cu = Kx.block(inside, drivers), Cx.block(inside, drivers)
    Fu = Csr.of_entries(
        np.concatenate([B.rows, Ku.rows]), np.concatenate([B.index, Ku.index]),
        np.concatenate([B.value, -Ku.value]), (n, n_u),
    )  # fmt: skip
    Fu, Cu = _scaled(Fu, inverse), _scaled(Cu, -inverse)
    in_start, in_signal, (in_u, in_du, in_b) = on_one_pattern([Fu, Cu, B])
    outside = np.zeros((3, n_u, n_u))
    if n_u:
        outside[0], outside[1] = Kx.block(drivers, drivers).dense(), Cx.block(drivers, drivers).dense()
        outside[2, :, :1] = linear.fx[n:, None]
    return {
        "offset": offset, "tridiagonal": int(n > 2 and np.array_equal(offset, [-1, 0, 1])),
        "stiff": stiff, "visc": visc, "start": start, "neighbour": index, "k": k, "c": c,
        "load": inverse * linear.fx[:n], "in_start": in_start, "in_signal": in_signal, "in_u": in_u, "in_du": in_du,
        "in_b": in_b, "mass": mass, "drivers": outside,
        "gauss": _gauss(), "damped": int(damped),
    }  # fmt: skip


def _contact_arrays(problem: Problem, inverse: Floats) -> dict[str, Any]:
    contacts, n, m = problem.contacts, problem.n, problem.m
    rows = contacts.csr("W").transposed()
    Wu = contacts.csr("Wu")
    push = inverse[rows.index] * rows.value
    compliance = np.bincount(rows.rows, rows.value * push, m).astype(float)
    plain = plain_contacts(problem)
    owner = np.full(n, -1, dtype=np.int64)
    owner[rows.index] = np.where(plain, np.arange(m), -1)[rows.rows]
    of = problem.contacts.of_row
    return {
        "row_start": rows.start, "row_dof": rows.index, "row_coef": rows.value, "push": push,
        "compliance": compliance, "belt": contacts.w, "stick": stick_limits(contacts)[of],
        "slip": (contacts.mu_0 * contacts.N)[of], "wu_start": Wu.start, "wu_signal": Wu.index, "wu_coef": Wu.value,
        "owner": owner, "plain": plain.astype(np.int8), "grouped": np.flatnonzero(~plain),
        "first_dof": rows.index[rows.start[:-1]],
    }  # fmt: skip


@cache
def _fit() -> Floats:
    """Powers of s of a polynomial from its values at points of a step; the last row is workspace."""
    powers = np.arange(POINTS)
    return np.vstack([np.linalg.inv((powers[:, None] / (POINTS - 1)) ** powers), np.zeros((1, POINTS))])


def net_lent(problem: Problem, degree: int) -> AbstractContextManager[Net]:
    """The arrays of a run with polynomials of this degree, all but what is kept of it."""
    load_blocks(*BLOCKS)
    return lent_per(problem, ("taylor", degree), lambda: _net(problem, degree))


def _net(problem: Problem, P: int) -> Net:
    n, m, n_u = problem.n, problem.m, problem.n_u
    statics = once_per(problem, "taylor statics", lambda: _statics(problem))
    largest = int(np.diff(group_statics(problem)["dof_start"]).max(initial=1))
    rings = P if statics["damped"] else P // 2
    widest = min(n + 8, WIDEST, largest * _widest(statics["start"], statics["neighbour"], n, rings))
    sizes = n, m, n_u, P, widest
    work = _work_pattern(*sizes).zeros()
    for name, value in (("sigma", 1.0), ("free", 1.0), ("place", -1)):
        work.arrays[name].fill(value)
    work.arrays["fit"][...] = _fit()
    codes = {"mode": np.zeros(m, np.int8), "grown": np.zeros(widest, np.int8), "kind": np.zeros(widest, np.int8)}
    given = {name: solid(value) for name, value in statics.items()} | codes
    rooms = {"signals": room(statics["signals"]), "groups": group_room(problem, P, widest)}
    net = with_arrays(_blank(*sizes), **given | rooms)
    _work_pattern(*sizes).put(net, work)
    return net


@lru_cache(maxsize=64)
def _work_pattern(n: int, m: int, n_u: int, P: int, widest: int) -> Pattern:
    """Arrays that a run works in, but for those of codes."""
    # rows that do not lie a multiple of 4096 bytes apart stay in the cache together
    wide = 8 * ((n + 7) // 8 | 1)
    heap = (2 * m + 64,)
    floats: dict[str, tuple[int, ...]] = {
        "series": (n_u, P + 3), "rates": (n_u, P + 3), "large": (2, n_u), "window": (8,), "fit": (POINTS + 1, POINTS),
        **dict.fromkeys(("q", "v", "top", "free"), (n,)), "Q": (P + 1, wide), "R": (P - 1, wide),
        **dict.fromkeys(("sigma", "loss", "mark", "slack", "due", "since"), (m,)), "heap_t": heap, "flat": (3, n),
        "dQ": (P + 2, widest), "dR": (P + 1, widest), "old": (3, P + 3), "events": (max(64, 4 * m), 3),
        "steps": (256, 2), "stops": (1,), "edge": (2,), "within": (1,),
        "quiet_edge": (1,), "quiet_least": (0, 0), "quiet_most": (0, 0), "quiet_gain": (0, 0), "quiet_work": (m,),
    }  # fmt: skip
    return Pattern(Net, floats, {"heap_c": heap, "local": (widest,), "place": (n,)})


@lru_cache(maxsize=64)
def _blank(n: int, m: int, n_u: int, P: int, widest: int) -> Net:
    """A room with arrays to work in and for no samples; of structure and contacts there is nothing."""
    arrays = empty_arrays(Net) | no_samples(n, m) | _work_pattern(n, m, n_u, P, widest).zeros().arrays
    nothing = Table(**empty_arrays(Table))
    return room(Net(**arrays, signals=nothing, groups=Groups(**empty_arrays(Groups), laws=nothing)))


@cached_by_content
def _widest(start: Ints, index: Ints, n: int, rings: int) -> int:
    """How many dofs the correction of a transition may touch: twice as many as around some of them."""
    largest = 1
    for first in {0, n // 2, n - 1, int(np.argmax(np.diff(start)))}:
        inside = np.zeros(n, dtype=bool)
        inside[first] = True
        front = np.array([first])
        for _ in range(rings):
            around = np.unique(np.concatenate([index[start[j] : start[j + 1]] for j in front]))
            front = around[~inside[around]]
            inside[front] = True
            if not len(front) or inside.sum() > WIDEST:
                break
        largest = max(largest, int(inside.sum()))
    return min(2 * largest + 8, WIDEST)


def no_samples(n: int, m: int, count: int = 0) -> dict[str, Any]:
    """Empty arrays for so many samples."""
    z = np.zeros
    return {
        "times": z(count), "left": z(count, np.int8), "out_q": z((count, n)), "out_v": z((count, n)),
        "out_F": z((count, m)), "out_g": z((count, m)), "out_loss": z((count, m)),
        "out_mode": z((count, m), np.int8), "out_x": z((count, 2)),
    }  # fmt: skip
