"""Scenes: names, parameters, replacing, pickling, equality."""

import copy
import itertools
import pickle

import numpy as np
import pytest

import fricmb as fm
from fricmb.scene._part import original_of


def brake(**changes):
    pad = fm.Body("pad", mass=1.0, axes="xy")
    rotor = fm.Body("rotor", mass=1000.0, axes="xy", velocity={"x": 10.0, "y": 0.01})
    settings = {"law": fm.laws.Coulomb(mu_s=1.0, mu_k=1.0), "normal_force": 15.0, **changes}
    return fm.Scene(
        "my brake",
        [
            pad,
            rotor,
            fm.Spring("k1x", pad, axis="x", stiffness=1.0),
            fm.Spring("k1y", pad, axis="y", stiffness=157.08),
            fm.Spring("k2y", rotor, axis="y", stiffness=0.25),
            fm.Damper("c1x", pad, axis="x", damping=0.01),
            fm.Contact("lining", pad, rotor, **settings),
        ],
    )


def test_names_and_parameters():
    scene = brake()
    assert scene.dof_names == ("pad.x", "pad.y", "rotor.x", "rotor.y")
    assert isinstance(scene.parts, tuple)
    assert scene["k1x"] is scene.parts[2]
    parameters = scene.parameters
    assert parameters["k1x.stiffness"] == 1.0
    assert parameters["lining.law.mu_k"] == 1.0
    assert parameters["lining.normal_force"] == 15.0
    assert parameters["rotor.velocity.x"] == 10.0
    assert parameters["pad.position.x"] == 0.0
    q, v = scene.initial_values()
    np.testing.assert_array_equal(q, np.zeros(4))
    np.testing.assert_array_equal(v, [0.0, 0.0, 10.0, 0.01])


def test_with_parameters_makes_a_new_scene():
    scene = brake()
    other = scene.with_parameters(
        {"k1x.stiffness": 4.0, "lining.law.mu_k": 0.5, "rotor.velocity.x": 3.0, "pad.mass": 2}
    )
    assert scene.parameters["k1x.stiffness"] == 1.0
    changed = {name: value for name, value in other.parameters.items() if scene.parameters[name] != value}
    assert changed == {"k1x.stiffness": 4.0, "lining.law.mu_k": 0.5, "rotor.velocity.x": 3.0, "pad.mass": 2.0}
    # what refers to a changed body refers to the new one
    assert other["k1x"].a is other["pad"]
    assert other["lining"].b is other["rotor"]
    assert scene.with_parameters({}) is scene
    assert scene.with_parameters(scene.parameters) == scene
    with pytest.raises(AttributeError, match="replace"):
        scene.name = "other"


def test_values_that_depend_on_one_another_change_together():
    scene = brake(law=fm.laws.Coulomb(mu_s=1.0, mu_k=0.9))
    assert scene.with_parameters({"lining.law.mu_s": 0.5, "lining.law.mu_k": 0.4})["lining"].law.mu_k == 0.4
    with pytest.raises(fm.LawError, match="mu_k"):
        scene.with_parameters({"lining.law.mu_s": 0.5})


def test_slots_that_are_not_listed_can_be_set():
    scene = brake(law=fm.laws.Coulomb(mu_s=1.0))
    assert "lining.law.mu_k" not in scene.parameters
    assert scene.with_parameters({"lining.law.mu_k": 0.5})["lining"].law.slip_limit() == 0.5


def test_replace():
    scene = brake()
    law = fm.laws.Stribeck(mu_s=1.0, mu_k=0.5, v_s=0.1)
    assert scene.replace("lining", law=law)["lining"].law is law
    heavy = scene.replace("pad", mass=7.0)
    assert heavy["k1y"].a is heavy["pad"]
    renamed = scene.replace("pad", name="shoe")
    assert renamed.dof_names[0] == "shoe.x"
    assert renamed["k1x"].local_coordinates()[0].motions == ("shoe.x",)
    with pytest.raises(KeyError, match="'lining'"):
        scene.replace("linin", law=law)
    with pytest.raises(fm.SceneError, match="did you mean 'law'"):
        scene.replace("lining", laws=law)


def test_scenes_pickle_copy_compare_and_hash():
    scene = brake()
    scene._cache["system"] = object()
    for again in (pickle.loads(pickle.dumps(scene)), copy.deepcopy(scene), brake()):
        assert again == scene
        assert hash(again) == hash(scene)
        assert again._cache == {}
        assert again["k1x"].b is fm.GROUND
    assert scene != brake(normal_force=16.0)
    assert scene != "my brake"


def test_unknown_names_list_those_near():
    scene = brake()
    for name, near in [
        ("k1x.stifness", "stiffness"),
        ("kx1.stiffness", "k1x.stiffness"),
        ("lining.law.mk", "mu_k"),
        ("lining.lw.mu_k", "lining.law.mu_k"),
        ("rotor.speed.x", "velocity"),
        ("rotor.velocity.z", "'x', 'y'"),
        ("k1x", ""),
        ("k1x.stiffness.x", "stiffness"),
        ("N0", "known"),
        ("lining.axes", "law"),
    ]:
        with pytest.raises(fm.SceneError) as error:
            scene.with_parameters({name: 1.0})
        assert near in str(error.value), name
        assert name.rsplit(".", 1)[-1] in str(error.value), name
    with pytest.raises(KeyError):
        scene.with_parameters({"k1x.stifness": 1.0})
    with pytest.raises(KeyError):
        scene["k9"]


