"""Bodies, ends, elements: what they declare, and what they refuse."""

import dataclasses
import pickle
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import pytest
import scipy.sparse
import sympy

import fricmb as fm
from fricmb.scene import LinearForm, check_ends, direction, expression_uses
from fricmb.values import symbolic
from fricmb.values._same import is_same

NAN, INF = float("nan"), float("inf")


def form(**terms):
    return LinearForm.of({name.replace("_", "."): c for name, c in terms.items()})


def value_at(element, x, v=None, t=0.0):
    """Potential, dissipation or force of an element, as numbers."""
    stand = symbolic(element)
    xs = sympy.symbols(f"x_0:{len(x)}", real=True)
    vs = sympy.symbols(f"v_0:{len(x)}", real=True)
    numbers = {
        **dict(zip(stand.flat, stand.values, strict=True)),
        **dict(zip(xs, x, strict=True)),
        **dict(zip(vs, v or (0.0,) * len(x), strict=True)),
    }
    potential, loss = stand.standin.define_potential(xs), stand.standin.define_dissipation(xs, vs)
    return [None if e is None else float(e.subs(numbers)) for e in (potential, loss)]


def test_spring_between_axes_and_directions():
    a, b = fm.Body("a", mass=1.0, axes="xy"), fm.Body("b", mass=1.0, axes="yx")
    assert fm.Spring("k", a, b, axis="y", stiffness=1.0).local_coordinates() == (form(a_y=1, b_y=-1),)
    oblique = fm.Spring("k", a, b, axis=(3, 4), stiffness=1.0).local_coordinates()[0]
    assert dict(oblique.terms) == pytest.approx({"a.x": 0.6, "a.y": 0.8, "b.x": -0.6, "b.y": -0.8})
    # components are over the axes of a, in its own order
    swapped = fm.Spring("k", b, a, axis=(3, 4), stiffness=1.0).local_coordinates()[0]
    assert dict(swapped.terms) == pytest.approx({"b.y": 0.6, "b.x": 0.8, "a.y": -0.6, "a.x": -0.8})
    assert fm.Spring("k", a, axis=(0, 2), stiffness=1.0).local_coordinates() == (form(a_y=1),)
    assert fm.Spring("k", fm.GROUND, a, axis="x", stiffness=1.0).local_coordinates() == (form(a_x=-1),)


def test_spring_potential_has_cubic_and_length():
    a = fm.Body("a", mass=1.0)
    spring = fm.Spring("k", a, axis="x", stiffness=2.0, cubic=3.0, length=0.5)
    assert value_at(spring, (1.5,)) == [pytest.approx(2.0 / 2 + 3.0 / 4), None]
    assert value_at(fm.Damper("c", a, axis="x", damping=3.0), (0.0,), (2.0,)) == [None, pytest.approx(6.0)]


def test_point_elements_act_along_the_line():
    a, b = fm.Body("a", mass=1.0, axes="xy"), fm.Body("b", mass=1.0, axes="xy")
    spring = fm.PointSpring("k", a, stiffness=2.0, length=4.0, anchor=(1.0, -2.0))
    assert spring.local_coordinates() == (LinearForm((("a.x", 1.0),), -1.0), LinearForm((("a.y", 1.0),), 2.0))
    assert value_at(spring, (3.0, 4.0))[0] == pytest.approx(1.0)
    assert value_at(fm.PointDamper("c", a, b, damping=2.0), (3.0, 4.0), (1.0, 2.0))[1] == pytest.approx((11 / 5) ** 2)
    assert fm.PointSpring("k", a, b, stiffness=2.0).local_coordinates() == (form(a_x=1, b_x=-1), form(a_y=1, b_y=-1))
    solid = fm.Body("c", mass=1.0, axes="xyz")
    assert fm.PointSpring("k", solid, stiffness=2.0).anchor == (0.0, 0.0, 0.0)


def test_derivatives_of_point_springs_are_finite_where_the_points_meet():
    a = fm.Body("a", mass=1.0, axes="xy")
    stand = symbolic(fm.PointSpring("k", a, stiffness=2.0, length=0.5))
    x = sympy.symbols("x_0 x_1", real=True)
    potential = stand.standin.define_potential(x)
    for first in x:
        for second in x:
            slope = sympy.lambdify([*x, *stand.flat], potential.diff(first, second), "math")
            assert np.isfinite(slope(0.0, 0.0, *stand.values))


