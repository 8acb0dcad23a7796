"""How contacts in two directions come to rest in Taylor steps: closed forms, runs cut on the way, fast loads."""

import math

import numpy as np
import pytest
import sympy
from numba import njit
from scipy.integrate import solve_ivp

import fricmb as fm
from fricmb.integrate.compile.compilers import MachineCompiler
from fricmb.integrate.taylor.landing_path import AT, UNIT, WAY, follow_landing

PULL, RUB = 0.2, 0.5
LEFT = RUB**2 - PULL**2
#: When a unit mass comes to rest that sets out with speed 1 across the pull (see ``taylor/landing``).
REST = RUB / LEFT


def pulled(speed=1.0, **other):
    """A unit mass that slides along y, and is pulled along x."""
    block = fm.Body("block", mass=1.0, axes="xy", velocity={"y": speed})
    pull = fm.Force("pull", block, axis="x", value=PULL)
    return [block, pull, fm.Contact("sole", block, law=fm.laws.Coulomb(mu_s=RUB), normal_force=1.0)]


def towards_rest(left):
    """Velocities (2, n) of that mass when so much time is left, from equations in the logarithm of speed."""

    def rate(_, y):  # of ln r and the angle to the pull, by the time that r takes to fall by its own size
        return [PULL * math.cos(y[1]) - RUB, -PULL * math.sin(y[1])]

    s = np.linspace(0.0, 120.0, 60_001)
    log_r, angle = solve_ivp(rate, (0.0, 120.0), [0.0, 0.5 * math.pi], "DOP853", s, rtol=1e-13, atol=1e-15).y
    log_left = log_r + np.log((RUB + PULL * np.cos(angle)) / LEFT)
    log_r, angle = (np.interp(-np.log(left), -log_left, y) for y in (log_r, angle))
    return np.exp(log_r) * np.array([np.cos(angle), np.sin(angle)])


@njit(error_model="numpy", pipeline_class=MachineCompiler)
def follow(plan, t):
    follow_landing(plan, t)


@pytest.mark.parametrize("pull", [0.0, 1e-3, 0.2, 0.45])
@pytest.mark.parametrize("angle", [0.0, 1e-3, 0.4, 2.0, 3.1, math.pi, 4.0])
def test_the_path_to_rest(angle, pull):
    """Velocity, way and direction at any time, beside steps of u' = a - b u/|u|."""
    a, u = pull * np.array([0.6, 0.8]), np.array([math.cos(angle + 0.9), math.sin(angle + 0.9)])
    end = (RUB + a @ u) / (RUB**2 - pull**2)
    t = end * np.array([0.0, 0.1, 0.5, 0.9, 0.99])

    def rate(_, y):
        return np.concatenate([a - RUB * y[:2] / np.linalg.norm(y[:2]), y[:2]])

    true = solve_ivp(rate, (0.0, t[-1]), [*u, 0.0, 0.0], "DOP853", t, rtol=1e-12, atol=1e-14).y
    for i in range(t.size):
        plan = np.array([end, *u, 0.0, 0.0, *a, RUB, *np.zeros(6)])
        follow(plan, t[i])
        np.testing.assert_allclose(plan[AT : AT + 2], true[:2, i], atol=1e-9)
        np.testing.assert_allclose(plan[WAY : WAY + 2], true[2:, i], atol=1e-9)
        np.testing.assert_allclose(plan[UNIT : UNIT + 2], true[:2, i] / np.linalg.norm(true[:2, i]), atol=1e-7)


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-9])
def test_slip_and_friction_on_the_last_bit_of_the_way(rtol):
    """The polynomials of that step lead to rest; what lies between turns as it should."""
    sol = fm.simulate(fm.Scene("pulled", pulled()), t_end=4.0, rtol=rtol, method="taylor")
    (stick,) = sol.events
    left = np.geomspace(rtol, 0.1 * math.sqrt(rtol), 60)
    seen, true = sol.at(stick.t - left), towards_rest(stick.t - (stick.t - left))
    np.testing.assert_allclose(seen.v, true, atol=0.1 * rtol)
    np.testing.assert_allclose(seen.force("sole"), -RUB * true / np.linalg.norm(true, axis=0), atol=0.02)


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-9])
def test_the_row_before_stick_has_the_last_direction_of_friction(rtol):
    """Slip has turned into the direction of the pull."""
    sol = fm.simulate(fm.Scene("pulled", pulled()), t_end=4.0, rtol=rtol, method="taylor")
    before, after = np.flatnonzero(sol.t == sol.events[0].t)
    assert list(sol.mode("sole")[[before, after]]) == [1, 0]
    np.testing.assert_allclose(sol.force("sole")[:, before], [-RUB, 0.0], atol=1e-3)
    np.testing.assert_allclose(sol.force("sole")[:, after], [-PULL, 0.0], atol=1e-12)


