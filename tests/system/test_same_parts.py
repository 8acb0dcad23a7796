"""Scenes that differ in one value share what they have the same parts of."""

import gc
import weakref
from dataclasses import dataclass

import numpy as np
import pytest
import sympy

import fricmb as fm
from fricmb.scene._family import MANY, of_same_parts
from fricmb.scene._family_of import FAMILIES, SMALL, _families, forget_families
from fricmb.system import build

M = fm.models


def halves(scene):
    problem = build(scene).problem
    return problem.linear, problem.contacts


def test_a_stiffness_leaves_the_contacts_and_a_coefficient_the_structure():
    scene = M.brake4dof()
    linear, contacts = halves(scene)
    stiff = scene.replace("k1x", stiffness=2.0)
    stiffer, same_contacts = halves(stiff)
    assert same_contacts is contacts
    assert stiffer is not linear
    assert stiffer.Kx[0, 0] == linear.Kx[0, 0] + 1.0
    same_linear, slower = halves(stiff.with_parameters({"lining.normal_force": 0.5}))
    assert same_linear is stiffer
    assert slower.N[0] == 0.5


def test_a_mass_leaves_the_contacts_and_a_start_all():
    scene = M.brake4dof()
    linear, contacts = halves(scene)
    heavier, same_contacts = halves(scene.with_parameters({"pad.mass": 2.0}))
    assert heavier is not linear
    assert heavier.M[0, 0] == 2.0
    assert same_contacts is contacts
    moved = scene.with_parameters({"pad.position.x": 0.3, "rotor.velocity.x": 2.0, "pad.mass": 2.0})
    assert halves(moved) == (heavier, contacts)
    assert build(moved).start.q[0] == 0.3


def test_a_body_with_other_axes_is_looked_at_again():
    scene = M.brake4dof()
    build(scene)
    with pytest.raises(fm.SceneError, match="axis"):
        build(scene.replace("pad", axes="x", position={}, velocity={}))


def test_bodies_of_other_kinds_are_never_taken_for_the_same():
    """Where its points are is a number of a modal body, which contacts feel."""
    def plate(tip):
        shapes = {"tip": [[tip, 1.0]]}
        return fm.ModalBody("plate", frequencies=[1.0, 2.0], damping_ratios=[0.0, 0.0], shapes=shapes)

    held, belt = plate(1.0), fm.Driven("belt", velocity={"x": 0.2})
    law = fm.laws.Coulomb(mu_s=0.3, mu_k=0.2)
    scene = fm.Scene("plate", [held, belt, fm.Contact("rub", held.point("tip"), belt, law=law, normal_force=1.0)])
    other = scene.replace("plate", shapes=plate(3.0).shapes)
    assert build(scene).problem.contacts.W[:, 0].tolist() == [1.0, 1.0]
    assert build(other).problem.contacts.W[:, 0].tolist() == [3.0, 1.0]


def test_signals_of_what_is_shared_are_there():
    shaken = fm.Driven("shaken", position={"x": 0.1 * sympy.sin(3 * fm.t)})
    belt = fm.Driven("belt", velocity={"x": 1 + 0.1 * sympy.cos(2 * fm.t)})
    body = fm.Body("body", mass=1.0)
    scene = fm.Scene("signals", [
        shaken, belt, body, fm.Spring("k", body, shaken, axis="x", stiffness=2.0),
        fm.Force("push", body, axis="x", value=0.3 * sympy.sin(fm.t)),
        fm.Contact("rub", body, belt, law=fm.laws.Coulomb(mu_s=0.4, mu_k=0.3), normal_force=1.0),
    ])  # fmt: skip
    build(scene)
    for values in ({"k.stiffness": 3.0}, {"rub.law.mu_k": 0.2}, {"rub.normal_force": 2.0}):
        changed = scene.with_parameters(values)
        forget_families()
        anew = fm.Scene(changed.name, changed.parts)
        found, wanted = build(changed).problem, build(anew).problem
        assert found.n_u == wanted.n_u == 3
        for part in ("linear", "contacts"):
            for name, value in vars(getattr(wanted, part)).items():
                if isinstance(value, np.ndarray):
                    np.testing.assert_array_equal(getattr(getattr(found, part), name), value)
        np.testing.assert_array_equal(found.signals.table.address, wanted.signals.table.address)
        np.testing.assert_array_equal(found.signals.uniform, wanted.signals.uniform)
        times = np.linspace(0.0, 2.0, 5)
        np.testing.assert_array_equal(build(changed).signals(times), build(anew).signals(times))


