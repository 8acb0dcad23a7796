"""Loads of dry joints between the stages of a step: a reaction that turns quickly has been missed by all of them.

The load of a pin is the length of its reaction.  Where that passes by close to 0, the length has all but a kink there:
no transition, and nothing that a load linear by pieces shows (``load_kinks``), but too much for one polynomial.  As
``law_defect`` asks laws, loads are asked half-way between the stages, by the polynomials of reactions, positions and
velocities.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.formulas.tableau import by_line, largest_in_step
from fricmb.integrate.implicit.equations.forces import call_joint, directions, friction_at, load_place, move
from fricmb.integrate.implicit.equations.instant_matrix import NONE, instant_matrix, solve_instant
from fricmb.integrate.implicit.equations.slip_rows import friction_coefficient, lightness
from fricmb.integrate.implicit.scene.control import Control, asked
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.implicit.scene.watch import Watch
from fricmb.integrate.implicit.stages.stages import Stages, bring_up_to_date
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.problem import LAW_SMOOTH, SLIP

#: Relative round-off of loads beside their polynomials.
ROUND_OFF = 1e-14
#: Part of the error that a step may make, above which joints are asked what a force does.
TELLS = 0.1


@kernel
def rubs_by_reaction(mech: Mech, y: State, out: Watch, c: int) -> bool:
    """Whether port c is a joint that slips under rigid friction, without a kink of its load that ends the step."""
    slips = mech.port.joint[c] >= 0 and y.mode[c] == SLIP and mech.port.law[c] != LAW_SMOOTH
    return bool(slips and out.kinked[c] == 0)


@kernel
def find_missed_loads(mech: Mech, k: Moving, w: Instant, y: State, st: Stages, out: Watch, h: float) -> None:
    """What loads are off by between stages, times the gaps, into ``out.missed`` (n_c,)."""
    tab, n = st.tab, y.q.shape[0]
    q, v, lam = w.r[:n], w.x[:n], out.lam
    out.missed[:] = 0.0
    for j in range(tab.c.shape[0]):
        line, before = tab.mid[j], tab.c[j - 1] if j > 0 else 0.0
        for i in range(n):
            q[i], v[i] = by_line(line, y.q[i], st.Q, i), by_line(line, y.v[i], st.V, i)
        for i in range(y.lam.shape[0]):
            lam[i] = by_line(line, y.lam[i], st.lam, i)
        move(mech, k, y.t + 0.5 * (before + tab.c[j]) * h, q, v)
        for c in range(y.mode.shape[0]):
            if not rubs_by_reaction(mech, y, out, c):
                continue
            i = mech.port.joint[c]
            n_x = call_joint(mech, k, i, lam)
            at = load_place(n_x, friction_at(n_x, mech.joint.row[i + 1] - mech.joint.row[i]), directions(mech, c))
            off = abs(k.out[at] - by_line(line, y.N[c], st.N, c)) - ROUND_OFF * largest_in_step(y.N[c], st.N, c)
            out.missed[c] += (tab.c[j] - before) * h * max(off, 0.0)


@kernel
def effect(mech: Mech, w: Instant, y: State, st: Stages, c: int) -> float:
    """Largest acceleration, by its scale, that a unit force of port c brings; the matrix without friction is there."""
    worst, n, m = 0.0, y.q.shape[0], y.lam.shape[0]
    for a in range(mech.port.row[c], mech.port.row[c + 1]):
        w.r[:] = 0.0
        w.r[n + m + a] = 1.0
        solve_instant(mech, w)
        for i in range(n):
            worst = max(worst, abs(w.r[i]) / st.scale[i])
    return float(worst)


@block
def load_defect(mech: Mech, k: Moving, w: Instant, y: State, st: Stages, c: Control, out: Watch, h: float) -> float:
    """Largest error of a velocity, by its own scale, that loads of joints leave between the stages.

    What a force does without joints is an upper bound; with them, a small body in a pin, say, hardly moves.
    """
    worst, some, solved = 0.0, False, False
    for p in range(y.mode.shape[0]):
        some = some or rubs_by_reaction(mech, y, out, p)
    if not some:
        return worst
    bring_up_to_date(mech, k, y, st, h)
    find_missed_loads(mech, k, w, y, st, out, h)
    for i in range(y.v.shape[0]):
        c.inertia[i] = (c.mass[i] * st.scale[i]) ** 2
    move(mech, k, y.t, y.q, y.v)
    for p in range(y.mode.shape[0]):
        if out.missed[p] == 0.0:
            continue
        mu, _, _ = friction_coefficient(mech, k, p, magnitude(mech.port.row, p, y.g), y.N[p])
        free = 0.0
        for a in range(directions(mech, p)):
            free = max(free, np.sqrt(lightness(mech, k, p, a, y.lam, c.inertia)))
        error = mu * out.missed[p] * free
        if error > TELLS * asked(c):
            solved = solved or instant_matrix(mech, k, w, y, NONE)
            error = min(error, mu * out.missed[p] * effect(mech, w, y, st, p)) if solved else error
        worst = max(worst, error)
    return worst
