"""Limit cycles against closed forms and a prototype in 30-digit arithmetic, and what cannot be a cycle."""

import pickle

import numpy as np
import pytest
import sympy

import fricmb as fm

LEINE = fm.laws.HyperbolicStribeck(mu_s=1.0, mu_k=0.0, delta=3.0)


def den_hartog(omega=0.4, mu_s=1.25, value=None):
    mass, w = fm.Body("mass", mass=1.0), fm.parameter("omega", omega)
    return fm.Scene(
        "forced",
        [
            mass,
            fm.Spring("spring", mass, axis="x", stiffness=1.0),
            fm.Damper("damper", mass, axis="x", damping=0.1),
            fm.Contact("sole", mass, law=fm.laws.Coulomb(mu_s=mu_s, mu_k=1.0), normal_force=0.4),
            fm.Force("drive", mass, axis="x", value=sympy.cos(w * fm.t) if value is None else value),
        ],
    )


@pytest.fixture(scope="module")
def belt():
    return fm.analysis.limit_cycle(fm.models.belt_oscillator())


@pytest.fixture(scope="module")
def driven():
    return fm.analysis.limit_cycle(den_hartog())


def test_belt_has_the_closed_forms(belt):
    """T = 2 D/V + 2 (pi - atan(D w/V))/w, D = (mu_s - mu_k) N/k, and its derivatives."""
    assert belt.period == pytest.approx(13.53638377328955475520274, rel=1e-13)
    exact = {
        "belt.velocity.x": -96.15384615384615384615385,
        "sole.law.mu_s": 19.230769230769230769,
        "sole.law.mu_k": -19.230769230769230769,
        "mass.mass": 1.96049957895246969,
        "spring.stiffness": -11.5758841943370851,
        "sole.normal_force": 9.61538461538461538,
    }
    for name, value in exact.items():
        assert belt.sensitivity("period", name) == pytest.approx(value, abs=1e-9), name
    assert belt.sensitivity("period", "mass.position.x") == pytest.approx(0.0, abs=1e-9)
    assert np.abs(belt.multipliers) == pytest.approx([0.0], abs=1e-9)
    assert belt.stable
    assert [event.kind for event in belt.events] == ["stick", "slip"]
    # A = sqrt(D^2 + V^2): dA/dV = V/A
    assert belt.amplitude("mass.x") == pytest.approx(0.5099019513592784830028, rel=1e-12)
    assert belt.sensitivity("mass.x", "belt.velocity.x") == pytest.approx(0.1 / np.sqrt(0.26), rel=1e-9)


def test_leines_oscillator():
    cycle = fm.analysis.limit_cycle(fm.models.belt_oscillator(belt=0.2, law=LEINE))
    assert cycle.period == pytest.approx(12.0010312948305786469, rel=1e-13)
    exact = {
        "belt.velocity.x": -30.300423494504402117,
        "spring.stiffness": -9.9589921160152764256,
        "damper.damping": -10.169833981690928169,
        "sole.law.mu_s": 7.9169529371999742043,
        "sole.law.delta": 0.6189560794330312603,
    }
    for name, value in exact.items():
        assert cycle.sensitivity("period", name) == pytest.approx(value, rel=2e-10), name
    assert cycle.amplitude("mass.x") == pytest.approx(0.5 * (1.13394467644165683998 + 0.5554326900602316063), rel=1e-12)


