"""fm.Signal: values, what is refused, filters."""

import warnings

import numpy as np
import pandas as pd
import pytest
import sympy
from scipy.interpolate import CubicSpline

import fricmb as fm

T = np.linspace(0.0, 4.0, 401)


def wave(t):
    return np.sin(2.0 * np.pi * 3.0 * t)


def test_values_between_and_outside():
    y = wave(T)
    x = np.array([-1.0, 0.123, 2.0, 3.9999, 4.0, 7.0])
    held = fm.Signal(T, y, outside="hold")
    assert held(x) == pytest.approx(np.interp(x, T, y), abs=1e-15)
    assert fm.Signal(T, y, outside="zero")([-1.0, 5.0]) == pytest.approx([0.0, 0.0])
    assert fm.Signal(T, y, "hold")([0.0149, 0.0151]) == pytest.approx([y[1], y[1]])
    inner = np.random.default_rng(0).uniform(0.0, 4.0, 100)
    assert fm.Signal(T, y, "cubic")(inner) == pytest.approx(CubicSpline(T, y)(inner), abs=1e-13)


def test_values_outside_are_refused_unless_said():
    signal = fm.Signal(T, wave(T), name="push")
    for x in (-0.1, [1.0, 4.1], np.inf):
        with pytest.raises(fm.SceneError, match="Signal 'push': known from t = 0 to 4, not at"):
            signal(x)
    # an end is inside, round-off aside
    assert signal(4.0 * (1.0 + 1e-15)) == pytest.approx(float(wave(4.0)), abs=1e-12)


def test_expressions_print_differentiate_and_evaluate():
    signal = fm.Signal(T, wave(T), "cubic", name="push")
    expression = 2 * signal + fm.t
    assert str(expression) == "t + 2*push(t)"
    assert str(expression.diff(fm.t)) == "2*push'(t) + 1"
    assert str(signal.slope) == "push'(t)"
    spline = CubicSpline(T, wave(T))
    assert float(signal.slope.subs(fm.t, 1.234)) == pytest.approx(float(spline(1.234, 1)), abs=1e-11)
    assert float(signal.integral.subs(fm.t, 1.234)) == pytest.approx(float(spline.integrate(0.0, 1.234)), abs=1e-13)
    assert sympy.lambdify(list(expression.free_symbols), expression)  # has an implementation of its own


@pytest.mark.parametrize(
    ("t", "y", "given", "said"),
    [
        ([0.0, 1.0, 2.0], [0.0, np.nan, 1.0], {}, r"y holds nan at place 1 \(t = 1\), 1 such"),
        ([0.0, 1.0, 1.0], [0.0, 1.0, 1.0], {}, r"t = 1 occurs twice \(places 1 and 2"),
        ([0.0, 2.0, 1.0], [0.0, 1.0, 1.0], {}, "t falls from 2 to 1"),
        ([0.0, 1.0], [0.0, 1.0, 1.0], {}, "as many values as t, 2, got 3"),
        ([0.0, 1.0], [0.0, 1.0], {"kind": "cubic"}, "cubic takes at least 4 values, got 2"),
        ([0.0, 1.0], [0.0, 1.0], {"kind": "spline"}, "kind must be one of linear, hold, cubic"),
        ([0.0, 1.0], [0.0, 1.0], {"outside": "nan"}, "outside must be one of refuse, hold, zero"),
        ([0.0, 1.0], ["a", "b"], {}, "y must be a vector of real numbers"),
    ],
)
def test_what_is_refused(t, y, given, said):
    with pytest.raises(fm.SceneError, match=said):
        fm.Signal(t, y, **given)


def test_filters_are_those_of_scipy_and_have_no_delay():
    slow, fast = wave(T), 0.5 * np.sin(2.0 * np.pi * 40.0 * T)
    signal = fm.Signal(T, slow + fast)
    inner = slice(50, -50)
    assert signal.lowpass(12.0).y[inner] == pytest.approx(slow[inner], abs=5e-3)
    assert signal.highpass(12.0).y[inner] == pytest.approx(fast[inner], abs=5e-3)
    assert fm.Signal(T, slow + 3.0 + 2.0 * T).detrended().y == pytest.approx(
        fm.Signal(T, slow).detrended().y, abs=1e-12
    )
    with pytest.raises(fm.SceneError, match="half that of the values, 50"):
        signal.lowpass(60.0)
    uneven = fm.Signal(np.delete(T, 100), np.delete(slow, 100))
    with pytest.raises(fm.SceneError, match=r"even times, spaced by 0.01; from t = 0.99 to 1.01"):
        uneven.lowpass(12.0)


