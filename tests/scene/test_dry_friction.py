"""Friction of constant size: what is accepted, and what it lowers to."""

import math
import pickle

import pytest

import fricmb as fm

ARM = fm.RigidBody("arm", mass=1.0, inertia=0.1, points={"pin": (0.0, 0.5)})
OTHER = fm.RigidBody("other", mass=1.0, inertia=0.1)
BLOCK = fm.Body("block", mass=1.0, axes="xy")


def refused(match, *arguments, **keywords):
    with pytest.raises(fm.SceneError, match=match):
        fm.DryFriction("dry", *arguments, **keywords)


def test_limits_are_short_for_coulomb():
    dry = fm.DryFriction("dry", BLOCK, axis="x", static=3.0, kinetic=2.0)
    assert dry.law == fm.laws.Coulomb(mu_s=3.0, mu_k=2.0)
    assert (dry.static, dry.kinetic) == (3.0, 2.0)
    assert fm.DryFriction("dry", BLOCK, axis="x", static=3).kinetic == 3.0
    law = fm.laws.Stribeck(mu_s=3.0, mu_k=2.0, v_s=0.1, viscous=0.4)
    assert fm.DryFriction("dry", BLOCK, axis="x", law=law).law is law


def test_values_change_by_the_names_of_the_law():
    scene = fm.Scene("s", [BLOCK, fm.DryFriction("dry", BLOCK, axis="y", static=3.0)])
    assert scene.parameters["dry.law.mu_s"] == 3.0
    named = fm.Scene("s", [BLOCK, fm.DryFriction("dry", BLOCK, axis="y", static=fm.parameter("limit", 3.0))])
    assert named.with_parameters({"limit": 4.0})["dry"].static == 4.0
    assert scene.with_parameters({"dry.law.mu_k": 1.0})["dry"].kinetic == 1.0
    assert scene.replace("dry", law=fm.laws.Coulomb(mu_s=1.0))["dry"].static == 1.0
    assert pickle.loads(pickle.dumps(scene["dry"])) == scene["dry"]


def test_axes():
    (along,) = fm.DryFriction("dry", BLOCK, axis=(3, 4), static=1.0).directions()
    assert dict(along.form.terms) == pytest.approx({"block.x": 0.6, "block.y": 0.8})
    (turn,) = fm.DryFriction("dry", ARM, OTHER, axis="angle", static=1.0).directions()
    assert dict(turn.form.terms) == {"arm.angle": 1.0, "other.angle": -1.0}
    assert fm.DryFriction("dry", ARM.point("pin"), axis="angle", static=1.0).labels() == ("angle",)


def test_a_joint_stands_for_its_coordinate():
    pin = fm.Revolute("pin", ARM.point("pin"), OTHER)
    for first, sign in ((ARM, 1.0), (OTHER, -1.0)):
        (turn,) = fm.DryFriction("dry", first, axis=pin, static=1.0).directions()
        assert dict(turn.form.terms) == {"arm.angle": sign, "other.angle": -sign}
    assert fm.DryFriction("dry", ARM, axis=fm.Prismatic("g", ARM), static=1.0).guide == "g"
    refused("a must be of a body that the joint 'pin' ties: 'arm' or 'other'", BLOCK, axis=pin, static=1.0)
    refused("b must be left out, or the other end of the joint, 'other'", ARM, BLOCK, axis=pin, static=1.0)


def test_what_cannot_be_is_refused_by_name():
    refused("axis must be given", BLOCK, static=1.0)
    refused("axis must be 'x', 'y', 'z', 'angle'", BLOCK, axis="turn", static=1.0)
    refused("axis must be 'x', 'y', 'z', 'angle'", BLOCK, axis=("x", "y"), static=1.0)
    refused("a must turn", BLOCK, axis="angle", static=1.0)
    refused("static or law must be given$", BLOCK, axis="x")
    refused("static or law must be given, got kinetic alone", BLOCK, axis="x", kinetic=1.0)
    refused("static must be a finite number >= 0, got -1", BLOCK, axis="x", static=-1.0)
    refused("static must be a finite number >= 0, got nan", BLOCK, axis="x", static=math.nan)
    refused("kinetic must be a finite number >= 0 and <= static = 1, got 2", BLOCK, axis="x", static=1.0, kinetic=2.0)
    law = fm.laws.Coulomb(mu_s=1.0)
    refused("static must be left out beside law", BLOCK, axis="x", static=1.0, law=law)
    refused("law must be a friction law", BLOCK, axis="x", law=2.0)
    refused("normal_force must be", BLOCK, axis="x", static=1.0, normal_force=-1.0)
    refused("law must be a law of one direction|axes must", BLOCK, axis="x", law=fm.laws.Contensou.example())


def test_in_space():
    body = fm.space.RigidBody("body", mass=1.0, inertia=(0.1, 0.2, 0.3))
    sleeve = fm.space.Cylindrical("sleeve", body, axis=(0, 0, 1))
    dry = fm.space.DryFriction("dry", body, axis=sleeve, along="slide", static=2.0, kinetic=1.0)
    assert (dry.axis, dry.along, dry.static, dry.kinetic) == ((0.0, 0.0, 1.0), "slide", 2.0, 1.0)
    scene = fm.Scene("s", [body, sleeve, dry])
    assert scene.with_parameters({"dry.friction.mu_k": 0.5})["dry"].kinetic == 0.5
    assert pickle.loads(pickle.dumps(dry)) == dry
    hinge = fm.space.Revolute("hinge", body, axis=(1, 0, 0))
    assert fm.space.DryFriction("dry", body, axis=hinge, static=1.0).labels() == ("angle",)
    with pytest.raises(fm.SceneError, match="along must be 'angle' or 'slide', got None"):
        fm.space.DryFriction("dry", body, axis=sleeve, static=1.0)
    with pytest.raises(fm.SceneError, match="along must be 'angle', got 'slide'"):
        fm.space.DryFriction("dry", body, axis=hinge, along="slide", static=1.0)
    with pytest.raises(fm.SceneError, match="axis must be given"):
        fm.space.DryFriction("dry", body, static=1.0)
