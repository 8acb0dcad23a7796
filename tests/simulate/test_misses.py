"""Runs say where their outcome hangs on less than they resolve."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm

METHODS = ["auto", "radau", "bdf"]


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


def through_zero(y=0.0, length=0.5):
    """A mass on a spring that passes its anchor, as near as ``y``."""
    body = fm.Body("p", mass=1.0, axes="xy", position={"x": 1.0, "y": y}, velocity={"x": -1.0})
    return fm.Scene("spring", [body, fm.PointSpring("k", body, stiffness=1.0, length=length)])


#: When the ends meet: x = 0.5 + 0.5 cos t - sin t until then, and after it -0.5 + 0.5 cos tau - 1 sin tau.
MET = 2.0 * np.arctan(0.5)


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("rtol", [1e-5, 1e-8, 1e-10])
def test_a_spring_whose_ends_meet_turns_its_force_there(method, rtol):
    sol = fm.simulate(through_zero(), t_end=2.0, rtol=rtol, method=method)
    tau = np.maximum(sol.t - MET, 0.0)
    before = 0.5 + 0.5 * np.cos(sol.t) - np.sin(sol.t)
    x = np.where(tau > 0.0, -0.5 + 0.5 * np.cos(tau) - np.sin(tau), before)
    assert np.abs(sol["p.x"] - x).max() < 30.0 * rtol
    assert sol.stats.notes == ()
    assert sol.audit().ok, sol.audit().table()


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("rtol", [1e-5, 1e-8, 1e-10])
def test_a_spring_on_a_slide_turns_its_force_where_its_ends_meet(method, rtol):
    """The same on a guide: steps with joints saw the jump in their stages alone, and were up to 45 rtol off."""
    body = fm.RigidBody("p", mass=1.0, inertia=1.0, position=(1.0, 0.0), velocity=(-1.0, 0.0))
    guide = fm.Prismatic("guide", body, fm.ground_point(0.0, 0.0))
    spring = fm.PointSpring("k", body, stiffness=1.0, length=0.5)
    sol = fm.simulate(fm.Scene("slide", [body, guide, spring]), t_end=2.0, rtol=rtol, method=method)
    tau = np.maximum(sol.t - MET, 0.0)
    before = 0.5 + 0.5 * np.cos(sol.t) - np.sin(sol.t)
    x = np.where(tau > 0.0, -0.5 + 0.5 * np.cos(tau) - np.sin(tau), before)
    assert np.abs(sol["p.x"] - x).max() < rtol
    assert sol.stats.notes == ()


@pytest.mark.parametrize("y", [1e-9, 1e-5, 1e-2])
def test_a_near_pass_is_followed_round(y):
    """Against an explicit method that goes round as well."""

    def rate(t, state):
        q = state[:2]
        return np.concatenate([state[2:], -q * (1.0 - 0.5 / np.hypot(*q))])

    true = solve_ivp(rate, (0.0, 2.0), [1.0, y, -1.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-14).y[:2, -1]
    for method in ("radau", "bdf"):
        sol = fm.simulate(through_zero(y), t_end=2.0, rtol=1e-7, method=method)
        assert np.abs(sol.q[:, -1] - true).max() < 3e-6
        assert sol.stats.notes == ()


@pytest.mark.parametrize("y", [0.0, 1e-9, 0.1])
def test_steps_without_error_control_say_that_ends_meet(y):
    notes = fm.simulate(through_zero(y), t_end=2.0, step=1e-3, method="bdf2-paper").stats.notes
    assert any("the ends of 'k' meet at t = 0.92" in note for note in notes) == (y < 1e-3)
    without = fm.simulate(through_zero(y, length=0.0), t_end=2.0, step=1e-3, method="bdf2-paper") if y == 0.0 else None
    assert without is None or without.stats.notes == ()
