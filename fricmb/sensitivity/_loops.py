"""Contacts in a loop that let go together: their forces in stick are open, the instant at which they let go is not.

At that instant each of them pushes with all that it can.  With that friction on those that let go, the others sticking
as before, nothing moves yet: the relative acceleration vanishes there, and this is an event function that needs none of
the forces which are open.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.problem import Codes, Floats
from fricmb.integrate.trajectory import Samples
from fricmb.sensitivity._dual import Dual
from fricmb.sensitivity._equations import Equations
from fricmb.sensitivity._found import Found, at, whole
from fricmb.sensitivity._friction import Friction


def about_to_slip(
    e: Equations, samples: Samples, mode: Codes, sign: Floats, contacts: list[int]
) -> dict[int, tuple[float, Floats, float]] | None:
    """Relative acceleration of each contact that lets go, along its slip, with its slopes and size, at one time.

    ``mode`` (n_c,), ``sign`` (m,): those of the phase that begins.  The size is what friction at its limit makes of it.
    None in two directions and where rows vary.
    """
    if any(e.contacts[k].d > 1 for k in contacts):
        return None
    field = e.field(samples, mode[:, None], sign[:, None])
    rows = field.found.rows
    if any(isinstance(c, Dual) for k in contacts for _, c in rows[k][0]):
        return None
    W = np.zeros((e.n, len(contacts)))
    for r, k in enumerate(contacts):
        for i, c in rows[k][0]:
            W[i, r] += c
    free = e.free(field.found, mode, 0)
    along = np.array([float(sign[e.rows(k)][0]) for k in contacts])
    more = [_more(e.contacts[k], field.found, k, sign[e.rows(k)]) for k in contacts]
    value, slopes = whole(more, 1, e.columns)
    a = field.a[0] + free @ W @ value[0]
    a_slopes = field.a_slopes[0] + free @ W @ slopes[0]
    drift, drift_slopes = whole([field.found.drift[k][0] for k in contacts], 1, e.columns)
    g, g_slopes = along * (W.T @ a + drift[0]), along[:, None] * (W.T @ a_slopes + drift_slopes[0])
    limits = np.array([at(field.found.limit[k].value, 0) for k in contacts])
    size = np.abs(W.T @ free @ W) @ np.abs(limits)
    return {k: (float(g[r]), g_slopes[r], float(size[r])) for r, k in enumerate(contacts)}


def _more(contact: Friction, found: Found, k: int, sign: Floats) -> Dual:
    """What friction at its limit is more than that of slip, as a force."""
    slipping = contact.beginning(found.N[k], sign[:, None])[0]
    return found.limit[k] * -float(sign[0]) + slipping * -1.0
