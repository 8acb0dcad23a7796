"""Laws that users write: one small class."""

import pickle
import subprocess
import sys
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pytest
import sympy

import fricmb as fm
from fricmb import laws
from fricmb.equations._templates import law_template


@dataclass(frozen=True, kw_only=True)
class LogWeakening(fm.FrictionLaw):
    mu_s: float
    slope: float

    def define_coefficient(self, r):
        return self.mu_s / (1 + self.slope * sympy.log(1 + r))


@dataclass(frozen=True, kw_only=True)
class LoadDependent(fm.FrictionLaw):
    mu_0: float
    N_ref: float = 10.0

    def define_coefficient(self, r, N):
        return self.mu_0 / (1 + N / self.N_ref)


@dataclass(frozen=True, kw_only=True)
class Smooth(fm.FrictionLaw):
    mu: float
    width: float

    def define_force(self, v, N, z):
        return tuple(-self.mu * N * sympy.tanh(c / self.width) for c in v)

    def validate(self):
        if self.width <= 0:
            raise fm.LawError(f"Smooth: width must be > 0, got {self.width}")


@dataclass(frozen=True, kw_only=True)
class TwoStates(fm.FrictionLaw):
    states: ClassVar[tuple[str, ...]] = ("z", "w")
    k: float = 3.0

    def define_force(self, v, N, z):
        d = len(v)
        return tuple(-N * (self.k * z[i] + z[d + i]) for i in range(d))

    def define_rate(self, v, N, z):
        d = len(v)
        return [*(v[i] - z[i] for i in range(d)), *(-z[d + i] for i in range(d))]


@dataclass(frozen=True, kw_only=True)
class Options(fm.FrictionLaw):
    """A field that is no number selects a formula."""

    mu: float
    falling: bool = True

    def define_coefficient(self, r):
        return self.mu / (1 + r) if self.falling else self.mu


def test_coefficient_law():
    law = LogWeakening(mu_s=0.5, slope=0.1)
    r = np.array([0.0, 0.1, 5.0])
    np.testing.assert_allclose(law.coefficient(r), 0.5 / (1 + 0.1 * np.log1p(r)), rtol=1e-14)
    assert law.derivative(0.0) == pytest.approx(-0.05, rel=1e-14)
    assert law.break_away() == 0.5
    assert law.kind == "coefficient"
    assert law.states == ()
    assert LogWeakening.example() == LogWeakening(mu_s=0.5, slope=0.5)


def test_load_dependent_law():
    law = LoadDependent(mu_0=0.6)
    assert law.load_dependent
    np.testing.assert_allclose(law.coefficient(np.ones(3), [0.0, 10.0, 20.0]), [0.6, 0.3, 0.2], rtol=1e-15)
    np.testing.assert_allclose(law.force([3.0, 4.0], 10.0), [-1.8, -2.4], rtol=1e-15)


def test_smooth_law():
    law = Smooth(mu=0.4, width=0.1)
    assert law.kind == "smooth"
    assert law.force(0.05, 2.0) == pytest.approx(-0.8 * np.tanh(0.5), rel=1e-15)
    assert law.force([0.0, 0.0], 2.0) == pytest.approx([0.0, 0.0])
    np.testing.assert_allclose(law.coefficient([0.0, 0.05, 3.0]), 0.4 * np.tanh([0.0, 0.5, 30.0]), rtol=1e-14)
    np.testing.assert_allclose(law.derivative(0.05), 4.0 / np.cosh(0.5) ** 2, rtol=1e-6)
    with pytest.raises(fm.LawError, match="width must be > 0, got 0"):
        Smooth(mu=0.4, width=0.0)


def test_validate_sees_numbers_behind_parameters():
    assert Smooth(mu=0.4, width=fm.parameter("w", 0.1)).force(0.05, 1.0) == Smooth(mu=0.4, width=0.1).force(0.05, 1.0)
    with pytest.raises(fm.LawError, match="width must be > 0, got -1"):
        Smooth(mu=0.4, width=fm.parameter("w", -1.0))


def test_several_states_come_name_by_name():
    law = TwoStates()
    z = np.array([1.0, 2.0, 10.0, 20.0])
    np.testing.assert_allclose(law.force([0.5, 0.5], 2.0, z), [-26.0, -52.0])
    np.testing.assert_allclose(law.rate([0.5, 0.5], 2.0, z), [-0.5, -1.5, -10.0, -20.0])
    with pytest.raises(fm.LawError, match="states no coefficient"):
        law.coefficient(1.0)


def test_options_select_formulas():
    assert Options(mu=0.5).coefficient(1.0) == 0.25
    assert Options(mu=0.5, falling=False).coefficient(1.0) == 0.5
    assert Options(mu=0.5).options() == {"falling": True}


def test_stand_in_has_symbols_for_fields():
    stand = fm.laws.symbolic(LogWeakening(mu_s=0.5, slope=0.1))
    assert stand.standin.mu_s == sympy.Symbol("mu_s", real=True)
    assert stand.values == (0.5, 0.1)
    assert [str(s) for s in stand.flat] == ["mu_s", "slope"]
    table = fm.laws.symbolic(fm.laws.Tabulated(speed=(0.0, 1.0), mu=(0.5, 0.4)))
    assert [str(s) for s in table.flat] == ["speed_0", "speed_1", "mu_0", "mu_1"]


@dataclass(frozen=True, kw_only=True)
class Power(fm.FrictionLaw):
    positive: ClassVar[tuple[str, ...]] = ("n",)
    mu: float
    n: float

    def define_coefficient(self, r):
        return self.mu * sympy.exp(-(r**self.n))