@pytest.mark.parametrize("rtol", [1e-6, 1e-9])
def test_a_run_that_is_cut_on_the_way_to_rest(rtol):
    scene = fm.Scene("pulled", pulled())
    for left in np.geomspace(0.01 * rtol, 1e-2, 25):
        begun = fm.simulate(scene, t_end=REST - left, rtol=rtol, method="taylor")
        rest = fm.simulate(scene, t_end=REST + 1.0, rtol=rtol, method="taylor", initial=begun)
        events = [*begun.events, *rest.events]
        assert [(event.kind, event.t) for event in events] == [("stick", pytest.approx(REST, abs=0.1 * rtol))]


@pytest.mark.parametrize("rtol", [1e-6, 1e-9])
@pytest.mark.parametrize("axes", ["x", "xy"])
def test_others_come_to_rest_on_the_way(axes, rtol):
    """A step that ends at another contact's transition is cut in the middle of this one's landing."""
    for before in np.geomspace(0.1 * rtol, 1e-2, 25):
        other = fm.Body("other", mass=1.0, axes=axes, velocity={"x": RUB * (REST - before)})
        parts = [other, fm.Contact("rub", other, law=fm.laws.Coulomb(mu_s=RUB), normal_force=1.0)]
        tie = fm.Spring("tie", (block := pulled())[0], other, axis="x", stiffness=1e-12)  # one island
        sol = fm.simulate(fm.Scene("two", [*block, *parts, tie]), t_end=4.0, rtol=rtol, method="taylor")
        found = {event.contact: event.t for event in sol.events}
        assert found == pytest.approx({"rub": REST - before, "sole": REST}, abs=0.2 * rtol)


def shaken(w):
    """A unit mass on the ground under two fast loads, from which it comes to rest and sets out again and again."""
    block = fm.Body("block", mass=1.0, axes="xy", velocity={"y": 0.3})
    law = fm.laws.Stribeck(mu_s=0.6, mu_k=0.4, v_s=0.05, exponent=1.0)
    loads = [0.9 * sympy.sin(w * fm.t), 0.5 * sympy.cos(0.77 * w * fm.t)]
    parts = [fm.Force(f"f{axis}", block, axis=axis, value=F) for axis, F in zip("xy", loads, strict=True)]
    return fm.Scene("shaken", [block, *parts, fm.Contact("sole", block, law=law, normal_force=1.0)])


@pytest.mark.parametrize("rtol", [1e-4, 1e-6])
def test_loads_that_change_on_the_way_to_rest(rtol):
    """The longest step is the whole run, since nothing rings; the loads say how far the way to rest is even."""
    t = np.linspace(0.0, 20.0, 201)
    true = fm.simulate(shaken(100.0), t_end=20.0, rtol=1e-9, t_eval=t, method="radau")
    sol = fm.simulate(shaken(100.0), t_end=20.0, rtol=rtol, t_eval=t, method="taylor")
    assert [event.kind for event in sol.events] == [event.kind for event in true.events]
    assert len(true.events) > 100
    np.testing.assert_allclose(sol.events.t, true.events.t, atol=rtol)
    np.testing.assert_allclose(sol.v, true.v, atol=0.1 * rtol)


def test_a_long_run_under_fast_loads_does_not_creep():
    """Steps that are short beside the run are not next to nothing where the loads take them."""
    sol = fm.simulate(shaken(10.0), t_end=600.0, rtol=1e-6, method="taylor")
    assert 10_000 < sol.stats.n_steps < 100_000
    w, N = 10.0, 1.0
    # it never rests from the second transition on: the mean of momentum's rate over many periods is that of friction
    assert len(sol.events) == 2
    assert np.linalg.norm(sol.force("sole"), axis=0).max() <= 0.6 * N * (1.0 + 1e-9)
    assert np.abs(sol.energy.residual).max() < 1e-4
    assert np.abs(sol.v[:, sol.t > 10.0]).max() < 3.0 * 0.9 / w


@pytest.mark.parametrize("excess", [1e-10, 1e-7])
@pytest.mark.parametrize("axis", ["x", "y"])
def test_a_load_next_to_the_limit(axis, excess):
    """x'' = excess mu N - x: at rest again after half a period, under a load that is as much below the limit."""
    block = fm.Body("block", mass=1.0, axes="xy")
    parts = [fm.Force("f", block, axis=axis, value=RUB * (1.0 + excess))]
    parts += [fm.Spring(f"k{a}", block, axis=a, stiffness=1.0) for a in "xy"]
    sole = fm.Contact("sole", block, law=fm.laws.Coulomb(mu_s=RUB), normal_force=1.0)
    sol = fm.simulate(fm.Scene("next", [block, *parts, sole]), t_end=8.0, rtol=1e-6, method="taylor")
    assert [(event.kind, event.t) for event in sol.events] == [("stick", pytest.approx(math.pi, abs=1e-4))]
    assert sol[f"block.{axis}"][-1] == pytest.approx(2.0 * RUB * excess, rel=1e-4)
