"""Two halves of a mass, tied as stiffly as it goes, on a slow belt: the motion of one mass, known in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest

import fricmb as fm

#: Speed of the belt; where the contact lets go, and where it holds again; how long it slips (x'' = 1 - x) and holds.
BELT, STRETCHED, LEFT = 0.05, 1.5, 0.5
SLIP = 2.0 * math.pi - 2.0 * math.atan(0.5 / BELT)
HOLD = (STRETCHED - LEFT) / BELT
COULOMB = fm.laws.Coulomb(mu_s=1.5, mu_k=1.0)


def pair(stiffness, law=COULOMB):
    """Mass 1 on a spring of stiffness 1, mu_s N = 1.5 and mu_k N = 1, starting with the belt."""
    start = {"position": {"x": LEFT}, "velocity": {"x": BELT}}
    one, two = (fm.Body(name, mass=0.5, **start) for name in ("one", "two"))
    belt = fm.Driven("belt", velocity={"x": BELT})
    return fm.Scene("pair", [
        one, two, belt,
        fm.Spring("soft", one, axis="x", stiffness=1.0),
        fm.Spring("tie", one, two, axis="x", stiffness=stiffness),
        fm.Damper("calm", one, two, axis="x", damping=0.5 * math.sqrt(stiffness)),
        fm.Contact("sole", two, belt, law=law, normal_force=1.0),
    ])  # fmt: skip


@pytest.mark.parametrize("method", ["auto", "radau", "bdf"])
@pytest.mark.parametrize(("stiffness", "rtol"), [(1e10, 1e-4), (1e12, 1e-4), (1e12, 1e-6)])
def test_long_steps_keep_the_forces_of_a_stiff_tie(stiffness, rtol, method):
    """Where velocities were solved to their tolerance alone, contacts let go by forces that were not there."""
    sol = fm.simulate(pair(stiffness), t_end=500.0, rtol=rtol, method=method)
    period = HOLD + SLIP
    lets_go = np.array([e.t for e in sol.events if e.kind == "slip"])
    holds = np.array([e.t for e in sol.events if e.kind == "stick"])
    turns = np.arange(int((500.0 - HOLD) / period) + 1)
    assert lets_go.size == turns.size
    # the last digit of a position is a force of 4e-16 of the stiffness; some turns add up
    close = 100.0 * (4e-16 * stiffness + 10.0 * rtol) / BELT
    np.testing.assert_allclose(lets_go, HOLD + period * turns, atol=close)
    np.testing.assert_allclose(holds[:3], (HOLD + SLIP + period * turns)[:3], atol=close)
    assert any("round-off of positions" in note for note in sol.stats.notes) == (stiffness > 1e11)


def test_a_law_that_asks_the_load_for_its_limit_is_told_of_round_off_too():
    """Stick and slip of a kind: sqrt(2) of friction up to break-away, and as much behind."""
    law = fm.laws.LoadDependent(mu_0=2.0, N_0=1.0, exponent=0.5)
    notes = fm.simulate(pair(1e12, law), t_end=100.0, rtol=1e-4, method="radau").stats.notes
    assert any("friction limit of contact 'sole'" in note for note in notes)


def test_springs_that_an_eigenproblem_hides_are_left_to_steps():
    """1e14 times as stiff as the spring to ground: exact modes took the pair for one that is held by nothing."""
    sol = fm.simulate(pair(1e14), t_end=40.0, rtol=1e-4)
    assert sol.stats.method != "collocation"
    assert any("friction limit of contact 'sole'" in note for note in sol.stats.notes)
    assert [e.kind for e in sol.events][:2] == ["slip", "stick"]
    assert sol.events[0].t == pytest.approx(HOLD, abs=0.05 * 1.5 / BELT)


def test_bodies_that_nothing_holds_are_no_hidden_springs():
    """A free body beside a sprung one, under one contact."""
    one, two = fm.Body("one", mass=1.0, position={"x": 1.0}), fm.Body("two", mass=1.0)
    scene = fm.Scene("free", [
        one, two, fm.Spring("soft", one, axis="x", stiffness=1e3),
        fm.Contact("sole", one, two, law=fm.laws.Coulomb(mu_s=0.5), normal_force=1.0),
    ])  # fmt: skip
    assert fm.simulate(scene, t_end=0.1).stats.method == "collocation"