def test_fields_declared_positive_are_checked_and_have_positive_symbols():
    r = sympy.Symbol("r", nonnegative=True)
    standin = fm.laws.symbolic(Power(mu=0.5, n=0.5)).standin
    assert standin.define_coefficient(r).subs(r, 0) == standin.mu
    with pytest.raises(fm.LawError, match=r"Power: n must be a finite number > 0, got 0"):
        Power(mu=0.5, n=0)
    with pytest.raises(fm.LawError, match="n must be"):
        Power(mu=0.5, n=fm.parameter("n", -1.0))


def test_break_away_below_the_limit_of_slip_is_refused():
    @dataclass(frozen=True, kw_only=True)
    class Rising(fm.FrictionLaw):
        mu_s: float

        def define_coefficient(self, r):
            return 2 * self.mu_s + r

    with pytest.raises(fm.LawError, match="mu_s"):
        Rising(mu_s=0.5)


def test_a_law_that_states_nothing_is_refused():
    @dataclass(frozen=True, kw_only=True)
    class Nothing(fm.FrictionLaw):
        mu: float

    with pytest.raises(fm.LawError, match="define_coefficient"):
        Nothing(mu=0.5)


def test_a_law_with_states_needs_a_force_and_a_rate():
    @dataclass(frozen=True, kw_only=True)
    class NoForce(fm.FrictionLaw):
        states: ClassVar[tuple[str, ...]] = ("z",)

        def define_coefficient(self, r):
            return 0.5

    @dataclass(frozen=True, kw_only=True)
    class NoRate(fm.FrictionLaw):
        states: ClassVar[tuple[str, ...]] = ("z",)

        def define_force(self, v, N, z):
            return tuple(-N * c for c in z)

    with pytest.raises(fm.LawError, match="define_force"):
        NoForce()
    with pytest.raises(fm.LawError, match="defines no rate"):
        NoRate().rate(0.1, 1.0)


def test_a_class_that_is_no_dataclass_is_refused():
    class Plain(fm.FrictionLaw):
        mu: float = 0.5

        def define_coefficient(self, r):
            return self.mu

    with pytest.raises(fm.LawError, match="dataclass"):
        Plain()


def test_wrong_number_of_force_components_is_refused():
    @dataclass(frozen=True, kw_only=True)
    class OneOnly(fm.FrictionLaw):
        def define_force(self, v, N, z):
            return (-N * v[0],)

    assert OneOnly().force(0.5, 2.0) == -1.0
    with pytest.raises(fm.LawError, match="2 expressions"):
        OneOnly().force([0.5, 0.5], 2.0)


def test_own_laws_pickle():
    law = LogWeakening(mu_s=0.5, slope=0.1)
    assert pickle.loads(pickle.dumps(law)) == law


def test_a_law_defined_in_main():
    code = (
        "from dataclasses import dataclass\n"
        "import fricmb as fm, pickle\n"
        "@dataclass(frozen=True, kw_only=True)\n"
        "class Own(fm.FrictionLaw):\n"
        "    mu_s: float\n"
        "    def define_coefficient(self, r):\n"
        "        return self.mu_s / (1 + r)\n"
        "law = pickle.loads(pickle.dumps(Own(mu_s=0.5)))\n"
        "assert law == Own(mu_s=0.5) and law.coefficient(1.0) == 0.25 and law.derivative(1.0) == -0.125\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_redefined_classes_do_not_share_formulas():
    def define(factor):
        @dataclass(frozen=True, kw_only=True)
        class Again(fm.FrictionLaw):
            mu: float

            def define_coefficient(self, r):
                return factor * self.mu

        return Again(mu=0.5)

    assert define(1).coefficient(0.0) == 0.5
    assert define(2).coefficient(0.0) == 1.0


@dataclass(frozen=True, kw_only=True)
class Shaped(fm.FrictionLaw):
    """A field that holds a function."""

    mu_s: float
    shape: Any

    def define_coefficient(self, r):
        return self.mu_s * self.shape(r)


@dataclass(frozen=True, kw_only=True)
class Slow(fm.FrictionLaw):
    mu_s: float

    def define_coefficient(self, r):
        return self.mu_s / (1 + r)


@dataclass(frozen=True, kw_only=True)
class Fast(fm.FrictionLaw):
    mu_s: float

    def define_coefficient(self, r):
        return self.mu_s / (1 + 3 * r)


def test_functions_in_fields_select_formulas():
    slow, fast = Shaped(mu_s=1.0, shape=lambda r: 1 / (1 + r)), Shaped(mu_s=1.0, shape=lambda r: 1 / (1 + 3 * r))
    assert (slow.coefficient(1.0), fast.coefficient(1.0)) == (0.5, 0.25)
    assert law_template(slow, 1).key != law_template(fast, 1).key
    again = Shaped(mu_s=2.0, shape=slow.shape)
    assert law_template(again, 1) is law_template(slow, 1)
    assert law_template(slow, 1).key == law_template(Shaped(mu_s=1.0, shape=lambda r: 1 / (1 + r)), 1).key


def test_laws_inside_a_law_do_not_share_its_formulas():
    slow, fast = (laws.Regularised(law=law(mu_s=1.0), v_reg=1e-3) for law in (Slow, Fast))
    assert slow.coefficient(1.0) == pytest.approx(0.5, rel=1e-12)
    assert fast.coefficient(1.0) == pytest.approx(0.25, rel=1e-12)
    assert law_template(slow, 1).key != law_template(fast, 1).key