@dataclass(frozen=True, kw_only=True)
class Slack(fm.Element):
    """A spring of somebody's own, as long as its ends are apart at the start, and longer for a heavy body."""

    a: fm.Body
    b: fm.Body
    stiffness: float
    length: float = 0.0

    def __post_init__(self):
        super().__post_init__()
        self._set("length", self.b.position["x"] - self.a.position["x"] + self.a.mass)

    def local_coordinates(self):
        return (self.b.motion("x") - self.a.motion("x"),)

    def define_potential(self, x):
        return self.stiffness * (x[0] - self.length) ** 2 / 2


def test_elements_of_others_may_read_anything_of_a_body():
    a, b = fm.Body("a", mass=1.0), fm.Body("b", mass=2.0, position={"x": 1.0})
    scene = fm.Scene("own", [a, b, Slack("s", a=a, b=b, stiffness=3.0)])
    assert build(scene).problem.linear.fx.tolist() == [-6.0, 6.0]
    moved = scene.with_parameters({"b.position.x": 1.5})
    assert build(moved).problem.linear.fx.tolist() == [-7.5, 7.5]
    heavy = moved.with_parameters({"a.mass": 2.0})
    assert build(heavy).problem.linear.fx.tolist() == [-10.5, 10.5]


def test_equal_parts_that_are_not_the_same_are_looked_at_again():
    scene, made = M.belt_oscillator(), []
    (body, *_) = scene.bodies

    def make():
        made.append(1)
        return len(made)

    twin = fm.Body(body.name, mass=2.0, axes=body.axes, position=body.position, velocity=body.velocity)
    assert [of_same_parts(scene, "k", [body], make) for _ in range(2)] == [1, 1]
    assert of_same_parts(scene, "k", [twin], make) == 2
    assert of_same_parts(scene, "other", [body], make) == 3
    assert of_same_parts(scene, "k", [twin, body], make) == 4


