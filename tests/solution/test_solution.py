import pickle
from dataclasses import fields, replace

import numpy as np
import pytest

from fricmb.errors import FricmbError, IntegrationError, SceneError
from fricmb.integrate import MotionSamples

ENDS = np.pi * np.arange(1, 6)


def test_rows_hold_each_transition_twice(sol):
    assert sol.q.shape == sol.v.shape == (1, sol.t.size)
    for end in ENDS:
        assert (sol.t == end).sum() == 2
    last = np.flatnonzero(sol.t == ENDS[-1])
    assert sol.mode("floor")[last].tolist() == [1, 0]


def test_signals_by_name(sol):
    np.testing.assert_array_equal(sol["mass.x"], sol.q[0])
    np.testing.assert_array_equal(sol.velocity("mass.x"), sol.v[0])
    np.testing.assert_array_equal(sol["mass.tip.x"], 2 * sol.q[0])
    np.testing.assert_array_equal(sol.velocity("mass.tip.x"), 2 * sol.v[0])
    np.testing.assert_allclose(sol["base.x"], 0.1 * sol.t)
    np.testing.assert_allclose(sol.velocity("base.x"), 0.1)
    assert sol.force("floor").shape == sol.relative_velocity("floor").shape == (1, sol.t.size)
    assert sol.normal_force("floor").shape == sol.mode("floor").shape == (sol.t.size,)
    assert sol.state("floor").shape == (0, sol.t.size)
    assert sol.scene == "a scene"


@pytest.mark.parametrize("ask", [lambda s: s["mass.y"], lambda s: s.velocity("mas.x"), lambda s: s[0]])
def test_an_unknown_motion_lists_those_near(sol, ask):
    with pytest.raises(KeyError) as caught:
        ask(sol)
    assert isinstance(caught.value, FricmbError)
    assert "mass.x" in str(caught.value)


@pytest.mark.parametrize("what", ["force", "relative_velocity", "normal_force", "mode", "state"])
def test_an_unknown_contact_lists_those_near(sol, what):
    with pytest.raises(KeyError, match="did you mean 'floor'"):
        getattr(sol, what)("flor")


def test_dense_state_is_q_over_v(sol):
    t = np.array([3.0, 0.25, 19.0])
    state = sol(t)
    assert state.shape == (2, 3)
    assert state[0, 1] == pytest.approx(0.1 + 0.85 * np.cos(0.25), abs=1e-15)
    assert state[1, 1] == pytest.approx(-0.85 * np.sin(0.25), abs=1e-15)
    np.testing.assert_array_equal(sol(0.25), state[:, 1])
    assert sol([]).shape == (2, 0)


@pytest.mark.parametrize("t", [-1e-6, 20.0001, np.nan, [1.0, 21.0], [[1.0]], "now", None])
def test_a_time_outside_the_run_is_an_error(sol, t):
    for ask in (sol, sol.at):
        with pytest.raises(SceneError, match="t: "):
            ask(t)


def test_round_off_counts_as_the_end(sol):
    steps = np.cumsum(np.full(20000, 1e-3))
    assert steps[-1] != 20.0
    assert sol.at(steps).t[-1] <= 20.0
    np.testing.assert_array_equal(sol(20.0 * (1 + 1e-14)), sol(20.0))


def test_at_takes_the_right_hand_value_at_a_transition(sol):
    other = sol.at([ENDS[-1], 1.0])
    assert other.t.tolist() == [ENDS[-1], 1.0]
    assert other.mode("floor").tolist() == [0, 1]
    assert len(other.events) == 5
    assert other.energy.residual == pytest.approx([0, 0], abs=1e-14)


def test_events_are_named_and_in_order(sol):
    assert [e.kind for e in sol.events] == ["reversal"] * 4 + ["stick"]
    assert {e.contact for e in sol.events} == {"floor"}
    np.testing.assert_array_equal(sol.events.t, ENDS)
    assert sol.events[-1].t == ENDS[-1]
    assert len(sol.events.of(kind="reversal")) == len(sol.events[:4]) == 4
    with pytest.raises(KeyError, match="reversal"):
        sol.events.of(kind="revrsal")


