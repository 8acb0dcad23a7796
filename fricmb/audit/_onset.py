"""The beginning of slip under friction that falls with speed: growth on the scale of the law.

Where friction falls at the rate s with the slip speed, slip grows like exp(D s t) after break-away, and an error of the
beginning grows with it.  It is measured by what it makes of the end of that growth.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.audit._gather import Gathered
from fricmb.audit._points import row_unit
from fricmb.audit._release import _matrix
from fricmb.audit._transitions import opening
from fricmb.audit._units import DENSE, Units
from fricmb.field._contacts import Rubs
from fricmb.field._statements import Statements
from fricmb.integrate.problem import Floats
from fricmb.integrate.trajectory import Samples

#: Times after break-away, in times of growth, between which the motion is compared with its equations.
_TIMES = (0.0, 0.3, 1.0, 2.0, 4.0)
_ONSETS, _NODES = 40, 12


def look(statements: Statements, units: Units, gathered: Gathered, rows: Samples, sample: Any, events: Any) -> None:
    """Every contact with two rows at its break-away."""
    for k, law in statements.contacts.items():
        if law.smooth or len(statements.names.directions[k]) > 1 or statements.mass_matrices or statements.joints:
            continue  # without a solution for D; the equations of motion are looked at all the same
        begins, own = opening(rows, k), np.asarray(events.of(contact=law.name).t)
        for t in begins[:: max(1, -(-begins.size // _ONSETS))].tolist():
            later = own[own > t]
            end = float(later[0]) if later.size else float(rows.t[-1])
            _one(k, law, t, end, statements, units, gathered, rows, sample, np.asarray(events.t))


def _one(
    k: int, law: Rubs, t: float, t_end: float, s: Statements, units: Units, gathered: Gathered, rows: Samples,
    sample: Any, kinks: Floats,
) -> None:  # fmt: skip
    """One slip from t to t_end, where it ends or turns round; ``kinks``: transitions of all contacts."""
    within = slice(int(np.searchsorted(rows.t, t, side="right")), int(np.searchsorted(rows.t, t_end, side="right")))
    if within.stop <= within.start:
        return
    begin = s.moment(sample(np.array([t])))
    found = s.found(begin)
    W = _matrix(found.rows[k], len(s.mass), 0)
    D = float((W**2 / s.mass).sum())
    N = float(found.N[k][0])
    fastest = float(np.abs(rows.g[int(s.names.row[k]), within]).max())
    if fastest == 0.0:
        return  # slip that is held again at the instant at which it begins
    rate, speed = _growth(law, D, N, fastest)
    if rate <= 0.0 or rate * (t_end - t) < 4.0:
        return
    at = t + np.array(_TIMES) / rate
    # the rule does not see what another contact's transition, or a knot of the law, makes of forces within it; steps
    # end there
    cuts = np.unique(np.concatenate([at, *(x[(x > at[0]) & (x < at[-1])] for x in (kinks, rows.t))]))
    x, w = np.polynomial.legendre.leggauss(_NODES)
    half = 0.5 * np.diff(cuts)
    nodes = (cuts[:-1] + half)[:, None] + half[:, None] * x
    moment = s.moment(sample(nodes.ravel()))
    seen = s.found(moment)
    force = seen.force / s.mass[:, None]
    pull = (W @ force)[0].reshape(nodes.shape)
    drift = _belt(s, k, at, sample)
    change = s.found(s.moment(sample(at))).g[k][0]
    stated = np.add.reduceat(half * (pull @ w), np.searchsorted(cuts, at[:-1])) + drift
    unit = float(row_unit(found.rows[k][0], units.v, (1,))[0])
    size = np.maximum(np.abs(change[1:]), np.abs(np.cumsum(stated)))
    relative = np.abs(np.diff(change) - stated) / (size + 1e-300)
    # the times lie within steps
    gathered.add("growth of slip", relative * speed / (2.0 * DENSE * unit + 1e-300), at[1:], law.name)


def _belt(s: Statements, k: int, at: Floats, sample: Any) -> Floats:
    """Change of the slip velocity that prescribed motions bring in, between the times."""
    still = s.moment(sample(at))
    still.v = np.zeros_like(still.v)
    still._places = {}
    found: Floats = np.diff(s.found(still).g[k][0])
    return found


def _growth(law: Rubs, D: float, N: float, fastest: float) -> tuple[float, float]:
    """Rate of growth at break-away, and the slip speed up to which it goes on; 0 where slip does not grow."""
    r = np.geomspace(1e-6, 1.0, 200) * fastest
    load = np.full(r.shape, N)
    friction = np.asarray(law.numeric.coefficient(r, load)) * load
    slope = -np.gradient(friction, r)
    first = float(slope[:20].max())
    falls = slope > 0.1 * first
    if first <= 0.0:
        return 0.0, 0.0
    last = int(np.argmin(falls)) if not falls.all() else r.size - 1
    return D * first, float(r[last])
