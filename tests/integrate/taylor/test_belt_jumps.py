"""Belts whose velocity jumps: what stuck slips on behind the jump, under any law, alone or under other blocks."""

import numpy as np
import pytest
import sympy

import fricmb as fm

COULOMB = fm.laws.Coulomb(mu_s=0.9, mu_k=0.5)
RISING = fm.laws.CoulombViscous(mu_s=0.9, mu_k=0.5, viscous=0.1)
PLATES = fm.laws.Coulomb(mu_s=0.7, mu_k=0.7)


def block_on_belt(law):
    block = fm.Body("block", mass=1.0, velocity={"x": 0.863})
    belt = fm.Driven("belt", velocity={"x": sympy.Piecewise((0.863, fm.t < 0.368), (0.6629, True))})
    spring = fm.Spring("spring", block, axis="x", stiffness=1.0)
    return fm.Scene("jump", [block, belt, spring, fm.Contact("sole", block, belt, law=law, normal_force=2.0)])


def plates():
    lower, upper = (fm.Body(name, mass=1.0, velocity={"x": 0.1}) for name in ("lower", "upper"))
    belt = fm.Driven("belt", velocity={"x": sympy.Piecewise((0.1, fm.t < 0.5), (-0.3, True))})
    sole = fm.Contact("sole", lower, belt, law=PLATES, normal_force=2.5)
    top = fm.Contact("top", upper, lower, law=PLATES, normal_force=1.9)
    return fm.Scene("plates", [lower, upper, belt, sole, top])


@pytest.mark.parametrize("law", [COULOMB, RISING])
def test_a_belt_that_jumps_takes_no_block_with_it(law):
    sol = fm.simulate(block_on_belt(law), t_end=0.4, rtol=1e-8, method="taylor")
    assert [(event.kind, event.t) for event in sol.events] == [("slip", pytest.approx(0.368, abs=1e-12))]
    # x'' = -x - mu N behind the jump
    push = 2.0 * (0.5 + (0.1 * 0.19 if law is RISING else 0.0))
    assert sol(0.4)[1] == pytest.approx(0.863 - (0.863 * 0.384 + push) * 0.032, abs=2e-4)


def test_plates_on_a_belt_that_jumps():
    """Closed form: friction between the plates carries the upper one along, the sole takes the lower one back."""
    sol = fm.simulate(plates(), t_end=2.0, rtol=1e-8, method="taylor")
    rate = 0.7 * 2.5 / 2.0
    assert [(event.contact, event.kind) for event in sol.events] == [("sole", "slip"), ("sole", "stick")]
    assert sol.events.t == pytest.approx([0.5, 0.5 + 0.4 / rate], abs=1e-12)
    assert sol(0.9)[2:] == pytest.approx(0.1 - rate * 0.4, abs=1e-12)
    assert sol.end.v == pytest.approx(-0.3, abs=1e-12)
    assert np.abs(sol.energy.residual).max() < 1e-11


@pytest.mark.parametrize("scene", [block_on_belt(COULOMB), block_on_belt(RISING), plates()], ids=lambda s: s.name)
def test_against_radau(scene):
    grid = np.linspace(0.0, 3.0, 61)
    ours = fm.simulate(scene, t_end=3.0, t_eval=grid, rtol=1e-9, method="taylor")
    other = fm.simulate(scene, t_end=3.0, t_eval=grid, rtol=1e-10, method="radau")
    assert np.abs(ours.q - other.q).max() < 1e-9
    assert np.abs(ours.v - other.v).max() < 1e-9
    assert [(e.contact, e.kind) for e in ours.events] == [(e.contact, e.kind) for e in other.events]
    for part in ("friction_loss", "input"):
        assert getattr(ours.energy, part) == pytest.approx(getattr(other.energy, part), abs=1e-8)
