"""What is put into arrays all at once is what would be put there one by one."""

import dataclasses
import itertools

import numpy as np
import pytest

import fricmb as fm
from fricmb.integrate import Samples
from fricmb.plan import make_plan
from fricmb.system import _lined, build

LAWS = (
    fm.laws.Coulomb(mu_s=1.2),
    fm.laws.Coulomb(mu_s=1.2, mu_k=0.5),
    fm.laws.Stribeck(mu_s=1.0, mu_k=0.5, v_s=0.1),
    fm.laws.LuGre(sigma0=100.0, sigma1=1.0, sigma2=0.1, mu_s=1.0, mu_k=0.5, v_s=0.1),
)


def mixed(n=90, *, slanted=False):
    """Of everything something; ``slanted``: letters are written as direction tuples, which are no lines."""
    rng = np.random.default_rng(7)
    x, y = ((1.0,), (0.0, 1.0)) if slanted else ("x", "y")
    bodies = [fm.Body(f"b{i}", mass=rng.uniform(1, 2), axes="xy" if i % 3 else "x") for i in range(n)]
    belt = fm.Driven("belt", velocity={"x": 0.1})
    shaken = fm.Driven("shaken", velocity={"x": fm.t**2})
    parts = []
    for i, (body, other) in enumerate(itertools.pairwise(bodies)):
        stiffness, length, cubic = rng.uniform(1, 9), float(i % 2), float(i % 7 == 0)
        parts.append(fm.Spring(f"k{i}", body, other, axis=x, stiffness=stiffness, length=length, cubic=cubic))
        if i % 3 and (i + 1) % 3:
            parts.append(fm.Damper(f"d{i}", body, other, axis=y, damping=float(i % 4)))
        if i % 5 == 0:
            parts.append(fm.Spring(f"s{i}", body, belt, axis="x", stiffness=2.0))
        under = (belt, shaken, other, fm.GROUND)[i % 4]
        parts.append(fm.Contact(f"c{i}", body, under, axes=(x,), law=LAWS[i % 4], normal_force=float(i % 6)))
    return fm.Scene("mixed", [*bodies, belt, shaken, *parts])


def arrays(value, path=""):
    if isinstance(value, np.ndarray):
        return {path: value}
    if not dataclasses.is_dataclass(value):
        return {}
    found = {}
    for field in dataclasses.fields(value):
        found |= arrays(getattr(value, field.name), f"{path}.{field.name}")
    return found


def test_arrays_are_those_of_parts_one_by_one(monkeypatch):
    together = build(mixed())
    assert together.lined
    monkeypatch.setattr(_lined, "FEW", 10**6)
    single = build(mixed())
    assert not single.lined
    for name in ("M", "Kx", "Cx", "fx", "B"):
        found, expected = (getattr(system.problem.linear, name) for system in (together, single))
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-14)
    contacts = arrays(together.problem.contacts)
    for name, expected in arrays(single.problem.contacts).items():
        np.testing.assert_array_equal(contacts[name], expected, err_msg=name)
    for name in ("contact_axes", "state_names", "axis_scale", "contact_names", "dof_names"):
        assert getattr(together, name) == getattr(single, name)
    q, none = np.random.default_rng(1).normal(size=(together.problem.n, 3)), np.zeros((0, 3))
    samples = Samples(
        t=np.arange(3.0), q=q, v=q, z=none, F=none, g=none, N=none, mode=none, friction_loss=none, damping_loss=none,
        input=none,
    )  # fmt: skip
    np.testing.assert_allclose(together.potential(samples), single.potential(samples), rtol=1e-14)
    found, expected = together.potentials(samples), single.potentials(samples)
    assert found.keys() == expected.keys()
    assert all(np.allclose(found[name], expected[name], rtol=1e-13, atol=1e-13) for name in expected)


@pytest.mark.parametrize("observe", [None, ["b10.y"], ["c5"], ["b3.x"]])
def test_plans_are_those_of_parts_one_by_one(observe):
    together, single = make_plan(mixed(), observe), make_plan(mixed(slanted=True), observe)
    assert together == single
    assert together.counts["bodies"] > 0


def test_a_part_of_a_large_scene_is_built_as_if_it_stood_alone():
    scene = mixed()
    plan = make_plan(scene, ["b3.x"])
    assert _lined.FEW < len(plan.parts) < len(scene.parts)
    alone = build(fm.Scene("alone", [scene[name] for name in plan.parts]))
    rows = [alone.dof_names.index(name) for name in plan.dofs]
    found, expected = build(scene, plan).problem.linear.Kx, alone.problem.linear.Kx
    np.testing.assert_array_equal(found[: len(rows), : len(rows)], expected[np.ix_(rows, rows)])
