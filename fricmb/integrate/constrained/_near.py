"""Before the stages of a step: which contacts in two directions are near rest, and what a turn of their force does."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.constrained._pack import Mech, Moving
from fricmb.integrate.constrained._slip import lightness, magnitude, plane
from fricmb.integrate.constrained._stages import Stages, newton_change
from fricmb.integrate.constrained._state import State
from fricmb.integrate.constrained._turns import NEAR, across, by_turn, force_place
from fricmb.integrate.problem import SLIP


@kernel
def choose_forms(mech: Mech, k: Moving, y: State, st: Stages, h: float) -> None:
    """Mark the contacts that may come to rest in a step h, or set out (``k.form``)."""
    row, turns = mech.port.row, st.turns
    turns.near[0] = 0
    for c in range(y.mode.shape[0]):
        k.form[c] = 0
        if not plane(mech, c) or y.mode[c] != SLIP or turns.near[0] == turns.which.shape[0]:
            continue
        force = magnitude(row, c, y.F)
        change = magnitude(row, c, y.ga) + force * (
            lightness(mech, k, c, 0, y.lam, mech.address) + lightness(mech, k, c, 1, y.lam, mech.address)
        )
        if y.N[c] > 0.0 and force > 0.0 and magnitude(row, c, y.g) <= NEAR * h * change:
            i = turns.near[0]
            k.form[c] = 1
            turns.which[i] = c
            turns.tangent[i, 0] = y.F[row[c] + 1] / force
            turns.tangent[i, 1] = -y.F[row[c]] / force
            turns.base[i] = by_turn(mech, c, y.F, y.g)
            turns.near[0] = i + 1


@kernel
def prepare_turns(mech: Mech, st: Stages) -> None:
    """Solve for what the marked contacts' directions answer; the factors are there."""
    turns, s = st.turns, st.tab.c.shape[0]
    for p in range(turns.near[0] * s):
        for i in range(s):
            for a in range(st.R.shape[1]):
                st.R[i, a] = 0.0
        st.R[p % s, force_place(mech, turns.which[p // s])] = 1.0
        newton_change(mech, st, mech.address)
        for i in range(s):
            for a in range(st.R.shape[1]):
                turns.answer[p, i, a] = st.R[i, a]
        for q in range(turns.near[0] * s):
            turns.gain[q, p] = across(mech, turns, q // s, st.R[q % s])
