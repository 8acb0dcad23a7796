"""What becomes of derivatives: pickles, files, other times, errors."""

import pickle

import numpy as np
import pytest

import fricmb as fm

NAMES = ("belt.velocity.x", "rub.law.mu_s")


def scene():
    belt, mass = fm.Driven("belt", velocity={"x": 0.1}), fm.Body("mass", mass=1.0, velocity={"x": 0.1})
    rub = fm.Contact("rub", mass, belt, law=fm.laws.Coulomb(mu_s=1.5, mu_k=1.0), normal_force=1.0)
    return fm.Scene("belt", [mass, belt, fm.Spring("spring", mass, axis="x", stiffness=1.0), rub])


@pytest.fixture(scope="module")
def sol():
    return fm.simulate(scene(), t_end=30.0, rtol=1e-8, sensitivities=NAMES)


def assert_same(one, other):
    for name in NAMES:
        for signal in ("mass.x", "mass.x.velocity"):
            assert np.array_equal(one.sensitivity(signal, name), other.sensitivity(signal, name))
        assert [e.sensitivity(name) for e in one.events] == [e.sensitivity(name) for e in other.events]
    assert [e.transversality for e in one.events] == [e.transversality for e in other.events]


def test_pickles(sol):
    assert_same(sol, pickle.loads(pickle.dumps(sol)))


def test_files(sol, tmp_path):
    sol.save(tmp_path / "run")
    held = fm.Solution.load(tmp_path / "run")
    assert_same(sol, held)
    t = np.linspace(0.0, 30.0, 13)
    assert_same(sol.at(t), held.at(t))
    with np.load(tmp_path / "run.npz", allow_pickle=False) as data:
        assert data["sensitivity_S"].shape == (sol.t.size, 2, 2)


def test_other_times_lie_between_the_steps(sol):
    t = np.linspace(0.0, 30.0, 301)
    there = sol.at(t)
    again = fm.simulate(scene(), t_end=30.0, rtol=1e-8, t_eval=t, sensitivities=NAMES)
    for name in NAMES:
        assert there.sensitivity("mass.x", name) == pytest.approx(again.sensitivity("mass.x", name), abs=1e-9)
    own = there.sensitivity("mass.x", "belt.velocity.x")
    rate = there.sensitivity("mass.x.velocity", "belt.velocity.x")
    event = np.searchsorted(t, sol.events.t)
    inside = np.setdiff1d(np.arange(1, 300), [event, event - 1, event + 1])
    assert np.gradient(own, t)[inside] == pytest.approx(rate[inside], abs=0.02 * np.abs(rate).max())


def test_before_a_transition_the_derivatives_before_it(sol):
    first = np.searchsorted(sol.t, sol.events.t)
    change = np.diff(sol.sensitivity("mass.x.velocity", "belt.velocity.x"))[first]
    assert np.all(sol.t[first] == sol.t[first + 1])
    assert np.all(np.abs(change) > 1e-3)
    # what sticks moves with the belt
    after = sol.sensitivity("mass.x.velocity", "belt.velocity.x")[first[1] + 1]
    assert after == pytest.approx(1.0, abs=1e-12)


def test_runs_that_go_on_have_their_own(sol):
    later = fm.simulate(scene(), initial=sol, t_end=60.0, rtol=1e-8, sensitivities=NAMES)
    assert later.sensitivity("mass.x", NAMES[0])[0] == 0.0
    joined = fm.Solution.join([sol, later])
    with pytest.raises(fm.SceneError, match="joined runs have none"):
        joined.sensitivity("mass.x", NAMES[0])


def test_all_initial_values(sol):
    both = fm.simulate(scene(), t_end=30.0, rtol=1e-8, sensitivities=("state", *NAMES, "mass.velocity.x"))
    assert both.monodromy.shape == (2, 2)
    assert both.sensitivity("mass.x", "mass.position.x")[-1] == pytest.approx(both.monodromy[0, 0], abs=1e-12)
    assert both.sensitivity("mass.x", NAMES[0]) == pytest.approx(sol.sensitivity("mass.x", NAMES[0]), abs=1e-12)


def test_events_that_are_not_sound_are_a_list(sol, tmp_path):
    """Two blocks of one belt let go at the same time, each by its own limit: what follows is one-sided."""
    assert sol.unsafe_events == ()
    belt = fm.Driven("belt", velocity={"x": 0.1})
    blocks = [fm.Body(name, mass=1.0, velocity={"x": 0.1}) for name in ("one", "two")]
    law = fm.laws.Coulomb(mu_s=1.5, mu_k=1.0)
    parts = [fm.Spring(f"k_{body.name}", body, axis="x", stiffness=1.0) for body in blocks]
    parts += [fm.Contact(f"rub_{body.name}", body, belt, law=law, normal_force=1.0) for body in blocks]
    joined = fm.Spring("between", *blocks, axis="x", stiffness=0.5)
    scene = fm.Scene("twins", [belt, *blocks, *parts, joined])
    both = fm.simulate(scene, t_end=20.0, rtol=1e-8, sensitivities=("rub_one.law.mu_s",))
    first = both.unsafe_events[:2]
    assert {event.contact for event in first} == {"rub_one", "rub_two"}
    assert first[0].t == first[1].t == both.events[0].t
    assert any("one-sided" in note for note in both.stats.notes)
    both.save(tmp_path / "twins")
    held = fm.Solution.load(tmp_path / "twins").unsafe_events
    assert [event.t for event in held] == [event.t for event in both.unsafe_events]


def test_errors(sol):
    with pytest.raises(fm.SceneError, match=r"rub\.law\.mu_s"):
        fm.simulate(scene(), t_end=1.0, sensitivities=("rub.law.mu_q",))
    with pytest.raises(fm.SceneError, match="expected names"):
        fm.simulate(scene(), t_end=1.0, sensitivities=3)
    with pytest.raises(fm.SceneError, match="on_chunk"):
        fm.simulate(scene(), t_end=1.0, sensitivities="state", on_chunk=print)
    with pytest.raises(fm.SceneError, match="does not locate"):
        fm.simulate(scene(), t_end=1.0, sensitivities="state", method="bdf2-paper", step=0.1)
    with pytest.raises(fm.SceneError, match=r"mass\.x"):
        sol.sensitivity("mas.x", NAMES[0])
    with pytest.raises(fm.SceneError, match=r"belt\.velocity\.x"):
        sol.events[0].sensitivity("belt.velocity.y")
    with pytest.raises(fm.SceneError, match='sensitivities="state"'):
        _ = sol.monodromy
    plain = fm.simulate(scene(), t_end=30.0)
    with pytest.raises(fm.SceneError, match="simulate with"):
        plain.sensitivity("mass.x", NAMES[0])
    with pytest.raises(fm.SceneError, match="simulate with"):
        _ = plain.events[0].transversality
