"""Energies are integrated when somebody asks for them: not before, with the same result, and from whatever is kept."""

import copy
import itertools
import pickle
from dataclasses import asdict, replace

import numpy as np
import pytest

import fricmb as fm
from fricmb import models
from fricmb.integrate.collocation.one_contact.trajectory import SingleRun
from fricmb.integrate.implicit.output import step_trajectory

TIMES = np.linspace(0.0, 30.0, 61)
METHODS = ("auto", "radau", "bdf", "taylor")


@pytest.fixture
def integrated(monkeypatch):
    """How often energies were integrated."""
    calls = []
    energies = SingleRun._energies

    def single(self, *arguments):
        calls.append("single")
        return energies(self, *arguments)

    def steps(*arguments):
        calls.append("steps")
        return powers(*arguments)

    powers = step_trajectory.integrate_powers
    monkeypatch.setattr(step_trajectory, "integrate_powers", steps)
    monkeypatch.setattr(SingleRun, "_energies", single)
    return calls


@pytest.mark.parametrize("method", ["auto", "radau", "bdf"])
@pytest.mark.parametrize("times", [TIMES, None])
def test_motion_forces_and_counters_need_no_energies(method, times, integrated):
    sol = fm.simulate(models.brake4dof("5"), t_end=30.0, t_eval=times, method=method)
    assert sol.stats.n_steps > 10
    assert sol.stats.method
    assert len(sol.events) == 2
    sol.at([1.0, 2.0]).force("lining")
    assert np.isfinite(sol(3.0)).all()
    assert 0.0 < sol.time_share("lining", 1) <= 1.0
    again = pickle.loads(pickle.dumps(sol))
    assert integrated == []
    asked = again.energy
    assert integrated
    np.testing.assert_array_equal(asked.damping_loss, sol.energy.damping_loss)
    np.testing.assert_array_equal(asked.residual, sol.energy.residual)


def loss_of(scene, sol, at):
    """What the damper and the contact take until ``at``, by Simpson's rule between transitions."""
    edges = np.unique(np.concatenate(([sol.t_start, at], sol.events.t[sol.events.t < at], np.arange(0.0, at, 0.5))))
    damped = rubbed = 0.0
    for a, b in itertools.pairwise(edges):
        t = np.linspace(a, b, 201)
        t[0], t[-1] = a + 1e-12 * (b - a), b - 1e-12 * (b - a)
        seen = sol.at(t)
        weight = np.r_[1.0, np.tile([4.0, 2.0], 99), 4.0, 1.0] * (b - a) / 600.0
        damped += 0.05 * weight @ seen.velocity("mass.x") ** 2
        rubbed -= weight @ (seen.force("sole")[0] * seen.relative_velocity("sole")[0])
    return damped, rubbed


@pytest.mark.parametrize("method", METHODS)
def test_losses_are_those_of_the_motion(method):
    """Integrals by another rule, of what the solution says of its motion."""
    scene = models.belt_oscillator(damping=0.05)
    sol = fm.simulate(scene, t_end=30.0, t_eval=TIMES, method=method, rtol=1e-8)
    contact = sol.contact_names.index("sole")
    for i in (20, 60):
        damped, rubbed = loss_of(scene, sol, TIMES[i])
        assert sol.energy.damping_loss[i] == pytest.approx(damped, rel=1e-6)
        assert sol.energy.friction_loss_by_contact[contact, i] == pytest.approx(rubbed, rel=1e-6)


@pytest.mark.parametrize("times", [TIMES, None])
def test_whatever_is_kept_has_them(times, tmp_path):
    scene = models.brake4dof("5")
    sol = fm.simulate(scene, t_end=30.0, t_eval=times)
    expected = copy.deepcopy(sol).energy
    sol.save(tmp_path / "run.npz")
    long = fm.simulate(scene, t_end=30.0, t_eval=TIMES, dense=False)
    for back in (fm.Solution.load(tmp_path / "run.npz"), pickle.loads(pickle.dumps(sol)), sol.at(sol.t)):
        np.testing.assert_allclose(back.energy.damping_loss[::2], expected.damping_loss[::2], rtol=1e-12)
    np.testing.assert_allclose(long.energy.damping_loss[-1], expected.damping_loss[-1], rtol=1e-9)
    parts = []
    fm.simulate(scene, t_end=30.0, t_eval=TIMES, chunk=11.0, on_chunk=parts.append)
    whole = sum(part.at([part.t_end]).energy.damping_loss[0] for part in parts)
    assert whole == pytest.approx(expected.damping_loss[-1], rel=1e-7)
    half = fm.simulate(scene, t_end=15.0)
    both = fm.Solution.join([half, fm.simulate(scene, t_end=30.0, initial=half)])
    assert both.energy.damping_loss[-1] == pytest.approx(expected.damping_loss[-1], rel=1e-7)


def test_a_note_of_the_ledger_waits_for_its_reader():
    def stats():
        return fm.simulate(models.belt_oscillator(), t_end=60.0, step=1.5, method="bdf2-paper").stats

    (note,) = stats().notes
    assert note.startswith("the energy ledger does not close")
    assert pickle.loads(pickle.dumps(stats())).notes == (note,)
    assert copy.copy(stats()).notes == asdict(stats())["notes"] == replace(stats(), n_steps=0).notes == (note,)
    assert note in repr(stats())
    kept = stats()
    assert kept == kept
    assert kept.n_steps == 40
    with pytest.raises(AttributeError, match="nothing"):
        _ = kept.nothing
    sol = fm.simulate(models.belt_oscillator(), t_end=60.0, step=1.5, method="bdf2-paper")
    assert sol.at([1.0]).stats.notes == fm.Solution.join([sol]).stats.notes == (note,)
    sol.add_notes(("another",))
    assert set(sol.stats.notes) == {note, "another"}
