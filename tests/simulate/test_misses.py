"""Runs say where their outcome hangs on less than they resolve."""

import numpy as np
import pytest

import fricmb as fm

METHODS = ["auto", "radau", "bdf", "timestepping"]


def puck(aside, mu_s=0.6):
    """A puck on a plane, pushed back by 0.5 between mu_k N = 0.4 and mu_s N; ``aside`` of its path to rest."""
    body = fm.Body("puck", mass=1.0, axes="xy", velocity={"x": -1.0, "y": aside})
    law = fm.laws.Coulomb(mu_s=mu_s, mu_k=0.4)
    sole = fm.Contact("sole", body, law=law, normal_force=1.0)
    return fm.Scene("plane", [body, fm.Force("push", body, axis="x", value=0.5), sole])


def least_speed(aside):
    """Of the path: with the angle th of slip to the push, r is (tan th/2)^(4/5)/sin th times a constant."""
    th = np.linspace(1e-9, np.pi - 1e-9, 200001)
    start = np.arctan2(aside, -1.0)
    shape = np.tan(th / 2) ** 0.8 / np.sin(th)
    return np.hypot(1.0, aside) * shape.min() / (np.tan(start / 2) ** 0.8 / np.sin(start))


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("aside", [1e-6, 1e-4, 1e-2, 0.3])
def test_a_pass_of_rest_nearer_than_the_tolerance_is_said(aside, method):
    """Methods may disagree there whether it sticks, and then all of them say so; elsewhere none does."""
    rtol = 1e-4
    sol = fm.simulate(puck(aside), t_end=4.0, rtol=rtol, method=method)
    least = least_speed(aside)
    assert any("'sole' passes rest" in note for note in sol.stats.notes) == (least < 10.0 * rtol)
    if least > 10.0 * rtol:
        assert not len(sol.events)


@pytest.mark.parametrize("method", METHODS)
def test_rest_on_a_straight_line_or_at_mu_s_equal_to_mu_k_is_no_doubt(method):
    straight = fm.simulate(puck(0.0), t_end=4.0, rtol=1e-4, method=method)
    assert [event.kind for event in straight.events] == ["stick"]
    assert straight.events[0].t == pytest.approx(1.0 / 0.9, rel=1e-4)
    assert straight.stats.notes == ()
    assert fm.simulate(puck(1e-6, mu_s=0.4), t_end=4.0, rtol=1e-4, method=method).stats.notes == ()


@pytest.mark.parametrize("y", [0.0, 1e-9, 0.1])
def test_a_spring_whose_ends_meet_is_said(y):
    """The force of a spring with a length turns round where its ends pass each other."""
    body = fm.Body("p", mass=1.0, axes="xy", position={"x": 1.0, "y": y}, velocity={"x": -1.0})
    scene = fm.Scene("spring", [body, fm.PointSpring("k", body, stiffness=1.0, length=0.5)])
    notes = fm.simulate(scene, t_end=2.0, rtol=1e-6).stats.notes
    # x = 0.5 + 0.5 cos t - sin t until the ends meet
    met = 2.0 * np.arctan(0.5)
    assert any(f"the ends of 'k' meet at t = {met:.6g}" in note for note in notes) == (y < 1e-3)
    without = scene.replace("k", length=0.0) if y == 0.0 else None
    assert without is None or fm.simulate(without, t_end=2.0, rtol=1e-6).stats.notes == ()
