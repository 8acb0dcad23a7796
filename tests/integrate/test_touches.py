"""A touch is not a stick: slip whose speed only comes down to the belt's, against closed forms."""

import numpy as np
import pytest

import fricmb as fm


@pytest.mark.parametrize("mu", [1e-7, 1e-5, 1e-2, 0.1, 1.0])
@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-9])
@pytest.mark.parametrize("method", ["auto", "radau", "bdf", "taylor"])
def test_a_block_that_touches_the_speed_of_its_belt_slips_on(mu, rtol, method):
    """Started on the belt: x = V t up to mu/V, then mu + V sin(t - mu/V) for ever, which touches V once a period."""
    V = 0.1
    sol = fm.simulate(fm.models.belt_oscillator(mu_s=mu, mu_k=mu), t_end=40.0, rtol=rtol, method=method)
    t = np.linspace(0.0, 40.0, 4001)
    exact = np.where(t < mu / V, V * t, mu + V * np.sin(t - mu / V))
    assert np.abs(sol.at(t)["mass.x"] - exact).max() <= rtol * max(mu, V)
    assert [e.kind for e in sol.events] == ["slip"]
    assert sol.audit().ok, sol.audit()


def grazing():
    block = fm.Body("b", mass=1.1, position={"x": -0.5}, velocity={"x": 0.64})
    belt = fm.Driven("belt", velocity={"x": 0.1})
    sole = fm.Contact("c", block, belt, law=fm.laws.Coulomb(mu_s=0.47), normal_force=1.9)
    return fm.Scene("grazing", [block, belt, fm.Spring("k", block, axis="x", stiffness=7.7), sole])


@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("method", ["auto", "radau", "bdf", "taylor"])
def test_nothing_happens_after_the_last_stick(rtol, method, tmp_path):
    """Twelve touches in thirty seconds, in the run, in its modes, out of a file and gone on with."""
    sol = fm.simulate(grazing(), t_end=30.0, rtol=rtol, method=method)
    assert [e.kind for e in sol.events] == ["reversal", "stick", "slip"]
    assert not ((sol.mode("c") == 0) & (sol.t > sol.events.t[2])).any()
    sol.save(tmp_path / "run.fricmb")
    again = fm.Solution.load(tmp_path / "run.fricmb")
    assert [e.kind for e in again.events] == ["reversal", "stick", "slip"]
    further = fm.simulate(grazing(), t_end=60.0, rtol=rtol, method=method, initial=sol)
    assert [e.kind for e in fm.Solution.join([sol, further]).events] == ["reversal", "stick", "slip"]


@pytest.mark.parametrize("rtol", [1e-8, 1e-10])
@pytest.mark.parametrize("method", ["auto", "radau", "taylor"])
def test_a_short_stick_that_is_one_stays(rtol, method):
    """Slip ends at t = 1 a ten thousandth short of where friction lets go: stick for a thousandth of a second."""
    V, mu, short = 0.1, 0.1, 1e-4
    block = fm.Body(
        "b", mass=1.0, position={"x": mu - short * np.cos(1.0) - V * np.sin(1.0)},
        velocity={"x": V * np.cos(1.0) - short * np.sin(1.0)},
    )  # fmt: skip
    belt = fm.Driven("belt", velocity={"x": V})
    sole = fm.Contact("c", block, belt, law=fm.laws.Coulomb(mu_s=mu), normal_force=1.0)
    scene = fm.Scene("s", [block, belt, fm.Spring("k", block, axis="x", stiffness=1.0), sole])
    sol = fm.simulate(scene, t_end=5.0, rtol=rtol, method=method)
    assert [e.kind for e in sol.events] == ["stick", "slip"]
    np.testing.assert_allclose(sol.events.t, [1.0, 1.0 + short / V], atol=1e-5 if rtol > 1e-9 else 1e-6)
