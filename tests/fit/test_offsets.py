"""Signals whose zero is not known."""

import numpy as np
import pytest

import fricmb as fm

TRUE = {"sole.law.mu_k": 0.9, "spring.stiffness": 1.2}
BOUNDS = {"sole.law.mu_k": (0.5, 1.2), "spring.stiffness": (0.5, 2.0)}


@pytest.fixture(scope="module")
def truth():
    t = np.linspace(0.5, 30.0, 120)
    scene = fm.models.belt_oscillator(belt=0.4, mu_s=1.4, damping=0.15).with_parameters(TRUE)
    return fm.simulate(scene, t_end=30.0, t_eval=t, rtol=1e-10)


def fitted(truth, data, **options):
    scene = fm.models.belt_oscillator(belt=0.4, mu_s=1.4, damping=0.15, mu_k=1.0)
    return fm.fit(scene, {"t": truth.t} | data, parameters=BOUNDS, progress=False, **options)


def test_an_offset_is_found_beside_the_parameters(truth):
    data = {"mass.x": truth["mass.x"] + 0.37}
    found = fitted(truth, data, offset="mass.x")
    for name, value in TRUE.items():
        assert found.values[name] == pytest.approx(value, abs=1e-6)
    assert found.offsets["mass.x"] == pytest.approx(0.37, abs=1e-6)
    assert np.abs(found.residuals["mass.x"]).max() < 1e-5
    assert "mass.x: zero of the measurement +0.37" in str(found)
    # without it the parameters make up for what is not theirs
    plain = fitted(truth, data, starts=1)
    assert abs(plain.values["spring.stiffness"] - TRUE["spring.stiffness"]) > 0.02
    assert plain.offsets == {}


def test_errors_of_the_parameters_count_that_it_was_unknown(truth):
    """Against the covariance of the problem with the offset as one more column."""
    noise = 0.01 * np.random.default_rng(2).standard_normal(truth.t.size)
    data = {"mass.x": truth["mass.x"] + noise - 0.2}
    found = fitted(truth, data, offset=True, sigma=0.01)
    h, columns = 1e-5, []
    for name, value in found.values.items():
        ends = [
            fm.simulate(found.scene.with_parameters({name: value + s * h}), t_end=30.0, t_eval=truth.t, rtol=1e-11)
            for s in (-1, 1)
        ]
        columns.append((ends[1]["mass.x"] - ends[0]["mass.x"]) / (2 * h))
    J = np.column_stack([*columns, np.ones(truth.t.size)]) / 0.01
    expected = np.sqrt(np.diag(np.linalg.inv(J.T @ J)))[:2]
    np.testing.assert_allclose(list(found.std.values()), expected, rtol=1e-3)
    assert found.offsets["mass.x"] == pytest.approx(-0.2, abs=0.01)


def test_what_is_no_signal_is_refused(truth):
    with pytest.raises(fm.FricmbError, match=r"unknown signal in offset 'mass\.y'; .*'mass\.x'"):
        fitted(truth, {"mass.x": truth["mass.x"]}, offset="mass.y")
    with pytest.raises(fm.SceneError, match="offset: got 3; expected True, False, or names"):
        fitted(truth, {"mass.x": truth["mass.x"]}, offset=3)
