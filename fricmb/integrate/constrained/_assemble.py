"""Consistent initial values, and constraints that depend on one another: before a run, in numpy."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fricmb.errors import SceneError
from fricmb.integrate._mechanism import Mechanism
from fricmb.integrate._problem import Floats, Ints, Problem, Start
from fricmb.integrate.constrained._pack import mech_of, mechanism_of, moving_of
from fricmb.integrate.constrained._sample import constraints

#: Singular values this small beside the largest count as 0.
RANK = 1e-9
#: A constraint is satisfied to this part of the sizes that occur.
CLOSED = 1e-12
CORRECTIONS = 60


@dataclass(frozen=True, kw_only=True)
class Constrained:
    """Constraints phi (m,), their rates (m,) and Jacobian G (m, n) at a state."""

    phi: Floats
    rate: Floats
    G: Floats


def constraints_at(problem: Problem, t: float, q: Floats, v: Floats) -> Constrained:
    """The constraints at a state."""
    m, nc = mechanism_of(problem).n_rows, problem.n_c
    phi, rate, G = np.zeros(m), np.zeros(m), np.zeros((m, problem.n))
    k = moving_of(problem)
    F, N, g = np.zeros(nc), np.zeros(nc), np.zeros(nc)
    q, v = (np.array(x, dtype=float) for x in (q, v))
    constraints(mech_of(problem), k, float(t), q, v, np.zeros(m), F, N, g, phi, rate, G)
    return Constrained(phi=phi, rate=rate, G=G)


def mass_of(m: Mechanism) -> Floats:
    """Diagonal of the mass matrix (n,)."""
    mass = np.zeros(m.n)
    on = m.M.row == m.M.column
    np.add.at(mass, m.M.row[on], m.M.value[on])
    return mass


def names_of_rows(m: Mechanism, rows: Ints) -> list[str]:
    """Joints that own the rows, each once."""
    owner = np.searchsorted(m.joints.row, rows, side="right") - 1
    return list(dict.fromkeys(m.joints.names[i] for i in owner))


def consistent_start(problem: Problem, start: Start) -> tuple[Start, tuple[str, ...]]:
    """The start moved the least (in the norm of the mass matrix) onto the constraints, and notes on what moved.

    Raises
    ------
    SceneError
        Where the constraints cannot be satisfied; names the joints that stay open.
    """
    m = mechanism_of(problem)
    if not m.n_rows:
        return start, ()
    weight = 1.0 / np.sqrt(mass_of(m))
    q, v = np.array(start.q, float), np.array(start.v, float)
    q = _closed(problem, m, start.t, q, v, weight)
    there = constraints_at(problem, start.t, q, v)
    v = v - weight * np.linalg.lstsq(there.G * weight, there.rate, rcond=RANK)[0]
    left = np.abs(constraints_at(problem, start.t, q, v).rate)
    size = np.abs(there.G) @ np.abs(v) + np.abs(there.rate)
    if (left > 1e-9 * np.maximum(size, size.max(initial=0.0))).any():
        names = names_of_rows(m, np.flatnonzero(left > 1e-9 * size.max(initial=0.0)))
        raise SceneError(
            f"joints {_listed(names)}: no velocities satisfy them together at t = {start.t:g}; the motion they"
            " prescribe contradicts itself"
        )
    notes = [
        _moved(what, old, new, problem.dof_names)
        for what, old, new in (("positions", start.q, q), ("velocities", start.v, v))
    ]
    return replace(start, q=q, v=v), tuple(note for note in notes if note)


def _moved(what: str, old: Floats, new: Floats, names: tuple[str, ...]) -> str:
    change = np.abs(new - old)
    i = int(np.argmax(change)) if change.size else 0
    if not change.size or change[i] <= 1e-9 * max(np.abs(new).max(), np.abs(old).max()):
        return ""
    return (
        f"{what} at the start were moved by up to {change[i]:.3g} ({names[i]}: {old[i]:.6g} -> {new[i]:.6g}) to satisfy"
        " the joints"
    )


def _closed(problem: Problem, m: Mechanism, t: float, q: Floats, v: Floats, weight: Floats) -> Floats:
    """Positions on the constraints, by Gauss-Newton with the step halved where the constraints grow."""
    here = constraints_at(problem, t, q, v)
    last = np.inf
    for _ in range(CORRECTIONS):
        step = weight * np.linalg.lstsq(here.G * weight, here.phi, rcond=RANK)[0]
        size = float(np.abs(q).max(initial=0.0)) + float(np.abs(step).max(initial=0.0))
        if np.abs(step).max(initial=0.0) <= 4e-16 * size:
            break
        part, norm = 1.0, float(np.linalg.norm(here.phi))
        while part > 1e-6:
            there = constraints_at(problem, t, q - part * step, v)
            if np.linalg.norm(there.phi) <= norm:
                break
            part *= 0.5
        q, here = q - part * step, there
        change = float(np.abs(part * step).max())
        if change <= 1e-13 * size and change >= 0.5 * last:
            break
        last = change
    reach = np.abs(here.G) @ (np.abs(q) + np.abs(q).max(initial=0.0)) + 1e-300
    open_rows = np.flatnonzero(np.abs(here.phi) > CLOSED * np.maximum(reach, reach.max()))
    if open_rows.size:
        worst = int(np.argmax(np.abs(here.phi)))
        names = names_of_rows(m, open_rows)
        raise SceneError(
            f"the mechanism cannot be assembled: {_listed(names)} stay open by up to {abs(here.phi[worst]):.3g} "
            f"({names_of_rows(m, np.array([worst]))[0]}); bodies are too short or too far apart, or joints contradict "
            "one another"
        )
    return q


def _listed(names: list[str]) -> str:
    shown = ", ".join(repr(name) for name in names[:6])
    return shown + (f" and {len(names) - 6} more" if len(names) > 6 else "")


@dataclass(frozen=True, kw_only=True)
class Redundancy:
    """Rows that follow from the others, and the joints whose reactions are not determined for it."""

    rows: Ints
    joints: tuple[str, ...]


def redundancy(problem: Problem, start: Start) -> Redundancy:
    """Find constraints that depend on others throughout (not in this position alone).

    Rank by the singular values of ``G M^-1/2``; the rows to leave out by QR with column pivoting.  Where the rank is
    higher in a neighbouring position, the mechanism is in a singular position.

    Raises
    ------
    SceneError
        For a singular position at the start.
    """
    from scipy.linalg import qr

    m = mechanism_of(problem)
    if not m.n_rows:
        return Redundancy(rows=np.zeros(0, np.int64), joints=())
    weight = 1.0 / np.sqrt(mass_of(m))
    start, _ = consistent_start(problem, start)
    J = _scaled(constraints_at(problem, start.t, start.q, start.v).G * weight)
    rank = _rank(J)
    if rank == m.n_rows:
        return Redundancy(rows=np.zeros(0, np.int64), joints=())
    left = np.linalg.svd(J, full_matrices=True)[0][:, rank:]
    touched = names_of_rows(m, np.flatnonzero(np.abs(left).max(axis=1) > 1e-6))
    if _rank_nearby(problem, start, J, weight, rank) > rank:
        raise SceneError(
            f"the mechanism starts in a singular position: the constraints of {_listed(touched)} depend on one another "
            "there, and not in positions nearby; start it from another one"
        )
    order = qr(J.T, mode="r", pivoting=True)[1]
    return Redundancy(rows=np.sort(order[rank:]).astype(np.int64), joints=tuple(touched))


def _scaled(J: Floats) -> Floats:
    length = np.linalg.norm(J, axis=1, keepdims=True)
    return J / np.where(length > 0.0, length, 1.0)


def _rank(J: Floats) -> int:
    values = np.linalg.svd(J, compute_uv=False)
    return int((values > RANK * values.max(initial=0.0)).sum())


def _rank_nearby(problem: Problem, start: Start, J: Floats, weight: Floats, rank: int) -> int:
    """Rank after a small motion that the constraints allow (the same, where they allow none)."""
    free = np.linalg.svd(J, full_matrices=True)[2][rank:]
    if not len(free):
        return rank
    m = mechanism_of(problem)
    direction = weight * (np.random.default_rng(1).standard_normal(len(free)) @ free)
    length = 1e-3 * max(float(np.abs(start.q).max(initial=0.0)), 1e-300) / np.abs(direction).max()
    try:
        q = _closed(problem, m, start.t, start.q + length * direction, start.v, weight)
    except SceneError:
        return rank
    return _rank(_scaled(constraints_at(problem, start.t, q, start.v).G * weight))


def singular_joints(problem: Problem, t: float, q: Floats, v: Floats) -> list[str]:
    """Joints whose constraints are nearest to depending on one another."""
    m = mechanism_of(problem)
    J = _scaled(constraints_at(problem, t, q, v).G / np.sqrt(mass_of(m)))
    kept = np.flatnonzero(m.joints.dropped == 0)
    left = np.abs(np.linalg.svd(J[kept], full_matrices=False)[0][:, -1])
    return names_of_rows(m, kept[np.flatnonzero(left > 0.1 * left.max())])