def test_energy_ledger_closes(sol):
    energy = sol.energy
    np.testing.assert_allclose(energy.kinetic + energy.potential + energy.friction_loss, 0.5 * 0.95**2, atol=1e-14)
    assert np.abs(energy.residual).max() < 1e-14
    np.testing.assert_array_equal(energy.friction_loss_by_contact.sum(axis=0), energy.friction_loss)
    assert (np.diff(energy.friction_loss) >= 0).all()


def test_energy_residual_is_relative_to_the_largest_term_of_the_run(make):
    assert make(times=np.array([0.0, ENDS[-1]]), stiffness=1.0).energy.reference.largest == pytest.approx(0.45125)
    wrong = make(stiffness=2.0)
    terms = [0.95**2, wrong.energy.friction_loss.max(), wrong.energy.kinetic.max()]
    missing = wrong.q[0] ** 2 + wrong.v[0] ** 2 / 2 + wrong.energy.friction_loss - 0.95**2
    np.testing.assert_allclose(wrong.energy.residual, missing / max(terms), atol=1e-14)
    np.testing.assert_allclose(wrong.at(wrong.t[:3]).energy.residual, wrong.energy.residual[:3], atol=1e-14)


def test_energy_residual_of_nothing_is_zero(make):
    sol = make(t_start=17.0, t_end=20.0, stiffness=0.0)
    assert sol.energy.reference.largest == 0.0
    assert (sol.energy.residual == 0.0).all()


def test_time_share_comes_from_the_transitions_not_from_the_times(make):
    slipping = ENDS[-1] / 20.0
    for sol in (make(), make(times=np.array([0.0, 1.0]))):
        assert sol.time_share("floor", 1) == pytest.approx(slipping, rel=1e-12)
        assert sol.time_share("floor", 0) == pytest.approx(1 - slipping, rel=1e-12)


def test_nothing_that_is_not_finite_is_returned(make, oscillator):
    class Overflow(oscillator):
        def sample(self, t):
            samples = super().sample(t)
            return replace(samples, N=np.where(t > 2.0, np.inf, samples.N))

    with pytest.raises(IntegrationError, match="not finite") as caught:
        make(trajectory=Overflow(0.0, 20.0))
    assert 2.0 < caught.value.t <= 2.5
    sol = make(trajectory=Overflow(0.0, 20.0), times=np.array([0.0, 1.0]))
    with pytest.raises(IntegrationError):
        sol(3.0)


def test_a_pickled_solution_keeps_its_dense_output(sol):
    sol.run.pieces[0].trajectory.marker = 1
    back = pickle.loads(pickle.dumps(sol))
    assert "problem" not in vars(back.run.pieces[0]._trajectory)
    np.testing.assert_array_equal(back.q, sol.q)
    np.testing.assert_array_equal(back(1.5), sol(1.5))
    np.testing.assert_array_equal(back.energy.residual, sol.energy.residual)
    assert back.events == sol.events
    assert back.scene == "a scene"


def test_said_in_words(sol):
    assert "1 degree of freedom, 1 contact, t = 0 to 20" in repr(sol)
    assert "5 events" in repr(sol)
    assert repr(sol.events) == "<5 events: 1 stick, 4 reversal>"
    text = sol.summary()
    assert "floor: 1 stick, 4 reversal; stick 21.5% of the time" in text
    assert "closed form" in text
    assert "residual" in text


def test_table(sol):
    pytest.importorskip("pandas")
    frame = sol.to_pandas()
    assert list(frame.columns) == [
        "mass.x", "mass.x.velocity", "mass.tip.x", "mass.tip.x.velocity", "floor.force.x",
        "floor.relative_velocity.x", "floor.normal_force", "floor.mode",
    ]  # fmt: skip
    assert frame.index.name == "t"
    np.testing.assert_array_equal(frame["mass.x.velocity"], sol.v[0])


def test_energies_beyond_what_numbers_hold_are_refused_when_asked_for(make):
    class Huge(type(make().run.pieces[0]._trajectory)):
        def rows(self):
            samples = super().rows()
            samples.friction_loss[0, -1] = np.inf
            return samples

        def row_motion(self):
            held = vars(super().rows())
            return MotionSamples(**{f.name: held[f.name] for f in fields(MotionSamples)})

    sol = make(trajectory=Huge(0.0, 20.0))
    assert np.isfinite(sol.q).all()
    with pytest.raises(IntegrationError, match="not finite at t = 20"):
        _ = sol.energy
