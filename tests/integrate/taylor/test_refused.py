"""What Taylor steps leave to others, by name."""

import pytest
import sympy

import fricmb as fm


def test_bodies_that_turn_are_refused():
    rod = fm.models.dry_pendulum()
    with pytest.raises(fm.FricmbError, match="bodies that turn, or joints"):
        fm.simulate(rod, t_end=1.0, method="taylor")


@pytest.mark.parametrize("rubs", [True, False])
@pytest.mark.parametrize("load", [1 / (fm.t - 0.5), sympy.tan(fm.t)], ids=["1/(t - 0.5)", "tan t"])
def test_a_pole_ahead_ends_a_run(load, rubs):
    """Steps came down to last digits of the time and went on, millions of them."""
    block, belt = fm.Body("b", mass=1.0), fm.Driven("d", velocity={"x": 0.3})
    law = fm.laws.Coulomb(mu_s=0.5, mu_k=0.3)
    parts = [block, belt, fm.Spring("k", block, axis="x", stiffness=1.0), fm.Force("f", block, axis="x", value=load)]
    scene = fm.Scene("pole", [*parts, fm.Contact("c", block, belt, law=law, normal_force=1.0)] if rubs else parts)
    with pytest.raises(fm.IntegrationError, match="a function of time cannot be followed") as caught:
        fm.simulate(scene, t_end=3.0, method="taylor")
    assert caught.value.t == pytest.approx(0.5 if load.has(sympy.Pow) else float(sympy.pi) / 2, abs=1e-8)
    assert len(caught.value.partial.t) < 2000
