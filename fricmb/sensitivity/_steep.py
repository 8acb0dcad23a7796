"""Friction that falls so steeply with the slip speed that errors of the run's own slip speed move derivatives."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fricmb.integrate.problem import SLIP
from fricmb.sensitivity._dual import Dual
from fricmb.sensitivity._equations import Equations
from fricmb.sensitivity._found import whole
from fricmb.sensitivity._mesh import Mesh, Stepper

#: Tolerances by which derivatives may be off without a word.
_SAID = 1e3


def steep(e: Equations, stepper: Stepper, mesh: Mesh) -> Iterator[tuple[int, float]]:
    """Contacts in one direction, and by how many tolerances of their size derivatives may be off for them.

    Where the slope mu' N D of friction changes by d while r changes at the rate r', a slip speed that is off by one
    tolerance of the largest, and so late or early by that over r', makes the map of states off by d times that time.
    """
    varying = [k for k in stepper.varying if e.contacts[k].d == 1]
    if not varying:
        return
    at = np.flatnonzero(stepper.poles.doubling(mesh.t, mesh.h, mesh.phase, stepper.varying))
    if not at.size:
        return
    edges, phase = np.concatenate([mesh.t[at], mesh.t[at] + mesh.h[at]]), np.tile(mesh.phase[at], 2)
    phases, largest = stepper.phases, np.abs(stepper.sample(stepper.phases.t).g).max(axis=1)
    found = e.field(stepper.sample(edges), phases.mode[:, phase], phases.sign[:, phase]).found
    for k in varying:
        g, slopes = whole(found.g[k], edges.size, e.columns)
        r, W = np.abs(g[:, 0]), slopes[0, 0, e.n : 2 * e.n]
        N = Dual(value=np.broadcast_to(found.N[k].value, r.shape))
        fall = e.contacts[k].coefficient_slope(r, N) * N.value * float(W @ e.inverse @ W)
        changes, passed = (np.abs(np.diff(x.reshape(2, -1), axis=0))[0] for x in (fall, r))
        slips = phases.mode[k, mesh.phase[at]] == SLIP
        off = float(np.sum(slips * mesh.h[at] * changes * largest[e.rows(k)].max() / np.maximum(passed, 1e-300)))
        if off > _SAID:
            yield k, off
