"""Derivatives against differences of runs: random scenes of the oracle, laws of all kinds, elements, every method."""

import numpy as np
import pytest
import sympy

import fricmb as fm
from tests.oracle.random_scenes import generate
from tests.oracle.spec import scene as scene_of

from .differences import worst


@pytest.mark.parametrize(
    ("kind", "seed"), [("line", 1), ("line", 7), ("stack", 1), ("modes", 1), ("modes", 5), ("plane", 1)]
)
def test_random_scene(kind, seed):
    spec = generate(kind, seed)
    scene = scene_of(spec)
    numbers = [name for name, value in scene.parameters.items() if isinstance(value, float)]
    friction = [name for name in numbers if ".law." in name or name.startswith("belt")]
    rng = np.random.default_rng(seed)
    names = list(dict.fromkeys([str(x) for x in [*rng.permutation(friction)[:2], *rng.permutation(numbers)[:3]]]))
    found = worst(scene, names, rtol=1e-8, t_end=spec.t_end)
    assert found
    assert max(found.values()) < 1e3, found


def bristle(law):
    """A block pulled by a spring whose end moves."""
    hand, block = fm.Driven("hand", velocity={"x": 0.1}), fm.Body("block", mass=1.0)
    spring = fm.Spring("spring", block, hand, axis="x", stiffness=2.0)
    return fm.Scene("pulled", [hand, block, spring, fm.Contact("rub", block, law=law, normal_force=1.0)])


@pytest.mark.parametrize(
    ("law", "names"),
    [
        (
            fm.laws.LuGre(sigma0=100.0, sigma1=2.0, sigma2=0.4, mu_s=1.5, mu_k=1.0, v_s=0.1),
            ("rub.law.sigma0", "rub.law.mu_k"),
        ),
        (fm.laws.Dahl(mu=0.8, sigma0=50.0), ("rub.law.mu", "rub.law.sigma0")),
    ],
)
def test_laws_with_states(law, names):
    names = (*names, "hand.velocity.x", "block.mass")
    found = worst(bristle(law), names, rtol=1e-8, step=2e-4, t_end=6.0)
    assert set(found) == set(names)
    assert max(found.values()) < 1e3, found


@pytest.mark.parametrize("method", ["auto", "radau", "bdf", "collocation"])
def test_loads_that_vary(method):
    """A normal force of time and a parameter, a cubic spring, a force of motion and time."""
    swing = fm.parameter("swing", 0.3)
    load = 1.0 + swing * sympy.sin(2.0 * fm.t)
    belt, block = fm.Driven("belt", velocity={"x": 0.4}), fm.Body("block", mass=1.3, position={"x": 0.2})
    parts = [
        belt, block, fm.Spring("spring", block, axis="x", stiffness=1.5),
        fm.Contact("rub", block, belt, law=fm.laws.Coulomb(mu_s=0.7, mu_k=0.5), normal_force=load),
        fm.Force("push", block, axis="x", value=0.2 * sympy.cos(fm.t)),
    ]  # fmt: skip
    names = ("swing", "belt.velocity.x", "rub.law.mu_s", "spring.stiffness", "block.mass")
    found = worst(fm.Scene("loads", parts), names, rtol=1e-8, t_end=12.0, method=method)
    assert found
    assert max(found.values()) < 1e3, found


def test_what_is_not_covered_says_so():
    with pytest.raises(fm.SceneError, match=r"'top\.spin' of a body in space is not covered"):
        fm.simulate(fm.models.heavy_top(), t_end=0.1, sensitivities=("top.spin",))
