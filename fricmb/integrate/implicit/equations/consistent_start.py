"""Consistent initial values of a mechanism."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fricmb.errors import SceneError
from fricmb.integrate.implicit.equations.least_change import (
    Constrained,
    Least,
    constraints_at,
    names_of_rows,
    unit_rows,
)
from fricmb.integrate.implicit.scene.problem_structs import masses
from fricmb.integrate.implicit.scene.structure import mechanism_of, with_open
from fricmb.integrate.mechanism import RIGID, Mechanism
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import Codes, Floats, Problem, Start

#: A constraint is satisfied to this part of the sizes that occur.
CLOSED = 1e-12
CORRECTIONS = 60
#: Distance at which something rigid is touched, and depth by which it may be entered at the start, beside positions.
TOUCHES, CLOSED_RIGID = 1e-12, 1e-9


def consistent_start(problem: Problem, start: Start) -> tuple[Start, tuple[str, ...]]:
    """The start moved the least (in the norm of the mass matrix) onto the constraints, and notes on what moved.

    Raises
    ------
    SceneError
        Where the constraints cannot be satisfied; names the joints that stay open.
    """
    if not mechanism_of(problem).n_rows:
        return start, ()
    found = assembled(problem, start)
    return replace(start, q=found.q.copy(), v=found.v.copy()), found.notes


@dataclass(frozen=True, kw_only=True)
class Assembled:
    """Positions and velocities (n,) that satisfy the constraints, their Jacobian there, and notes on what moved."""

    q: Floats
    v: Floats
    G: Any
    notes: tuple[str, ...]


def assembled(problem: Problem, start: Start) -> Assembled:
    """What :func:`consistent_start` finds, with the Jacobian; raises as that."""
    q, v = np.array(start.q, float), np.array(start.v, float)
    key = ("start", start.t, q.tobytes(), v.tobytes())
    return once_per(problem, key, lambda: _assembled(problem, start.t, q, v))


def _assembled(problem: Problem, t: float, q: Floats, v: Floats) -> Assembled:
    m, old = mechanism_of(problem), (q, v)
    weight = 1.0 / np.sqrt(masses(m))
    q, there = closed(problem, m, t, q, v, weight)
    change = least_change(there.G, weight, there.rate)
    v = v - change
    left = np.abs(there.rate - there.G @ change)  # rates are linear in velocities
    size = abs(there.G) @ np.abs(v) + np.abs(there.rate)
    if (left > 1e-9 * np.maximum(size, size.max(initial=0.0))).any():
        names = names_of_rows(m, np.flatnonzero(left > 1e-9 * size.max(initial=0.0)))
        raise SceneError(
            f"joints {listed(names)}: no velocities satisfy them together at t = {t:g}; the motion they"
            " prescribe contradicts itself"
        )
    notes = [
        _note_of_change(what, before, now, problem.dof_names)
        for what, before, now in zip(("positions", "velocities"), old, (q, v), strict=True)
    ]
    return Assembled(q=q, v=v, G=there.G, notes=tuple(note for note in notes if note))


def away(problem: Problem, start: Start) -> Codes:
    """Which joints that may open (n_j,) are open at a start: their points are away from the surface, or leave it."""
    joints = mechanism_of(problem).joints
    opened = np.zeros(len(joints.port), np.int8)
    if joints.hands_over.any():
        here = distances_at(problem, start)
        may = np.flatnonzero(joints.hands_over)
        row, rigid = joints.row[may], joints.hands_over[may] == RIGID
        size, speed = (max(float(np.abs(x).max(initial=0.0)), 1e-300) for x in (start.q, start.v))
        far = here.phi[row] > np.where(rigid, TOUCHES, 1e-9) * size
        # what is rigid is met by an impact
        rate = np.where(rigid, np.abs(here.rate[row]), here.rate[row])
        opened[may] = far | (rate > 1e-9 * speed)
    return opened


def distances_at(problem: Problem, start: Start) -> Constrained:
    """Constraints at a start, those of joints that are open as well."""
    none = np.zeros(len(mechanism_of(problem).joints.port), np.int8)
    held = once_per(problem, "all held", lambda: with_open(problem, none))
    return constraints_at(held, start.t, np.asarray(start.q, float), np.asarray(start.v, float))


def check_apart(problem: Problem, start: Start) -> None:
    """Refuse, by SceneError, a start at which something is inside of what is rigid."""
    m = mechanism_of(problem)
    if not m.has_impacts:
        return
    phi = distances_at(problem, start).phi[np.minimum(m.joints.row[:-1], m.n_rows - 1)]
    deep = np.where(m.joints.hands_over == RIGID, phi, 0.0)
    size = max(float(np.abs(start.q).max(initial=0.0)), 1e-300)
    if deep.min(initial=0.0) < -CLOSED_RIGID * size:
        j = int(np.argmin(deep))
        raise SceneError(f"{m.joints.names[j]!r} is rigid, and the run starts {-deep[j]:.6g} inside of it")


def least_change(G: object, weight: Floats, r: Floats) -> Floats:
    """The change x (n,) with ``G x = r`` that is least in the norm of the mass matrix; ``weight``: its -1/2 power."""
    J, length = unit_rows(G, weight)
    change: Floats = weight * Least(J).change(r / length)
    return change


def _note_of_change(what: str, old: Floats, new: Floats, names: tuple[str, ...]) -> str:
    change = np.abs(new - old)
    i = int(np.argmax(change)) if change.size else 0
    if not change.size or change[i] <= 1e-9 * max(np.abs(new).max(), np.abs(old).max()):
        return ""
    return (
        f"{what} at the start were moved by up to {change[i]:.3g} ({names[i]}: {old[i]:.6g} -> {new[i]:.6g}) to satisfy"
        " the joints"
    )


def closed(
    problem: Problem, m: Mechanism, t: float, q: Floats, v: Floats, weight: Floats
) -> tuple[Floats, Constrained]:
    """Positions on the constraints, and these there, by Gauss-Newton with the step halved where the constraints grow.

    Raises
    ------
    SceneError
        Where they stay open.
    """
    here = constraints_at(problem, t, q, v)
    last = np.inf
    for _ in range(CORRECTIONS):
        step = least_change(here.G, weight, here.phi)
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
    reach = abs(here.G) @ (np.abs(q) + np.abs(q).max(initial=0.0)) + 1e-300
    open_rows = np.flatnonzero(np.abs(here.phi) > CLOSED * np.maximum(reach, reach.max()))
    if open_rows.size:
        worst = int(np.argmax(np.abs(here.phi)))
        names = names_of_rows(m, open_rows)
        raise SceneError(
            f"the mechanism cannot be assembled: {listed(names)} stay open by up to {abs(here.phi[worst]):.3g} "
            f"({names_of_rows(m, np.array([worst]))[0]}); bodies are too short or too far apart, or joints contradict "
            "one another"
        )
    return q, here


def listed(names: list[str]) -> str:
    """Names for a message."""
    shown = ", ".join(repr(name) for name in names[:6])
    return shown + (f" and {len(names) - 6} more" if len(names) > 6 else "")
