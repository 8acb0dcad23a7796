"""Contacts: tangential directions, normal forces, slide."""

import pytest

import fricmb as fm
from fricmb.scene import LinearForm

LAW = fm.laws.Coulomb(mu_s=0.5)
XY, XY2 = fm.Body("a", mass=1.0, axes="xy"), fm.Body("b", mass=1.0, axes="yx")
XYZ = fm.Body("s", mass=1.0, axes="xyz")
X = fm.Body("x", mass=1.0)
BELT = fm.Driven("belt", velocity={"x": 0.2})


def contact(a, b=fm.GROUND, **arguments):
    return fm.Contact("c", a, b, **{"law": LAW, "normal_force": 1.0, **arguments})


def labels(*arguments, **keywords):
    return [d.label for d in contact(*arguments, **keywords).directions()]


def test_default_axes_are_those_along_which_the_ends_move():
    assert labels(XY, XY2) == ["x", "y"]
    assert labels(XY2, XY) == ["y", "x"]
    assert labels(XY, X) == labels(X, XY) == ["x", "y"]
    assert labels(XY, BELT) == labels(BELT, XY) == labels(XY) == ["x", "y"]
    assert labels(XY, fm.Driven("d", axes="y")) == ["y"]
    assert labels(XYZ, X, axes="xz") == ["x", "z"]
    with pytest.raises(fm.SceneError, match="axes must be given"):
        contact(XYZ, X)


def test_what_moves_across_a_guide_slips_there():
    across = fm.Driven("belt", velocity={"x": 0.2, "y": 1.0})
    assert labels(X, across) == labels(across, X) == ["x", "y"]
    assert contact(X, across).directions()[1].form == LinearForm((("belt.y", -1.0),))
    assert labels(X, fm.Driven("belt", velocity={"x": 0.2, "y": 0.0})) == ["x"]
    assert labels(X, fm.Driven("belt", velocity={"y": fm.t})) == ["x", "y"]
    assert labels(X, across, axes="x") == ["x"]  # y is the direction of the load
    assert labels(X, axes="xy", slide=(0.1, 1.0)) == ["x", "y"]
    assert labels(XYZ, across, normal_force=fm.normal.Spring(axis="z", stiffness=1.0)) == ["x", "y"]
    with pytest.raises(fm.SceneError, match=r"slide must be 1 value.*axes= states others"):
        contact(X, slide=(0.1, 1.0))
    with pytest.raises(fm.SceneError, match="needs the axis 'y', which 'x' does not"):
        contact(X, axes="xy")


def test_default_axes_leave_out_that_of_a_normal_law():
    assert labels(XY, normal_force=fm.normal.Spring(axis="y", stiffness=1.0)) == ["x"]
    assert labels(XYZ, normal_force=fm.normal.Spring(axis="y", stiffness=1.0)) == ["x", "z"]
    assert labels(XYZ, normal_force=fm.normal.Spring(axis=(0, 2, 0), stiffness=1.0)) == ["x", "z"]
    (tangent,) = contact(XY, normal_force=fm.normal.Spring(axis=(3, 4), stiffness=1.0)).directions()
    assert dict(tangent.vector) == pytest.approx({"x": 0.8, "y": -0.6})
    normal = contact(XY, BELT, normal_force=fm.normal.Spring(axis=(3, 4), stiffness=1.0)).normal_direction()
    assert dict(normal.form.terms) == pytest.approx({"a.x": 0.6, "a.y": 0.8, "belt.x": -0.6})
    assert normal.dot(tangent) == pytest.approx(0.0, abs=1e-16)


def test_axes_by_letters_and_directions():
    assert labels(XY, axes="y") == ["y"]
    assert labels(XYZ, axes="zx") == labels(XYZ, axes=("z", "x")) == ["z", "x"]
    (one,) = contact(XY, axes=(3, 4)).directions()
    assert one.label == "t"
    assert dict(one.form.terms) == pytest.approx({"a.x": 0.6, "a.y": 0.8})
    first, second = contact(XYZ, axes=[(1, 1, 0), (1, -1, 0)]).directions()
    assert (first.label, second.label) == ("t1", "t2")
    assert dict(second.form.terms) == pytest.approx({"s.x": 0.5**0.5, "s.y": -(0.5**0.5)})
    assert [d.label for d in contact(XYZ, axes=["z", (1, 0, 0)]).directions()] == ["z", "t2"]


def test_form_is_the_motion_of_a_less_that_of_b():
    along_x = contact(XY, XY2).directions()[0]
    assert along_x.form == LinearForm((("a.x", 1.0), ("b.x", -1.0)))
    assert contact(XY, BELT).directions()[1].form == LinearForm((("a.y", 1.0),))


