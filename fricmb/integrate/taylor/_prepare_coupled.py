"""Contacts that touch the same bodies, in groups; laws of slip speed; the arrays for both."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from fricmb.integrate.model.problem_structs import _table
from fricmb.integrate.problem import LAW_COEFFICIENT, LAW_CONSTANT, Floats, Ints, Problem, Templates
from fricmb.integrate.run.problem_cache import kept
from fricmb.integrate.taylor._coupled import Coupled

#: Most contacts of a group: its matrix is factorised as a full one whenever one of them changes its mode.
LARGEST = 200
#: A group's contacts that share their forces in more than one way: least pivot relative to the diagonal.
INDEPENDENT = 1e-9


def groups_of(problem: Problem) -> tuple[int, Ints]:
    """Number of groups, and the group of every contact: those on common dofs are one."""
    return kept(problem, "taylor groups", lambda: _groups_of(problem))


def _groups_of(problem: Problem) -> tuple[int, Ints]:
    W = problem.contacts.csr("W")
    n, m = problem.n, problem.n_c
    if not (np.bincount(W.rows, minlength=1) > 1).any():
        return m, np.arange(m)
    graph = csr_array((np.ones(len(W.value)), (W.rows, n + W.index)), shape=(n + m, n + m))
    _, label = connected_components(graph, directed=False)
    found, group = np.unique(label[n:], return_inverse=True)
    return len(found), group.astype(np.int64)


def is_coupled(problem: Problem) -> bool:
    """Whether contacts touch each other, or friction depends on slip speed."""
    return groups_of(problem)[0] < problem.n_c or bool((problem.contacts.law != LAW_CONSTANT).any())


def against_groups(problem: Problem) -> str | None:
    """What stands against taking the contacts in groups, or None."""
    count, group = groups_of(problem)
    if count == problem.n_c:
        return None
    largest = int(np.bincount(group).max())
    if largest > LARGEST:
        return f"{largest} contacts hold each other through common bodies (at most {LARGEST})"
    parts = coupled_statics(problem, 1.0 / problem.linear.csr("M").diagonal())
    for gi in np.flatnonzero(np.bincount(group) > 1):
        size = int(parts["group_start"][gi + 1] - parts["group_start"][gi])
        G = parts["G"][parts["at"][gi] : parts["at"][gi] + size * size].reshape(size, size)
        scale = 1.0 / np.sqrt(np.diag(G))
        if np.linalg.eigvalsh(G * scale * scale[:, None])[0] < INDEPENDENT:
            return "contacts between the same bodies share their forces in more than one way"
    return None


def _lists(label: Ints, count: int) -> tuple[Ints, Ints]:
    """Members of every label: start, members."""
    start = np.zeros(count + 1, dtype=np.int64)
    np.cumsum(np.bincount(label[label >= 0], minlength=count), out=start[1:])
    order = np.argsort(label, kind="stable")
    return start, order[np.count_nonzero(label < 0) :]


def coupled_statics(problem: Problem, inverse: Floats) -> dict[str, Any]:
    """Groups with their matrices, laws with their places."""
    return kept(problem, "taylor coupled", lambda: _coupled_statics(problem, inverse))


def _coupled_statics(problem: Problem, inverse: Floats) -> dict[str, Any]:
    contacts, n, m = problem.contacts, problem.n, problem.n_c
    count, group = groups_of(problem)
    W = contacts.csr("W")
    dof_group = np.full(n, -1, dtype=np.int64)
    dof_group[W.rows] = group[W.index]
    group_start, group_contact = _lists(group, count)
    dof_start, group_dof = _lists(dof_group, count)
    at = np.zeros(count + 1, dtype=np.int64)
    np.cumsum(np.diff(group_start) ** 2, out=at[1:])
    place = np.empty(m, dtype=np.int64)
    place[group_contact] = np.arange(m) - np.repeat(group_start[:-1], np.diff(group_start))
    G = np.zeros(at[-1])
    for j in np.flatnonzero(np.diff(W.start)):
        part = slice(W.start[j], W.start[j + 1])
        c, w = W.index[part], W.value[part]
        gi = group[c[0]]
        size = group_start[gi + 1] - group_start[gi]
        np.add.at(G, at[gi] + place[c][:, None] * size + place[c], inverse[j] * w[:, None] * w)
    lawful = np.full(m, -1, dtype=np.int64)
    chosen = np.flatnonzero(contacts.law == LAW_COEFFICIENT)
    lawful[chosen] = np.arange(len(chosen))
    return {
        "group": group, "group_start": group_start, "group_contact": group_contact, "dof_start": dof_start,
        "group_dof": group_dof, "dof_group": dof_group, "at": at, "G": G, "lawful": lawful,
        "laws": _table(contacts.law_table), "N": np.asarray(contacts.N, dtype=float),
    }  # fmt: skip


def _interpolation(degree: int) -> tuple[Floats, Floats]:
    """Chebyshev points, and the matrix from values there to coefficients."""
    angle = (np.arange(degree + 1) + 0.5) * np.pi / (degree + 1)
    fit = 2.0 / (degree + 1) * np.cos(np.outer(np.arange(degree + 1), angle))
    fit[0] *= 0.5
    return np.cos(angle), fit


def coupled_arrays(problem: Problem, P: int, widest: int, statics: dict[str, Any]) -> Coupled:
    """All of it for polynomials of degree P and corrections of at most ``widest`` dofs."""
    i, z, m = np.int64, np.zeros, problem.n_c
    D = P
    at, weights = np.polynomial.legendre.leggauss(P)
    nodes, fit = _interpolation(D)
    chosen = int(np.count_nonzero(statics["lawful"] >= 0))
    count = len(statics["group_start"]) - 1
    cap = min(m, 4 * widest)
    arrays = {
        **statics, "F": z((P - 1, m)), "L": z(len(statics["G"])), "stuck": z(m, i), "n_stuck": z(count, i),
        "factored": np.full(m, -1, np.int8), "rhs": z(m), "curve": z((chosen, D + 1)), "middle": z(chosen),
        "half": z(chosen), "terms": z(chosen, i), "rough": z(chosen), "nodes": nodes, "fit": fit,
        "values": z(D + 1), "work": z(8), "b": z((chosen, D + 3, P + 1)), "paid": z(m),
        "paid_dof": z(problem.n),
        "rule": np.stack([0.5 * (at + 1.0), 0.5 * weights]), "slot": np.full(m, -1, i), "here": z(cap, i),
        "groups": z(count, i), "touched": z(m, np.int8), "was": z((cap, P + 1)), "dF": z((P + 1, cap)),
        "local_b": z((cap if chosen else 0, D + 3, P + 1)), "first": z(cap, i),
    }  # fmt: skip
    return _solid_tuple(arrays)


def nothing_coupled() -> Coupled:
    """For scenes that need none of it."""
    arrays: dict[str, Any] = {"laws": _table(Templates())}
    for name, note in Coupled.__annotations__.items():
        kind = str(getattr(note, "__forward_arg__", note))
        if name != "laws":
            axes = int(kind[-1]) if kind[-1].isdigit() else 1
            dtype = np.int64 if kind.startswith("Ints") else np.int8 if kind.startswith("Codes") else np.float64
            arrays[name] = np.zeros((0,) * axes, dtype)
    return _solid_tuple(arrays)


def _solid_tuple(arrays: dict[str, Any]) -> Coupled:
    def solid(x: Any) -> Any:
        return np.ascontiguousarray(x) if isinstance(x, np.ndarray) else x

    return Coupled(**{name: solid(arrays[name]) for name in Coupled._fields})
