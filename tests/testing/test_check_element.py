"""Every built-in element conforms; each thing that authors get wrong is found and named."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pytest
import sympy

import fricmb as fm
from fricmb.testing import ConformanceError, check_element
from fricmb.testing._element_forces import Trial, force_findings

PAD = fm.Body("pad", mass=1.0, axes="xy")
BELT = fm.Driven("belt", velocity={"x": 0.1})
ARM = fm.RigidBody("arm", mass=1.0, inertia=1.0)

BUILT_IN = [
    fm.Spring("linear", PAD, axis="x", stiffness=3.0),
    fm.Spring("cubic", PAD, BELT, axis="x", stiffness=3.0, cubic=2.0, length=0.4),
    fm.Damper("damper", PAD, BELT, axis=(0.6, 0.8), damping=0.3),
    fm.PointSpring("point spring", PAD, stiffness=3.0, length=0.4, anchor=(0.1, 0.2)),
    fm.PointDamper("point damper", PAD, damping=0.7),
    fm.Force("constant", PAD, axis="x", value=2.0),
    fm.Force("function", PAD, axis="x", value=fm.coordinate("pad.y") - fm.speed("pad.x") ** 3 * sympy.sin(2 * fm.t)),
    fm.TorsionSpring("torsion spring", ARM, stiffness=2.0, angle=0.3),
    fm.TorsionDamper("torsion damper", ARM, damping=1.0),
    fm.Torque("torque", ARM, value=sympy.cos(fm.coordinate("arm.angle"))),
    fm.Stop("stop", PAD, axis="x", upper=0.5, stiffness=100.0, hunt_crossley=0.2),
    fm.Backlash("backlash", PAD, BELT, axis="x", gap=0.2, stiffness=100.0),
]


@pytest.mark.parametrize("element", BUILT_IN, ids=lambda e: e.name)
def test_built_in_elements_conform(element):
    check_element(element)


def test_every_built_in_element_is_checked():
    known = {kind for kind in vars(fm.scene).values() if isinstance(kind, type) and issubclass(kind, fm.Element)}
    assert known - {fm.Element, fm.scene.AxialElement} == {type(element) for element in BUILT_IN}


@dataclass(frozen=True, kw_only=True)
class Own(fm.Element):
    """What the elements below share: a body, a strength, x."""

    a: fm.Body = PAD
    strength: float = 2.0

    def local_coordinates(self):
        return (self.a.motion("x"),)


class Stop(Own):
    """Right: a one-sided stop with a dashpot of its own and a push."""

    def define_potential(self, x):
        return self.strength * sympy.Max(0, x[0]) ** 2 / 2

    def define_dissipation(self, x, x_dot):
        return self.strength * x[0] ** 2 * x_dot[0] ** 2

    def define_force(self, x, x_dot, t):
        return (self.strength * sympy.cos(t) * x_dot[0],)


def test_an_element_of_all_three_parts_conforms():
    check_element(Stop(name="stop"))


class Silent(Own):
    pass


class Gains(Own):
    def define_dissipation(self, x, x_dot):
        return -self.strength * x_dot[0] ** 2 / 2


class GainsFar(Own):
    """Nonlinear, and wrong for |x| > 1 alone."""

    def define_dissipation(self, x, x_dot):
        return self.strength * (1 - x[0] ** 2) * x_dot[0] ** 2 / 2


class Pole(Own):
    def define_potential(self, x):
        return self.strength / x[0]


class Overflows(Own):
    def define_potential(self, x):
        return self.strength * sympy.exp(x[0])


class TwoForces(Own):
    def define_force(self, x, x_dot, t):
        return (self.strength, 0)


class TwoPotentials(Own):
    def define_potential(self, x):
        return (self.strength, 0)


class Stray(Own):
    def define_potential(self, x):
        return sympy.Symbol("c") * x[0] ** 4


class Unknown(Own):
    def define_potential(self, x):
        return sympy.Function("f")(x[0])


class WrongSignature(Own):
    def define_dissipation(self, x_dot):
        return x_dot[0] ** 2


class Lax(Own):
    def __post_init__(self):
        pass

    def define_potential(self, x):
        return self.strength * x[0] ** 2


class LaxSign(Own):
    """Says ``positive``, checks nothing of it."""

    positive = ("strength",)

    def _check_positive(self):
        pass

    def define_potential(self, x):
        return self.strength * x[0] ** 2


class Nameless(Own):
    def __post_init__(self):
        if not abs(self.strength) < 1e300:
            raise ValueError("that cannot be")

    def define_potential(self, x):
        return self.strength * x[0] ** 2


class Rounds(Own):
    def __post_init__(self):
        super().__post_init__()
        self._set("strength", float(round(self.strength)))

    def define_potential(self, x):
        return self.strength * x[0] ** 2


class Forgets(Own):
    """A named parameter becomes its number."""

    def __post_init__(self):
        super().__post_init__()
        if isinstance(self.strength, fm.Parameter):
            self._set("strength", self.strength.value)

    def define_potential(self, x):
        return self.strength * x[0] ** 2


class NoDataclass(Own):
    length: float = 0.5

    def define_potential(self, x):
        return self.strength * (x[0] - self.length) ** 2


class NoMotion(Own):
    def local_coordinates(self):
        return (fm.scene.LinearForm.of({"pad.z": 1.0}),)

    define_potential = Overflows.define_potential


class Bare(Own):
    def local_coordinates(self):
        return self.a.motion("x")

    define_potential = Overflows.define_potential


class Still(Own):
    def local_coordinates(self):
        return (fm.scene.LinearForm((), 1.0),)

    define_potential = Overflows.define_potential


class NotEqual(Own):
    define_potential = Lax.define_potential

    def __eq__(self, other):
        return self is other

    __hash__ = object.__hash__


@pytest.mark.parametrize(
    ("kind", "named"),
    [
        (Silent, "none of define_potential, define_dissipation and define_force is defined"),
        (Gains, "the dissipation gives power at"),
        (GainsFar, "the dissipation gives power at"),
        (Pole, "not finite at x = [0.0]"),
        (Overflows, "not finite at x = [1000000.0]"),
        (TwoForces, "define_force must return 1 expression(s), one a coordinate, got 2"),
        (TwoPotentials, "define_potential must return one expression"),
        (Stray, "undefined symbols in a derived expression: c"),
        (Unknown, "the function f(x_0) cannot be compiled"),
        (WrongSignature, "define_dissipation takes (self, x_dot); expected is define_dissipation(self, x, x_dot)"),
        (Lax, "strength = nan is accepted"),
        (LaxSign, "strength = -1.0 is accepted"),
        (Nameless, "strength = nan is refused by ValueError without its name"),
        (Rounds, "strength = 2.25 is set, but it holds 2.0"),
        (Forgets, "strength turns a named parameter into 2.0"),
        (NoDataclass, "length is no field: NoDataclass lacks @dataclass"),
        (NoMotion, "name the motion 'pad.z', which does not exist"),
        (Bare, "local_coordinates must return a tuple of linear forms"),
        (Still, "local_coordinates depend on nothing that moves"),
        (NotEqual, "a copy made of the same fields is not equal to it"),
        (NotEqual, "does not come back equal from a pickle"),
    ],
)
def test_wrong_elements_are_named(kind, named):
    with pytest.raises(ConformanceError) as caught:
        check_element(kind(name="own"))
    assert named in str(caught.value)
    assert str(caught.value).startswith(f"{kind.__name__} 'own': ")


#: What a formula must not use: it is no field, so that nobody knows when it changes.
SHAPES = {"of": sympy.sin}


@dataclass(frozen=True, kw_only=True)
class Shaped(Own):
    """A formula that uses what stands outside the declaration: kept formulas do not follow it."""

    def define_potential(self, x):
        return self.strength * SHAPES["of"](x[0])


@dataclass(frozen=True, kw_only=True)
class Held(Own):
    """A formula that uses a function in a field."""

    shape: Callable[..., Any]

    def define_potential(self, x):
        return self.strength * self.shape(x[0])


def test_a_formula_that_depends_on_more_than_fields_is_found(monkeypatch):
    check_element(Shaped(name="first"))
    monkeypatch.setitem(SHAPES, "of", sympy.cos)
    with pytest.raises(ConformanceError, match="does a formula use what is neither a parameter"):
        check_element(Shaped(name="second"))


def test_functions_in_fields_are_formulas_of_their_own():
    check_element(Held(name="first", shape=sympy.sin))
    check_element(Held(name="second", shape=sympy.cos))


def test_a_wrong_template_is_found(monkeypatch):
    """Force, Jacobian, energies and symmetry against a compiled force that is not the stated one."""
    spring = fm.PointSpring("spring", PAD, stiffness=3.0, length=0.4)
    from fricmb.testing import _element_forces

    right = _element_forces.compiled(spring)

    def skewed(state):
        values = right(state)
        jacobian = values.jacobian.copy()
        jacobian[0, 1] += 1e-6
        return type(values)(values.force * (1 + 1e-6), jacobian, values.potential + 1e-6, 0.0, 0.0, values.size)

    monkeypatch.setattr(_element_forces, "compiled", lambda element: skewed)
    found = " ".join(force_findings(spring, Trial((0.0, 0.0), 1.0, 1e6)))
    for named in ("the compiled force at", "the compiled Jacobian at", "are counted as", "is not symmetric"):
        assert named in found


def test_where_an_element_is_looked_at():
    """A pole is no fault where nobody goes; motions that are no ends come in by ``parts``."""
    check_element(Pole(name="pole"), around=[50.0], size=2.0, largest=10.0)
    other = fm.Body("other", mass=1.0)
    force = fm.Force("f", PAD, axis="x", value=fm.coordinate("other.x"))
    check_element(force, parts=[other])
    with pytest.raises(ConformanceError, match=r"other\.x"):
        check_element(force)
    with pytest.raises(ConformanceError, match="around must hold 1"):
        check_element(Pole(name="pole"), around=[1.0, 2.0])
    with pytest.raises(ConformanceError, match=r"subclass of fm\.Element"):
        check_element(PAD)
