"""The check of every run: its energy ledger closes, or its notes say that it does not."""

import numpy as np
import pytest
import sympy

import fricmb as fm
from fricmb import models
from fricmb.bench import SCENES


@pytest.mark.parametrize("method", ["auto", "radau", "bdf", "taylor"])
@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-10])
def test_runs_to_tolerance_have_no_note(method, rtol):
    sol = fm.simulate(models.belt_oscillator(), t_end=60.0, rtol=rtol, method=method)
    assert sol.stats.notes == ()
    assert np.abs(sol.energy.residual).max() < 100.0 * rtol


def test_a_step_that_is_too_large_is_said():
    scene = models.belt_oscillator()
    fine = fm.simulate(scene, t_end=60.0, step=1e-3, method="bdf2-paper")
    assert fine.stats.notes == ()
    coarse = fm.simulate(scene, t_end=60.0, step=1.5, method="bdf2-paper")
    (note,) = coarse.stats.notes
    assert note.startswith("the energy ledger does not close: ")
    assert float(note.split(": ")[1].split()[0]) > 0.02
    assert note in coarse.summary()


def test_a_large_energy_hides_little():
    """The brake's disc holds 50 000 and the pad exchanges 300 with it."""
    coarse = fm.simulate(models.brake4dof("2"), t_end=700.0, step=1.0, method="bdf2-paper")
    assert len(coarse.events) < 10  # 213
    assert np.abs(coarse.energy.residual).max() < 0.01
    assert len(coarse.stats.notes) == 1
    assert fm.simulate(models.brake4dof("2"), t_end=700.0, step=1e-2, method="bdf2-paper").stats.notes == ()


def test_few_times_are_enough():
    scene = models.belt_oscillator()
    for times in ([60.0], [59.0, 60.0], np.linspace(0.0, 60.0, 7)):
        assert fm.simulate(scene, t_end=60.0, t_eval=times, method="radau").stats.notes == ()


def test_slip_that_has_only_begun_is_no_negative_friction():
    """Between two rows of a coarse run the slip speed may show the wrong sign, within the tolerance."""
    case = next(case for case in SCENES if case.name == "two_blocks")
    sol = fm.simulate(case.build(), t_end=case.t_end, t_eval=case.reference().t, rtol=1e-3, method="bdf")
    told = [e.kind for e in sol.events]
    assert (told.count("stick"), told.count("slip")) == (20, 20)
    assert told.count("reversal") in (1, 3)  # one, and at this tolerance a pair that a finer run has not


@pytest.mark.parametrize(("method", "rtol"), [("radau", 1e-4), ("bdf", 1e-6)])
def test_slip_that_ends_is_no_negative_friction(method, rtol):
    """Steps that come to rest to the tolerance have passed it by as much: the row before stick has slip reversed."""
    block = fm.Body("block", mass=1.0, axes="xy", velocity={"y": 0.3})
    law = fm.laws.Stribeck(mu_s=0.6, mu_k=0.4, v_s=0.05, exponent=1.0)
    loads = [0.9 * sympy.sin(100.0 * fm.t), 0.5 * sympy.cos(77.0 * fm.t)]
    shaken = [fm.Force(f"f{axis}", block, axis=axis, value=F) for axis, F in zip("xy", loads, strict=True)]
    scene = fm.Scene("shaken", [block, *shaken, fm.Contact("sole", block, law=law, normal_force=1.0)])
    t = np.linspace(0.0, 5.0, 51)
    true = fm.simulate(scene, t_end=5.0, rtol=1e-9, t_eval=t, method="taylor")
    sol = fm.simulate(scene, t_end=5.0, rtol=rtol, method=method)
    assert [event.kind for event in sol.events] == [event.kind for event in true.events]
    np.testing.assert_allclose(sol(t)[2:], true.v, atol=100.0 * rtol)


@pytest.mark.parametrize("load", [0.1, 1e-3])
def test_what_rests_under_a_load_closes(load):
    """Nothing is exchanged: what the solver's round-off moves is no loss."""
    block = fm.Body("block", mass=1.0)
    law = fm.laws.Coulomb(mu_s=0.8, mu_k=0.6)
    scene = fm.Scene("rest", [
        block,
        fm.Force("push", block, axis="x", value=load),
        fm.Contact("sole", block, law=law, normal_force=1.0),
    ])  # fmt: skip
    sol = fm.simulate(scene, t_end=10.0, method="radau")
    assert not [note for note in sol.stats.notes if "ledger" in note]