def test_den_hartog(driven):
    """Two sticks a period; the section's time moves with the drive."""
    assert driven.period == pytest.approx(5.0 * np.pi, rel=1e-14)
    assert driven.multipliers[0] == pytest.approx(0.21431492140652878768, rel=1e-10)
    assert abs(driven.multipliers[1]) < 1e-12
    times = [18.15119319359291996277, 23.24070589490598087408, 26.00517482756740305893, 31.09468752888046397024]
    off = np.array(sorted(np.mod(times, driven.period))) - np.sort(np.mod(driven.events.t, driven.period))
    assert np.abs(off).max() < 1e-10
    assert driven.amplitude("mass.x") == pytest.approx(1.059269513157373852607, rel=1e-12)
    assert driven.sensitivity("mass.x", "omega") == pytest.approx(2.2221116384609168994, rel=1e-9)
    assert driven.sensitivity("period", "omega") == pytest.approx(-2.0 * np.pi / 0.16, rel=1e-14)
    # F_s = mu_s N at mu_k N = 0.4
    assert driven.sensitivity("mass.x", "sole.law.mu_s") == pytest.approx(0.4 * 0.14915323774197896702, rel=1e-9)


@pytest.mark.parametrize("section", [("mass.x", 1.2), ("mass.x.velocity", 0.0)])
def test_any_section_will_do(section, belt):
    cycle = fm.analysis.limit_cycle(fm.models.belt_oscillator(), section=section)
    assert cycle.period == pytest.approx(belt.period, rel=1e-12)
    assert cycle.sensitivity("period", "belt.velocity.x") == pytest.approx(-96.1538461538461538, abs=1e-8)


def test_a_section_in_stick():
    """Varied along the stuck states alone; they move with the belt."""
    run = fm.simulate(fm.models.belt_oscillator(), t_end=41.0, rtol=1e-8)  # ends stuck, after it has passed x = 1.2
    cycle = fm.analysis.limit_cycle(fm.models.belt_oscillator(), start=run, section=("mass.x", 1.2))
    assert cycle.solution.mode("sole")[0] == 0
    assert cycle.sensitivity("period", "belt.velocity.x") == pytest.approx(-96.1538461538461538, abs=1e-8)
    assert cycle.sensitivity("mass.x", "belt.velocity.x") == pytest.approx(0.1 / np.sqrt(0.26), rel=1e-8)
    assert np.abs(cycle.multipliers).max(initial=0.0) < 1e-9


def test_two_laps(belt):
    twice = fm.analysis.limit_cycle(fm.models.belt_oscillator(), start=belt, laps=2)
    assert twice.period == pytest.approx(2.0 * belt.period, rel=1e-12)
    assert len(twice.events) == 4


def test_a_cycle_starts_another():
    first = fm.analysis.limit_cycle(fm.models.belt_oscillator(belt=0.2, law=LEINE))
    second = fm.analysis.limit_cycle(fm.models.belt_oscillator(belt=0.21, law=LEINE), start=first)
    direct = fm.analysis.limit_cycle(fm.models.belt_oscillator(belt=0.21, law=LEINE))
    assert second.period == pytest.approx(direct.period, rel=1e-11)


def test_laws_with_states():
    """A bristle never sticks: all multipliers are there, and a run that is left alone closes after the period."""
    law = fm.laws.LuGre(sigma0=1e3, sigma1=10.0, sigma2=0.0, mu_s=1.5, mu_k=1.0, v_s=0.1)
    scene = fm.models.belt_oscillator(belt=0.2, damping=0.01, law=law)
    cycle = fm.analysis.limit_cycle(scene, start=fm.simulate(scene, t_end=150.0, rtol=1e-8), rtol=1e-9)
    assert cycle.multipliers.size == 2
    assert cycle.residual < 1e-7
    long = fm.simulate(scene, t_end=400.0, rtol=1e-10)
    passes = fm.analysis.poincare_section(long, ("mass.x.velocity", 0.0), rising=True, discard=0.7).t
    assert np.diff(passes).mean() == pytest.approx(cycle.period, rel=1e-7)


def test_periods_of_drives():
    period = fm.analysis.limit_cycle(den_hartog(value=sympy.cos(0.4 * fm.t) + 0.1 * sympy.sin(0.6 * fm.t))).period
    assert period == pytest.approx(10.0 * np.pi, rel=1e-14)
    with pytest.raises(fm.analysis.AnalysisError, match="period"):
        fm.analysis.limit_cycle(den_hartog(value=sympy.cos(0.4 * fm.t) + sympy.sin(sympy.sqrt(2) * fm.t)))
    with pytest.raises(fm.analysis.AnalysisError, match="period="):
        fm.analysis.limit_cycle(den_hartog(value=sympy.exp(-fm.t)))


