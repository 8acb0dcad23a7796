"""Every law of the catalogue: one loop of properties, then closed forms law by law."""

import pickle
import subprocess
import sys
import warnings

import numpy as np
import pytest

import fricmb as fm
from fricmb import laws

EVERY = [getattr(laws, name) for name in laws.names]
SPEEDS = np.array([0.0, 1e-300, 1e-12, 1e-3, 0.1, 1.0, 30.0, 1e3, 1e150, 1e300])


@pytest.mark.parametrize("law_type", EVERY)
def test_numbers_are_finite_everywhere_without_warnings(law_type):
    law = law_type.example()
    d = law.dimensions[-1]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mu, slope = law.coefficient(SPEEDS), law.derivative(SPEEDS)
        force = law.force(np.array([SPEEDS, -SPEEDS, SPEEDS][:d]), 2.0)
    assert mu.shape == slope.shape == SPEEDS.shape
    assert np.all(np.isfinite(mu))
    assert np.all(np.isfinite(slope))
    assert np.all(np.isfinite(force))
    assert np.all(mu >= 0.0)


@pytest.mark.parametrize("law_type", EVERY)
def test_derivative_is_that_of_the_coefficient(law_type):
    law = law_type.example()
    r = np.array([3e-4, 2e-3, 0.03, 0.2, 0.7, 2.5])
    h = 1e-6 * r
    difference = (law.coefficient(r + h) - law.coefficient(r - h)) / (2 * h)
    np.testing.assert_allclose(law.derivative(r), difference, rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("law_type", EVERY)
def test_scalars_give_scalars(law_type):
    law = law_type.example()
    assert isinstance(law.coefficient(0.3), float)
    assert isinstance(law.derivative(0.3), float)
    if 1 in law.dimensions:
        assert isinstance(law.force(0.3, 2.0), float)
        assert law.force(np.array([0.3]), 2.0).shape == (1,)
    d = law.dimensions[-1]
    assert law.force(np.full((d, 5), 0.3), np.linspace(0, 1, 5)).shape == (d, 5)


@pytest.mark.parametrize("law_type", [t for t in EVERY if not t.states and 3 not in t.example().dimensions])
def test_force_opposes_slip_and_vanishes_at_rest(law_type):
    law = law_type.example()
    v = np.array([[0.3, 0.0, -0.4], [0.4, 0.0, 0.0]])
    N = np.array([2.0, 2.0, 3.0])
    if law.dimensions == (1,):
        v[1] = 0.0
        force = np.array([law.force(v[:1], N)[0], np.zeros(3)])
    else:
        force = law.force(v, N)
    force[: len(law.offsets())] += np.array(law.offsets())[:, None] * N * (np.hypot(*v) > 0) if law.offsets() else 0.0
    scale = np.array(law.axis_scale() or (1.0, 1.0))[:, None]
    scaled = scale * v
    r = np.hypot(*scaled)
    np.testing.assert_allclose(np.hypot(*(force / scale)), law.coefficient(r, N) * N * (r > 0), rtol=1e-14)
    np.testing.assert_allclose(force[0] * scaled[1] * scale[1] - force[1] * scaled[0] * scale[0], 0.0, atol=1e-15)
    assert np.all((force * v).sum(axis=0) <= 0.0)
    np.testing.assert_allclose(force[:, 1], 0.0, atol=1e-60)


@pytest.mark.parametrize("law_type", EVERY)
def test_laws_pickle_compare_and_hash(law_type):
    law = law_type.example()
    again = pickle.loads(pickle.dumps(law))
    assert again == law
    assert hash(again) == hash(law)
    name, value = next(iter(law.slots().items()))
    other = law.with_slots({name: tuple(1.01 * v + 1e-3 for v in value) if isinstance(value, tuple) else 1.1 * value})
    assert other != law


@pytest.mark.parametrize("law_type", EVERY)
def test_named_parameters_stand_for_every_number(law_type):
    law = law_type.example()
    path, value = (
        next((p, v) for p, v in law.slots().items() if isinstance(v, float))
        if law_type is not laws.Tabulated
        else ("mu_s", 0.7)
    )
    named = law.with_slots({path: fm.parameter("p", value)})
    assert named.numeric() == law.with_slots({path: value})
    np.testing.assert_array_equal(named.coefficient(SPEEDS[:8]), named.numeric().coefficient(SPEEDS[:8]))
    assert named.with_named({"p": 1.01 * value}).numeric_slots()[path] == 1.01 * value


def test_coulomb():
    law = laws.Coulomb(mu_s=0.5)
    assert law.coefficient(3.0) == 0.5
    assert law.break_away() == law.slip_limit() == 0.5
    assert law.with_slots({"mu_s": 0.7}).slip_limit() == 0.7  # mu_k follows
    assert laws.Coulomb(mu_s=0.5, mu_k=0.2).slip_limit() == 0.2
    assert law.kind == "constant"


def test_stribeck():
    law = laws.Stribeck(mu_s=0.6, mu_k=0.4, v_s=0.1, exponent=1.5, viscous=0.02)
    r = np.array([0.0, 0.05, 0.3])
    np.testing.assert_allclose(law.coefficient(r), 0.4 + 0.2 * np.exp(-((r / 0.1) ** 1.5)) + 0.02 * r, rtol=1e-15)
    assert law.break_away() == law.slip_limit() == law.coefficient(0.0) == 0.6
    exponential = laws.Stribeck(mu_s=0.6, mu_k=0.4, v_s=0.1, exponent=1.0)
    assert exponential.derivative(0.0) == pytest.approx(-2.0, rel=1e-12)
    steep = laws.Stribeck(mu_s=0.6, mu_k=0.4, v_s=1e-3, exponent=40.0)
    assert np.all(np.isfinite(steep.derivative(SPEEDS)))


def test_hyperbolic_stribeck():
    law = laws.HyperbolicStribeck(mu_s=1.3, mu_k=0.1, delta=3.0)
    assert law.coefficient(2.0) == pytest.approx(0.1 + 1.2 / 7.0, rel=1e-15)
    assert law.derivative(0.0) == pytest.approx(-3.6, rel=1e-15)
    assert laws.HyperbolicStribeck(mu_s=1.0, delta=3.0).mu_k == 0.0


def test_lugre_in_steady_sliding_has_its_coefficient():
    law = laws.LuGre(sigma0=1e4, sigma1=10.0, sigma2=0.4, mu_s=0.6, mu_k=0.4, v_s=0.1)
    v = np.array([0.03, -0.04])
    steady = (law.coefficient(0.05) - 0.4 * 0.05) / 1e4 * v / 0.05
    np.testing.assert_allclose(law.rate(v, 2.0, steady), 0.0, atol=1e-16)
    np.testing.assert_allclose(law.force(v, 2.0, steady), -2.0 * law.coefficient(0.05) * v / 0.05, rtol=1e-12)
    assert law.rate(np.full((2, 3), 0.1), 1.0, np.zeros(2)).shape == (2, 3)
    # at rest the bristles hold, and their force is that of a spring
    assert law.force(0.0, 2.0, [1e-5]) == pytest.approx(-0.2, rel=1e-15)
    assert law.rate(0.0, 2.0, [1e-5]) == pytest.approx(0.0, abs=1e-12)


def test_table_is_monotone_between_its_points_and_constant_outside():
    speed, mu = (0.01, 0.1, 0.5, 2.0), (0.6, 0.45, 0.3, 0.35)
    law = laws.Tabulated(speed=list(speed), mu=np.array(mu))
    np.testing.assert_allclose(law.coefficient(speed), mu, rtol=1e-15)
    assert law.coefficient(0.0) == 0.6
    assert law.coefficient(1e300) == 0.35
    assert np.all(np.diff(law.coefficient(np.linspace(0.01, 0.5, 200))) < 0.0)
    assert np.all(np.diff(law.coefficient(np.linspace(0.5, 2.0, 200))) > 0.0)
    assert law.break_away() == 0.6
    assert laws.Tabulated(speed=speed, mu=mu, mu_s=0.8).break_away() == 0.8


def test_compiled_table_equals_the_numeric_one():
    law = laws.Tabulated.example()
    block, function = law.parameter_block(), law.compiled_coefficient()
    for r in (0.0, 0.005, 0.01, 0.03, 0.1, 0.77, 2.99, 3.0, 50.0):
        out = np.full(3, np.nan)
        function(np.array([r, 1.0]), block, out)
        np.testing.assert_allclose(out, [law.coefficient(r), law.derivative(r), 0.0], rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: laws.Coulomb(mu_s=0.3, mu_k=0.5), ("mu_k", "0.5", "mu_s", "0.3")),
        (lambda: laws.Coulomb(mu_s=-0.3), ("mu_s", "-0.3", ">= 0")),
        (lambda: laws.Coulomb(mu_s=float("nan")), ("mu_s", "nan", "finite")),
        (lambda: laws.Coulomb(mu_s="0.3"), ("mu_s", "'0.3'", "number")),
        (lambda: laws.Coulomb(mu_s=True), ("mu_s", "True", "number")),
        (lambda: laws.Coulomb(mu_s=fm.parameter("mu", -1.0)), ("mu_s", "-1")),
        (lambda: laws.Stribeck(mu_s=0.3, mu_k=0.5, v_s=1.0), ("Stribeck", "mu_k", "0.5")),
        (lambda: laws.Stribeck(mu_s=0.5, mu_k=0.3, v_s=0.0), ("v_s", "> 0")),
        (lambda: laws.Stribeck(mu_s=0.5, mu_k=0.3, v_s=1.0, exponent=-2.0), ("exponent", "-2.0")),
        (lambda: laws.HyperbolicStribeck(mu_s=0.5, delta=-1.0), ("delta", "-1.0")),
        (lambda: laws.LuGre(sigma0=0.0, sigma1=0.0, sigma2=0.0, mu_s=1.0, mu_k=1.0, v_s=1.0), ("sigma0", "> 0")),
        (lambda: laws.Tabulated(speed=[0.0, 1.0, 1.0], mu=[1.0, 1.0, 1.0]), ("speed", "increasing")),
        (lambda: laws.Tabulated(speed=[0.0, 1.0], mu=[1.0]), ("mu", "two")),
        (lambda: laws.Tabulated(speed=[0.0, 1.0], mu=[1.0, -1.0]), ("mu", ">= 0")),
        (lambda: laws.Tabulated(speed=0.0, mu=[1.0, 1.0]), ("speed",)),
        (lambda: laws.Tabulated(speed=[0.0, float("inf")], mu=[1.0, 1.0]), ("speed[1]", "inf")),
        (lambda: laws.Tabulated(speed=[0.0, 1.0], mu=[0.5, 0.4], mu_s=0.3), ("mu_s", "0.3", "0.5")),
        (lambda: laws.Coulomb(mu_s=0.3).coefficient(-1.0), ("r", "-1.0")),
        (lambda: laws.Coulomb(mu_s=0.3).force(np.zeros((4, 2)), 1.0), ("v_rel", "(4, 2)")),
        (lambda: laws.LuGre.example().rate([0.1, 0.1], 1.0, [0.0]), ("state", "(2,)", "(1,)")),
    ],
)
def test_bad_laws_say_what_is_wrong(make, words):
    with pytest.raises(fm.LawError) as error:
        make()
    for word in words:
        assert word in str(error.value)
    assert isinstance(error.value, ValueError)


def test_built_in_constant_and_table_laws_need_no_sympy():
    code = (
        "import fricmb as fm, sys\n"
        "c = fm.laws.Coulomb(mu_s=0.5, mu_k=0.3); c.coefficient(1.0); c.derivative(1.0); c.force([1.0, 2.0], 3.0)\n"
        "fm.laws.Stribeck.example(); fm.laws.HyperbolicStribeck.example(); fm.laws.LuGre.example()\n"
        "assert not {'sympy', 'numba', 'matplotlib'} & set(sys.modules), 'heavy import'\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
