"""Expressions of time and motions: signals, breakpoints, forces split by what they depend on."""

import numpy as np
import pytest
import sympy
from scipy.integrate import quad

import fricmb as fm
from fricmb.equations import derivations, force_terms, function, signal_expression, value_expression


def outputs(template, x, p, n):
    out = np.full(n, np.nan)
    function(template.address)(np.atleast_1d(np.array(x, dtype=float)), np.array(p, dtype=float), out)
    return out


def test_signal_by_value_has_both_derivatives():
    a = fm.parameter("a", 0.7)
    signal = signal_expression(a * sympy.sin(3 * fm.t), "value", 0.25, "test")
    u = outputs(signal.template, 0.4, signal.parameters, 3)
    expected = [0.25 + 0.7 * np.sin(1.2), 2.1 * np.cos(1.2), -6.3 * np.sin(1.2)]
    np.testing.assert_allclose(u, expected, rtol=1e-14)


@pytest.mark.parametrize(
    ("velocity", "switch"),
    [
        (sympy.exp(-fm.t) * sympy.cos(2 * fm.t), []),
        (sympy.Piecewise((0.2 * fm.t, fm.t < 2), (0.4, True)), [2.0]),
        (1.5 * sympy.Heaviside(fm.t - 1) - 0.5 * sympy.Heaviside(fm.t - 2.5), [1.0, 2.5]),
        (sympy.sin(sympy.sin(fm.t)) + 0.1, []),
    ],
    ids=["smooth", "piecewise", "heaviside", "no closed form"],
)
def test_position_is_the_integral_of_a_velocity(velocity, switch):
    signal = signal_expression(velocity, "rate", 2.0, "test")
    assert sorted(instant(signal.parameters) for instant, *_ in signal.template.instants) == switch
    number = sympy.lambdify(fm.t, velocity, "math")
    if velocity.has(sympy.Heaviside):
        number = lambda t: 1.5 * (t >= 1) - 0.5 * (t >= 2.5)  # noqa: E731
    for t in (0.0, 0.7, 1.9, 6.0):
        points = [s for s in switch if s < t] or None
        exact = quad(number, 0.0, t, points=points, epsabs=1e-13)[0]
        u = outputs(signal.template, t, signal.parameters, 3)
        assert u[0] == pytest.approx(2.0 + exact, abs=1e-12)
        assert u[1] == pytest.approx(number(t), abs=1e-14)


def test_a_breakpoint_follows_its_parameter():
    t0 = fm.parameter("t0", 1.25)
    signal = signal_expression(sympy.Heaviside(2 * fm.t - t0), "value", 0.0, "test")
    ((instant, *_),) = signal.template.instants
    assert instant(signal.parameters) == pytest.approx(0.625)


def test_equal_formulas_with_other_parameters_share_a_template():
    def make(name, value):
        k = fm.parameter(name, value)
        return value_expression(k * fm.coordinate("pad.x") ** 2 + sympy.cosh(fm.t), "test").template.key

    first = make("k", 1.0)
    before = len(derivations)
    assert make("k", 2.0) == first
    assert make("other", 3.0) == first
    assert len(derivations) == before


def test_value_with_gradient():
    k = fm.parameter("k", 2.0)
    x, v = fm.coordinate("pad.x"), fm.speed("pad.y")
    expression = value_expression(k * x**2 * v + sympy.sin(fm.t), "test")
    assert (expression.coordinates, expression.speeds, expression.timed) == (("pad.x",), ("pad.y",), True)
    found = outputs(expression.template, (0.5, 3.0, 1.0), expression.parameters, 4)
    np.testing.assert_allclose(found, [1.5 + np.sin(1.0), 6.0, 0.5, np.cos(1.0)], rtol=1e-14)


def test_force_terms_are_sorted():
    k, off = fm.parameter("k", 2.0), fm.parameter("off", 0.0)
    x, v, t = fm.coordinate("pad.x"), fm.speed("pad.x"), fm.t
    terms = force_terms(3 - k * x + 0.5 * v + sympy.sin(t) + k * x**3 + off * x**2, "test")
    assert terms.constant == 3.0
    assert set(terms.slopes) == {("coordinate", "pad.x", -2.0), ("speed", "pad.x", 0.5)}
    assert terms.signal == sympy.sin(t)
    assert sympy.simplify(terms.rest - sympy.sympify(k) * x**3) == 0
    assert force_terms(off * x**3, "test").rest is None
    # what depends on a prescribed motion brings power in and is never part of the structure
    assert force_terms(x, "test", {"pad.x"}).slopes == ()


def test_unknown_symbols_are_named():
    with pytest.raises(fm.SceneError, match="zeta"):
        value_expression(sympy.Symbol("zeta") * fm.t, "Force 'f': value")
    with pytest.raises(fm.SceneError, match=r"pad\.x"):
        signal_expression(fm.coordinate("pad.x"), "value", 0.0, "Driven 'belt'")
