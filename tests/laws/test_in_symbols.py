"""Formulas written for numbers are refused with the name of the law, the line, and the function of SymPy to use."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
import sympy

import fricmb as fm


@dataclass(frozen=True, kw_only=True)
class WithMath(fm.FrictionLaw):
    mu: float = 0.5

    def define_coefficient(self, r):
        return self.mu * math.exp(-r)


@dataclass(frozen=True, kw_only=True)
class WithNumpy(fm.FrictionLaw):
    mu: float = 0.5

    def define_coefficient(self, r):
        return self.mu * np.arctan(1.0 + r)


@dataclass(frozen=True, kw_only=True)
class WithBranch(fm.FrictionLaw):
    mu: float = 0.5

    def define_coefficient(self, r):
        if r < 1:
            return self.mu
        return self.mu / 2


@dataclass(frozen=True, kw_only=True)
class ForceWithNumpy(fm.FrictionLaw):
    k: float = 1.0

    def define_force(self, v, N, z):
        return tuple(-self.k * N * np.tanh(c) for c in v)


@dataclass(frozen=True, kw_only=True)
class Broken(fm.FrictionLaw):
    mu: float = 0.5

    def define_coefficient(self, r):
        return sympy.exp(r) + None


@pytest.mark.parametrize(
    ("kind", "said"),
    [
        (WithMath, ["WithMath: define_coefficient", "math.exp", "sympy.exp", "self.mu * math.exp(-r)"]),
        (WithNumpy, ["WithNumpy: define_coefficient", "np.arctan", "write sympy.atan", "np.arctan(1.0 + r)"]),
        (WithBranch, ["WithBranch: define_coefficient", "sympy.Piecewise", "if r < 1:"]),
    ],
)
def test_a_coefficient_for_numbers_names_the_cure(kind, said):
    with pytest.raises(fm.LawError) as raised:
        kind()
    for words in said:
        assert words in str(raised.value)


def test_a_force_for_numbers_names_the_cure():
    with pytest.raises(fm.LawError, match=r"ForceWithNumpy: define_force .* write sympy\.tanh .*np\.tanh\(c\)"):
        ForceWithNumpy().force(0.1, 1.0)


def test_an_author_s_own_mistake_stays_as_it_is():
    with pytest.raises(TypeError, match="NoneType"):
        Broken()


def test_a_misspelt_law_suggests_the_right_one():
    with pytest.raises(AttributeError, match=r"fricmb\.laws has no 'Stribek'; did you mean Stribeck\?"):
        fm.laws.Stribek  # noqa: B018
    with pytest.raises(AttributeError, match=r"did you mean Spring\?"):
        fm.Spirng  # noqa: B018
    assert not hasattr(fm.laws, "nothing_like_it")


def test_a_conversion_to_a_number_is_not_taken_for_a_function():
    @dataclass(frozen=True, kw_only=True)
    class WithFloat(fm.FrictionLaw):
        mu: float = 0.5

        def define_coefficient(self, r):
            return self.mu + float(r)

    with pytest.raises(fm.LawError, match=r"float\(\) takes numbers alone: leave the expression as it is"):
        WithFloat().coefficient(0.1)