def test_large_scenes_keep_nothing():
    scene = M.stick_slip_chain(MANY // 2)
    assert len(scene.parts) > MANY
    first = build(scene).problem.contacts
    name = next(part.name for part in scene.parts if isinstance(part, fm.Spring))
    assert build(scene.with_parameters({f"{name}.stiffness": 3.0})).problem.contacts is not first


def test_a_family_keeps_its_last_problem_and_no_other():
    scene = M.brake4dof()
    other = scene.with_parameters({"pad.mass": 2.0})
    build(other)
    kept = weakref.ref(build(other).problem)
    del other
    gc.collect()
    assert build(scene.with_parameters({"pad.mass": 2.0})).problem is kept()
    assert build(scene.with_parameters({"pad.mass": 3.0})).problem is not kept()
    gc.collect()
    assert kept() is None


def test_a_scene_that_a_function_makes_anew_takes_what_it_has_in_common_with_the_last_one():
    forget_families()
    first = build(M.brake4dof()).problem
    assert build(M.brake4dof()).problem is first
    harder = build(M.brake4dof(mu_k_N=16.0)).problem
    assert harder.linear is first.linear
    assert harder.contacts is not first.contacts
    heavier = build(M.brake4dof(mu_k_N=16.0, mass_ratio=900.0)).problem
    assert heavier.contacts is harder.contacts
    assert heavier.linear is not harder.linear
    other_belt = build(M.belt_oscillator(belt=0.3)).problem
    assert build(M.belt_oscillator(belt=0.2)).problem.signals is not other_belt.signals


def test_scenes_of_other_names_types_or_order_are_of_other_families():
    a, b = fm.Body("a", mass=1.0), fm.Body("b", mass=1.0)
    spring, damper = fm.Spring("s", a, b, axis="x", stiffness=1.0), fm.Damper("s", a, b, axis="x", damping=1.0)
    scene = fm.Scene("one", [a, b, spring])
    assert fm.Scene("one", [a, b, spring])._shared is scene._shared
    for other in (fm.Scene("two", [a, b, spring]), fm.Scene("one", [a, b, damper]), fm.Scene("one", [b, a, spring])):
        assert other._shared is not scene._shared
    many = [fm.Body(f"b{i}", mass=1.0) for i in range(SMALL + 1)]
    assert fm.Scene("many", many)._shared is not fm.Scene("many", many)._shared


def test_families_are_forgotten_when_there_are_many():
    scene = M.brake4dof()
    for i in range(FAMILIES):
        fm.Scene(f"scene {i}", [fm.Body("a", mass=1.0)])
    assert M.brake4dof()._shared is not scene._shared


def test_a_wrong_scene_joins_no_family():
    a = fm.Body("a", mass=1.0)
    forget_families()
    with pytest.raises(fm.SceneError):
        fm.Scene("wrong", [a, a])
    assert not _families


def test_one_problem_serves_all_starts_while_somebody_has_it():
    scene = M.brake4dof()
    problem = build(scene).problem
    assert build(scene.with_parameters({"pad.position.x": 0.3})).problem is problem
    assert build(scene.with_parameters({"lining.normal_force": 0.5})).problem is not problem
    stiff = build(scene.replace("k1x", stiffness=2.0)).problem
    assert stiff is not problem
    assert build(scene.with_parameters({"pad.position.x": 0.3})).problem is not stiff


def test_a_part_that_reads_signals_is_put_in_anew_where_their_numbers_change():
    """A spring to a body that moves comes after another one, or before."""
    first, second = (fm.Driven(name, position={"x": sympy.sin(fm.t)}) for name in ("first", "second"))
    body = fm.Body("body", mass=1.0)
    one, other = (fm.Spring(f"to {end.name}", body, end, axis="x", stiffness=2.0) for end in (first, second))
    forget_families()
    for springs in ((one, other), (other, one), (other,), (one,)):
        scene = fm.Scene("signals", [first, second, body, *springs])
        linear = build(scene).problem.linear
        names = [spring.name.removeprefix("to ") for spring in springs]
        assert linear.Kx[0, 1:].tolist() == [-2.0] * len(names)
        stiffer = scene.with_parameters({f"to {names[-1]}.stiffness": 3.0})
        assert build(stiffer).problem.linear.Kx[0, 1:].tolist() == [-2.0] * (len(names) - 1) + [-3.0]


def test_a_sweep_refuses_what_an_element_of_others_refuses_before_anything_is_run():
    @dataclass(frozen=True, kw_only=True)
    class Light(fm.Element):
        """Holds light bodies alone."""

        a: fm.Body
        stiffness: float

        def __post_init__(self):
            super().__post_init__()
            if self.a.mass > 5.0:
                self._refuse("a", self.a.mass, "a body of at most 5")

        def local_coordinates(self):
            return (self.a.motion("x"),)

        def define_potential(self, x):
            return self.stiffness * x[0] ** 2 / 2

    body = fm.Body("body", mass=1.0, velocity={"x": 1.0})
    scene = fm.Scene("light", [body, Light(name="s", a=body, stiffness=3.0)])
    ran = []
    with pytest.raises(fm.SceneError, match="at most 5"):
        fm.sweep(scene, [{"body.mass": m} for m in (2.0, 9.0)], t_end=1.0, reduce=ran.append, workers=1, progress=False)
    assert not ran
