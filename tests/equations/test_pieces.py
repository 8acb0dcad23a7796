"""A Piecewise without a last piece: where none of its conditions holds it has no value, and no 0."""

from dataclasses import dataclass

import pytest
import sympy

import fricmb as fm


@dataclass(frozen=True, kw_only=True)
class Short(fm.FrictionLaw):
    """Stated for slow slip alone."""

    mu: float

    def define_coefficient(self, r):
        return sympy.Piecewise((self.mu, r < 0.5))


@dataclass(frozen=True, kw_only=True)
class OneSided(fm.FrictionLaw):
    """A bristle whose rate is stated on one side alone."""

    k: float
    states = ("z",)

    def define_force(self, v, N, z):
        return tuple(-N * self.k * bent for bent in z)

    def define_rate(self, v, N, z):
        return tuple(sympy.Piecewise((speed, bent > 0)) for speed, bent in zip(v, z, strict=True))


@pytest.mark.parametrize("law", [Short(mu=1.0), OneSided(k=2.0)])
def test_a_law_that_is_not_stated_everywhere_is_refused(law):
    with pytest.raises(fm.LawError, match="is not finite at"):
        fm.simulate(fm.models.belt_oscillator(law=law, belt=1.0), t_end=5.0)


@pytest.mark.parametrize("condition", [fm.t < 0.5, fm.coordinate("m.x") < 0.125])
def test_a_force_ends_its_run_where_it_is_not_stated(condition):
    """From rest under the force 1: x = t^2/2 is 0.125 at t = 0.5."""
    block = fm.Body("m", mass=1.0)
    pull = fm.Force("pull", block, axis="x", value=sympy.Piecewise((1.0, condition)))
    with pytest.raises(fm.IntegrationError, match=r"pull.value = Piecewise.* is nan at t") as caught:
        fm.simulate(fm.Scene("s", [block, pull]), t_end=3.0)
    assert caught.value.t == pytest.approx(0.5, rel=1e-6)


def test_pieces_that_leave_no_gap_need_no_last_one():
    block = fm.Body("m", mass=1.0)
    value = sympy.Piecewise((1.0, fm.t < 0.5), (-1.0, fm.t >= 0.5))
    sol = fm.simulate(fm.Scene("s", [block, fm.Force("pull", block, axis="x", value=value)]), t_end=1.0, rtol=1e-9)
    assert sol["m.x"][-1] == pytest.approx(0.25, rel=1e-9)
