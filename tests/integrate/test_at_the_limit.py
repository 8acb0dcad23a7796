"""Contacts at rest near and at their limit: loads and belts that jump or bend, normal forces that fall."""

from __future__ import annotations

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import fricmb as fm

T = fm.t
LOCAL = ("taylor", "radau")


def block(load=0.0, mu_s=0.8, mu_k=0.6, normal_force=1.0, belt=None, spring=0.0):
    """A block of mass 1 under a load, on the ground or on a belt of a given velocity."""
    body = fm.Body("block", mass=1.0)
    ends = [body] if belt is None else [body, fm.Driven("belt", velocity={"x": belt})]
    contact = fm.Contact("rub", *ends, law=fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k), normal_force=normal_force)
    parts = [*ends, contact, fm.Force("load", body, axis="x", value=load)]
    return fm.Scene("block", [*parts, *([fm.Spring("spring", body, axis="x", stiffness=spring)] if spring else [])])


@pytest.mark.parametrize("method", LOCAL)
@pytest.mark.parametrize(
    "load",
    [
        sympy.Piecewise((0.70, T < 1), (0.71, True)),
        sympy.Piecewise((0.70, T < 1), (0.71, T < 2), (0.6, T < 3), (0.79, True)),
        sympy.Piecewise((0.2 * T, T < 3.9), (0.78, T < 5), (-0.79, True)),
    ],
)
def test_loads_within_the_limit_hold_whatever_they_do(method, load):
    sol = fm.simulate(block(load), t_end=10.0, method=method)
    assert np.abs(sol["block.x"]).max() < 1e-9
    assert len(sol.events) == 0


@pytest.mark.parametrize("method", LOCAL)
def test_a_load_that_jumps_beyond_the_limit_starts_slip_there(method):
    sol = fm.simulate(block(sympy.Piecewise((0.7, T < 1), (0.9, True))), t_end=3.0, method=method)
    assert [(event.kind, event.t) for event in sol.events] == [("slip", pytest.approx(1.0, abs=1e-9))]
    assert sol["block.x"][-1] == pytest.approx(0.5 * 0.3 * 2.0**2, rel=1e-5)


@pytest.mark.parametrize("method", LOCAL)
@pytest.mark.parametrize("load", [0.6, sympy.Piecewise((0.5, T < 1), (0.6, True))])
def test_a_load_at_the_limit_is_held(method, load):
    sol = fm.simulate(block(load, mu_s=0.6, mu_k=0.6), t_end=10.0, method=method)
    assert np.abs(sol["block.x"]).max() < 1e-9
    assert len(sol.events) == 0
    assert (sol.mode("rub") == 0).all()


@pytest.mark.parametrize("method", LOCAL)
@pytest.mark.parametrize("spring", [0.0, 1.0])
@pytest.mark.parametrize("rtol", [1e-5, 1e-8])
def test_a_belt_that_bends_carries_what_sticks_without_transitions(method, spring, rtol):
    belt = sympy.Piecewise((0.1 * T, T < 1), (0.1 * (2 - T), T < 3), (0.1 * (T - 4), T < 5), (0.1, True))
    sol = fm.simulate(block(belt=belt, spring=spring), t_end=8.0, method=method, rtol=rtol)
    assert len(sol.events) == 0
    assert (sol.mode("rub") == 0).all()
    assert sol["block.x"][-1] == pytest.approx(0.35, abs=1e-9)


@pytest.mark.parametrize("method", LOCAL)
def test_a_belt_that_jumps_ends_stick_there(method):
    belt = sympy.Piecewise((0.1, T < 1), (0.2, True))
    sol = fm.simulate(block(belt=belt, spring=1.0), t_end=2.0, method=method, rtol=1e-4)
    assert [event.kind for event in sol.events] == ["stick", "slip", "stick"]
    assert sol.events[1].t == 1.0


def moved(normal, load, mu_k, t0, t_end):
    """Where a block gets to that slips from t0 on."""
    rates = lambda t, y: (y[1], load - mu_k * normal(t))  # noqa: E731
    return solve_ivp(rates, (t0, t_end), (0.0, 0.0), method="DOP853", rtol=1e-12, atol=1e-15).y[0, -1]


@pytest.mark.parametrize("mu_k", [0.6, 0.8])
@pytest.mark.parametrize("rtol", [1e-3, 1e-4, 1e-6])
def test_break_away_under_a_falling_normal_force(mu_k, rtol):
    sol = fm.simulate(block(0.5, 0.8, mu_k, 2 - 0.1 * T), t_end=16.0, method="radau", rtol=rtol)
    assert [event.kind for event in sol.events] == ["slip"]
    assert sol.events[0].t == pytest.approx(13.75, abs=1e-9)
    assert sol["block.x"][-1] == pytest.approx(moved(lambda t: 2 - 0.1 * t, 0.5, mu_k, 13.75, 16.0), rel=5 * rtol)


@pytest.mark.parametrize("rtol", [1e-3, 1e-5])
def test_break_away_under_a_wavy_normal_force(rtol):
    normal = lambda t: 2 + np.sin(t)  # noqa: E731
    scene = block(0.6, 0.5, 0.4, 2 + sympy.sin(T))
    sol = fm.simulate(scene, t_end=6.0, method="radau", rtol=rtol)
    first = brentq(lambda t: 0.5 * normal(t) - 0.6, np.pi, 1.5 * np.pi)
    assert sol.events[0].kind == "slip"
    assert sol.events[0].t == pytest.approx(first, abs=10 * rtol)
    assert sol.at([5.0])["block.x"][0] == pytest.approx(moved(normal, 0.6, 0.4, first, 5.0), rel=10 * rtol)
