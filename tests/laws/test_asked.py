"""What authors' methods are asked and give back: a mistake is an error with class, method and what is expected."""

from dataclasses import dataclass

import numpy as np
import pytest
import sympy

import fricmb as fm


def law(**methods):
    """A class with the given methods and one field."""
    kind = type("Own", (fm.FrictionLaw,), {"__annotations__": {"mu_s": float}, "mu_s": 0.5, **methods})
    return dataclass(frozen=True, kw_only=True)(kind)


def run(kind, **options):
    block, belt = fm.Body("block", mass=1.0), fm.Driven("belt", velocity={"x": 1.0})
    lining = fm.Contact("lining", block, belt, law=kind(), normal_force=1.0)
    spring = fm.Spring("spring", block, axis="x", stiffness=1.0)
    return fm.simulate(fm.Scene("own", [block, belt, spring, lining]), **{"t_end": 0.1, "rtol": 1e-4, **options})


def bristle(rate, force=lambda self, v, N, z: [-z[0]]):
    return law(states=("z",), define_force=force, define_rate=rate)


ALIEN = sympy.Symbol("alien")


@pytest.mark.parametrize(("kind", "said"), [
    (law(define_coefficient=lambda self: 0.5), r"define_coefficient takes \(self\); expected is .*\(self, r\)"),
    (law(define_coefficient=lambda self, r, N, z: 0.5), r"takes \(self, r, N, z\); expected is .*\(self, r, N\)"),
    (law(define_coefficient=lambda self, r: None), "define_coefficient must return one expression, got None"),
    (law(define_coefficient=lambda self, r: [0.5]), r"define_coefficient must return one expression, got \[0.5\]"),
    (law(define_coefficient=lambda self, r: np.array([0.5, 0.2])), "must return one expression, got array"),
    (law(define_coefficient=lambda self, r: r > 1), "define_coefficient must return one expression, got"),
    (law(define_coefficient=lambda self, r: sympy.Matrix([r])), "define_coefficient must return one expression, got"),
    (law(define_coefficient=lambda self, r: "0.5"), "define_coefficient must return one expression, got '0.5'"),
    (law(define_coefficient=lambda self, r: 0.5 + sympy.I * r), "define_coefficient must return a real expression"),
    (law(define_coefficient=lambda self, r: 0.5 + ALIEN), "define_coefficient: undefined symbols .*: alien; accepted"),
    (law(define_coefficient=lambda self, r: sympy.Function("f")(r)), r"the function f\(.*\) is not known"),
    (law(define_force=lambda self, v: -0.1), r"define_force takes \(self, v\); expected is .*\(self, v, N, z\)"),
    (law(define_force=lambda self, v, N, z: None), "define_force must return 1 expressions for this contact, got None"),
    (law(define_force=lambda self, v, N, z: [-v[0], -v[0]]), "define_force must return 1 .*, got 2"),
    (law(define_force=lambda self, v, N, z: [-v[0] * ALIEN]), "define_force: undefined symbols .*: alien"),
    (law(define_force=lambda self, v, N, z: -v), "define_force .* its arguments are tuples"),
    (bristle(lambda self, v, N: [v[0]]), r"define_rate takes \(self, v, N\); expected is .*\(self, v, N, z\)"),
    (bristle(lambda self, v, N, z: None), "define_rate must return 1 expressions for this contact, got None"),
    (bristle(lambda self, v, N, z: [v[0], z[0]]), "define_rate must return 1 .*, got 2"),
    (bristle(lambda self, v, N, z: [v[0] * ALIEN]), "define_rate: undefined symbols .*: alien"),
    (bristle(lambda self, v, N, z: [object()]), "define_rate must return one expression, got"),
])  # fmt: skip
def test_mistakes_are_named(kind, said):
    with pytest.raises(fm.LawError, match=f"Own.*: .*{said}"):
        run(kind)


def test_what_is_right_runs():
    for kind in (
        law(define_coefficient=lambda self, r: 0.5), law(define_coefficient=lambda self, r: np.float64(0.5)),
        law(define_coefficient=lambda self, *given: self.mu_s / (1 + given[0])),
        bristle(lambda self, v, N, z: v[0] - z[0]),
    ):  # fmt: skip
        assert run(kind).t[-1] == 0.1


@dataclass(frozen=True, kw_only=True)
class Pressed(fm.normal.NormalLaw):
    """A normal force that depends on what it does not have."""

    axis: str = "y"
    push: float = 1.0

    def define_normal(self, e, rate):
        return self.push - ALIEN * e


@dataclass(frozen=True, kw_only=True)
class Short(Pressed):
    """One that does not take a rate."""

    def define_normal(self, e):
        return self.push - e


@pytest.mark.parametrize(("kind", "said"), [
    (Pressed, "Pressed: define_normal: undefined symbols in a derived expression: alien"),
    (Short, r"Short: define_normal takes \(self, e\); expected is define_normal\(self, e, e_dot\)"),
])  # fmt: skip
def test_normal_laws_are_asked_alike(kind, said):
    block = fm.Body("block", mass=1.0, axes="xy")
    contact = fm.Contact("floor", block, law=fm.laws.Coulomb(mu_s=0.5), normal_force=kind())
    with pytest.raises(fm.LawError, match=said):
        fm.simulate(fm.Scene("pressed", [block, contact]), t_end=0.1)


@dataclass(frozen=True, eq=False)
class Pulls(fm.Element):
    """An element whose potential does not take coordinates."""

    a: fm.Body

    def local_coordinates(self):
        return (self.a.motion("x"),)

    def define_potential(self):
        return 0


@dataclass(frozen=True, eq=False)
class Says(Pulls):
    """One whose potential is text."""

    def define_potential(self, x):
        return "x**2"


@pytest.mark.parametrize(("kind", "said"), [
    (Pulls, r"Pulls 'own': define_potential takes \(self\); expected is define_potential\(self, x\)"),
    (Says, r"Says 'own': define_potential must return one expression, got 'x\*\*2'"),
])  # fmt: skip
def test_elements_are_asked_alike(kind, said):
    block = fm.Body("block", mass=1.0)
    with pytest.raises(fm.SceneError, match=said):
        fm.simulate(fm.Scene("pulled", [block, kind("own", block)]), t_end=0.1)


def test_a_rate_in_steps_is_named_where_a_run_does_not_get_on():
    """Driven back to where it jumps, a state made steps shorter without end, and nothing said why."""
    with pytest.raises(fm.IntegrationError, match=r"the rate of Own of Contact 'lining' jumps \(floor\(.*\)\)"):
        run(bristle(lambda self, v, N, z: [v[0] - 2 * sympy.floor(3 * z[0] + 1)]), t_end=1.0, time_limit=1.0)
