"""Minima beside the best one: found again from several sides, and told in words where there is doubt."""

import numpy as np
import pytest

import fricmb as fm

TIMES = np.linspace(0.5, 40.0, 80)
TRUE = {"sole.law.mu_s": 1.4, "sole.law.mu_k": 0.9, "damper.damping": 0.15, "spring.stiffness": 1.2}
BOUNDS = {
    "sole.law.mu_s": (1.0, 2.0), "sole.law.mu_k": (0.5, 1.2), "damper.damping": (0.0, 0.5),
    "spring.stiffness": (0.5, 2.0),
}  # fmt: skip
GUESS = fm.models.belt_oscillator(belt=0.4, mu_s=1.3, mu_k=1.0, damping=0.1, stiffness=1.1)


@pytest.fixture(scope="module")
def exact():
    return fm.simulate(GUESS.with_parameters(TRUE), t_end=40.0, t_eval=TIMES, rtol=1e-9)["mass.x"]


def noisy(exact, seed):
    return exact + 0.02 * np.random.default_rng(seed).standard_normal(TIMES.size)


@pytest.mark.parametrize("seed", [0, 9, 11, 13])
def test_no_fit_is_worse_than_the_truth(exact, seed):
    """Least squares over four parameters lie below the residuals of the values that made the data."""
    data = noisy(exact, seed)
    found = fm.fit(GUESS, {"t": TIMES, "mass.x": data}, parameters=BOUNDS, progress=False)
    assert np.linalg.norm(found.residuals["mass.x"]) < np.linalg.norm(data - exact)
    off = [(found.values[name] - value) / found.std[name] for name, value in TRUE.items()]
    assert np.abs(off).max() < 4.0
    assert found.notes == ()


def test_a_parameter_that_data_do_not_bound_is_noted(exact):
    """The block sticks on the belt but for the last 0.1 s, which tells next to nothing of what it slips by."""
    t = np.linspace(0.0, 2.96, 60)
    x = fm.simulate(GUESS, t_end=2.96, t_eval=t, rtol=1e-9)["mass.x"]
    data = x + 0.02 * np.random.default_rng(1).standard_normal(t.size)
    bounds = {"sole.law.mu_k": (0.5, 1.2), "damper.damping": (0.0, 0.5)}
    found = fm.fit(GUESS, {"t": t, "mass.x": data}, parameters=bounds, progress=False)
    wide = [name for name, (low, high) in bounds.items() if 0.5 * (high - low) < found.std[name] < np.inf]
    assert wide
    for name in wide:
        assert any(note.startswith(f"{name} is not determined within its bounds") for note in found.notes)


def test_doubt_says_what_it_rests_on(exact):
    """A scene with a wrong spring cannot explain the data; how much it explains is said as well."""
    scene = GUESS.with_parameters({"spring.stiffness": 1.6})
    bounds = {"sole.law.mu_s": (1.0, 2.0), "sole.law.mu_k": (0.5, 1.2)}
    found = fm.fit(scene, {"t": TIMES, "mass.x": noisy(exact, 1)}, parameters=bounds, starts=2, progress=False)
    (note,) = [note for note in found.notes if "false minimum" in note]
    data = noisy(exact, 1)
    explained = 1.0 - (found.residuals["mass.x"] ** 2).sum() / ((data - data.mean()) ** 2).sum()
    assert float(note.split("R^2 is ")[1].split()[0]) == pytest.approx(explained, abs=0.05)
