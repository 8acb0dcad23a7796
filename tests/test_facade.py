"""Methods that a higher layer does: they are all in one list, it leads somewhere, and users see what they call."""

import inspect
import subprocess
import sys

import pytest

import fricmb as fm
from fricmb._facade import TARGETS, WORDS, find


def declared(name):
    held = find(name)
    return held.fget if isinstance(held, property) else held


@pytest.mark.parametrize("name", TARGETS)
def test_the_target_takes_what_the_method_declares(name):
    method, target = inspect.signature(declared(name)), inspect.signature(find(TARGETS[name]))
    _, *own = method.parameters.values()
    _, *others = target.parameters.values()
    taken = {p.name: (p.kind, p.default) for p in others}
    for parameter in own:
        assert taken.pop(parameter.name) == (parameter.kind, parameter.default)
    assert all(default is not inspect.Parameter.empty for _, default in taken.values())


@pytest.mark.parametrize("name", TARGETS)
def test_users_see_what_they_call(name):
    method = declared(name)
    assert inspect.getdoc(method)
    assert f"{method.__module__}:{method.__qualname__}" == name
    assert "return" in method.__annotations__


@pytest.mark.parametrize("name", TARGETS)
def test_methods_have_no_body_beside_the_target(name):
    inner = inspect.unwrap(declared(name))
    assert inner is not declared(name)
    assert inner.__code__.co_names == ()


def test_words_of_files_are_found():
    assert find(WORDS["ground"]) is fm.GROUND
    assert find(WORDS["scene"]).__module__ == "fricmb._simulate._mechanics"


def test_what_reaches_up_does_what_the_layer_does():
    scene = fm.models.brake4dof("2")
    assert str(scene.plan()) == str(fm.Scene(scene.name, scene.parts).plan())
    assert scene.plan().dofs == scene.dof_names
    assert fm.laws.Coulomb(mu_s=0.5).creep(0.25).load == 0.25
    with pytest.raises(TypeError, match=r"Scene\.plan\(\)"):
        scene.plan(3)


def test_a_scene_is_declared_without_what_is_above_it():
    code = (
        "import sys, fricmb as fm; fm.Scene('s', [fm.Body('b', mass=1.0)]);"
        "print([m for m in sys.modules if m.startswith(('fricmb.plan', 'fricmb.equations', 'fricmb.plot', 'numba'))])"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"
