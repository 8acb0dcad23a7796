"""Whether contacts had to let go: the friction that would have held them, from the equations of motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.field._motions import Moment, Row
from fricmb.field._parts import Found
from fricmb.field._statements import Statements
from fricmb.integrate.problem import Floats

#: More degrees of freedom or rows than this are not solved for.
MOST = 400
#: A difference over this share of the time scale stands for a derivative.
_STEP = 1e-5
#: Least share of the time itself for that: beside it a first step of a run may be too short to be told.
_LEAST = 1e-9
#: Singular values this small beside 1 are 0; sides of the pyramid for a cone, rounds in which loads come in anew.
_RANK, _SIDES, _ROUNDS = 1e-9, 64, 6


def _matrix(rows: Sequence[Row], n: int, j: int) -> Floats:
    """Rows (len, n) at time number j."""
    found = np.zeros((len(rows), n))
    for r, row in enumerate(rows):
        for i, c in row:
            found[r, i] += c if np.ndim(c) == 0 else c[j]
    return found


def _rates(found: Found, joints: Sequence[str], contacts: Sequence[int]) -> Floats:
    """Slip velocities of contacts, then rates of constraints (m, n_t)."""
    parts = [found.g[k] for k in contacts] + [found.phi_dot[name] for name in joints]
    return np.concatenate(parts) if parts else np.zeros((0, 0))


@dataclass(frozen=True, kw_only=True)
class Held:
    """Forces x of contacts ``contacts`` and joints that hold: ``D x = rhs``, rows of D scaled to 1 by ``size`` (m,).

    ``free``: the moment without these forces.
    """

    contacts: Sequence[int]
    free: Moment
    D: Floats
    rhs: Floats
    size: Floats

    @property
    def is_determined(self) -> bool:
        """Whether the forces are."""
        return int(np.linalg.matrix_rank(self.D, tol=_RANK)) == len(self.rhs)


def held_together(statements: Statements, moment: Moment, held: Sequence[int], h: float) -> Held | None:
    """What holds contacts at the one time of ``moment``, the friction of all others being the moment's.

    ``h``: a time over which the motion changes.  None where that is not solved for.
    """
    names, joints = statements.names, [joint.name for joint in statements.joints]
    n = len(names.dofs)
    free = Moment(**{**_fields(moment), "F": moment.F.copy(), "lam": {j: 0.0 * x for j, x in moment.lam.items()}})
    for c in held:
        free.F[names.row[c] : names.row[c + 1]] = 0.0
    found = statements.found(free)
    rows = [row for c in held for row in found.rows[c]] + [row for j in joints for row in found.phi_rows[j]]
    if max(n, len(rows)) > MOST or not statements.mass.all():  # (an axis of a flat body has no mass)
        return None
    M = np.diag(statements.mass)
    for at, part in statements.mass_matrices:
        M[np.ix_(at, at)] += part if isinstance(part, np.ndarray) else part.toarray()
    W = _matrix(rows, n, 0)
    step = max(_STEP * h, _LEAST * abs(float(moment.t[0])))
    ahead = Moment(**{**_fields(free), "t": free.t + step, "q": free.q + step * free.v})
    drift = (_rates(statements.found(ahead), joints, held) - _rates(found, joints, held))[:, 0] / step
    solved = np.linalg.solve(M, np.column_stack([found.force[:, 0], W.T]))
    D = W @ solved[:, 1:]
    size = np.sqrt(np.abs(np.diag(D))) + 1e-300
    rhs = -(W @ solved[:, 0] + drift) / size
    return Held(contacts=held, free=free, D=D / np.outer(size, size), rhs=rhs, size=size)


def holding(
    statements: Statements, moment: Moment, k: int, stuck: Sequence[int], h: float
) -> tuple[Floats, float] | None:
    """Friction (d,) that would hold contact k at the one time of ``moment``, and its normal force.

    ``stuck``: contacts that are held together with it; the friction of all others is the moment's.  ``h``: a time over
    which the motion changes.  None where the friction is not determined.
    """
    held = held_together(statements, moment, [k, *(other for other in stuck if other != k)], h)
    if held is None or not held.is_determined:
        return None
    force = np.linalg.solve(held.D, held.rhs) / held.size
    row = statements.names.row
    return force[: row[k + 1] - row[k]], float(loads(statements, held, force)[k][0])


def loads(statements: Statements, held: Held, force: Floats) -> dict[int, Floats]:
    """Normal forces of all contacts under forces (m,) of what holds."""
    free, row = held.free, statements.names.row
    if not statements.joints:
        return statements.found(free).N
    at, lam = sum(int(row[c + 1] - row[c]) for c in held.contacts), {}
    for joint in statements.joints:
        count = len(free.lam[joint.name])
        lam[joint.name], at = force[at : at + count, None], at + count
    return statements.found(Moment(**{**_fields(free), "lam": lam})).N


def group_spare(statements: Statements, moment: Moment, held: Sequence[int], h: float) -> float | None:
    """What a group has to spare that holds by more forces than are determined, in parts of its limits.

    Of all shares those are taken with the most to spare, each force within its own cone: above 0 it can hold.  Cones of
    two directions are taken as pyramids within them, and loads that bend as their tangents, so that the answer is on
    the safe side.  None where the forces are determined, or nothing holds whatever the limits.
    """
    group = held_together(statements, moment, held, h)
    if group is None or group.is_determined:
        return None
    u, sigma, vt = np.linalg.svd(group.D)
    some = sigma > _RANK * sigma[0]
    x = vt[some].T @ ((u[:, some].T @ group.rhs) / sigma[some])
    if np.abs(group.D @ x - group.rhs).max() > 1e-6 * np.abs(group.rhs).max():
        return None
    force, shares = x / group.size, vt[~some].T / group.size[:, None]
    spare = -np.inf
    for _ in range(_ROUNDS):
        least, change = _program(statements, group, force, shares)
        if change is None or least <= spare + 1e-9:
            break
        spare, force = least, force + change
    return float(spare) if np.isfinite(spare) else None


def _program(statements: Statements, group: Held, force: Floats, shares: Floats) -> tuple[float, Floats | None]:
    """Most to spare, and the shares (m,) that have it, by linear programming; loads as their tangents at ``force``."""
    from scipy.optimize import linprog

    row, at, lines, bounds = statements.names.row, 0, [], []
    now, r = loads(statements, group, force), shares.shape[1]
    step = 1e-6 * (np.abs(force).max() + 1e-300)
    unit = shares / np.abs(shares).max(axis=0)
    moved = [loads(statements, group, force + step * unit[:, j]) for j in range(r)]
    top = max(float(statements.contacts[c].limit(now[c])[0]) for c in group.contacts)
    for c in group.contacts:
        law, d = statements.contacts[c], int(row[c + 1] - row[c])
        limit = float(law.limit(now[c])[0])
        slope = np.array([(float(law.limit(other[c])[0]) - limit) / step for other in moved])
        size = max(abs(limit), 1e-3 * top) + 1e-300
        for e in _directions(d):
            lines.append(np.append((e @ unit[at : at + d] - slope) / size, 1.0))
            bounds.append((limit - e @ force[at : at + d]) / size)
        at += d
    far = 10.0 * (np.abs(force).max() + top)
    box = [(-far, far)] * r + [(None, 1.0)]
    solved = linprog(np.append(np.zeros(r), -1.0), A_ub=np.array(lines), b_ub=bounds, bounds=box)
    if solved.x is None or solved.status != 0:
        return -np.inf, None
    found: Floats = unit @ solved.x[:-1]
    return float(solved.x[-1]), found


def _directions(d: int) -> Floats:
    """Normals of the sides of a pyramid within a cone of d directions, so long that its edges are in the cone."""
    if d == 1:
        return np.array([[1.0], [-1.0]])
    if d == 2:
        angle = 2.0 * np.pi * np.arange(_SIDES) / _SIDES
        sides: Floats = np.column_stack([np.cos(angle), np.sin(angle)]) / np.cos(np.pi / _SIDES)
        return sides
    corners: Floats = np.array(np.meshgrid(*[[-1.0, 1.0]] * d), dtype=float).reshape(d, -1).T
    return corners


def _fields(moment: Moment) -> dict[str, Any]:
    return {name: value for name, value in vars(moment).items() if name != "_places"}
