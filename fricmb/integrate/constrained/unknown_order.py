"""Which unknowns of a step meet in an equation, and an order of them that keeps the matrices narrow."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from fricmb.integrate.mechanism import Mechanism
from fricmb.integrate.model.band_ordering import narrow_order
from fricmb.integrate.problem import Ints, Problem, Templates


def ordering(problem: Problem, m: Mechanism, y_start: Ints, y_dof: Ints) -> tuple[Ints, int, Ints]:
    """Place of each unknown [v, lam, F, z] and the half-bandwidth: reverse Cuthill-McKee on the pattern.

    Last (n,) the group of each degree of freedom: what nothing ties together is in groups of its own.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    size = m.n + m.n_rows + problem.m + problem.n_z
    groups = [(i,) for i in range(size)] + [sorted(group) for group in _groups(problem, m, y_start, y_dof)]
    start = np.concatenate(([0], np.cumsum([len(group) for group in groups])))
    member = np.array([i for group in groups for i in group], dtype=np.int64)
    meets = csr_array((np.ones(len(member)), member, start), shape=(len(groups), size))
    pattern = (meets.T @ meets).tocoo()
    order = np.lexsort((pattern.col, pattern.row))
    place, half = narrow_order(pattern.row[order].astype(np.int64), pattern.col[order].astype(np.int64), size)
    tied = connected_components(pattern, directed=False)[1] if size else np.zeros(0)
    return place, half, np.unique(tied[: m.n], return_inverse=True)[1].astype(np.int64)


def _groups(problem: Problem, m: Mechanism, y_start: Ints, y_dof: Ints) -> Iterator[set[int]]:
    def dofs(extended: Iterable[int]) -> set[int]:
        return {int(d) for e in extended if 0 <= e < m.n_y for d in y_dof[y_start[e] : y_start[e + 1]]}

    def places(table: Templates, k: int) -> set[int]:
        first, last = table.x_start[k], table.x_start[k + 1]
        index = table.form_index[table.form_start[first] : table.form_start[last]] - 1
        return {int(i) for i in index if 0 <= i < m.n_y} | {int(i) - m.n_y for i in index if m.n_y <= i < 2 * m.n_y}

    for entries in (m.M, m.K, m.C):
        for i, j in zip(entries.row.tolist(), entries.column.tolist(), strict=True):
            yield dofs((i, j))
    for k in range(len(m.places.address)):
        yield {int(d) for d in m.places.dof[m.places.dof_start[k] : m.places.dof_start[k + 1]]}
    elements = problem.elements
    for k in range(len(elements.table.address)):
        spread = elements.spread_dof[
            elements.spread_start[elements.f_start[k]] : elements.spread_start[elements.f_start[k + 1]]
        ]
        yield dofs([*places(elements.table, k), *spread.tolist()])
    force0 = m.n + m.n_rows
    state0 = force0 + problem.m

    def port(k: int) -> set[int]:
        z, row = problem.contacts.z_start, problem.contacts.row
        forces = range(force0 + int(row[k]), force0 + int(row[k + 1]))
        return {*forces, *range(state0 + int(z[k]), state0 + int(z[k + 1]))}

    joint_ports = set()
    for j in range(len(m.joints.row) - 1):
        mine = dofs(places(m.joints.table, j)) | set(range(m.n + int(m.joints.row[j]), m.n + int(m.joints.row[j + 1])))
        if m.joints.port[j] >= 0:
            joint_ports.add(int(m.joints.port[j]))
            mine |= port(int(m.joints.port[j]))
        yield mine
    for k in set(range(problem.n_c)) - joint_ports:
        yield dofs(places(m.slip, k) | places(problem.contacts.normal_table, k)) | port(k)
