"""Events that a user asks for, against closed forms."""

import math
import pickle

import numpy as np
import pytest

import fricmb as fm

STIFFNESS = 4.0


def swing():
    """A mass that starts at 1 and swings as cos(2 t)."""
    mass = fm.Body("mass", mass=1.0, position={"x": 1.0})
    return fm.Scene("swing", [mass, fm.Spring("k", mass, axis="x", stiffness=STIFFNESS)])


def slide():
    """A block with a speed of 2 on the ground: it stops at t = 1 after a way of 1, by friction of 2."""
    block = fm.Body("block", mass=1.0, velocity={"x": 2.0})
    law = fm.laws.Coulomb(mu_s=0.2, mu_k=0.2)
    return fm.Scene("slide", [block, fm.Contact("sole", block, fm.GROUND, axes="x", law=law, normal_force=10.0)])


def crossings(level, t_end):
    """Times at which cos(2 t) passes a level."""
    first = math.acos(level)
    every = [x + 2.0 * math.pi * k for k in range(20) for x in (first, 2.0 * math.pi - first)]
    return np.array([x / 2.0 for x in every if x / 2.0 < t_end])


@pytest.mark.parametrize("method", ["auto", "radau", "bdf", "taylor"])
def test_passes_of_a_motion_a_speed_and_a_clock(method):
    events = {
        "half": fm.coordinate("mass.x") - 0.5,
        "turn": fm.speed("mass.x"),
        "clock": fm.t - math.sqrt(2.0),
        "near the top": ("mass.x", 0.9999),
    }
    sol = fm.simulate(swing(), t_end=10.0, rtol=1e-8, method=method, events=events)
    for name, right in (
        ("half", crossings(0.5, 10.0)),
        ("turn", np.pi / 2.0 * np.arange(1, 7)),
        ("clock", [math.sqrt(2.0)]),
        ("near the top", crossings(0.9999, 10.0)),
    ):
        found = sol.events.of(name=name)
        assert len(found) == len(right), name
        assert {event.kind for event in found} == {"event"}
        # a level next to the top is passed at a speed of 0.03: errors are larger by as much
        assert np.abs(found.t - right).max() < 1e-6, name
    assert (np.diff(sol.events.t) >= 0.0).all()


def test_a_pair_of_passes_within_one_step_is_found():
    """They are 4e-4 apart."""
    level = 1.0 - 1e-7
    sol = fm.simulate(swing(), t_end=10.0, events={"top": fm.coordinate("mass.x") - level})
    assert np.diff(sol.run.row_motion().samples.t).min() > 0.1
    assert np.abs(sol.events.t - crossings(level, 10.0)).max() < 1e-9


def test_what_touches_its_level_does_not_pass():
    sol = fm.simulate(swing(), t_end=20.0, rtol=1e-6, method="radau", events={"top": fm.coordinate("mass.x") - 1.0})
    assert len(sol.events) == 0


def test_rest_makes_no_events_of_round_off():
    events = {"speed": fm.speed("block.x"), "place": fm.coordinate("block.x") - 1.0, "half": ("sole.force", -1.0)}
    sol = fm.simulate(slide(), t_end=5.0, events=events)
    assert [event.name for event in sol.events] == ["sole", "half"], "friction ends with the slip"
    assert sol.events[0].contact == "sole"
    assert sol.events[1].contact == ""
    assert np.abs(sol.events.t - 1.0).max() < 1e-9


def test_a_relation_is_its_difference():
    sol = fm.simulate(swing(), t_end=3.0, events={"below": fm.coordinate("mass.x") < 0.25})
    assert np.allclose(sol.events.t, crossings(0.25, 3.0))


def test_a_parameter_has_the_value_of_the_run():
    load = fm.parameter("load", 1.0)
    mass = fm.Body("mass", mass=1.0)
    scene = fm.Scene("pushed", [mass, fm.Force("push", mass, axis="x", value=load)])
    events = {"pass": fm.coordinate("mass.x") - load}  # load t^2/2 = load
    for value in (1.0, 3.0):
        sol = fm.simulate(scene, t_end=3.0, parameters={"load": value}, events=events, sensitivities=("load",))
        assert sol.events.t == pytest.approx([math.sqrt(2.0)])
        assert sol.events[0].sensitivity("load") == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("method", ["auto", "radau"])
def test_a_run_ends_at_the_first_terminal_event(method):
    events = {"late": fm.t - 50.0, "half": fm.coordinate("mass.x") + 0.5, "before": fm.coordinate("mass.x") - 0.5}
    sol = fm.simulate(swing(), t_end=1e9, rtol=1e-8, method=method, events=events, terminal=("half", "late"))
    assert [event.name for event in sol.events] == ["before", "half"]
    assert abs(sol.t_end - math.acos(-0.5) / 2.0) < 1e-8
    assert sol.t[-1] == sol.t_end == sol.events[-1].t
    assert "where 'half' changes its sign" in sol.stats.notes[-1]
    on = fm.simulate(swing(), t_end=5.0, rtol=1e-8, initial=sol)
    assert abs(on["mass.x"][-1] - math.cos(10.0)) < 1e-6


def test_a_terminal_event_that_does_not_come_changes_nothing():
    plain = fm.simulate(slide(), t_end=5.0)
    sol = fm.simulate(slide(), t_end=5.0, events={"far": fm.coordinate("block.x") - 3.0}, terminal="far")
    assert sol.t_end == 5.0
    assert np.array_equal(sol.q, plain.q)
    assert list(sol.events) == list(plain.events)


