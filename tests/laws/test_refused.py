"""Laws that no run may start with are refused by name, before it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import pytest
import sympy

import fricmb as fm
from fricmb import laws
from fricmb.system import build


@dataclass(frozen=True, kw_only=True)
class Driving(fm.FrictionLaw):
    mu: float = 0.5

    def define_force(self, v, N, z):
        return tuple(self.mu * N * sympy.tanh(c) for c in v)


@dataclass(frozen=True, kw_only=True)
class Singular(fm.FrictionLaw):
    mu: float = 0.5

    def define_force(self, v, N, z):
        return tuple(-self.mu * N * sympy.log(c**2) * c / (c * c) for c in v)


@dataclass(frozen=True, kw_only=True)
class Exploding(fm.FrictionLaw):
    mu: float = 0.5

    def define_force(self, v, N, z):
        return tuple(-self.mu * N * sympy.sinh(c) for c in v)


@dataclass(frozen=True, kw_only=True)
class Unbounded(fm.FrictionLaw):
    """A coefficient that is finite nowhere far out."""

    mu: float = 0.5

    def define_coefficient(self, r):
        return self.mu + sympy.exp(sympy.exp(r + 1000))


@dataclass(frozen=True, kw_only=True)
class OneShort(fm.FrictionLaw):
    mu: float = 0.5

    def define_force(self, v, N, z):
        return (-self.mu * N * v[0],)


@dataclass(frozen=True, kw_only=True)
class RateMissing(fm.FrictionLaw):
    states: ClassVar[tuple[str, ...]] = ("z", "w")
    mu: float = 0.5

    def define_force(self, v, N, z):
        return tuple(-self.mu * N * c for c in z[: len(v)])

    def define_rate(self, v, N, z):
        return v


def too_much(x: Any, p: Any, out: Any) -> None:
    for i in range(12):
        out[i] = 0.0


def too_little(x: Any, p: Any, out: Any) -> None:
    out[0] = -p[0] * x[1] * x[0]
    out[1] = -p[0] * x[1]


@dataclass(frozen=True, kw_only=True)
class Compiled(fm.FrictionLaw):
    dimensions: ClassVar[tuple[int, ...]] = (1,)
    function: Any
    mu: float = 0.5

    def define_coefficient(self, r):
        return self.mu * r

    def compiled_force(self, d: int) -> Callable[..., None]:
        return self.function


def scene_of(law, d):
    block = fm.Body("block", mass=1.0, axes="xy"[:d], velocity={"x": 1.0})
    return fm.Scene("s", [block, fm.Contact("sole", block, law=law, normal_force=2.0)])


@pytest.mark.parametrize(
    ("law", "d", "message"),
    [
        (Driving(), 1, "Contact 'sole': its law Driving drives the slip: the force at v = "),
        (Driving(), 2, "its law Driving drives the slip"),
        (Singular(), 1, "its law Singular is not finite at v = "),
        (Exploding(), 1, r"its law Exploding is not finite at v = \[1000"),
        (OneShort(), 2, "OneShort: define_force must return 2 expressions for this contact, got 1"),
        (RateMissing(), 1, "RateMissing: define_rate must return 2 expressions for this contact, got 1"),
        (Compiled(function=too_much), 1, r"Compiled writes more than the 3 numbers \[force, rates"),
        (Compiled(function=too_little), 1, r"Compiled leaves out\[2\] of the 3 numbers"),
    ],
)
def test_broken_laws_are_refused_by_name(law, d, message):
    with pytest.raises(fm.LawError, match=message):
        build(scene_of(law, d))


def test_unbounded_is_refused_when_it_is_made():
    with pytest.raises(fm.LawError, match="finite at r = 0"):
        Unbounded()


@pytest.mark.parametrize("name", laws.names)
def test_no_law_of_the_catalogue_is_refused(name):
    law = getattr(laws, name).example()
    for d in law.dimensions:
        if d < 3:
            build(scene_of(law, d))


@pytest.mark.parametrize(
    ("said", "text"),
    [
        ({"states": "z"}, "states must be a tuple of names"),
        ({"states": ["z"]}, "states must be a tuple of names"),
        ({"states": ("z", "z")}, "states must be different names"),
        ({"states": ("z",), "scalars": ("w",)}, "scalars: unknown name 'w'"),
        ({"states": ("z",), "copies": lambda law: {"w": 2}}, "copies names an undeclared state: unknown name 'w'"),
        ({"states": ("z",), "copies": lambda law: {"z": 1.5}}, "copies of z must be a whole number"),
        ({"positive": ("mu_",)}, "positive: unknown name 'mu_'; did you mean 'mu'"),
        ({"dimensions": (5,)}, "dimensions must be a tuple of 1, 2, 3"),
    ],
)
def test_what_a_law_says_of_itself_is_checked(said, text):
    kind = dataclass(frozen=True, kw_only=True)(type("Saying", (OneShort,), said))
    with pytest.raises(fm.LawError, match=f"Saying: {text}"):
        kind(mu=0.3)


@pytest.mark.parametrize("value", [None, ("a",)])
def test_a_formula_is_no_word_and_not_left_out(value):
    said = {"states": ("z",), "define_force": lambda law, v, N, z: (-z[0],), "define_rate": lambda law, v, N, z: value}
    kind = dataclass(frozen=True, kw_only=True)(type("Saying", (OneShort,), said))
    with pytest.raises(fm.LawError, match="define_rate must return 1 expressions for this contact, got"):
        fm.simulate(fm.models.belt_oscillator(law=kind(mu=0.3)), t_end=1.0)
