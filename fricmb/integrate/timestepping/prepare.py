"""From a problem to the arrays of a run; why a problem cannot be run this way."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.integrate.compile.lapack import load_lapack
from fricmb.integrate.compile.layout import room_type
from fricmb.integrate.compile.parallel_compile import load_blocks
from fricmb.integrate.compile.room import room
from fricmb.integrate.csr import on_one_pattern
from fricmb.integrate.model.band_ordering import narrow_order
from fricmb.integrate.model.forces import scratch_of
from fricmb.integrate.model.problem_structs import table_of
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import LAW_SMOOTH, NORMAL_CONSTANT, NORMAL_LAW, Ints, Problem
from fricmb.integrate.timestepping.loops import loops_of
from fricmb.integrate.timestepping.room import Run

#: Most contact rows that may be condensed, and numbers that a factorisation may hold.
CONDENSABLE, LARGEST = 600, 2e8
SLOTS = 6
BLOCKS = ("review_balls", "take_step")


def refusal(problem: Problem) -> str | None:
    """What stands against time stepping, or None."""
    return once_per(problem, "timestepping refusal", lambda: _refusal(problem))


def _refusal(problem: Problem) -> str | None:
    if (problem.contacts.law == LAW_SMOOTH).any():
        return "smooth laws (regularised, bristles) need no cones: 'bdf' takes them"
    if int(np.diff(problem.contacts.row).max(initial=1)) > 2:
        return "contacts have one or two directions"
    return None


def _contact_pairs(problem: Problem) -> tuple[Ints, Ints]:
    """Pairs of dofs that a contact ties together."""
    W = problem.contacts.csr("W").transposed()
    row = problem.contacts.row
    rows, columns = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
    counts = W.start[row[1:]] - W.start[row[:-1]]
    for size in np.unique(counts):
        chosen = np.flatnonzero(counts == size)
        dofs = W.index[W.start[row[chosen]][:, None] + np.arange(size)]
        rows.append(np.repeat(dofs, size, axis=1).ravel())
        columns.append(np.tile(dofs, (1, size)).ravel())
    return np.concatenate(rows), np.concatenate(columns)


def _band_cost(n: int, width: int) -> float:
    """Operations of a factorisation and a few solutions in a band of that half width."""
    return 2.0 * n * width * (width + 1.0) + n * (12.0 * width + 6.0)


def _storage(problem: Problem, rows: Ints, columns: Ints, contacts: str | None) -> tuple[Ints, int, bool]:
    """Order of the dofs, half width of the band, and whether contacts are condensed: by operations a step."""
    n, m = problem.n, problem.m
    alone, narrow = narrow_order(rows, columns, n)
    nnz = len(problem.contacts.csr("W").value)
    slim = n * (4.0 * narrow + 2.0) + 4.0 * nnz + 2.0 * m * n + 3.0 * m**3
    # the dofs of one contact are neighbours of each other: a lower bound of the width
    least = int(np.diff(problem.contacts.csr("W").transposed().start).max(initial=1)) - 1
    if contacts == "condensed" or (contacts is None and m <= CONDENSABLE and slim < _band_cost(n, least)):
        return alone, narrow, True
    extra = _contact_pairs(problem)
    both_rows, both_columns = np.concatenate([rows, extra[0]]), np.concatenate([columns, extra[1]])
    together, wide = narrow_order(both_rows, both_columns, n)
    if contacts is None and m <= CONDENSABLE and slim < _band_cost(n, wide):
        return alone, narrow, True
    return together, wide, False


def _statics(problem: Problem, contacts: str | None) -> dict[str, Any]:
    n, n_u, linear = problem.n, problem.n_u, problem.linear
    inside, drivers = slice(0, n), slice(n, n + n_u)
    Kx, Cx, B = linear.csr("Kx"), linear.csr("Cx"), linear.csr("B")
    K = Kx.block(inside, inside)
    mirrored = K.transposed()
    start, index, (mass, stiff, visc, other) = on_one_pattern(
        [linear.csr("M"), K, Cx.block(inside, inside), mirrored], (np.arange(n), np.arange(n))
    )
    rows = np.repeat(np.arange(n), np.diff(start))
    order, band, condensed = _storage(problem, rows, index, contacts)
    skew = 0.5 * (stiff - other)
    Ku, Cu = Kx.block(inside, drivers), Cx.block(inside, drivers)
    in_start, in_signal, (in_b, in_k, in_c) = on_one_pattern([B, Ku, Cu])
    back_start, back_dof, (back_k, back_c) = on_one_pattern([Kx.block(drivers, inside), Cx.block(drivers, inside)])
    outside = np.zeros((3, n_u, n_u))
    outside[0], outside[1] = Kx.block(drivers, drivers).dense(), Cx.block(drivers, drivers).dense()
    outside[2, :, :1] = linear.fx[n:, None]
    return {
        "start": start, "column": index, "mass": mass, "stiff": stiff, "visc": visc,
        "skew": skew if skew.any() else np.zeros(0),
        "at": order[rows] * (2 * band + 1) + order[index] - order[rows] + band, "order": order,
        "load": linear.fx[:n], "in_start": in_start, "in_signal": in_signal, "in_u": in_b - in_k, "in_b": in_b,
        "in_du": -in_c, "back_start": back_start, "back_dof": back_dof, "back_k": back_k, "back_c": back_c,
        "drivers": outside, **_contact_arrays(problem), "band": band, "condensed": int(condensed),
    }  # fmt: skip


def _contact_arrays(problem: Problem) -> dict[str, Any]:
    contacts = problem.contacts
    W, Wu, Wn = contacts.csr("W").transposed(), contacts.csr("Wu"), contacts.csr("Wn").transposed()
    varies = contacts.normal != NORMAL_CONSTANT
    loop, rank = loops_of(problem)
    return {
        "loop": loop, "rank": rank, "row": contacts.row, "w_start": W.start, "w_dof": W.index, "w_coef": W.value,
        "belt": contacts.w, "wu_start": Wu.start, "wu_signal": Wu.index, "wu_coef": Wu.value, "law": contacts.law,
        "mu_s": contacts.mu_s, "mu_0": contacts.mu_0, "N": np.where(varies, 0.0, contacts.N),
        "var": varies.astype(np.int8),
        "acts": (contacts.normal == NORMAL_LAW).astype(np.int8), "n_start": Wn.start, "n_dof": Wn.index,
        "n_coef": Wn.value, "N0": contacts.N0, "signals": table_of(problem.signals.table),
        "laws": table_of(contacts.law_table), "normals": table_of(contacts.normal_table),
    }  # fmt: skip


def run_of(problem: Problem, contacts: str | None, capacity: int) -> Run:
    """The arrays of a run with space for so many rows."""
    statics = once_per(problem, ("timestepping", contacts), lambda: _statics(problem, contacts))
    n, m, nc, n_u = problem.n, problem.m, problem.n_c, problem.n_u
    band, condensed = statics["band"], statics["condensed"]
    slots = (SLOTS if n * (2 * band + 1) < 1e6 else 4) if condensed else 2
    if n * (2.0 * band + 1.0) > LARGEST:
        raise MemoryError(f"timestepping: a band of half width {band} for {n} degrees of freedom is too wide")
    k = m if condensed else 0
    load_lapack()
    load_blocks("newton_condensed" if condensed else "newton_band", *BLOCKS)
    z, i = np.zeros, np.int64
    arrays = {
        **dict.fromkeys(room_type(Run).numbers, 0), **statics, **_states(n, m, nc, n_u),
        **{name: z(n) for name in ("free", "dv", "turn", "trial", "top_q", "top_v", "floor_q", "floor_v")},
        **{name: z(m) for name in ("gf", "y", "P", "phi", "move", "delta", "away", "rhs")},
        **{name: z(nc) for name in ("rho", "slide", "brake", "soft", "share", "total")},
        "H": z(3 * nc), "weight": z(3 * nc), "status": z(nc, np.int8), "tried": z(nc, np.int8),
        "base": z(max(n, m)), "jolt": z(n), "last": z(nc), "instant": z((nc, 2)),
        "lu": z((slots, n * (2 * band + 1))), "of": z((slots, 3 * nc + 1)), "used": z(slots, i),
        "Y": z((slots if k else 0, k, n)), "D": z((slots if k else 0, k, k)), "J": z(k * k),
        "sizes": z(4, np.int32), "pivots": z(max(1, m), np.int32), "stops": z(1), "s": scratch_of(problem),
        **{name: z(len(statics["rank"]), i) for name in ("held", "spare")},
        "part": z(n, i), "part_of": z(nc, i), "largest": z((1, 3)), "events": z(1, i),
        **no_rows(n, m, nc, capacity),
    }  # fmt: skip
    return room(Run(**{name: _solid(arrays[name]) for name in Run._fields}))


def _states(n: int, m: int, nc: int, n_u: int) -> dict[str, Any]:
    z = np.zeros
    return {
        "q": z((4, n)), "v": z((4, n)), "u": z((4, n_u)), "du": z((4, n_u)), "g": z((4, m)), "w": z((4, m)),
        "F": z((4, m)), "ends": z((4, m)), "hold": z((4, m)), "grip": z((4, nc)),
        "when": z((4, nc)), "known": z((4, nc), np.int8), "jolted": z((4, nc), np.int8),
        "mode": z((4, nc), np.int8), "push": z((4, nc)), "loss": z((4, nc)), "spent": z((4, 2)),
        "what": z((4, nc), np.int8), "moment": z((4, nc)), "strain": z((4, nc)),
    }  # fmt: skip


def no_rows(n: int, m: int, nc: int, capacity: int) -> dict[str, Any]:
    """Space for so many rows."""
    z = np.zeros
    return {
        "row_t": z(capacity), "row_q": z((capacity, n)), "row_v": z((capacity, n)), "row_F": z((capacity, m)),
        "row_g": z((capacity, m)), "row_N": z((capacity, nc)), "row_mode": z((capacity, nc), np.int8),
        "row_loss": z((capacity, nc)), "row_x": z((capacity, 2)), "event": z((3 * nc + 64, 3)),
    }  # fmt: skip


def _solid(x: Any) -> Any:
    if not isinstance(x, np.ndarray):
        return x
    return np.ascontiguousarray(x, dtype=None if x.dtype in (np.int8, np.float64, np.int32) else np.int64)
