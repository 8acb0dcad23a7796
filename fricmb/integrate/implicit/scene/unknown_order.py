"""Which unknowns of a step meet in an equation, and an order of them that keeps the matrices narrow."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np

from fricmb.integrate.mechanism import Mechanism, loads_of
from fricmb.integrate.model.band_ordering import narrow_order
from fricmb.integrate.problem import Ints, Problem, Templates


class Ordering(NamedTuple):
    """Place of each unknown [v, lam, F, z], half-bandwidth of all but the last ``border`` of them, which meet the rest.

    ``group`` (n,) of each degree of freedom: what nothing ties together is in groups of its own.
    """

    place: Ints
    half: int
    border: int
    group: Ints


def ordering(problem: Problem, m: Mechanism, y_start: Ints, y_dof: Ints) -> Ordering:
    """Reverse Cuthill-McKee on the pattern of all unknowns, or of velocities, ports being a border, if that costs less.

    With joints velocities alone may have no factors: a border is for scenes without them.
    """
    from scipy.sparse.csgraph import connected_components

    size = m.n + m.n_rows + problem.m + problem.n_z
    dofs = _Dofs(m, y_start, y_dof)
    structure = list(_of_structure(problem, m, dofs))
    pattern = _meeting([*structure, *_of_ports(problem, m, dofs)], size)
    place, half = _narrow(pattern)
    tied = connected_components(pattern, directed=False)[1] if size else np.zeros(0)
    group = np.unique(tied[: m.n], return_inverse=True)[1].astype(np.int64)
    border = size - m.n
    if border > 0 and problem.mechanism is None:
        own, narrow = _narrow(_meeting(structure, m.n))
        if cost_of(m.n, narrow, border) < cost_of(size, half, 0):
            return Ordering(np.append(own, np.arange(m.n, size)), narrow, border, group)
    return Ordering(place, half, 0, group)


def _meeting(groups: list[set[int]], size: int) -> Any:
    """Pattern of a matrix in whose equations the unknowns of each group meet."""
    from scipy.sparse import csr_array

    members = [(i,) for i in range(size)] + [sorted(group) for group in groups]
    start = np.concatenate(([0], np.cumsum([len(group) for group in members])))
    member = np.array([i for group in members for i in group], dtype=np.int64)
    meets = csr_array((np.ones(len(member)), member, start), shape=(len(members), size))
    return (meets.T @ meets).tocoo()


def _narrow(pattern: Any) -> tuple[Ints, int]:
    """Places that keep a pattern narrow, and its half-bandwidth then."""
    order = np.lexsort((pattern.col, pattern.row))
    return narrow_order(pattern.row[order].astype(np.int64), pattern.col[order].astype(np.int64), pattern.shape[0])


def cost_of(n: int, half: int, border: int) -> float:
    """Multiplications that factors of a band with a border take, about."""
    return n * (2.0 * half**2 + 1) + border * n * (3 * half + 1) + border**2 * n + border**3


class _Dofs:
    """Degrees of freedom that extended coordinates, and templates of them, move with."""

    def __init__(self, m: Mechanism, y_start: Ints, y_dof: Ints) -> None:
        self.n_y, self.y_start, self.y_dof = m.n_y, y_start, y_dof

    def of(self, extended: Iterable[int]) -> set[int]:
        """Those of extended coordinates."""
        start, dof = self.y_start, self.y_dof
        return {int(d) for e in extended if 0 <= e < self.n_y for d in dof[start[e] : start[e + 1]]}

    def of_template(self, table: Templates, k: int, *further: int) -> set[int]:
        """Those that template k takes, with those of further extended coordinates."""
        n_y, first, last = self.n_y, table.x_start[k], table.x_start[k + 1]
        index = table.form_index[table.form_start[first] : table.form_start[last]] - 1
        inside = index[(index >= 0) & (index < 2 * n_y)]
        return self.of([*(inside % n_y).tolist(), *further])


def _of_structure(problem: Problem, m: Mechanism, dofs: _Dofs) -> Iterator[set[int]]:
    """Degrees of freedom that matrices, bodies that turn, elements and normal forces tie together."""
    for entries in (m.M, m.K, m.C):
        for i, j in zip(entries.row.tolist(), entries.column.tolist(), strict=True):
            yield dofs.of((i, j))
    for k in range(len(m.places.address)):
        yield {int(d) for d in m.places.dof[m.places.dof_start[k] : m.places.dof_start[k + 1]]}
    elements = problem.elements
    for k in range(len(elements.table.address)):
        first, last = elements.f_start[k], elements.f_start[k + 1]
        spread = elements.spread_dof[elements.spread_start[first] : elements.spread_start[last]]
        yield dofs.of_template(elements.table, k, *spread.tolist())
    for k in range(problem.n_c):
        yield dofs.of_template(problem.contacts.normal_table, k)


def _of_ports(problem: Problem, m: Mechanism, dofs: _Dofs) -> Iterator[set[int]]:
    """Unknowns of each joint and each contact, with the degrees of freedom that they meet."""
    contacts, force0 = problem.contacts, m.n + m.n_rows
    state0 = force0 + problem.m

    def port(k: int) -> set[int]:
        z, row = contacts.z_start, contacts.row
        forces = range(force0 + int(row[k]), force0 + int(row[k + 1]))
        return {*forces, *range(state0 + int(z[k]), state0 + int(z[k + 1]))}

    joint_ports = set()
    load_of = loads_of(m.joints)
    for j in range(len(m.joints.row) - 1):
        reactions = range(m.n + int(m.joints.row[j]), m.n + int(m.joints.row[j + 1]))
        mine = dofs.of_template(m.joints.table, j) | set(reactions)
        if m.joints.port[j] >= 0:
            joint_ports.add(int(m.joints.port[j]))
            mine |= port(int(m.joints.port[j]))
            mine |= set(range(m.n + int(m.joints.row[load_of[j]]), m.n + int(m.joints.row[load_of[j] + 1])))
        yield mine
    for k in set(range(problem.n_c)) - joint_ports:
        yield dofs.of_template(m.slip, k) | dofs.of_template(contacts.normal_table, k) | port(k)