def test_driven_bodies_have_the_axes_of_their_partner():
    a, belt = fm.Body("a", mass=1.0, axes="xy"), fm.Driven("belt", velocity={"x": 0.2})
    assert fm.Spring("k", a, belt, axis="x", stiffness=1.0).local_coordinates() == (form(a_x=1, belt_x=-1),)
    assert fm.Spring("k", a, belt, axis="y", stiffness=1.0).local_coordinates() == (form(a_y=1),)
    narrow = fm.Driven("belt", velocity={"x": fm.t**2}, axes="x")
    with pytest.raises(fm.SceneError, match="'belt' does not have"):
        fm.Spring("k", a, narrow, axis="y", stiffness=1.0)
    assert narrow.moving == ("x",)
    both = fm.Driven("d", velocity={"x": fm.t}, position={"x": 3.0, "y": sympy.sin(fm.t)})
    assert both.moving == ("x", "y")


def test_force_depends_on_motions_of_other_parts():
    a, b = fm.Body("a", mass=1.0), fm.Body("b", mass=1.0)
    value = fm.coordinate("b.x") * fm.speed("a.x") + sympy.cos(fm.t)
    force = fm.Force("f", a, axis="x", value=value)
    uses = expression_uses(force.value)
    assert (uses.time, uses.coordinates, uses.speeds, uses.motions) == (True, ("b.x",), ("a.x",), ("b.x", "a.x"))
    assert force.local_coordinates() == (form(a_x=1), form(b_x=1), form(a_x=1))
    assert fm.Scene("s", [a, b, force]).parameters.keys() == {
        f"{n}.{slot}" for n in "ab" for slot in ("mass", "position.x", "velocity.x")
    }
    assert list(force.expressions()) == ["value"]


def test_matrix_element_takes_dense_and_sparse():
    dense = fm.MatrixElement("m", ["a.x", "b.x"], M=np.eye(2), K=[[1, 2], [0, 1]])
    sparse = fm.MatrixElement("m", ["a.x", "b.x"], M=scipy.sparse.eye(2), K=scipy.sparse.coo_array([[1, 2], [0, 1]]))
    assert sparse.K.toarray().tolist() == dense.K.tolist() == [[1.0, 2.0], [0.0, 1.0]]
    assert dense.C is None
    with pytest.raises(ValueError, match="read-only"):
        dense.K[0, 0] = 3.0
    for element in (dense, sparse):
        again = pickle.loads(pickle.dumps(element))
        assert again == element
        assert hash(again) == hash(element)
    assert dense != fm.MatrixElement("m", ["a.x", "b.x"], M=np.eye(2), K=[[1, 2.5], [0, 1]])


def test_modal_body_and_its_points():
    plate = fm.ModalBody(
        "plate",
        frequencies=np.array([0.0, 3.0, 5.0]),
        damping_ratios=0.01,
        shapes={"tip": [[1.0, 0.5, 0.2], [0.0, 2.0, -1.0]], "root": np.zeros((2, 3))},
        axes="xy",
        velocity={"mode2": 0.1},
    )
    tip = plate.point("tip")
    assert plate.dof_names == ("plate.mode1", "plate.mode2", "plate.mode3")
    scene = fm.Scene("s", [plate, fm.Spring("k", tip, plate.point("root"), axis="y", stiffness=1.0)])
    assert scene["k"].local_coordinates() == (LinearForm((("plate.tip.y", 1.0), ("plate.root.y", -1.0))),)
    assert scene.expand(scene["k"].local_coordinates()[0]) == LinearForm((("plate.mode2", 2.0), ("plate.mode3", -1.0)))
    assert scene.motion_names == (*plate.dof_names, "plate.tip.x", "plate.tip.y", "plate.root.x", "plate.root.y")
    assert scene.initial_values()[1].tolist() == [0.0, 0.1, 0.0]
    faster = scene.with_parameters({"plate.frequencies": [0.0, 4.0, 5.0], "plate.damping_ratios": [0.0, 0.1, 0.1]})
    assert faster["k"].a.body is faster["plate"]
    assert faster["plate"].frequencies == (0.0, 4.0, 5.0)
    assert pickle.loads(pickle.dumps(faster)) == faster
    with pytest.raises(KeyError, match="'tip'"):
        plate.point("tipp")


def test_one_axis_of_a_modal_body_takes_a_flat_shape():
    body = fm.ModalBody("p", frequencies=[1.0, 2.0], damping_ratios=[0.0, 0.1], shapes={"tip": [1.0, -1.0]})
    assert body.modal_form("tip", "x") == form(p_mode1=1, p_mode2=-1)


