"""What Taylor steps leave to others, by name."""

import pytest
import sympy

import fricmb as fm


def test_bodies_that_turn_are_refused():
    rod = fm.models.dry_pendulum()
    with pytest.raises(fm.FricmbError, match="bodies that turn, or joints"):
        fm.simulate(rod, t_end=1.0, method="taylor")


@pytest.mark.parametrize(
    "law", [fm.laws.Coulomb(mu_s=0.9, mu_k=0.5), fm.laws.CoulombViscous(mu_s=0.9, mu_k=0.5, viscous=0.1)]
)
def test_a_belt_that_jumps_takes_no_block_with_it(law):
    """A block that sticks slips on behind the jump; friction that depends on speed is left to the general methods."""
    block = fm.Body("block", mass=1.0, velocity={"x": 0.863})
    belt = fm.Driven("belt", velocity={"x": sympy.Piecewise((0.863, fm.t < 0.368), (0.6629, True))})
    spring = fm.Spring("spring", block, axis="x", stiffness=1.0)
    scene = fm.Scene("jump", [block, belt, spring, fm.Contact("sole", block, belt, law=law, normal_force=2.0)])
    if isinstance(law, fm.laws.CoulombViscous):
        with pytest.raises(fm.FricmbError, match="need a constant coefficient"):
            fm.simulate(scene, t_end=1.0, method="taylor")
        return
    sol = fm.simulate(scene, t_end=0.4, rtol=1e-8, method="taylor")
    assert [(event.kind, event.t) for event in sol.events] == [("slip", pytest.approx(0.368, abs=1e-12))]
    # x'' = -x - mu_k N behind the jump
    assert sol(0.4)[1] == pytest.approx(0.863 - (0.863 * 0.384 + 1.0) * 0.032, abs=2e-4)


def test_a_belt_that_jumps_under_plates_that_rub_on_each_other_is_refused():
    lower, upper = (fm.Body(name, mass=1.0, velocity={"x": 0.1}) for name in ("lower", "upper"))
    belt = fm.Driven("belt", velocity={"x": sympy.Piecewise((0.1, fm.t < 0.5), (-0.3, True))})
    law = fm.laws.Coulomb(mu_s=0.7, mu_k=0.7)
    contacts = [
        fm.Contact("sole", lower, belt, law=law, normal_force=2.5),
        fm.Contact("top", upper, lower, law=law, normal_force=1.9),
    ]
    scene = fm.Scene("plates", [lower, upper, belt, *contacts])
    with pytest.raises(fm.FricmbError, match="bodies of their own"):
        fm.simulate(scene, t_end=1.0, method="taylor")