def test_kinds_of_normal_force():
    assert contact(XY).normal_kind == "constant"
    assert contact(XY, normal_force=fm.parameter("N", 3.0)).normal_kind == "constant"
    assert contact(XY, normal_force=1 + fm.t).normal_kind == "expression"
    assert contact(XY, normal_force=fm.normal.Spring(axis="y", stiffness=1.0)).normal_kind == "law"
    assert contact(XY, normal_force=0.0).normal_force == 0.0


def test_normal_force_on_a_coordinate_along_a_default_direction_needs_axes():
    value = 15.0 + 2.0 * fm.coordinate("a.y")
    with pytest.raises(fm.SceneError, match=r"axes must be given.*'a\.y'"):
        contact(XY, normal_force=value)
    assert labels(XY, normal_force=value, axes="x") == ["x"]
    assert labels(X, normal_force=15.0 + fm.coordinate("a.y")) == ["x"]  # another body's coordinate
    assert labels(X, normal_force=15.0 + fm.speed("x.x")) == ["x"]


def test_slide_has_one_value_for_each_direction():
    assert contact(XY).slides() == (0.0, 0.0)
    assert contact(XY, slide=(0.1, fm.t)).slides() == (0.1, fm.t)
    assert contact(X, slide=0.1).slides() == (0.1,)
    scene = fm.Scene("s", [X, contact(X, slide=0.1)])
    assert scene.parameters["c.slide"] == (0.1,)
    assert scene.with_parameters({"c.slide": 0.3})["c"].slide == (0.3,)


def test_parameters_of_law_and_normal_law():
    scene = fm.Scene("s", [XY, contact(XY, normal_force=fm.normal.Spring(axis="y", stiffness=3.0, preload=2.0))])
    assert scene.parameters["c.normal_force.preload"] == 2.0
    assert scene.parameters["c.law.mu_s"] == 0.5
    other = scene.with_parameters({"c.normal_force.stiffness": 0.0, "c.law.mu_s": 0.7})
    assert other["c"].normal_force.stiffness == 0.0
    assert scene.replace("c", normal_force=3.0).parameters["c.normal_force"] == 3.0


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: contact(XY, fm.Body("z", mass=1, axes="z")), ("share no axis", "'xy'", "'z'")),
        (lambda: contact(XYZ), ("axes must be given", "'xyz'")),
        (lambda: contact(X, normal_force=fm.normal.Spring(axis="x", stiffness=1.0)), ("no tangential direction",)),
        (lambda: contact(X, normal_force=fm.normal.Spring(axis="y", stiffness=1.0)), ("normal_force.axis", "'y'")),
        (
            lambda: contact(XYZ, normal_force=fm.normal.Spring(axis=(1, 1), stiffness=1.0)),
            ("axes must be given", "oblique"),
        ),
        (
            lambda: contact(XY, axes="y", normal_force=fm.normal.Spring(axis="y", stiffness=1.0)),
            ("axes", "normal-force law"),
        ),
        (lambda: contact(XY, axes="z"), ("axes", "'z'", "'a' does not")),
        (lambda: contact(XYZ, axes="xyz"), ("axes", "one or two")),
        (lambda: contact(XY, axes=""), ("axes", "one or two")),
        (lambda: contact(XY, axes="xx"), ("axes", "right angles")),
        (lambda: contact(XY, axes=[(1, 0), (1, 1)]), ("axes", "right angles")),
        (lambda: contact(XY, axes=[(1, 0), (0, 1), (1, 1)]), ("axes", "one or two")),
        (lambda: contact(XY, axes=(0, 0)), ("axes", "non-zero")),
        (lambda: contact(XY, axes=3), ("axes", "3")),
        (lambda: contact(XY, axes="w"), ("axes", "'w'")),
        (lambda: contact(fm.GROUND, BELT), ("degrees of freedom",)),
        (lambda: contact(XY, XY), ("another end",)),
        (lambda: contact(XY, law=0.5), ("law", "0.5", "fm.laws.Coulomb")),
        (lambda: contact(XY, law=fm.laws.Coulomb), ("law", "fm.laws.Coulomb(mu_s=0.5)")),
        (lambda: contact(XY, normal_force=-1.0), ("normal_force", "-1.0", ">= 0")),
        (lambda: contact(XY, normal_force=float("nan")), ("normal_force", "nan")),
        (lambda: contact(XY, normal_force=LAW), ("normal_force", "fm.normal")),
        (lambda: contact(XY, normal_force=fm.normal.Spring), ("normal_force", "fm.normal")),
        (lambda: contact(XY, normal_force="15"), ("normal_force", "'15'")),
        (lambda: contact(XY, slide=0.1), ("slide", "2 value(s)")),
        (lambda: contact(XY, slide=(0.1, fm.coordinate("a.x"))), ("slide", "a.x", "fm.t")),
        (lambda: contact(XY, slide=(0.1, float("inf"))), ("slide", "inf")),
    ],
)
def test_wrong_contacts_say_what_is_wrong(make, words):
    with pytest.raises(fm.SceneError) as error:
        make()
    for word in words:
        assert word in str(error.value)
