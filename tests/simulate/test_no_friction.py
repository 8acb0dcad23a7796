"""Contacts whose coefficient is 0, where every sweep over one begins: they never stick, and bring no force."""

import numpy as np
import pytest

import fricmb as fm

IDLE = fm.RigidBody("idle", mass=1.0, inertia=1.0)


@pytest.mark.parametrize("mu", [0.0, 1e-300])
@pytest.mark.parametrize("method", ["auto", "radau", "bdf"])
@pytest.mark.parametrize("beside", [(), (IDLE,)], ids=["blocks", "mechanism"])
def test_block_that_starts_on_a_belt_without_friction(mu, method, beside):
    """X = 0.1 sin t, at rest on the belt at the start."""
    b, belt = fm.Body("b", mass=1.0, velocity={"x": 0.1}), fm.Driven("belt", velocity={"x": 0.1})
    contact = fm.Contact("c", b, belt, law=fm.laws.Coulomb(mu_s=mu), normal_force=1.0)
    scene = fm.Scene("bare", [b, belt, fm.Spring("k", b, axis="x", stiffness=1.0), contact, *beside])
    sol = fm.simulate(scene, t_end=30.0, rtol=1e-8, method=method)
    assert sol["b.x"] == pytest.approx(0.1 * np.sin(sol.t), abs=1e-7)
    assert not len(sol.events)
    assert np.all(sol.force("c") == 0.0)
    assert np.all(sol.normal_force("c") == 1.0)
    assert sol.audit().ok


def test_a_sweep_from_none():
    """The amplitude of the first swing is mu N/k where it sticks first."""
    b, belt = fm.Body("b", mass=1.0, velocity={"x": 0.1}), fm.Driven("belt", velocity={"x": 0.1})
    contact = fm.Contact("c", b, belt, law=fm.laws.Coulomb(mu_s=0.3), normal_force=1.0)
    scene = fm.Scene("swept", [b, belt, fm.Spring("k", b, axis="x", stiffness=1.0), contact])
    values = [{"c.law.mu_s": mu} for mu in (0.0, 0.1, 0.3)]
    runs = fm.sweep(scene, values, t_end=20.0, t_eval=np.linspace(0.0, 20.0, 2001), workers=1, progress=False)
    tops = [run["b.x"].max() for run in runs]
    assert tops == pytest.approx([0.1, 0.2, 0.4], abs=1e-4)
