"""Which contacts are plain; the groups of all others, laws of slip speed, and the arrays for both."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricmb.integrate.array_cache import cached_by_content
from fricmb.integrate.compile.exchange import with_arrays
from fricmb.integrate.compile.piece import Pattern
from fricmb.integrate.compile.room import room
from fricmb.integrate.model.problem_structs import Table, table_of
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import LAW_COEFFICIENT, LAW_CONSTANT, Floats, Ints, Problem
from fricmb.integrate.run.workspace import empty_arrays
from fricmb.integrate.taylor.groups import SECOND, Groups
from fricmb.integrate.taylor.layout import PLAN

#: Most contacts of a group: its matrix is factorised as a full one whenever one of them changes its mode.
LARGEST = 200
#: Round-off of what a contact in two directions answers in one and in the other.
ISOTROPIC = 1e-12
#: A group's contacts that share their forces in more than one way: least pivot relative to the diagonal.
INDEPENDENT = 1e-9


def has_planar(problem: Problem) -> bool:
    """Whether a contact has two directions."""
    return problem.m > problem.n_c


def _labels(problem: Problem) -> tuple[int, Ints]:
    """Number of sets of rows on common dofs, or of one contact, and the set of every row."""
    W = problem.contacts.csr("W")
    rows, columns, n = W.rows, W.index, problem.n
    if has_planar(problem):
        # a contact holds its rows together as a dof would
        rows = np.concatenate([rows, n + problem.contacts.of_row])
        columns = np.concatenate([columns, np.arange(problem.m)])
        n += problem.n_c
    return _labels_of(rows, columns, n, problem.m)


@cached_by_content
def _labels_of(rows: Ints, columns: Ints, n: int, m: int) -> tuple[int, Ints]:
    if not (np.bincount(rows, minlength=1) > 1).any():
        return m, np.arange(m)
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    graph = csr_array((np.ones(len(rows)), (rows, n + columns)), shape=(n + m, n + m))
    _, label = connected_components(graph, directed=False)
    found, group = np.unique(label[n:], return_inverse=True)
    return len(found), group.astype(np.int64)


def plain_contacts(problem: Problem) -> NDArray[np.bool_]:
    """Contacts of one dof each, that no other is of, against belts of constant velocity, of constant coefficients."""
    return once_per(problem, "taylor plain", lambda: _plain_contacts(problem))


def _plain_contacts(problem: Problem) -> NDArray[np.bool_]:
    contacts, m = problem.contacts, problem.m
    W, Wu, law = contacts.csr("W"), contacts.csr("Wu"), contacts.law[problem.contacts.of_row]
    _, label = once_per(problem, "taylor labels", lambda: _labels(problem))
    plain = (np.bincount(W.index, minlength=m) == 1) & (np.diff(Wu.start) == 0) & (law == LAW_CONSTANT)
    return np.asarray(plain & (np.bincount(label)[label] == 1))


def against_groups(problem: Problem) -> str | None:
    """What stands against taking the contacts in groups, or None."""
    parts = group_statics(problem)
    sizes = np.diff(parts["group_start"])
    if (sizes > LARGEST).any():
        return f"{sizes.max()} contacts hold each other through common bodies (at most {LARGEST})"
    for gi in np.flatnonzero(sizes > 1):
        size = int(sizes[gi])
        G = parts["G"][parts["at"][gi] : parts["at"][gi] + size * size].reshape(size, size)
        if not np.diag(G).all():
            return "a contact slips in a direction in which its forces move nothing"
        scale = 1.0 / np.sqrt(np.diag(G))
        if np.linalg.eigvalsh(G * scale * scale[:, None])[0] < INDEPENDENT:
            return "contacts between the same bodies share their forces in more than one way"
    return _against_planes(problem, parts)


def _against_planes(problem: Problem, parts: dict[str, Any]) -> str | None:
    """What stands against the contacts in two directions, or None."""
    width = np.diff(problem.contacts.row)
    if (width > 2).any():
        return "every contact must slide along one direction or two"
    for k in np.flatnonzero(width == 2):
        name, gi = problem.contact_names[k], parts["group"][problem.contacts.row[k]]
        if parts["group_start"][gi + 1] - parts["group_start"][gi] > 2:
            return f"contact {name!r}, which slides in two directions, shares a body with another contact"
        G = parts["G"][parts["at"][gi] : parts["at"][gi] + 4]
        if max(abs(G[1]), abs(G[0] - G[3])) > ISOTROPIC * G[0]:
            return f"contact {name!r} does not answer to a force alike in all directions"
    return None


def _lists(label: Ints, count: int) -> tuple[Ints, Ints]:
    """Members of every label: start, members."""
    start = np.zeros(count + 1, dtype=np.int64)
    np.cumsum(np.bincount(label[label >= 0], minlength=count), out=start[1:])
    order = np.argsort(label, kind="stable")
    return start, order[np.count_nonzero(label < 0) :]


def group_statics(problem: Problem) -> dict[str, Any]:
    """Groups with their matrices, laws with their places."""
    return once_per(problem, "taylor groups", lambda: _group_statics(problem))


def _groups(problem: Problem) -> tuple[int, Ints]:
    """Number of groups, and the group of every row, -1 of plain contacts."""
    _, label = once_per(problem, "taylor labels", lambda: _labels(problem))
    return _groups_of(label, ~plain_contacts(problem))


@cached_by_content
def _groups_of(label: Ints, others: NDArray[np.bool_]) -> tuple[int, Ints]:
    group = np.full(len(label), -1, dtype=np.int64)
    found, group[others] = np.unique(label[others], return_inverse=True)
    return len(found), group


def _group_statics(problem: Problem) -> dict[str, Any]:
    contacts, m = problem.contacts, problem.m
    W = contacts.csr("W")
    count, group = _groups(problem)
    lawful = np.full(m, -1, dtype=np.int64)
    chosen = contacts.row[:-1][contacts.law == LAW_COEFFICIENT]
    lawful[chosen] = np.arange(len(chosen))
    owner, laws = problem.contacts.of_row, table_of(contacts.law_table)
    planar = np.full(m, -1, dtype=np.int64)
    first = contacts.row[:-1][np.diff(contacts.row) == 2]
    planar[first], planar[first + 1] = np.arange(len(first)), SECOND
    return {
        **_places(problem.linear.csr("M").diagonal(), W.rows, W.index, W.value, group, count), "lawful": lawful,
        "laws": laws._replace(address=laws.address[owner], p_start=laws.p_start[owner]),
        "N": np.asarray(contacts.N, dtype=float)[owner], "planar": planar,
    }  # fmt: skip


@cached_by_content
def _places(mass: Floats, dof: Ints, row: Ints, W: Floats, group: Ints, count: int) -> dict[str, Any]:
    """Members of each group, and its matrix G.

    Of W the entries ``W`` (.) with dof and row; ``group`` (m,) of every row among ``count``.
    """
    from scipy.sparse import coo_array, csr_array

    n, m, inverse = len(mass), len(group), 1.0 / mass
    dof_group = np.full(n, -1, dtype=np.int64)
    dof_group[dof] = group[row]
    group_start, group_contact = _lists(group, count)
    dof_start, group_dof = _lists(dof_group, count)
    at = np.zeros(count + 1, dtype=np.int64)
    np.cumsum(np.diff(group_start) ** 2, out=at[1:])
    place = np.zeros(m, dtype=np.int64)
    place[group_contact] = np.arange(len(group_contact)) - np.repeat(group_start[:-1], np.diff(group_start))
    G = np.zeros(at[-1])
    if count:
        rows = csr_array((W, (dof, row)), shape=(n, m))
        product = coo_array(rows.T @ csr_array((inverse[dof] * W, (dof, row)), shape=(n, m)))
        both = group[product.row] >= 0
        one, other = product.row[both], product.col[both]
        size = np.diff(group_start)[group[one]]
        G[at[group[one]] + place[one] * size + place[other]] = product.data[both]
    return {
        "group": group, "group_start": group_start, "group_contact": group_contact, "dof_start": dof_start,
        "group_dof": group_dof, "dof_group": dof_group, "at": at, "G": G,
    }  # fmt: skip


@lru_cache(maxsize=64)
def legendre_rule(count: int) -> tuple[Floats, Floats]:
    """Points in -1 to 1 and weights of Gauss and Legendre."""
    at, weights = np.polynomial.legendre.leggauss(count)
    return at, weights


@lru_cache(maxsize=64)
def _interpolation(degree: int) -> tuple[Floats, Floats]:
    """Chebyshev points, and the matrix from values there to coefficients."""
    angle = (np.arange(degree + 1) + 0.5) * np.pi / (degree + 1)
    fit = 2.0 / (degree + 1) * np.cos(np.outer(np.arange(degree + 1), angle))
    fit[0] *= 0.5
    return np.cos(angle), fit


def group_room(problem: Problem, P: int, widest: int) -> Groups:
    """All of it for polynomials of degree P and corrections of at most ``widest`` dofs."""
    statics = group_statics(problem)
    lawful = int(np.count_nonzero(statics["lawful"] >= 0))
    count, grouped = len(statics["group_start"]) - 1, len(statics["group_contact"])
    planes = int(np.count_nonzero(statics["planar"] >= 0))
    sizes = problem.m, P, count, grouped, len(statics["G"]), lawful, min(grouped, 4 * widest), planes
    work = _work_pattern(*sizes).zeros()
    work.arrays["slot"].fill(-1)
    codes = {
        "factored": np.full(grouped, -1, np.int8), "touched": np.zeros(count, np.int8),
        "begins": np.zeros(planes, np.int8),
        **{name: np.zeros(problem.m, np.int8) for name in ("rests", "before")},
    }  # fmt: skip
    given = {name: solid(value) for name, value in statics.items()} | codes
    groups = with_arrays(_blank(*sizes), **given | {"laws": room(statics["laws"])})
    _work_pattern(*sizes).put(groups, work)
    return groups


@lru_cache(maxsize=64)
def _work_pattern(
    m: int, P: int, count: int, grouped: int, entries: int, lawful: int, most: int, planes: int
) -> Pattern:
    """Arrays that a run works in, but for those of codes."""
    sums = (P + 3, P + 1)
    floats: dict[str, tuple[int, ...]] = {
        "F": (P - 1, m if grouped else 0), "L": (entries,), "rhs": (grouped,), "curve": (lawful, P + 1),
        "middle": (lawful,), "half": (lawful,), "rough": (lawful,), "values": (P + 1,), "work": (8,),
        "b": (lawful, *sums), "paid": (m,), "was": (most, P + 1), "dF": (P + 1, most),
        "local_b": (most if lawful else 0, *sums), "along": (2, 12), "unit": (planes, 2, P + 1),
        "first_speed": (planes,), "landing": (planes, PLAN), "square": (2 * P + 3,),
        **dict.fromkeys(("speed", "rubbing", "turned"), (planes, P + 1)),
    }  # fmt: skip
    whole = {"stuck": (grouped,), "n_stuck": (count,), "terms": (lawful,), "slot": (m,), "reached": (count,)}
    return Pattern(Groups, floats, {**whole, "here": (most,), "first": (most,)})


@lru_cache(maxsize=64)
def _blank(m: int, P: int, count: int, grouped: int, entries: int, lawful: int, most: int, planes: int) -> Groups:
    """A room with arrays to work in and rules; of groups and laws there is nothing."""
    arrays = empty_arrays(Groups) | _work_pattern(m, P, count, grouped, entries, lawful, most, planes).zeros().arrays
    at, weights = legendre_rule(P)
    nodes, fit = _interpolation(P)
    rules = {"nodes": nodes, "fit": fit, "rule": np.stack([0.5 * (at + 1.0), 0.5 * weights])}
    given = {name: solid(array) for name, array in (arrays | rules).items()}
    return room(Groups(**given, laws=Table(**empty_arrays(Table))))


def solid(x: Any) -> Any:
    """An array as kernels take it."""
    if not isinstance(x, np.ndarray):
        return x
    return np.ascontiguousarray(x, dtype=None if x.dtype in (np.int8, np.float64) else np.int64)
