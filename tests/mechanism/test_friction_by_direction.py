"""Friction that differs by direction, as the page on parts builds it: Coulomb's law with the mean and a bias."""

import pytest

import fricmb as fm

FORWARD, BACK, N = 0.2, 0.6, 10.0


def pushed(value, velocity=0.0):
    block = fm.Body("block", mass=1.0, velocity={"x": velocity})
    feet = fm.Contact("feet", block, law=fm.laws.Coulomb(mu_s=(FORWARD + BACK) / 2), normal_force=N)
    bias = fm.Force("bias", block, axis="x", value=-(FORWARD - BACK) / 2 * N)
    return fm.Scene("s", [block, feet, bias, fm.Force("push", block, axis="x", value=value)])


@pytest.mark.parametrize(("push", "rate"), [(1.9, 0.0), (2.1, 0.1), (-5.9, 0.0), (-6.1, -0.1)])
def test_breaks_away_at_each_limit(push, rate):
    sol = fm.simulate(pushed(push), t_end=1.0, rtol=1e-9)
    assert sol.velocity("block.x")[-1] == pytest.approx(rate, abs=1e-9)


@pytest.mark.parametrize(("velocity", "mu"), [(1.0, FORWARD), (-1.0, BACK)])
def test_slides_to_rest_under_its_own_side(velocity, mu):
    sol = fm.simulate(pushed(0.0, velocity), t_end=1.0, rtol=1e-9)
    assert [(e.kind, e.t) for e in sol.events] == [("stick", pytest.approx(1.0 / (mu * N), rel=1e-9))]
    whole = sol.force("feet")[0] - (FORWARD - BACK) / 2 * N
    assert whole[0] == pytest.approx(-mu * N * velocity)
    assert whole[-1] == pytest.approx(0.0, abs=1e-9)
