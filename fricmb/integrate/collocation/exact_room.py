"""Any linear structure with its ports as the room of exact steps: blocks, inputs, outputs, tables."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricmb.integrate.collocation.nodes import TERMS, Z_EXACT, nodes
from fricmb.integrate.collocation.structure_blocks import Blocks, blocks
from fricmb.integrate.compile.lanes import padded
from fricmb.integrate.compile.room import room
from fricmb.integrate.csr import is_diagonal
from fricmb.integrate.model.structure import dense_inverse
from fricmb.integrate.once_per import lent_per, once_per
from fricmb.integrate.problem import Floats, Ints, Problem, Templates
from fricmb.integrate.step.exact_structure import RUNGS, UNIT_RUNG, Exact


@dataclass(frozen=True, kw_only=True)
class PortForms:
    """Inputs B (n, n_in) on the dofs; outputs by positions and velocities (n_o, n) each; sizes of their groups."""

    B: Floats
    by_q: Floats
    by_v: Floats
    unknown: int
    element_x: int
    normal_x: int
    element_f: int


def _forms(templates: Templates, n: int) -> tuple[Floats, Floats]:
    """Arguments of templates by q and by v."""
    start, index, coefficient = templates.form_start, templates.form_index, templates.form_coefficient
    count = int(templates.x_start[-1])
    row = np.repeat(np.arange(count), np.diff(start[: count + 1]))
    column, value = index[: len(row)] - 1, coefficient[: len(row)]
    by = np.zeros((2, count, n))
    for k in range(2):
        inside = (column >= k * n) & (column < (k + 1) * n)
        np.add.at(by[k], (row[inside], column[inside] - k * n), value[inside])
    return by[0], by[1]


def port_forms(problem: Problem) -> PortForms:
    """What acts on the structure and what is asked of it."""
    n, linear, contacts, elements = problem.n, problem.linear, problem.contacts, problem.elements
    varies = np.flatnonzero(contacts.normal != 0)
    n_f = int(elements.f_start[-1])
    spread = np.zeros((n, n_f))
    row = np.repeat(np.arange(n_f), np.diff(elements.spread_start[: n_f + 1]))
    np.add.at(spread, (elements.spread_dof[: len(row)], row), elements.spread_coefficient[: len(row)])
    loads = linear.B - linear.Kx[:n, n:]
    B = np.hstack([contacts.W, contacts.Wn[:, varies], spread, loads, -linear.Cx[:n, n:]])
    xq, xv = _forms(elements.table, n)
    yq, yv = _forms(contacts.normal_table, n)
    return PortForms(
        B=B, by_q=np.vstack([np.zeros((problem.m, n)), xq, yq]), by_v=np.vstack([contacts.W.T, xv, yv]),
        unknown=problem.m + len(varies) + n_f, element_x=len(xq), normal_x=len(yq), element_f=n_f,
    )  # fmt: skip


def free_blocks(problem: Problem) -> Blocks:
    """The structure without contact forces in blocks; raises NoBlocks where it has no such form."""
    n, linear = problem.n, problem.linear

    def make() -> Blocks:
        M, K, C = (np.asarray(x, float) for x in (linear.M, linear.Kx[:n, :n], linear.Cx[:n, :n]))
        return blocks(M, K, C, np.zeros((n, 0)), ())

    return once_per(linear, "free blocks", make)


def _product(pairs: list[tuple[Floats, Floats]], mass: Floats) -> Floats:
    """Sum of products of rows over the dofs (m, n) with motions (n, b), what is round-off of the motions as 0.

    Motions are right to round-off in coordinates in which all masses are 1: beside a heavy body what a light one feels
    is small, and no round-off.
    """
    scale = np.sqrt(mass)[:, None]
    found = sum(rows @ motions for rows, motions in pairs)
    grain = sum(
        (np.abs(rows) @ (1.0 / scale)) * (np.abs(motions) * scale).max(axis=0, initial=0.0) for rows, motions in pairs
    )
    return np.where(np.abs(found) < 1e-15 * grain, 0.0, found)


def _by_velocities(force: Floats, M: Floats) -> Floats:
    """Block states by velocities from those by forces."""
    return force * np.diagonal(M) if is_diagonal(M) else force @ M


def has_ledger(problem: Problem) -> bool:
    """Whether anything but friction takes or brings energy."""
    n, linear, contacts = problem.n, problem.linear, problem.contacts
    K = linear.Kx[:n, :n]
    parts = [linear.Cx[:n, :n], contacts.w, contacts.Wn, problem.elements.table.address]
    return bool(problem.n_u > 0 or any(np.any(x) for x in parts) or np.any(K != K.T))


def _ranges(filled: NDArray[np.bool_]) -> Ints:
    """First and one behind the last row (2, columns) that each column fills."""
    first, behind = filled.argmax(axis=0), len(filled) - filled[::-1].argmax(axis=0)
    return np.where(filled.any(axis=0), np.stack([first, behind]), 0)


def _tables(b: int, s: int, pairs: int) -> tuple[dict[str, Floats], Floats]:
    count = 1 + int(np.clip(6_000_000 // (6 * b * s + pairs * s * s + 1), 10, 60))
    names = ("S", "IS", "IIS", "Q1", "Q2", "Q3")
    return {name: np.zeros((count, b, padded(s))) for name in names}, np.zeros((count, pairs, s, padded(s)))


#: Numbers kept at most for contacts that stick.
HELD_NUMBERS = 3_000_000


def _exact(problem: Problem, s: int) -> Exact:
    n, forms, part, table = problem.n, port_forms(problem), free_blocks(problem), nodes(s)
    b, n_in, n_o = len(part.w2), forms.B.shape[1], len(forms.by_v)
    Minv = dense_inverse(problem.linear.M).dense()
    mass = np.diagonal(problem.linear.M)
    c = np.stack([
        _product([(forms.by_q, part.q_u), (forms.by_v, part.v_u)], mass),
        _product([(forms.by_q, part.q_v), (forms.by_v, part.v_v)], mass),
    ])  # fmt: skip
    by = np.stack([_product([(forms.B.T, force.T)], mass) for force in (part.force_0, part.force_1)])
    linked = np.abs(c).sum(axis=0) @ np.abs(by).sum(axis=0).T > 0
    fastest = float(max(np.sqrt(np.abs(part.w2)).max(initial=0.0), np.abs(part.d).max(initial=0.0)))
    tables, tk = _tables(b, s, n_o * n_in)
    slots = np.full(RUNGS + 1, -1, np.int64)
    slots[-1] = 0
    xs, ys, nf = forms.element_x, forms.normal_x, forms.element_f
    nv = problem.n_v
    inner = xs * s
    wide = s * problem.m
    # with nonlinear elements or normal forces the equations of contacts change from one iteration to the next
    held = 0 if nv or nf else int(np.clip(HELD_NUMBERS // (3 * wide * wide + 1), 0, 256))
    numbers: dict[str, Any] = {
        "modal": part.modal and not c[0].any(), "ledger": has_ledger(problem), "unknown": forms.unknown, "held_next": 0,
        "safety": 1.0, "stiff_at": Z_EXACT[s] * 1.0001, "cap": np.inf, "fastest": fastest, "length": 0.0,
    }  # fmt: skip
    start_0, start_1 = (_by_velocities(force, problem.linear.M) for force in (part.force_0, part.force_1))
    filled = (part.q_u != 0) | (part.q_v != 0) | (part.v_u != 0) | (part.v_v != 0)
    filled |= (start_0.T != 0) | (start_1.T != 0) | (part.force_0.T != 0) | (part.force_1.T != 0)
    made: dict[str, Any] = {
        "moves": _ranges(filled), "moved_by": _ranges(filled.T),
        "w2": part.w2[None], "damp": part.d[None], "c0": c[0], "c1": c[1], "b0": by[0], "b1": by[1],
        "linked": linked.astype(float), "q_u": part.q_u, "q_v": part.q_v, "v_u": part.v_u, "v_v": part.v_v,
        "force_0": part.force_0, "force_1": part.force_1, "start_0": start_0, "start_1": start_1,
        "MB": (Minv @ forms.B).T, "monomial": table.monomial,
        "tails": table.tails, "mo": table.mo, **tables, "tk": tk, "radau": np.zeros((s, s)),
        **{name: np.zeros(b) for name in ("v0", "a0", "k0", "du", "dv")},
        "ladder": 2.0 ** (0.25 * (np.arange(RUNGS) - UNIT_RUNG)), "slots": slots,
        "kappa": np.zeros((b + 1, TERMS)), "terms": np.zeros(b, np.int64),
        "xf": np.zeros((n_o, s)), "x": np.zeros((n_o, s)), "P": np.zeros((n_in, s)),
        "now": np.zeros(n_in), "weight": np.zeros(n_in), "low": np.zeros((2, n + 1)), "end": np.zeros((2, n)),
        "node": np.zeros((2, s, n)), "f": np.zeros(n),
        "held": np.empty((held, 3, wide, wide)), "held_for": np.zeros((held, 2), np.int64),
        "rows": np.zeros(wide, np.int64),
        "J": np.zeros((s, nf, xs)), "JN": np.zeros((s, nv, ys)), "fe": np.zeros((s, nf)),
        "A": np.zeros(inner * inner), "R": np.zeros((s * (problem.m + nv) + 1, inner)),
        "pivots": np.zeros(max(1, inner), np.int32),
    }  # fmt: skip
    arrays: dict[str, Any] = {
        name: np.ascontiguousarray(value, dtype=None if value.dtype.kind == "i" else float)
        for name, value in made.items()
    }
    return room(Exact(tab=table.tab, **numbers, **arrays))


@contextmanager
def exact_lent(problem: Problem, s: int, safety: float, exact_up_to: float | None) -> Iterator[Exact]:
    """A room of the problem with s nodes; nobody else has it meanwhile.

    Its tables are kept for the next run, where workspaces are lent as they were when they were made.
    """
    with lent_per(problem, ("exact", s, exact_up_to), lambda: _exact(problem, s)) as found:
        found.safety = safety
        found.stiff_at = Z_EXACT[s] * 1.0001 if exact_up_to is None else exact_up_to
        found.cap = np.inf
        found.low[:] = 0.0
        yield found
