"""Every element type: the force is the derivative of its energies, the Jacobian that of the force."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
import sympy

import fricmb as fm
from fricmb.equations import element_template, function, numbers
from fricmb.scene import End, LinearForm


@dataclass(frozen=True, eq=False)
class Gap(fm.Element):
    """A bilinear stop with a dashpot of its own: potential, dissipation and an outer force in one element."""

    a: End
    stiffness: Any
    damping: Any
    pull: Any

    def local_coordinates(self):
        return (self.a.motion("x"),)

    def define_potential(self, x):
        return self.stiffness * sympy.Max(0, x[0]) ** 2 / 2

    def define_dissipation(self, x, x_dot):
        return self.damping * x[0] ** 2 * x_dot[0] ** 2 / 2

    def define_force(self, x, x_dot, t):
        return (self.pull * sympy.cos(t) * x_dot[0],)


@dataclass(frozen=True, eq=False)
class Pendulum(fm.Element):
    """Strongly nonlinear in two coordinates, in one potential."""

    a: End
    weight: Any

    def local_coordinates(self):
        return self.a.motion("x"), self.a.motion("y")

    def define_potential(self, x):
        return self.weight * sympy.exp(x[0]) * sympy.sin(x[1]) + self.weight * x[0] * x[1]


PAD = fm.Body("pad", mass=1.0, axes="xy")
ELEMENTS = [
    fm.Spring("s", PAD, axis="x", stiffness=3.0, cubic=2.0, length=0.4),
    fm.PointSpring("ps", PAD, stiffness=3.0, length=0.4, anchor=(0.1, 0.2)),
    fm.PointDamper("pd", PAD, damping=0.7),
    Gap("gap", PAD, stiffness=4.0, damping=0.3, pull=0.2),
    Pendulum("pendulum", PAD, weight=1.3),
]


class Kernel:
    """The nonlinear remainder of an element as a function of x, v, d (rates that driven ends bring in) and t."""

    def __init__(self, element, driven):
        self.template = element_template(element, driven=driven)
        self.n = len(element.local_coordinates())
        self.places = self.template.facts["arguments"]
        self.p = np.array(numbers(element))

    def arguments(self, x, v, d, t):
        held = {"x": x, "v": v, "d": d, "t": [t]}
        return np.array([held[kind][i] for kind, i in self.places])

    def outputs(self, arguments):
        out = np.full(self.n * (1 + len(self.places)) + 3, np.nan)
        function(self.template.address)(np.ascontiguousarray(arguments), self.p, out)
        force = out[: self.n]
        jacobian = out[self.n : -3].reshape(self.n, len(self.places))
        return force.copy(), jacobian.copy(), *out[-3:]


STATES = [([0.3, -0.8], [0.7, 0.4], [0.2, -0.1], 0.3), ([-1.2, 0.5], [-2.0, 0.1], [0.0, 1.0], 2.0)]


@pytest.mark.parametrize("driven", [False, True])
@pytest.mark.parametrize("element", ELEMENTS, ids=lambda e: type(e).__name__)
@pytest.mark.parametrize("state", STATES)
def test_jacobian_is_the_derivative_of_the_force(element, driven, state):
    kernel = Kernel(element, driven)
    arguments = kernel.arguments(*state)
    _, jacobian, *_ = kernel.outputs(arguments)
    for column in range(len(arguments)):
        h = np.zeros(len(arguments))
        h[column] = 1e-6
        slope = (kernel.outputs(arguments + h)[0] - kernel.outputs(arguments - h)[0]) / 2e-6
        np.testing.assert_allclose(jacobian[:, column], slope, rtol=1e-7, atol=1e-8)


@pytest.mark.parametrize("element", ELEMENTS, ids=lambda e: type(e).__name__)
@pytest.mark.parametrize("state", STATES)
def test_powers_balance(element, state):
    """f.v_dofs = -dV/dt - loss + input, for the remainder alone."""
    x, v, d, t = (np.array(part) for part in state)
    kernel = Kernel(element, True)
    force, _, _, loss, supply = kernel.outputs(kernel.arguments(x, v, d, t))
    h = 1e-6
    after = kernel.outputs(kernel.arguments(x + h * v, v, d, t))[2]
    before = kernel.outputs(kernel.arguments(x - h * v, v, d, t))[2]
    n = kernel.n
    given = force @ (v - d)[:n]
    assert given == pytest.approx(-(after - before) / (2 * h) - loss + supply, abs=1e-8)


@pytest.mark.parametrize("element", ELEMENTS, ids=lambda e: type(e).__name__)
def test_kernels_are_finite_at_rest_and_far_away(element):
    kernel = Kernel(element, True)
    for scale in (0.0, 1e-200, 1e8):
        state = [scale, scale], [scale, 0.0], [0.0, scale], 0.0
        if type(element) is Pendulum and scale > 1.0:
            continue
        force, jacobian, *scalars = kernel.outputs(kernel.arguments(*state))
        assert np.all(np.isfinite(force))
        assert np.all(np.isfinite(jacobian))
        assert np.all(np.isfinite(scalars))


@pytest.mark.parametrize(
    ("element", "left"),
    [
        (fm.Spring("s", PAD, axis="x", stiffness=3.0), False),
        (fm.Spring("s", PAD, axis="x", stiffness=3.0, length=0.5), False),
        (fm.Spring("s", PAD, axis="x", stiffness=0.0, cubic=-1.0), True),
        (fm.PointSpring("s", PAD, stiffness=3.0), False),
        (fm.PointSpring("s", PAD, stiffness=3.0, length=0.5), True),
        (fm.PointDamper("s", PAD, damping=0.0), False),
        (fm.PointDamper("s", PAD, damping=0.1), True),
        (Gap("s", PAD, stiffness=0.0, damping=0.0, pull=0.0), False),
        (Gap("s", PAD, stiffness=0.0, damping=0.0, pull=1.0), True),
        (Pendulum("s", PAD, weight=0.0), False),
    ],
)
def test_nothing_nonlinear_is_left_where_its_factors_are_zero(element, left):
    assert element_template(element, driven=False).rest(numbers(element)) is left


def test_a_point_spring_without_length_is_a_linear_spring():
    entries = element_template(ELEMENTS[1], driven=False).matrices((0.1, 0.2, 3.0, 0.0))
    assert entries["K"] == [(0, 0, 3.0), (1, 1, 3.0)]
    assert not entries["f"]


def test_affine_part_of_a_spring_with_length():
    template = element_template(ELEMENTS[0], driven=False)
    entries = template.matrices((3.0, 2.0, 0.4))
    assert entries["K"] == [(0, 0, 3.0)]
    ((_, _, force),) = entries["f"]
    assert force == pytest.approx(1.2)
    # the cubic part keeps its own elongation: no cancellation of expanded powers near x = L
    kernel = Kernel(ELEMENTS[0], False)
    force, *_ = kernel.outputs(kernel.arguments([0.4 + 1e-5], [0.0], [0.0], 0.0))
    assert force[0] == pytest.approx(-2.0 * (0.4 + 1e-5 - 0.4) ** 3, rel=1e-12)


def test_a_function_that_cannot_be_compiled_is_named():
    @dataclass(frozen=True, eq=False)
    class Strange(fm.Element):
        a: End
        k: Any

        def local_coordinates(self):
            return (LinearForm.of({"pad.x": 1.0}),)

        def define_potential(self, x):
            return self.k * sympy.besselj(0, x[0])

    with pytest.raises(fm.SceneError, match="besselj"):
        element_template(Strange("strange", PAD, k=1.0), driven=False)


@dataclass(frozen=True, kw_only=True)
class Shaped(fm.Element):
    """A potential given as a function."""

    a: fm.Body
    shape: Any

    def local_coordinates(self):
        return (self.a.motion("x"),)

    def define_potential(self, x):
        return self.shape(x[0])


def test_functions_in_fields_select_templates():
    body = fm.Body("b", mass=1.0)
    quartic, cosh = (Shaped(name="e", a=body, shape=f) for f in (lambda x: x**4, sympy.cosh))
    first, second = (element_template(e, driven=False) for e in (quartic, cosh))
    assert first.key != second.key
    other = Shaped(name="other", a=fm.Body("c", mass=2.0), shape=sympy.cosh)
    assert element_template(other, driven=False) is second


def test_arrays_in_fields_select_templates():
    body = fm.Body("b", mass=1.0)
    a, b, c = (Shaped(name="e", a=body, shape=Table(k)) for k in ((1.0, 2.0), (1.0, 3.0), (1.0, 2.0)))
    assert element_template(a, driven=False).key != element_template(b, driven=False).key
    assert element_template(a, driven=False).key == element_template(c, driven=False).key


class Table:
    """An object that is called, with an array inside."""

    def __init__(self, coefficients):
        self.coefficients = np.array(coefficients)

    def __call__(self, x):
        return sum(float(c) * x ** (i + 2) for i, c in enumerate(self.coefficients))