@dataclass(frozen=True, kw_only=True)
class Quintic(fm.Element):
    """An element as a user writes one."""

    a: fm.Body
    strength: float

    def __post_init__(self):
        super().__post_init__()
        check_ends(self, self.a, fm.GROUND)

    def local_coordinates(self):
        return (direction(self, "axis", "x", self.a, fm.GROUND).form,)

    def define_potential(self, x):
        return self.strength * x[0] ** 6 / 6


def test_own_elements():
    a = fm.Body("a", mass=1.0)
    scene = fm.Scene("s", [a, Quintic(name="q", a=a, strength=6.0)])
    assert scene.parameters["q.strength"] == 6.0
    assert value_at(scene["q"], (2.0,))[0] == 64.0
    other = scene.with_parameters({"a.mass": 2.0, "q.strength": 1.0})
    assert other["q"].a is other["a"]
    assert pickle.loads(pickle.dumps(other)) == other
    with pytest.raises(fm.SceneError, match=r"Quintic 'q': strength must be a finite number"):
        Quintic(name="q", a=a, strength=NAN)


A = fm.Body("a", mass=1.0, axes="xy")
B = fm.Body("b", mass=1.0, axes="z")
D = fm.Driven("d")
P = {"frequencies": [1.0, 2.0], "damping_ratios": 0.0, "shapes": {"tip": [1.0, 1.0]}}


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: fm.Body("a.b", mass=1), ("name", "'a.b'", "dots")),
        (lambda: fm.Body("", mass=1), ("name", "''")),
        (lambda: fm.Body(3, mass=1), ("name", "3")),
        (lambda: fm.Body(" a", mass=1), ("name",)),
        (lambda: fm.Body("a", mass=-1.0), ("Body 'a'", "mass", "-1.0", ">= 0")),
        (lambda: fm.Body("a", mass=NAN), ("mass", "nan", "finite")),
        (lambda: fm.Body("a", mass=INF), ("mass", "inf", "finite")),
        (lambda: fm.Body("a", mass="1"), ("mass", "'1'", "number")),
        (lambda: fm.Body("a", mass=None), ("mass", "None")),
        (lambda: fm.Body("a", mass=1j), ("mass", "1j")),
        (lambda: fm.Body("a", mass=10**400), ("mass", "finite")),
        (lambda: fm.Body("a", mass=fm.t), ("mass", "t", "parameters")),
        (lambda: fm.Body("a", mass=1, axes="xx"), ("axes", "'xx'")),
        (lambda: fm.Body("a", mass=1, axes=""), ("axes", "''")),
        (lambda: fm.Body("a", mass=1, axes="xw"), ("axes", "'xw'", "'x', 'y', 'z'")),
        (lambda: fm.Body("a", mass=1, axes=2), ("axes", "2")),
        (lambda: fm.Body("a", mass=1, position={"y": 1.0}), ("position", "'y'", "'x'")),
        (lambda: fm.Body("a", mass=1, velocity={"x": NAN}), ("velocity['x']", "nan")),
        (lambda: fm.Body("a", mass=1, velocity=3.0), ("velocity", "3.0", "dict")),
        (lambda: fm.Driven("d", velocity={"x": sympy.Symbol("t")}), ("velocity['x']", "fm.t", "is not fm.t")),
        (lambda: fm.Driven("d", velocity={"x": fm.coordinate("a.x")}), ("velocity['x']", "a.x", "fm.t")),
        (lambda: fm.Driven("d", velocity={"x": fm.t}, position={"x": fm.t}), ("position['x']", "number")),
        (lambda: fm.Driven("d", position={"x": sympy.I * fm.t}), ("position['x']", "real")),
        (lambda: fm.Driven("d", position={"x": sympy.oo * fm.t}), ("position['x']",)),
        (lambda: fm.Driven("d", position={"x": lambda t: t}), ("position['x']", "SymPy expression")),
        (lambda: fm.Driven("d", velocity={"y": 1.0}, axes="x"), ("velocity", "'y'")),
        (lambda: fm.Spring("k", A, axis="z", stiffness=1.0), ("Spring 'k'", "axis", "'z'", "'xy'")),
        (lambda: fm.Spring("k", A, axis="q", stiffness=1.0), ("axis", "'q'")),
        (lambda: fm.Spring("k", A, axis=0, stiffness=1.0), ("axis", "0")),
        (lambda: fm.Spring("k", A, axis=(0, 0), stiffness=1.0), ("axis", "non-zero")),
        (lambda: fm.Spring("k", A, axis=(1, 0, 0), stiffness=1.0), ("axis", "3 components", "'xy'")),
        (lambda: fm.Spring("k", A, axis=(1, NAN), stiffness=1.0), ("axis", "nan")),
        (lambda: fm.Spring("k", A, B, axis="x", stiffness=1.0), ("axis", "'b' does not have")),
        (lambda: fm.Spring("k", A, A, axis="x", stiffness=1.0), ("another end",)),
        (lambda: fm.Spring("k", fm.GROUND, axis="x", stiffness=1.0), ("degrees of freedom", "'ground'")),
        (lambda: fm.Spring("k", D, axis="x", stiffness=1.0), ("degrees of freedom", "'d'")),
        (lambda: fm.Spring("k", "a", axis="x", stiffness=1.0), ("a must be a Body", "'a'")),
        (lambda: fm.Spring("k", A, None, axis="x", stiffness=1.0), ("b must be a Body", "None")),
        (lambda: fm.Spring("k", fm.ModalBody("p", **P), axis="x", stiffness=1.0), ("point('tip')",)),
        (lambda: fm.Spring("k", A, axis="x", stiffness=NAN), ("stiffness", "nan")),
        (lambda: fm.Spring("k", A, axis="x", stiffness=1.0, cubic="a"), ("cubic", "'a'")),
        (lambda: fm.Spring("k", A, axis="x", stiffness=fm.coordinate("a.x")), ("stiffness", "a.x")),
        (lambda: fm.Damper("c", A, axis="x", damping=INF), ("Damper 'c'", "damping", "inf")),
        (lambda: fm.PointSpring("k", A, stiffness=1.0, length=-1.0), ("length", "-1.0", ">= 0")),
        (lambda: fm.PointSpring("k", A, stiffness=1.0, anchor=(1.0,)), ("anchor", "2 numbers")),
        (lambda: fm.PointSpring("k", A, stiffness=1.0, anchor=3.0), ("anchor",)),
        (
            lambda: fm.PointSpring("k", A, fm.Body("e", mass=1, axes="xy"), stiffness=1.0, anchor=(1, 1)),
            ("anchor", "GROUND"),
        ),
        (lambda: fm.PointSpring("k", A, B, stiffness=1.0), ("same axes", "'xy'", "'z'")),
        (lambda: fm.PointDamper("c", A, damping=NAN), ("damping", "nan")),
        (lambda: fm.Force("f", fm.GROUND, axis="x", value=1.0), ("body", "'ground'")),
        (lambda: fm.Force("f", D, axis="x", value=1.0), ("body", "'d'")),
        (lambda: fm.Force("f", A, axis="x", value="sin(t)"), ("value", "'sin(t)'", "SymPy expression")),
        (lambda: fm.Force("f", A, axis="x", value=sympy.Symbol("q")), ("value", "q", "fm.coordinate")),
        (lambda: fm.Force("f", A, axis="x", value=sympy.Function("g")(fm.t)), ("value", "g(t)")),
        (lambda: fm.Force("f", A, axis="x", value=NAN), ("value", "nan")),
        (lambda: fm.Force("f", A, axis="x", value=sympy.nan), ("value", "nan")),
        (lambda: fm.MatrixElement("m", "a.x", K=[[1]]), ("dofs", "'a.x'")),
        (lambda: fm.MatrixElement("m", [], K=[[1]]), ("dofs",)),
        (lambda: fm.MatrixElement("m", ["a.x", "a.x"], K=np.eye(2)), ("dofs", "different")),
        (lambda: fm.MatrixElement("m", ["a.x"]), ("M, C, K",)),
        (lambda: fm.MatrixElement("m", ["a.x"], K=np.eye(2)), ("K", "(1, 1)", "(2, 2)")),
        (lambda: fm.MatrixElement("m", ["a.x"], K=scipy.sparse.eye(2)), ("K", "(1, 1)", "(2, 2)")),
        (lambda: fm.MatrixElement("m", ["a.x"], K=[[NAN]]), ("K", "finite")),
        (lambda: fm.MatrixElement("m", ["a.x"], K=scipy.sparse.csr_array([[NAN]])), ("K", "finite")),
        (lambda: fm.MatrixElement("m", ["a.x"], K=[["a"]]), ("K", "numbers")),
        (lambda: fm.MatrixElement("m", ["a.x", "b.x"], K=[[1, 2], [3]]), ("K", "numbers")),
        (lambda: fm.MatrixElement("m", ["a.x", "b.x"], M=[[1, 2], [0, 1]]), ("M", "symmetric")),
        (lambda: fm.ModalBody("p", **{**P, "frequencies": []}), ("frequencies",)),
        (lambda: fm.ModalBody("p", **{**P, "frequencies": [1.0, -1.0]}), ("frequencies[1]", "-1.0", ">= 0")),
        (lambda: fm.ModalBody("p", **{**P, "frequencies": [[1.0], [1.0, 2.0]]}), ("frequencies",)),
        (lambda: fm.ModalBody("p", **{**P, "frequencies": 1.0}), ("frequencies", "1.0")),
        (lambda: fm.ModalBody("p", **{**P, "damping_ratios": [0.1]}), ("damping_ratios", "2 numbers")),
        (lambda: fm.ModalBody("p", **{**P, "damping_ratios": -0.1}), ("damping_ratios", "-0.1")),
        (lambda: fm.ModalBody("p", **P, masses=[1.0, 0.0]), ("masses[1]", "> 0")),
        (lambda: fm.ModalBody("p", **{**P, "shapes": {}}), ("shapes", "at least one")),
        (lambda: fm.ModalBody("p", **{**P, "shapes": {"tip": [1.0]}}), ("shapes['tip']", "(1, 2)", "(1, 1)")),
        (lambda: fm.ModalBody("p", **{**P, "shapes": {"t.p": [1.0, 1.0]}}), ("shapes", "'t.p'")),
        (lambda: fm.ModalBody("p", **{**P, "shapes": {"mode1": [1.0, 1.0]}}), ("shapes", "'mode1'")),
        (lambda: fm.ModalBody("p", **{**P, "shapes": {"tip": [1.0, NAN]}}), ("shapes['tip']", "finite")),
        (lambda: fm.ModalBody("p", **P, position={"mode3": 1.0}), ("position", "'mode3'", "'mode1'")),
        (lambda: fm.ModalBody("p", **P, axes="xy"), ("shapes['tip']", "(2, 2)")),
        (lambda: fm.coordinate("pad"), ("coordinate", "'pad'")),
        (lambda: fm.speed(3), ("speed", "3")),
    ],
)
def test_wrong_declarations_say_what_is_wrong(make, words):
    with pytest.raises(fm.SceneError) as error:
        make()
    for word in words:
        assert word in str(error.value)