def test_resampled_has_even_times_and_no_image_of_what_was_too_fast():
    fine = np.linspace(0.0, 4.0, 8001)
    signal = fm.Signal(fine, wave(fine) + np.sin(2.0 * np.pi * 105.0 * fine))
    found = signal.resampled(0.01)  # 105 would be seen as 5
    assert np.diff(found.t) == pytest.approx(np.full(found.t.size - 1, 0.01))
    inner = slice(50, -50)
    assert found.y[inner] == pytest.approx(wave(found.t)[inner], abs=2e-2)
    uneven = fm.Signal(np.sort(np.concatenate([fine[::5], fine[1::50]])), np.zeros(1601 + 160))
    assert np.ptp(np.diff(uneven.resampled(0.01).t)) < 1e-12


def test_aligned_finds_a_delay_between_the_samples():
    rng = np.random.default_rng(1)
    bump = lambda t: np.exp(-(((t - 1.7) / 0.1) ** 2))  # noqa: E731
    late = fm.Signal(T, bump(T - 0.3137) + 0.01 * rng.standard_normal(T.size))
    found = late.aligned(fm.Signal(T, bump(T)))
    assert found.t[0] == pytest.approx(-0.3137, abs=1e-3)
    assert late.shifted(-0.3137).t[0] == pytest.approx(-0.3137)


def test_noise_and_that_of_the_slope():
    rng = np.random.default_rng(2)
    t = np.linspace(0.0, 10.0, 10001)
    noise = 0.01 * rng.standard_normal(t.size)
    for kind in ("linear", "cubic"):
        signal = fm.Signal(t, np.sin(t) + noise, kind)
        assert signal.noise == pytest.approx(0.01, rel=0.05)
        clean = fm.Signal(t, np.sin(t), kind)
        from fricmb.integrate.signals.pieces import SLOPE

        spread = np.std(signal._table.value(t[5:-5], SLOPE) - clean._table.value(t[5:-5], SLOPE))
        assert signal.slope_noise == pytest.approx(spread, rel=0.05)


def test_gaps_are_named():
    t = np.concatenate([T[:100], T[130:]])
    assert fm.Signal(t, wave(t)).gaps == [(pytest.approx(0.99), pytest.approx(1.3))]


def test_pandas():
    body = fm.Body("b", mass=1.0)
    frame = pd.DataFrame({"F": wave(T), "x": T}, index=pd.Index(T, name="t"))
    assert str(fm.Force("f", body, axis="x", value=frame["F"]).value) == "F(t)"
    dates = pd.Series(wave(T), index=pd.to_datetime("2024-05-01") + pd.to_timedelta(T, unit="s"))
    force = fm.Force("f", body, axis="x", value=dates)
    assert float(force.value.subs(fm.t, 0.12)) == pytest.approx(wave(0.12), abs=1e-9)
    with pytest.raises(fm.SceneError, match=r"Force 'f': value: Signal: a DataFrame with 2 columns, F, x"):
        fm.Force("f", body, axis="x", value=frame)


def test_a_position_whose_speed_is_noise_is_warned_of():
    rng = np.random.default_rng(4)
    clean, noisy = (fm.Signal(T, wave(T) + size * rng.standard_normal(T.size), "cubic") for size in (0.0, 0.3))
    with pytest.warns(UserWarning, match=r"position\['x'\]: the speed that follows from 'signal' has"):
        fm.Driven("table", position={"x": noisy})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fm.Driven("table", position={"x": clean})
        fm.Driven("table", position={"x": noisy.lowpass(6.0)})
        fm.Driven("table", velocity={"x": noisy})


def test_masked_values_are_missing():
    masked = np.ma.array([1, 5, 3], mask=[False, True, False])
    with pytest.raises(fm.SceneError, match=r"y holds nan at place 1 \(t = 1\)"):
        fm.Signal([0.0, 1.0, 2.0], masked)
    assert fm.Signal([0.0, 1.0, 2.0], np.ma.array([1, 5, 3]))([0.5]) == pytest.approx([3.0])
