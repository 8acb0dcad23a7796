"""What the tolerance of a run allows: units that residuals are measured by."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from fricmb.field._motions import Moment
from fricmb.field._statements import Statements
from fricmb.integrate.problem import Floats
from fricmb.integrate.run.chunked_run import take
from fricmb.integrate.trajectory import Samples

#: Round-off of a value, relative to its size.
ROUND_OFF = 4e-15
#: What moves by less than this share of what friction could do in a step rests.
RESTS = 1e-3
#: A dense output may be off by so many times more than the ends of steps: in many methods it is of a lower order.
DENSE = 10.0


@dataclass(frozen=True, kw_only=True)
class Units:
    """Error that the tolerance allows in positions, velocities (n,), law states (n_z,), forces (m,), all of the run.

    ``lam``: of joints' reactions by name; ``loss`` of friction losses (n_c,).
    """

    q: Floats
    v: Floats
    z: Floats
    F: Floats
    loss: Floats
    rtol: float

    def perturbed(self, moment: Moment, rng: np.random.Generator) -> Moment:
        """The moment with every value off by its unit, up or down at random."""

        def off(values: Floats, unit: Floats) -> Floats:
            signs = rng.choice((-1.0, 1.0), size=values.shape)
            found: Floats = values + signs * np.maximum(unit[:, None], ROUND_OFF * np.abs(values))
            return found

        lam = {name: off(rows, _largest(rows) * self.rtol) for name, rows in moment.lam.items()}
        return replace(
            moment, q=off(moment.q, self.q), v=off(moment.v, self.v), z=off(moment.z, self.z),
            F=off(moment.F, self.F), lam=lam, _places={},
        )  # fmt: skip


def _largest(values: Floats) -> Floats:
    found: Floats = np.abs(values).max(axis=1, initial=0.0)
    return found


def units_of(rows: Samples, scale: Floats, rtol: float, atol: Any = None) -> Units:
    """Units of a run from its rows; ``scale`` (m, 1) takes their forces to those of the user, ``atol`` is a floor."""
    q, v = rtol * _largest(rows.q), rtol * _largest(rows.v)
    if atol is not None:
        floor = np.asarray(atol, dtype=float)
        low, high = np.split(floor if floor.size == 2 * len(q) else np.repeat(np.resize(floor, 2), len(q)), 2)
        q, v = np.maximum(q, low), np.maximum(v, high)
    # what is open all the time, or sticks without a force, has no size of its own, but the round-off of others
    size = _largest(rows.F * scale)
    top = float(size.max(initial=np.abs(rows.N).max(initial=0.0)))
    F = np.maximum(rtol * size, ROUND_OFF * top)
    span = float(rows.t[-1] - rows.t[0]) if rows.t.size else 0.0
    power = top * float(np.abs(rows.g).max(initial=0.0))
    loss = np.maximum(rtol * _largest(rows.friction_loss), ROUND_OFF * power * span)
    return Units(q=q, v=v, z=rtol * _largest(rows.z), F=F, loss=loss, rtol=rtol)


def at_rest(units: Units, statements: Statements, rows: Samples) -> Units:
    """Units at least as large as what an error of friction makes of a step: the floor for what all but rests."""
    if rows.t.size < 2:
        return units
    found = statements.found(statements.moment(take(rows, [0])))
    push, h = np.zeros(len(units.v)), float((rows.t[-1] - rows.t[0]) / np.unique(rows.t).size)
    for k, own in found.rows.items():
        # an error of direction is as large as one of size
        force = float(units.F[statements.names.row[k] : statements.names.row[k + 1]].max(initial=0.0))
        for row in own:
            for i, c in row:
                push[i] += abs(float(np.ravel(c)[0])) * force
    v = push / np.where(statements.weight > 0.0, statements.weight, np.inf) * h
    # of what moves its own size counts, however little friction it would take to move it
    v = np.where(units.v < RESTS * v, v, 0.0)
    loss = (
        np.array([float(units.F[a:b].sum()) for a, b in pairwise(statements.names.row)]) * float(v.max(initial=0.0)) * h
    )
    return replace(units, v=np.maximum(units.v, v), q=np.maximum(units.q, v * h), loss=np.maximum(units.loss, loss))
