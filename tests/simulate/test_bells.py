"""Bells: their tails, which are 1e-300 and not 0, and trains of them, at rest about the cone and in slip."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import erf

import fricmb as fm

F, MU = sympy.Float, 0.8
METHODS = ["auto", "radau", "bdf", "taylor"]


def block(load, velocity=0.0):
    """Mass 1 on the ground, which holds 1 and rubs with 0.8."""
    body = fm.Body("b", mass=1.0, velocity={"x": velocity})
    sole = fm.Contact("sole", body, law=fm.laws.Coulomb(mu_s=1.0, mu_k=MU), normal_force=1.0)
    return fm.Scene("bells", [body, fm.Force("load", body, axis="x", value=load), sole])


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("t_end", [5.4, 10.0])
def test_the_tail_of_a_bell_is_no_size(method, t_end):
    """Speeds that count as 1 were taken from a tail of 1e-300: 335 000 steps, or none that came to an end."""
    sol = fm.simulate(block(0.5 * sympy.exp(-(((fm.t - F(5.013)) / F(0.05)) ** 2))), t_end=t_end, method=method)
    assert not sol.events
    assert len(sol.t) < 400
    assert abs(sol["b.x"]).max() < 1e-15


@pytest.mark.parametrize("method", ["auto", "radau", "bdf"])
def test_the_tail_of_a_bell_of_the_ground_is_no_size(method):
    """Nothing but the ground moves, first by 1e-300: under a smooth law steps were as short as that asks."""
    at, width, size, v_reg = 12.4006, 0.03277, 0.1264, 1e-2
    bell = F(size) * sympy.exp(-(((fm.t - F(at)) / F(width)) ** 2))
    body, ground = fm.Body("b", mass=1.0), fm.Driven("ground", velocity={"x": bell})
    sole = fm.Contact("sole", body, ground, law=fm.laws.TanhRegularised(mu=0.6, v_reg=v_reg), normal_force=1.0)
    spring = fm.Spring("k", body, fm.GROUND, axis="x", stiffness=1.4)
    sol = fm.simulate(fm.Scene("bell", [body, ground, sole, spring]), t_end=16.0, method=method)
    own = solve_ivp(
        lambda t, y: [y[1], -1.4 * y[0] - 0.6 * np.tanh((y[1] - size * np.exp(-(((t - at) / width) ** 2))) / v_reg)],
        (at - 8 * width, 16.0), [0.0, 0.0], method="LSODA", rtol=1e-10, atol=1e-13, max_step=0.01,
    )  # fmt: skip
    assert len(sol.t) < 1000
    assert sol["b.x"][-1] == pytest.approx(own.y[0, -1], abs=1e-6 * abs(own.y[0]).max())


def pushed_by(bells):
    """Instants of letting go and coming to rest under bells (at, width, height) one by one."""
    events = []
    for at, width, height in bells:
        if height > 1.0:
            d = width * np.sqrt(np.log(height))

            def speed(t, at=at, width=width, height=height, d=d):
                area = 0.5 * height * width * np.sqrt(np.pi) * (erf((t - at) / width) + erf(d / width))
                return area - MU * (t - at + d)

            events += [at - d, brentq(speed, at + d, at + 10.0 * width, xtol=1e-15)]
    return events


@pytest.mark.parametrize("part", [1e-3, 1e-5])
def test_bells_at_any_times_just_over_the_cone_and_just_below(part):
    rng = np.random.default_rng(int(-np.log10(part)))
    at = np.sort(rng.uniform(0.5, 19.0, 8)).round(6)
    width = np.minimum(20.0 * part * rng.uniform(0.2, 1.0, 8), 0.05 * np.diff(at).min()).round(9)
    height = (1.0 + rng.choice([-1.0, 1.0], 8) * 10.0 ** rng.uniform(-4, -1, 8)).round(7)
    load = sum(F(h) * sympy.exp(-(((fm.t - F(a)) / F(w)) ** 2)) for a, w, h in zip(at, width, height, strict=True))
    expected = pushed_by(zip(at, width, height, strict=True))
    impulse = np.sqrt(np.pi) * width * height
    for method in METHODS:
        sol = fm.simulate(block(load), t_end=20.0, method=method)
        assert [e.t for e in sol.events] == pytest.approx(expected, abs=1e-6 * width.min()), method
        sol = fm.simulate(block(load, 30.0), t_end=20.0, method=method)
        assert sol.velocity("b.x")[-1] == pytest.approx(30.0 - 20.0 * MU + impulse.sum(), abs=1e-5 * impulse.max())


@pytest.mark.parametrize("method", METHODS)
def test_a_train_of_which_bounds_are_e_to_the_200(method):
    """1/cosh(sin(w t)/e) is a quotient of exponentials: where two of 23 bells lay no step was asked for."""
    omega, phase, width = 3.7, 0.3, 1e-2
    load = F(1.02) / sympy.cosh(sympy.sin(F(omega) * fm.t + F(phase)) / F(width))
    reach = np.arcsin(width * np.arccosh(1.02))
    expected = [(k * np.pi - phase - reach) / omega for k in range(1, 24)]
    sol = fm.simulate(block(load), t_end=20.0, method=method)
    assert [e.t for e in sol.events if e.kind == "slip"] == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("method", ["radau", "taylor"])
def test_a_train_of_very_many_bells(method):
    """Two hundred of them: bounds on halves and quarters of the run do not see them apart."""
    load = F(1.02) * sympy.exp(-((sympy.sin(F(300.0) * fm.t + F(0.3)) / F(1e-2)) ** 2))
    reach = np.arcsin(1e-2 * np.sqrt(np.log(1.02)))
    expected = [(k * np.pi - 0.3 - reach) / 300.0 for k in range(1, 192)]
    sol = fm.simulate(block(load), t_end=2.0, method=method)
    assert [e.t for e in sol.events if e.kind == "slip"] == pytest.approx([t for t in expected if t < 2.0], abs=1e-9)
    assert len(sol.t) < 50_000
