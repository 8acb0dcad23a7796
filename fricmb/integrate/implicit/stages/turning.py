"""Slip in several directions near rest: how the direction follows the force differs from stage to stage.

The rows of ``friction_rows`` in the form that finds the direction have the derivative ``r_i / |F_i|`` by a turn of the
force at stage i, r the slip speed; of three directions two such rows.  Near rest r changes by as much as it is, so that
Newton's method with the one Jacobian of all stages would not converge.  Its changes are corrected by what the few
derivatives differ by (Woodbury).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.compile.lu import lu_factor, lu_solve
from fricmb.integrate.formulas.tableau import Tableau
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.problem import (
    LAW_SMOOTH,
    Complexes,
    Complexes2,
    Complexes3,
    Floats,
    Floats2,
    Ints,
    Pivots,
    Problem,
)

#: A contact faster than what this many steps of its acceleration bring has a direction of its own: with joints, and
#: without, where a direction found from the force costs more than the few iterations that it spares.
NEAR, NEAR_WITHOUT = 4.0, 1.0
#: Contacts that can be near rest at once and still step well.
TOGETHER = 48


class Turns(Layout):
    """Rows of contacts near rest that find a direction: ``contact`` (k,) and ``line`` (k,) of its directions.

    ``near`` how many rows, ``tangent`` (k, 3) across the slip.

    ``answer`` (k, l, size): changes of the unknowns by a unit residual in the row of a direction, in each of the
    systems into which the stages fall apart; ``gain`` (k s, k s) the turns at stages by such residuals at stages;
    ``base`` (k,), ``spread`` (k s,): derivatives in the Jacobian, and what a stage's differ by.
    """

    contact: Ints
    line: Ints
    near: int
    tangent: Floats2
    base: Floats
    answer: Complexes3
    gain: Floats2
    work: Floats
    spread: Floats
    turn: Floats
    sizes: Pivots
    pivots: Pivots


def turning_rows(problem: Problem) -> int:
    """Rows in which contacts in several directions with set-valued laws turn, at most those that are kept."""
    contacts = problem.contacts
    return min(int(np.maximum(np.diff(contacts.row) - 1, 0)[contacts.law != LAW_SMOOTH].sum()), TOGETHER)


def turns_of(problem: Problem, tab: Tableau, size: int, turning: bool) -> Turns:
    """Arrays for the contacts in several directions with set-valued laws; not ``turning``: for none of them."""
    s = len(tab.c)
    k = turning_rows(problem) if turning else 0
    full = k * s
    return Turns(
        np.zeros(k, np.int64), np.zeros(k, np.int64), 0, np.zeros((k, 3)), np.zeros(k),
        np.zeros((k, len(tab.lam), size), complex), np.zeros((full, full)), np.zeros(full * full), np.zeros(full),
        np.zeros(full),
        np.zeros(4, np.int32), np.zeros(full, np.int32),
    )  # fmt: skip


@kernel
def force_place(mech: Mech, c: int) -> int:
    """Place of the first force of port c among the unknowns of a stage."""
    port = mech.port
    return int(mech.order.place.shape[0] - port.z_start[-1] - port.row[-1] + port.row[c])


@kernel
def by_turn(mech: Mech, c: int, F: Floats, g: Floats) -> float:
    """Derivative of the velocity across the direction of slip by the force across it: slip speed over force."""
    square, along = 0.0, 0.0
    for a in range(mech.port.row[c], mech.port.row[c + 1]):
        square += F[a] * F[a]
        along += F[a] * g[a]
    return float(-along / square) if square > 0.0 else 0.0


@kernel
def spread_of_stages(mech: Mech, turns: Turns, F: Floats2, g: Floats2) -> None:
    """What the derivatives at the stages differ by from those of the Jacobian, for forces and velocities (s, m_p)."""
    s = F.shape[0]
    for k in range(turns.near):
        for i in range(s):
            turns.spread[k * s + i] = by_turn(mech, turns.contact[k], F[i], g[i]) - turns.base[k]


@kernel
def across(mech: Mech, turns: Turns, k: int, x: Floats | Complexes) -> Any:
    """The turn of row k in a change x (size,) of the unknowns of a stage: force across the slip."""
    c = turns.contact[k]
    place, turn = force_place(mech, c), 0.0 * x[0]
    for a in range(mech.port.row[c + 1] - mech.port.row[c]):
        turn += turns.tangent[k, a] * x[place + a]
    return turn


@kernel
def correct_turns(mech: Mech, turns: Turns, tab: Tableau, R: Floats2, w: Complexes2) -> None:
    """From the changes R (s, size) by the Jacobian to those by the derivatives of every stage; ``w`` is space."""
    s = R.shape[0]
    full = turns.near * s
    work = turns.work[: full * full].reshape(full, full)
    for p in range(full):
        turns.turn[p] = across(mech, turns, p // s, R[p % s])
        for q in range(full):
            work[p, q] = turns.gain[p, q] * turns.spread[q] + (1.0 if p == q else 0.0)
    turn = turns.turn[:full]
    if not lu_factor(work, turns.sizes, turns.pivots):
        return
    lu_solve(work, turn, turns.sizes, turns.pivots)
    for q in range(full):
        turn[q] *= turns.spread[q]
    for i in range(tab.lam.shape[0]):
        w[i, :] = 0.0
        for k in range(turns.near):
            part = 0.0j
            for j in range(s):
                part += tab.Tinv[i, j] * turn[k * s + j]
            for a in range(R.shape[1]):
                w[i, a] += part * turns.answer[k, i, a]
        for j in range(s):
            for a in range(R.shape[1]):
                R[j, a] -= (tab.T[j, i] * w[i, a]).real
