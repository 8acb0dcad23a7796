"""Before the stages of a step: which contacts in several directions are near rest, and what turns of forces do."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.constrained.moving import Moving
from fricmb.integrate.constrained.plane_slip import largest_part
from fricmb.integrate.constrained.problem_structs import Mech
from fricmb.integrate.constrained.slip_rows import SLIGHT, lightness, plane
from fricmb.integrate.constrained.stages import Stages, newton_change
from fricmb.integrate.constrained.state import State
from fricmb.integrate.constrained.turning import NEAR, Turns, across, by_turn, force_place
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.problem import SLIP


@kernel
def choose_forms(mech: Mech, k: Moving, y: State, st: Stages, h: float) -> None:
    """Mark the contacts that may come to rest in a step h, or set out (``k.form``)."""
    row, turns = mech.port.row, st.turns
    turns.near = 0
    for c in range(y.mode.shape[0]):
        k.form[c] = 0
        first, d = row[c], row[c + 1] - row[c]
        if not plane(mech, c) or y.mode[c] != SLIP or turns.near + d - 1 > turns.contact.shape[0]:
            continue
        force, light = magnitude(row, c, y.F), 0.0
        for a in range(d):
            light += lightness(mech, k, c, a, y.lam, mech.mass)
        change = magnitude(row, c, y.ga) + force * light
        if y.N[c] <= 0.0 or force <= 0.0 or magnitude(row, c, y.g) > NEAR * h * change:
            continue
        k.form[c] = 1
        k.slight[c] = SLIGHT * h * change
        m = largest_part(row, c, y.n) - first
        for line in range(d):
            if line != m:
                turn_row(turns, c, line, m, -y.F[first + line] / force, -y.F[first + m] / force)
                turns.base[turns.near - 1] = by_turn(mech, c, y.F, y.g)


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
    turns, s = st.turns, st.tab.c.shape[0]
    for p in range(turns.near * s):
        for i in range(s):
            for a in range(st.R.shape[1]):
                st.R[i, a] = 0.0
        st.R[p % s, force_place(mech, turns.contact[p // s]) + turns.line[p // s]] = 1.0
        newton_change(mech, st)
        for i in range(s):
            for a in range(st.R.shape[1]):
                turns.answer[p, i, a] = st.R[i, a]
        for q in range(turns.near * s):
            turns.gain[q, p] = across(mech, turns, q // s, st.R[q % s])
