"""Constraints that depend on one another: found loop by loop, before a run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fricmb.errors import SceneError
from fricmb.integrate.implicit.equations.consistent_start import assembled, closed, listed
from fricmb.integrate.implicit.equations.least_change import Least, constraints_at, names_of_rows, unit_rows
from fricmb.integrate.implicit.scene.problem_structs import masses
from fricmb.integrate.implicit.scene.structure import mechanism_of
from fricmb.integrate.mechanism import Mechanism
from fricmb.integrate.problem import Floats, Ints, Problem, Start

#: Singular values this small beside the largest count as 0.
RANK = 1e-9
#: Change of the constraints' directions in a position that counts as nearby, and tries to find one.
NEARBY, TRIES = 1e-3, 8


@dataclass(frozen=True, kw_only=True)
class Redundancy:
    """Rows that follow from the others, and the joints whose reactions are not determined for it."""

    rows: Ints
    joints: tuple[str, ...]


def redundancy(problem: Problem, start: Start, groups: Sequence[Sequence[str]] = ()) -> Redundancy:
    """Find constraints that depend on others throughout (not in this position alone).

    Rank by the singular values of ``G M^-1/2``; the rows to leave out by QR with column pivoting.  Where the rank is
    higher in a neighbouring position, the mechanism is in a singular position.

    Parameters
    ----------
    groups : sequence of sequences of str
        Joints whose constraints can depend on one another, by name (loops that share a joint); the others are looked
        at one by one.  The work is the sum of the cubes of the groups' sizes.

    Raises
    ------
    SceneError
        For a singular position at the start.
    """
    from scipy.linalg import qr

    m = mechanism_of(problem)
    if not m.n_rows:
        return Redundancy(rows=np.zeros(0, np.int64), joints=())
    found = assembled(problem, start)
    start = replace(start, q=found.q, v=found.v)
    weight = 1.0 / np.sqrt(masses(m))
    J = unit_rows(found.G, weight)[0]
    dropped: list[Ints] = []
    touched: list[str] = []
    nearby: Any = None
    for rows in _rows_of(m, groups):
        block = _dense(J, rows)
        rank = _rank(block)
        if rank == len(rows):
            continue
        left = np.linalg.svd(block, full_matrices=True)[0][:, rank:]
        names = names_of_rows(m, rows[np.abs(left).max(axis=1) > 1e-6])
        nearby = _nearby(problem, start, J, weight) if nearby is None else nearby
        if _rank(_dense(nearby, rows)) > rank:
            raise SceneError(
                f"the mechanism starts in a singular position: the constraints of {listed(names)} depend on one "
                "another there, and not in positions nearby; start it from another one"
            )
        # what ties the coordinates of one body together comes first, and is never left out
        order = qr((block * _first(m, rows)[:, None]).T, mode="r", pivoting=True)[1]
        dropped.append(rows[order[rank:]])
        touched += names
    rows_left = np.sort(np.concatenate(dropped)).astype(np.int64) if dropped else np.zeros(0, np.int64)
    return Redundancy(rows=rows_left, joints=tuple(dict.fromkeys(touched)))


def _rows_of(m: Mechanism, groups: Sequence[Sequence[str]]) -> list[Ints]:
    """Rows of each group, and of every joint in none."""
    joints = m.joints
    place = {name: i for i, name in enumerate(joints.names)}
    together = [[place[name] for name in group if name in place] for group in groups]
    grouped = {i for group in together for i in group}
    together += [[i] for i in range(len(joints.names)) if i not in grouped]
    rows = [np.concatenate([np.arange(joints.row[i], joints.row[i + 1]) for i in group]) for group in together if group]
    return [found for found in rows if found.size]


def _first(m: Mechanism, rows: Ints) -> Floats:
    """Weights (n_rows,) by which pivoting takes the inner constraints of bodies before those of joints."""
    owner = m.joints.owners(rows)
    weights: Floats = np.where(m.joints.inner[owner] != 0, 1.0 / RANK, 1.0)
    return weights


def _dense(J: Any, rows: Ints) -> Floats:
    """The rows as a dense matrix over the columns that they touch."""
    some = J[rows]
    if isinstance(some, np.ndarray):
        return some
    columns = np.unique(some.indices)
    block: Floats = some[:, columns].toarray() if columns.size else np.zeros((len(rows), 1))
    return block


def _rank(J: Floats) -> int:
    values = np.linalg.svd(J, compute_uv=False)
    return int((values > RANK * values.max(initial=0.0)).sum())


def _nearby(problem: Problem, start: Start, J: Any, weight: Floats) -> Any:
    """J after a small motion that the constraints allow (the same, where they allow none)."""
    m = mechanism_of(problem)
    free = np.random.default_rng(1).standard_normal(problem.n)
    free -= Least(J).change(J @ free)
    direction = weight * free
    if np.abs(free).max() < 1e-9:
        return J
    step = _short_way(problem, start, J, weight, direction)
    try:
        _, there = closed(problem, m, start.t, start.q + step, start.v, weight)
    except SceneError:
        return J
    return unit_rows(there.G, weight)[0]


def _short_way(problem: Problem, start: Start, J: Any, weight: Floats, direction: Floats) -> Floats:
    """The part of a motion that changes J, whose rows are of length 1, by some NEARBY.

    Coordinates themselves tell nothing of that: lengths and angles are among them, in any units.
    """
    length = NEARBY * max(float(np.abs(start.q).max(initial=0.0)), 1e-300) / np.abs(direction).max()
    for _ in range(TRIES):
        there = unit_rows(constraints_at(problem, start.t, start.q + length * direction, start.v).G, weight)[0]
        change = float(abs(there - J).max())
        if 0.3 * NEARBY <= change <= 3.0 * NEARBY:
            break
        length *= min(max(NEARBY / max(change, 1e-300), 1e-3), 1e3)
    step: Floats = length * direction
    return step


def singular_joints(problem: Problem, t: float, q: Floats, v: Floats) -> list[str]:
    """Joints whose constraints are nearest to depending on one another."""
    m = mechanism_of(problem)
    kept = np.flatnonzero(m.joints.dropped == 0)
    J = unit_rows(constraints_at(problem, t, q, v).G, 1.0 / np.sqrt(masses(m)))[0]
    left = np.abs(Least(J[kept]).weakest())
    return names_of_rows(m, kept[np.flatnonzero(left > 0.1 * left.max())])