def test_a_spring_to_a_shaken_place():
    """Only whole periods will do as sections, since the place is the integral of a velocity."""
    mass, base = fm.Body("mass", mass=1.0), fm.Driven("base", velocity={"x": sympy.cos(0.7 * fm.t)})
    spring = fm.Spring("spring", mass, base, axis="x", stiffness=1.0)
    sole = fm.Contact("sole", mass, law=fm.laws.Coulomb(mu_s=0.5, mu_k=0.4), normal_force=1.0)
    scene = fm.Scene("shaken", [mass, base, spring, sole])
    cycle = fm.analysis.limit_cycle(scene)
    run = fm.simulate(scene, t_end=80.0 * np.pi / 0.7, rtol=1e-10)
    t = run.t_end - cycle.period + np.linspace(0.0, cycle.period, 50)
    assert np.ptp(run.at(t)["mass.x"]) == pytest.approx(2.0 * cycle.amplitude("mass.x"), rel=1e-2)
    assert np.abs(run.at(t)["mass.x"] - cycle.solution.at(t - t[0])["mass.x"]).max() < 1e-7


def test_what_cannot_be_a_cycle():
    quiet = fm.models.belt_oscillator(damping=0.5, mu_s=1.0, x0=1.0, v0=0.0)
    with pytest.raises(fm.analysis.AnalysisError, match=r"does not oscillate|no cycle"):
        fm.analysis.limit_cycle(quiet)
    still = fm.simulate(quiet, t_end=300.0)
    with pytest.raises(fm.analysis.AnalysisError, match="does not oscillate"):
        fm.analysis.limit_cycle(quiet, start=still)
    dying = fm.models.friction_oscillator(friction=0.0, damping=0.01)
    with pytest.raises(fm.analysis.AnalysisError):
        fm.analysis.limit_cycle(dying)
    with pytest.raises(fm.SceneError, match="mass"):
        fm.analysis.limit_cycle(fm.models.belt_oscillator(), section=("mass.y", 0.0))
    with pytest.raises(fm.analysis.AnalysisError, match="start must be a Solution"):
        fm.analysis.limit_cycle(fm.models.belt_oscillator(), start=40.0)
    with pytest.raises(fm.analysis.AnalysisError, match="laps"):
        fm.analysis.limit_cycle(fm.models.belt_oscillator(), laps=0)
    with pytest.raises(fm.analysis.AnalysisError, match="turn"):
        fm.analysis.limit_cycle(fm.models.dry_pendulum())


def test_a_parameter_that_also_gives_the_start():
    """The mass starts with the belt: a cycle knows of the belt alone."""
    V = fm.parameter("V", 0.1)
    mass, belt = fm.Body("mass", mass=1.0, velocity={"x": V}), fm.Driven("belt", velocity={"x": V})
    sole = fm.Contact("sole", mass, belt, law=fm.laws.Coulomb(mu_s=1.5, mu_k=1.0), normal_force=1.0)
    scene = fm.Scene("belt", [mass, belt, fm.Spring("spring", mass, axis="x", stiffness=1.0), sole])
    cycle = fm.analysis.limit_cycle(scene)
    assert cycle.sensitivity("period", "V") == pytest.approx(-96.1538461538461538, abs=1e-8)


def test_names_and_files(belt):
    with pytest.raises(fm.SceneError, match="sole"):
        belt.sensitivity("period", "sole.law.mu")
    with pytest.raises(fm.FricmbError):
        belt.amplitude("mass.y")
    again = pickle.loads(pickle.dumps(belt))
    assert again.sensitivity("period", "sole.law.mu_s") == belt.sensitivity("period", "sole.law.mu_s")
    assert "stable" in str(belt)