def test_times_asked_for_end_with_the_run():
    events = {"half": fm.coordinate("mass.x")}
    sol = fm.simulate(swing(), t_end=10.0, t_eval=np.linspace(0.0, 10.0, 101), events=events, terminal="half")
    assert np.allclose(sol.t, np.arange(0.0, math.pi / 4.0, 0.1))


def test_times_move_with_a_parameter():
    events = {"half": fm.coordinate("mass.x") - 0.5, "turn": fm.speed("mass.x"), "signal": ("mass.x", 0.3)}
    sol = fm.simulate(swing(), t_end=3.0, rtol=1e-9, events=events, sensitivities=("k.stiffness",))
    for event in sol.events:  # cos(w t) keeps its phase: t goes with 1/w, w with the root of the stiffness
        assert event.sensitivity("k.stiffness") == pytest.approx(-event.t / (2.0 * STIFFNESS), rel=1e-6)
        assert event.transversality > 1.0


def test_times_behind_a_transition_move_with_a_parameter():
    """The block is pulled back at t = 2: its speed is mu g (t - 2), and its way half the square of that."""
    block = fm.Body("block", mass=1.0, velocity={"x": 2.0})
    law = fm.laws.Coulomb(mu_s=0.2, mu_k=0.2)
    pull = fm.Force("pull", block, axis="x", value=-3.0 * fm.t)
    contact = fm.Contact("sole", block, fm.GROUND, axes="x", law=law, normal_force=10.0)
    scene = fm.Scene("pulled", [block, contact, pull])
    events = {"back": fm.speed("block.x") + 1.0}
    sol = fm.simulate(scene, t_end=3.0, rtol=1e-10, events=events, sensitivities=("sole.normal_force",))
    (event,) = sol.events.of(name="back")
    step = 1e-5
    there = [
        fm.simulate(scene.with_parameters({"sole.normal_force": 10.0 + by}), t_end=3.0, rtol=1e-12, events=events)
        for by in (step, -step)
    ]
    slope = (there[0].events.of(name="back").t[0] - there[1].events.of(name="back").t[0]) / (2.0 * step)
    assert event.sensitivity("sole.normal_force") == pytest.approx(slope, rel=1e-5)
    assert len(sol.events) > 1
    assert all(math.isfinite(one.sensitivity("sole.normal_force")) for one in sol.events)


def test_files_pickles_parts_and_audits_know_them(tmp_path):
    events = {"half": fm.coordinate("block.x") - 0.5}
    sol = fm.simulate(slide(), t_end=5.0, events=events)
    right = 1.0 - math.sqrt(0.5)
    assert np.abs(sol.events.of(kind="event").t - right).max() < 1e-9
    sol.save(tmp_path / "run.npz")
    assert list(fm.Solution.load(tmp_path / "run.npz").events) == list(sol.events)
    assert list(pickle.loads(pickle.dumps(sol)).events) == list(sol.events)
    assert list(sol.at([1.0, 2.0]).events) == list(sol.events)
    parts = []
    fm.simulate(slide(), t_end=5.0, events=events, chunk=0.25, on_chunk=parts.append)
    assert np.allclose([event.t for part in parts for event in part.events], sol.events.t)
    assert fm.Solution.join(parts).events.of(name="half").t == pytest.approx([right])
    assert sol.audit().ok


def test_a_part_that_an_event_alone_reads_is_not_left_out():
    a, b = (fm.Body(name, mass=1.0, velocity={"x": 1.0}) for name in "ab")
    scene = fm.Scene("two", [a, b])
    sol = fm.simulate(scene, t_end=2.0, observe=["a.x"], events={"b": fm.coordinate("b.x") - 0.5})
    assert sol.events.t == pytest.approx([0.5])


def test_a_long_run_of_which_little_is_kept_finds_the_same(monkeypatch):
    from fricmb._simulate import _keep

    monkeypatch.setattr(_keep, "SMALL", 1e4)
    scene, events = fm.models.belt_oscillator(), {"pass": fm.speed("mass.x")}
    kept = fm.simulate(scene, t_end=100.0, t_eval=[0.0, 100.0], dense=False, method="radau", events=events)
    whole = fm.simulate(scene, t_end=100.0, method="radau", events=events)
    assert len(whole.events.of(kind="event")) > 10
    assert len(kept.events) == len(whole.events)
    assert np.abs(kept.events.t - whole.events.t).max() < 1e-5


@pytest.mark.parametrize(
    ("events", "said"),
    [
        ({"a": 3}, "does not change"),
        ({"a": fm.coordinate("mas.x")}, "did you mean 'mass.x'"),
        ({"a": ("mass.x",)}, "expected a signal and a number"),
        ({"a": "mass.x - 3"}, "events: 'a': value must be"),
        ([1], "events: got"),
    ],
)
def test_what_is_no_event_is_named(events, said):
    with pytest.raises(fm.SceneError, match="event") as caught:
        fm.simulate(swing(), t_end=1.0, events=events)
    assert said in str(caught.value)


def test_a_terminal_event_has_to_be_among_the_events():
    with pytest.raises(fm.SceneError, match="did you mean 'half'"):
        fm.simulate(swing(), t_end=1.0, events={"half": fm.t - 0.5}, terminal="hal")
