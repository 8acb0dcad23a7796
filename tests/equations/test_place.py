"""Places of motions that are given by their velocity, beside closed forms: however quick the velocity is."""

import math

import numpy as np
import pytest
import sympy
from scipy.integrate import quad
from scipy.special import erf, fresnel

import fricmb as fm
from fricmb.equations import function, signal_expression
from fricmb.equations._place import integrate

T = fm.t
AT = 50.3
ROOT = math.sqrt(math.pi)
HOPS = [lambda u: sympy.exp(-(u**2)) / sympy.sqrt(sympy.pi), lambda u: 1 / (2 * sympy.cosh(u) ** 2)]


def place(velocity, time):
    signal = signal_expression(velocity, "rate", 0.0, "test")
    out = np.full(3, np.nan)
    function(signal.template.address)(np.array([time]), np.array(signal.parameters, dtype=float), out)
    return out[0]


@pytest.mark.parametrize("width", [1e-1, 1e-3, 1e-6])
@pytest.mark.parametrize("time", [60.0, 50.0, -3.0])
def test_a_bell_however_narrow(width, time):
    exact = 0.3 * time + ROOT / 2 * (erf((time - AT) / width) + erf(AT / width))
    found = place(0.3 + sympy.exp(-(((T - AT) / width) ** 2)) / width, time)
    assert found == pytest.approx(exact, rel=1e-13, abs=1e-14)


def test_a_bell_of_parameters():
    a, w = fm.parameter("a", AT), fm.parameter("w", 1e-3)
    assert place(sympy.exp(-(((T - a) / w) ** 2)), 60.0) == pytest.approx(1e-3 * math.sqrt(math.pi), rel=1e-13)


@pytest.mark.parametrize("width", [1e-1, 1e-3, 1e-5])
@pytest.mark.parametrize(
    ("velocity", "exact"),
    [
        (lambda u, w: 1 / (1 + u**2), lambda b, w: w * math.atan(b)),
        (lambda u, w: 1 / (1 + u**2) ** sympy.Rational(3, 2), lambda b, w: w * b / math.hypot(1, b)),
        (lambda u, w: 1 / sympy.cosh(u), lambda b, w: w * 2 * math.atan(math.tanh(b / 2))),
        (lambda u, w: 1 / sympy.cosh(u) ** 2, lambda b, w: w * math.tanh(b)),
        (lambda u, w: sympy.sin(sympy.erf(u)) + 1, lambda b, w: w * b),
        (lambda u, w: sympy.exp(-(u**2)) * sympy.cos(3 * u), lambda b, w: w * ROOT / 2 * math.exp(-9 / 4)),
    ],
    ids=["lorentz", "power", "sech", "sech2", "engaged", "packet"],
)
def test_pulses_without_a_closed_form_or_with(velocity, exact, width):
    """By the place at 2 ``AT``, which is twice the integral from the middle for even pulses."""
    found = place(velocity((T - AT) / width, width), 2 * AT)
    assert found == pytest.approx(2 * exact(AT / width, width), rel=1e-10)


@pytest.mark.parametrize("hertz", [0.5, 100.0, 44.1e3])
def test_the_place_of_a_wave_is_a_closed_form_however_fast(hertz):
    """By quadrature each value of a wave of 100 Hz would cost in proportion to the periods before it."""
    omega = 2 * np.pi * hertz
    velocity = 0.4 * sympy.cos(omega * T)
    assert integrate(velocity, T, []) is not None
    assert place(velocity, 8.0) == pytest.approx(0.4 * math.sin(omega * 8.0) / omega, abs=8.0 * 0.4 * 2.3e-16)


def test_trains_of_bells():
    """Each bell of ``exp(-(sin t / w)^2)`` has pi exp(-k) I_0(k), k = 1/(2 w^2)."""
    from scipy.special import ive

    k = 0.5e4
    assert place(sympy.exp(-((sympy.sin(T) / 1e-2) ** 2)), 16.5 * math.pi) == pytest.approx(16.5 * math.pi * ive(0, k))


@pytest.mark.parametrize("time", [0.3, 7.0, -2.0, 40.0])
def test_chirps_and_beats(time):
    a = 0.4
    s = fresnel(time * math.sqrt(2 * a / math.pi))[0] * math.sqrt(math.pi / (2 * a))
    assert place(sympy.sin(a * T**2), time) == pytest.approx(s, abs=1e-13)
    beat = (math.sin(17 * time - 1) - math.sin(-1)) / 34 - (math.sin(23 * time + 1) - math.sin(1)) / 46
    assert place(sympy.sin(20 * T) * sympy.sin(3 * T + 1), time) == pytest.approx(beat, abs=1e-14)


def test_a_function_of_a_square():
    """Its argument has no two zeros to be quick at: they are one, where it turns."""
    points = [3.2, 3.28, 3.3, 3.32, 3.4]
    exact = quad(lambda t: math.tanh(((t - 3.3) / 1e-2) ** 2), 0.0, 9.0, points=points, epsabs=1e-14)
    assert place(sympy.tanh(((T - 3.3) / 1e-2) ** 2), 9.0) == pytest.approx(exact[0], rel=1e-12)


@pytest.mark.parametrize("method", ["auto", "radau", "bdf"])
@pytest.mark.parametrize("pulse", HOPS, ids=["bell", "sech2"])
def test_a_spring_to_ground_that_hops(method, pulse):
    """Ground that goes 1 further within 1e-4: a body on a spring swings about the new place."""
    ground = fm.Driven("ground", velocity={"x": pulse((T - 5.3) / 1e-5) * 1e5})
    block = fm.Body("block", mass=1.0, axes="x")
    scene = fm.Scene("hop", [ground, block, fm.Spring("spring", block, ground, axis="x", stiffness=1.0)])
    sol = fm.simulate(scene, t_end=9.0, t_eval=[5.0, 9.0], rtol=1e-8, method=method)
    np.testing.assert_allclose(sol.q[0], [0.0, 1 - math.cos(9.0 - 5.3)], atol=1e-6)
