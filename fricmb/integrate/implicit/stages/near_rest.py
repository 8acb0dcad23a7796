"""Before the stages of a step: which contacts in several directions are near rest, and what turns of forces do."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.equations.plane_slip import largest_part
from fricmb.integrate.implicit.equations.slip_rows import SLIGHT, lightness, plane
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import State
from fricmb.integrate.implicit.stages.stages import Stages, solve_system
from fricmb.integrate.implicit.stages.steep_laws import set_gain
from fricmb.integrate.implicit.stages.turning import NEAR, NEAR_WITHOUT, Turns, across, by_turn, force_place
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.problem import SLIP


@kernel
def slip_change(mech: Mech, k: Moving, y: State, c: int, h: float) -> float:
    """What the slip velocity of contact c may change by in a step h."""
    light = 0.0
    for a in range(mech.port.row[c + 1] - mech.port.row[c]):
        light += lightness(mech, k, c, a, y.lam, mech.mass)
    return float(h * (magnitude(mech.port.row, c, y.ga) + magnitude(mech.port.row, c, y.F) * light))


@kernel
def nears_rest(mech: Mech, k: Moving, y: State, c: int, h: float) -> bool:
    """Whether contact c slips in a plane, and may come to rest in a step h, or has only set out."""
    if not plane(mech, c) or y.mode[c] != SLIP or y.N[c] <= 0.0 or magnitude(mech.port.row, c, y.F) <= 0.0:
        return False
    near = NEAR if y.lam.shape[0] > 0 else NEAR_WITHOUT
    return bool(magnitude(mech.port.row, c, y.g) <= near * slip_change(mech, k, y, c, h))


@kernel
def choose_forms(mech: Mech, k: Moving, y: State, st: Stages, h: float) -> None:
    """Mark the contacts that may come to rest in a step h, or set out (``k.form``): those nearest to it, if many are.

    The others step as if their slip were not less than what it may change by.
    """
    row, turns = mech.port.row, st.turns
    turns.near = 0
    for c in range(y.mode.shape[0]):
        k.form[c] = 0
        k.slight[c] = slip_change(mech, k, y, c, h) if nears_rest(mech, k, y, c, h) else 0.0
    for _ in range(turns.contact.shape[0]):
        c = nearest(mech, k, y)
        if c < 0 or turns.near + row[c + 1] - row[c] - 1 > turns.contact.shape[0]:
            break
        k.form[c] = 1
        k.slight[c] *= SLIGHT
        first, force = row[c], magnitude(row, c, y.F)
        m = largest_part(row, c, y.n) - first
        for line in range(row[c + 1] - first):
            if line != m:
                turn_row(turns, c, line, m, -y.F[first + line] / force, -y.F[first + m] / force)
                turns.base[turns.near - 1] = by_turn(mech, c, y.F, y.g)


@kernel
def nearest(mech: Mech, k: Moving, y: State) -> int:
    """The contact near rest, and not marked yet, that is slowest beside what its slip may change by; or -1."""
    found, least = -1, np.inf
    for c in range(y.mode.shape[0]):
        if k.form[c] == 0 and k.slight[c] > 0.0:
            part = magnitude(mech.port.row, c, y.g) / k.slight[c]
            if part < least:
                found, least = c, part
    return found


@kernel
def turn_row(turns: Turns, c: int, line: int, m: int, n_line: float, n_m: float) -> None:
    """Append the row of contact c in which direction ``line`` stands against direction m."""
    i = turns.near
    turns.contact[i], turns.line[i] = c, line
    for a in range(3):
        turns.tangent[i, a] = n_line if a == m else (-n_m if a == line else 0.0)
    turns.near = i + 1


@kernel
def prepare_turns(mech: Mech, st: Stages) -> None:
    """Solve for what the marked contacts' directions answer; the factors are there."""
    turns, tab = st.turns, st.tab
    s, near = tab.c.shape[0], turns.near
    turns.gain[: near * s, : near * s] = 0.0
    for k in range(near):
        row = force_place(mech, turns.contact[k]) + turns.line[k]
        for i in range(tab.lam.shape[0]):
            st.w[i, :] = 0.0
            st.w[i, row] = 1.0
            solve_system(mech, st, i, False)
            turns.answer[k, i] = st.w[i]
            for q in range(near):
                turn = across(mech, turns, q, st.w[i])
                for j in range(s):
                    for p in range(s):
                        turns.gain[q * s + j, k * s + p] += (tab.T[j, i] * tab.Tinv[i, p] * turn).real


@kernel
def prepare_steep(mech: Mech, st: Stages) -> None:
    """Solve for what the rows of steep laws answer; the factors are there."""
    steep = st.steep
    for a in range(steep.row.shape[0] if steep.on == 1 else 0):
        for i in range(st.tab.lam.shape[0]):
            st.w[i, :] = 0.0
            st.w[i, steep.row[a]] = 1.0
            solve_system(mech, st, i, False)
            set_gain(mech, steep, st.tab, a, i, st.w[i])
