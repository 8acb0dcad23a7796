"""Derivatives where contacts stick or rest at the start of a run."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.problem import SLIP, STICK, Codes, Floats, Ints
from fricmb.sensitivity._equations import Equations
from fricmb.sensitivity._found import Found, total, whole


def held(e: Equations, found: Found, i: int, mode: Codes, S: Floats) -> Floats:
    """Derivatives where what sticks keeps sticking, as if it had just come to rest; ``i``: which time of ``found``."""
    stuck = [k for k, contact in e.contacts.items() if not contact.smooth and mode[k] == STICK]
    if not stuck:
        return S
    _, slopes = whole([g for k in stuck for g in found.g[k]], found.force.shape[1], e.columns)
    _, B, _ = e.projector(found, stuck, i)
    stopped = S.copy()
    stopped[e.n : 2 * e.n] -= B @ total(slopes[i], S, e.n_y)
    return stopped


def one_sided(e: Equations, found: Found, mode: Codes, S: Floats) -> dict[str, Ints]:
    """Contacts at rest at the start that slip from there on, and the columns of S that give them a speed.

    A speed along the slip that begins and one against it are not two sides of one thing: there is no derivative.
    """
    sides = {}
    for k, contact in e.contacts.items():
        g, slopes = whole(found.g[k], 1, e.columns)
        if contact.smooth or mode[k] != SLIP or np.any(np.abs(g) > 1e-14):
            continue
        columns = np.flatnonzero(np.any(np.abs(total(slopes[0], S, e.n_y)) > 1e-14, axis=0))
        if columns.size:
            sides[contact.name] = columns
    return sides