def test_named_parameters_stand_anywhere_and_change_everywhere():
    N0 = fm.parameter("N0", 15.0)
    scene = brake(normal_force=2 * N0 - 15, law=fm.laws.Coulomb(mu_s=N0 / 10, mu_k=1.0))
    assert scene.parameters["N0"] == 15.0
    assert "lining.normal_force" not in scene.parameters
    assert "lining.law.mu_s" not in scene.parameters
    assert scene["lining"].numeric_slots() == {"law.mu_s": 1.5, "law.mu_k": 1.0, "normal_force": 15.0}
    other = scene.with_parameters({"N0": 20.0})
    assert other.parameters["N0"] == 20.0
    assert other["lining"].numeric_slots() == {"law.mu_s": 2.0, "law.mu_k": 1.0, "normal_force": 25.0}
    detached = scene.with_parameters({"lining.normal_force": 3.0})
    assert detached.parameters["lining.normal_force"] == 3.0
    assert pickle.loads(pickle.dumps(other)) == other
    assert other != scene


def test_named_parameters_in_every_kind_of_slot():
    p = fm.parameter("p", 2.0)
    belt = fm.Driven("belt", velocity={"x": p * fm.t})
    plate = fm.ModalBody("plate", frequencies=[1.0, p], damping_ratios=p / 100, shapes={"tip": [p, 1.0]}, masses=[p, p])
    block = fm.Body("block", mass=p, position={"x": -p})
    scene = fm.Scene(
        "all",
        [
            belt,
            plate,
            block,
            fm.Force("f", block, axis="x", value=p * fm.coordinate("plate.tip.x")),
            fm.MatrixElement("m", ["block.x", "plate.mode1"], K=[[p, 0.0], [0.0, 1.0]]),
            fm.Contact("c", block, belt, law=fm.laws.Coulomb(mu_s=p), normal_force=p, slide=p * fm.t),
        ],
    )
    assert scene.parameters["p"] == 2.0
    other = scene.with_parameters({"p": 3.0})
    assert other["block"].numeric_slots()["mass"] == 3.0
    assert other["block"].numeric_slots()["position.x"] == -3.0
    np.testing.assert_array_equal(other["plate"].numeric_slots()["frequencies"], [1.0, 3.0])
    np.testing.assert_array_equal(other["plate"].numeric_slots()["shapes.tip"], [[3.0, 1.0]])
    np.testing.assert_array_equal(other["m"].numeric_slots()["K"], [[3.0, 0.0], [0.0, 1.0]])
    assert other["belt"].velocity["x"].subs(fm.t, 2.0).free_symbols.pop().value == 3.0
    assert other["c"].uses()["slide.0"].parameters[0].value == 3.0
    assert other["f"].uses()["value"].parameters[0].value == 3.0
    assert pickle.loads(pickle.dumps(other)) == other
    assert other.with_parameters({"p": 2.0}) == scene


def test_two_values_of_one_parameter_are_refused():
    pad = fm.Body("pad", mass=fm.parameter("p", 1.0))
    with pytest.raises(fm.SceneError, match=r"'p'.*1\.0.*2\.0"):
        fm.Scene("s", [pad, fm.Spring("k", pad, axis="x", stiffness=fm.parameter("p", 2.0))])
    with pytest.raises(fm.SceneError, match=r"'p'.*1\.0.*2\.0"):
        fm.Scene("s", [pad, fm.Force("k", pad, axis="x", value=fm.parameter("p", 2.0) * fm.t)])


@pytest.mark.parametrize(
    ("name", "value"), [("a.b", 1.0), ("", 1.0), ("a", float("nan")), ("a", "1"), ("a", True), (3, 1.0)]
)
def test_bad_parameters_are_refused(name, value):
    with pytest.raises(fm.SceneError, match="parameter"):
        fm.parameter(name, value)


def test_parameters_combine_with_numbers_and_numpy():
    p = fm.parameter("p", 2.0)
    x = fm.t
    for value, number in [
        (p + 1, 3.0), (1 + p, 3.0), (p - 1, 1.0), (1 - p, -1.0), (p * 3, 6.0), (3 * p, 6.0), (p / 4, 0.5), (4 / p, 2.0),
        (p**3, 8.0), (3**p, 9.0), (-p, -2.0), (abs(-p), 2.0), (np.float64(3.0) * p, 6.0), (p + p, 4.0), (+p, 2.0),
    ]:  # fmt: skip
        body = fm.Body("b", mass=1.0, position={"x": value})
        assert body.numeric_slots()["position.x"] == pytest.approx(number, rel=1e-15)
        assert fm.Scene("s", [body]).parameters["p"] == 2.0
    assert (p * x).free_symbols == {x, (+p)}


