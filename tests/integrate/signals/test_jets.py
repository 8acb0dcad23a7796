"""Bounds of Taylor coefficients, against mpmath's at 40 digits."""

import itertools

import mpmath
import numpy as np
import pytest
import sympy

from fricmb.equations._inputs import time_inputs
from fricmb.integrate.signals.jets import bounds

T, A = sympy.Symbol("t", real=True), sympy.Symbol("a0", real=True)
ORDER = 8
SMOOTH = {
    "sin": A * sympy.sin(3 * T) + 0.2 * T,
    "cos of square": sympy.cos(T**2),
    "tanh": sympy.tanh(5 * (T - 1)),
    "bell": sympy.exp(-4 * (T - 1) ** 2),
    "log": sympy.log(1 + T),
    "atan": sympy.atan(4 * T),
    "erf": sympy.erf(4 * T),
    "erfc": sympy.erfc(T),
    "asin": sympy.asin(T / 4),
    "acos": sympy.acos(T / 4),
    "power": (1 + T) ** sympy.Rational(-3, 2),
    "inverse": 1 / (1 + T) ** 2,
    "quotient": sympy.sin(T) / (2 + sympy.cos(T)),
    "exponent": (1 + T) ** (A * T),
    "tan": sympy.tan(T / 3),
    "cosh": sympy.cosh(T),
}


def tape_of(expression):
    (found,) = time_inputs(expression, T, [A])
    return found["tape"]


@pytest.mark.parametrize("name", SMOOTH)
def test_coefficients_lie_within_their_bounds(name):
    expression, a = SMOOTH[name], 1.3
    edge = np.linspace(0.1, 2.0, 7)
    jet = bounds(tape_of(expression), (a,), edge[:-1], edge[1:], ORDER)
    with mpmath.workdps(40):
        function = sympy.lambdify(T, expression.subs(A, a), "mpmath")
        for i in range(edge.size - 1):
            for t in np.linspace(edge[i], edge[i + 1], 5):
                true = np.array([float(c) for c in mpmath.taylor(function, mpmath.mpf(t), ORDER)])
                slack = 1e-10 * (1.0 + np.abs(true))
                assert (jet.low[:, i] - slack <= true).all(), t
                assert (true <= jet.high[:, i] + slack).all(), t


@pytest.mark.parametrize("name", ["sin", "log", "power"])
def test_bounds_on_short_intervals_are_no_larger_than_they_have_to_be(name):
    expression = SMOOTH[name].subs(A, 1.3)
    low = np.linspace(0.1, 2.0, 20)
    jet = bounds(tape_of(expression), (), low, low + 1e-3, ORDER)
    for order in range(2, ORDER + 1):
        derivative = sympy.lambdify(T, sympy.diff(expression, T, order) / sympy.factorial(order))
        true = np.maximum(np.abs(derivative(low)), np.abs(derivative(low + 1e-3)))
        assert (jet.size(order) <= 1.1 * true + 1e-2 * true.max()).all()


SWITCHED = [
    (sympy.Piecewise((sympy.sin(9 * T), T < 1), (0.5, T < 2), (T**3, True)), (1.0, 2.0)),
    (sympy.Heaviside(T - 1.5) * sympy.exp(T), (0.0, 1.5)),
    (sympy.Max(0, sympy.sin(3 * T)), None),
    (sympy.Abs(sympy.cos(3 * T)), None),
    (sympy.sign(T - 1) * T**2, None),
    (sympy.Min(sympy.sin(3 * T), 0.2), None),
]


@pytest.mark.parametrize(("expression", "flat"), SWITCHED)
def test_what_switches_is_enclosed_and_exact_where_it_does_not(expression, flat):
    tape = tape_of(expression)
    edge = np.linspace(0.0, 3.0, 40)
    jet = bounds(tape, (), edge[:-1], edge[1:], 4)
    function = sympy.lambdify(T, expression, ["math", {"Heaviside": lambda x, *_: float(x >= 0)}])
    for i, (a, b) in enumerate(itertools.pairwise(edge)):
        values = [function(t) for t in np.linspace(a + 1e-9, b - 1e-9, 7)]
        assert jet.low[0, i] - 1e-9 <= min(values)
        assert max(values) <= jet.high[0, i] + 1e-9
        if flat is not None and flat[0] < a and b < flat[1]:
            assert jet.size(1)[i] == 0.0