def test_values_are_the_same_where_whatever_is_made_of_them_is():
    law = fm.laws.Stribeck(mu_s=1.0, mu_k=0.5, v_s=0.1)
    twins = [
        (1.5, 1.5), ("x", "x"), ((1.0, (2.0,)), (1.0, (2.0,))), ({"x": 1.0}, {"x": 1.0}),
        (law, fm.laws.Stribeck(mu_s=1.0, mu_k=0.5, v_s=0.1)),
    ]  # fmt: skip
    assert all(is_same(a, b) for a, b in twins)
    body = fm.Body("a", mass=1.0)
    others = [
        (0.0, -0.0), (1.0, 1), ((1.0,), (1.0, 2.0)), ({"x": 1.0, "y": 2.0}, {"y": 2.0, "x": 1.0}),
        ({"x": 1.0}, {"x": 2.0}),
        (law, fm.laws.Stribeck(mu_s=1.0, mu_k=0.5, v_s=0.2)), (law, fm.laws.Coulomb(mu_s=1.0, mu_k=0.5)),
        (body, fm.Body("a", mass=1.0)), (np.zeros(2), np.zeros(2)), (lambda x: x, lambda x: x),
    ]  # fmt: skip
    assert not any(is_same(a, b) for a, b in others)


def test_a_driven_end_moves_like_one_of_the_same_name_and_motion():
    def belt(**velocity):
        return fm.Driven("belt", velocity=velocity)

    assert belt(x=1.0).moves_like(belt(x=1.0))
    assert not belt(x=1.0).moves_like(belt(x=2.0))
    assert not belt(x=1.0).moves_like(belt(y=1.0))
    assert not belt(x=1.0).moves_like(fm.Driven("rail", velocity={"x": 1.0}))
    assert not belt(x=fm.t).moves_like(belt(x=2 * fm.t))


def test_a_body_holds_its_start_and_not_the_dict_behind_a_view_of_it():
    values = {"x": 1.0}
    body = fm.Body("a", mass=1.0, position=MappingProxyType(values))
    values["x"] = np.nan
    assert body.position == {"x": 1.0}
    again = dataclasses.replace(body, mass=2.0)
    assert again.position is body.position


def test_a_view_of_a_dict_is_checked_as_the_dict_is():
    with pytest.raises(fm.SceneError, match="position has the key 1; accepted are 'x'"):
        fm.Body("a", mass=1.0, position=MappingProxyType({1: 0.0}))
    with pytest.raises(fm.SceneError, match="Body 'a': velocity"):
        fm.Body("a", mass=1.0, velocity=MappingProxyType({"x": np.inf}))