def test_only_what_refers_to_a_changed_body_is_made_again():
    blocks = [fm.Body(f"b{i}", mass=1.0) for i in range(300)]
    springs = [fm.Spring(f"k{i}", a, b, axis="x", stiffness=1.0) for i, (a, b) in enumerate(itertools.pairwise(blocks))]
    scene = fm.Scene("chain", [*blocks, *springs])
    assert len(scene.dof_names) == 300
    other = scene.with_parameters({"b7.mass": 3.0})
    assert other["k7"].a is other["b7"]
    assert other["k6"].b is other["b7"]
    assert other["k100"] is scene["k100"]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda a, b: fm.Scene("s", [a, a]), ("'a'", "twice")),
        (lambda a, b: fm.Scene("s", [a, fm.Spring("a", a, axis="x", stiffness=1)]), ("'a'", "twice")),
        (
            lambda a, b: fm.Scene("s", [a, fm.Spring("k", b, axis="x", stiffness=1)]),
            ("Spring 'k'", "'b'", "among the parts"),
        ),
        (
            lambda a, b: fm.Scene("s", [a, fm.Spring("k", fm.Body("a", mass=2), axis="x", stiffness=1)]),
            ("another 'a'",),
        ),
        (lambda a, b: fm.Scene("s", []), ("at least one",)),
        (lambda a, b: fm.Scene("s", [fm.Driven("d")]), ("at least one",)),
        (lambda a, b: fm.Scene("s", [a, fm.GROUND]), ("GROUND",)),
        (lambda a, b: fm.Scene("s", [a, "b"]), ("'b'", "Body, Spring, Contact")),
        (lambda a, b: fm.Scene("s", a), ("parts", "list")),
        (lambda a, b: fm.Scene("s", None), ("parts", "list", "None")),
        (lambda a, b: fm.Scene("", [a]), ("name", "''")),
        (
            lambda a, b: fm.Scene("s", [a, fm.Force("f", a, axis="x", value=fm.coordinate("a.z"))]),
            ("value", "'a.z'", "'a.x'"),
        ),
        (lambda a, b: fm.Scene("s", [a, fm.Force("f", a, axis="x", value=fm.speed("b.x"))]), ("value", "'b.x'")),
        (
            lambda a, b: fm.Scene("s", [a, fm.MatrixElement("m", ["a.q"], K=[[1]])]),
            ("dofs", "MatrixElement 'm'", "'a.q'"),
        ),
        (lambda a, b: fm.Scene("s", [a]).with_parameters(3), ("parameters", "3")),
        (lambda a, b: fm.Scene("s", [a]).with_parameters({"a.mass": -3}), ("Body 'a'", "mass", "-3", ">= 0")),
        (lambda a, b: fm.Scene("s", [a]).with_parameters({"a.mass": "3"}), ("Body 'a'", "mass", "'3'")),
    ],
)
def test_wrong_scenes_say_what_is_wrong(make, words):
    a, b = fm.Body("a", mass=1.0), fm.Body("b", mass=1.0)
    with pytest.raises(fm.SceneError) as error:
        make(a, b)
    for word in words:
        assert word in str(error.value)


def test_a_value_that_cannot_be_is_refused_also_where_numbers_alone_change():
    scene = fm.models.brake4dof()
    for values in ({"k1x.stiffness": float("nan")}, {"pad.mass": -1.0}, {"lining.law.mu_k": 2.0}):
        with pytest.raises(fm.FricmbError):
            scene.with_parameters(values)
        with pytest.raises(fm.FricmbError):
            fm.sweep(scene, [values], t_end=1.0, workers=1, progress=False)
    with pytest.raises(fm.FricmbError):
        scene.with_parameters({"k1x.stifness": 1.0})


def test_a_scene_with_other_numbers_knows_its_parts():
    scene = fm.models.brake4dof()
    heavy = scene.with_parameters({"pad.mass": 2.0})
    assert heavy["pad"].mass == 2.0
    assert heavy["k1x"].a is heavy["pad"] is heavy["lining"].a
    assert heavy["k1x"] == fm.Spring("k1x", heavy["pad"], axis="x", stiffness=1.0)
    assert original_of(heavy["k1x"]) is scene["k1x"]
    assert heavy["k2y"] is scene["k2y"]
    assert heavy == fm.Scene(scene.name, heavy.parts, units=scene.units)
    again = heavy.with_parameters({"pad.mass": 3.0, "k1x.stiffness": 2.0})
    assert original_of(again["k1x"]) is not scene["k1x"]
    assert original_of(again["k1y"]) is scene["k1y"]
    assert again.parameters["k1x.stiffness"] == 2.0
    assert dict(again.parameters, **{"pad.mass": 1.0, "k1x.stiffness": 1.0}) == scene.parameters


def test_joints_look_at_the_angle_at_the_start_and_not_at_masses():
    scene = fm.models.slider_crank()
    assert original_of(scene.with_parameters({"slider.mass": 2.0})["guide"]) is scene["guide"]
    assert original_of(scene.with_parameters({"slider.angle": 0.1})["guide"]) is not scene["guide"]
