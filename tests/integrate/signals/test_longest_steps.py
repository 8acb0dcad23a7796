"""Steps that no function of time can be passed over by."""

import numpy as np
import pytest
import sympy
from numba import njit

import fricmb as fm
from fricmb.equations._inputs import time_inputs
from fricmb.integrate.formulas.tableau import radau
from fricmb.integrate.problem import Input
from fricmb.integrate.signals import longest_steps as module
from fricmb.integrate.signals.longest_steps import longest_steps

T, A = sympy.Symbol("t", real=True), sympy.Symbol("a0", real=True)


@njit
def longest_from(edge, longest, t):
    """Kernels are called by what is compiled alone."""
    return module.longest_from(edge, longest, t)


def input_of(expression, rates=0):
    (found,) = time_inputs(expression, T, [A], rates)
    return Input(tape=tuple(map(tuple, found["tape"])), parameters=(1.0,), rates=rates)


FUNCTIONS = {
    "sine": 0.6 + 0.3 * sympy.sin(20 * T) + 0.002 * T,
    "chirp": sympy.sin(T**2),
    "pulse": sympy.exp(-((1e3 * (T - sympy.Float(3.7123))) ** 2)),
    "engagement": sympy.tanh(200 * (T - sympy.Float(4.1))),
    "late": sympy.exp(-((1e4 * (T - sympy.Float(9.9999))) ** 2)),
}


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize(("tol", "nodes"), [(1e-4, 5), (1e-8, 7)])
def test_polynomials_through_the_nodes_of_such_steps_follow_the_function(name, tol, nodes):
    """Steps as long as they may be, wherever they begin: what lies between the nodes is off by ``tol`` at most."""
    expression = FUNCTIONS[name]
    found = longest_steps((input_of(expression),), 0.0, 10.0, tol=tol, nodes=nodes)
    function = sympy.lambdify(T, expression)
    scale = np.abs(function(np.linspace(0.0, 10.0, 2_000_001))).max()
    c, between = radau(nodes).c, np.linspace(0.0, 1.0, 40)
    rng = np.random.default_rng(1)
    starts = np.concatenate([rng.uniform(0.0, 10.0, 200), 3.7123 + rng.normal(0.0, 2e-3, 100), [0.0, 9.9]])
    for t in starts[(starts >= 0.0) & (starts < 10.0)]:
        h = min(longest_from(found.edge, found.longest, t), 10.0 - t)
        fit = np.polynomial.Polynomial.fit(c, function(t + c * h), nodes - 1)
        assert np.abs(fit(between) - function(t + between * h)).max() <= 1.01 * tol * scale, t


def test_a_sine_of_a_billion_periods_has_one_stretch():
    found = longest_steps((input_of(sympy.sin(20 * T)),), 0.0, 1e9, tol=1e-6, nodes=7)
    inside = np.isfinite(found.longest)
    assert inside.sum() == 1
    assert 0.02 < found.longest[inside][0] < 0.2


def test_where_nothing_happens_steps_are_free():
    found = longest_steps((input_of(FUNCTIONS["pulse"]),), 0.0, 10.0, tol=1e-6, nodes=7)
    assert longest_from(found.edge, found.longest, 3.8) > 0.5
    assert longest_from(found.edge, found.longest, 0.0) < 3.7123  # not over the pulse
    assert longest_from(found.edge, found.longest, 3.7123) < 1e-3


@pytest.mark.parametrize("rates", [0, 1])
def test_rates_of_a_position_count(rates):
    """A position that hardly moves may have a speed that does."""
    expression = T**2 + 1e-4 * sympy.sin(1000 * T)
    found = longest_steps((input_of(expression, rates),), 0.0, 10.0, tol=1e-6, nodes=7)
    step = longest_from(found.edge, found.longest, 5.0)
    assert (step < 0.02) == (rates == 1 or step < 0.02)
    if rates:
        other = longest_steps((input_of(expression, 0),), 0.0, 10.0, tol=1e-6, nodes=7)
        assert step < 0.5 * longest_from(other.edge, other.longest, 5.0)


def test_linear_functions_and_scenes_without_any_limit_nothing():
    assert time_inputs(2 + A * T, T, [A]) == []
    found = longest_steps((), 0.0, 1.0, tol=1e-6, nodes=7)
    assert longest_from(found.edge, found.longest, 0.5) == np.inf


def test_parts_of_a_force_that_depend_on_time_alone():
    x = sympy.Symbol("y0", real=True)
    found = time_inputs(x * sympy.sin(50 * T) * T**2 + sympy.exp(-T) * x**2, T, [A])
    assert len(found) == 2


def test_a_function_without_bounds_is_sampled():
    """A pulse of a thousandth of the run is seen, and one of a millionth may not be."""
    found = time_inputs(sympy.atanh(sympy.exp(-((100 * (T - 5)) ** 2)) / 2), T, [A])
    assert "source" in found[0]
    scene = fm.Scene("pushed", [
        body := fm.Body("b", mass=1.0, velocity={"x": 1.0}),
        fm.Force("push", body, axis="x", value=50 * sympy.atanh(sympy.exp(-((100 * (fm.t - 5)) ** 2)) / 2)),
        fm.Contact("sole", body, law=fm.laws.Coulomb(mu_s=0.1), normal_force=1.0),
    ])  # fmt: skip
    from fricmb.system import build

    (given,) = build(scene).problem.signals.inputs
    assert given.tape is None
    steps = longest_steps((given,), 0.0, 10.0, tol=1e-6, nodes=7)
    assert longest_from(steps.edge, steps.longest, 5.0) < 0.01


def test_a_bell_is_found_at_little_cost_wherever_it_is():
    """Where a stretch is halved in the middle of a bell each half saves little: a thousandth of what quarters save."""
    rng = np.random.default_rng(3)
    for width in (1e-2, 1e-4, 1e-6):
        for at in [*rng.uniform(0.0, 26.2933, 15), 11.2471, 26.2933 / 64 * 27.375]:
            given = input_of(sympy.exp(-(((T - sympy.Float(at)) / sympy.Float(width)) ** 2)))
            steps = longest_steps((given,), 0.0, 26.2933, tol=1e-6, nodes=7)
            limited = np.isfinite(steps.longest)
            assert (np.diff(steps.edge)[limited] / steps.longest[limited]).sum() < 60
