"""Whether a contact had to let go: the friction that would have held it, from the equations of motion."""

from __future__ import annotations

from collections.abc import Sequence
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


def holding(
    statements: Statements, moment: Moment, k: int, stuck: Sequence[int], h: float
) -> tuple[Floats, float] | None:
    """Friction (d,) that would hold contact k at the one time of ``moment``, and its normal force.

    ``stuck``: contacts that are held together with it; the friction of all others is the moment's.  ``h``: a time over
    which the motion changes.  None where the friction is not determined.
    """
    held = [k, *(other for other in stuck if other != k)]
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
    step = _STEP * h
    ahead = Moment(**{**_fields(free), "t": free.t + step, "q": free.q + step * free.v})
    drift = (_rates(statements.found(ahead), joints, held) - _rates(found, joints, held))[:, 0] / step
    solved = np.linalg.solve(M, np.column_stack([found.force[:, 0], W.T]))
    D = W @ solved[:, 1:]
    size = np.sqrt(np.abs(np.diag(D))) + 1e-300
    scaled = D / np.outer(size, size)
    if np.linalg.matrix_rank(scaled, tol=1e-9) < len(rows):
        return None
    force = -np.linalg.solve(scaled, (W @ solved[:, 0] + drift) / size) / size
    d = len(found.rows[k])
    if joints:
        at, lam = sum(len(found.rows[c]) for c in held), {}
        for j in joints:
            count = len(found.phi_rows[j])
            lam[j], at = force[at : at + count, None], at + count
        found = statements.found(Moment(**{**_fields(free), "lam": lam}))
    return force[:d], float(found.N[k][0])


def _fields(moment: Moment) -> dict[str, Any]:
    return {name: value for name, value in vars(moment).items() if name != "_places"}
