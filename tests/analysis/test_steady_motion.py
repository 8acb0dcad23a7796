"""Steady motion of mechanisms and its stability: closed forms, and the same scene as a linear structure."""

import numpy as np
import pytest

import fricmb as fm
from fricmb.analysis import steady_sliding


def with_a_pendulum(scene):
    """The same beside a rod on a sprung pin that nothing ties to it: a mechanism by that."""
    rod = fm.RigidBody("rod", mass=2.0, inertia=0.3, position=(0.0, -0.6), points={"eye": (0.0, 0.6)})
    pin, spring = fm.Revolute("pin", rod.point("eye")), fm.TorsionSpring("spring", rod, stiffness=5.0)
    return fm.Scene("both", [*scene.parts, rod, pin, spring])


def matched(values, among, rtol):
    """That each of some eigenvalues is among others."""
    for value in values:
        assert np.abs(among - value).min() < rtol * max(abs(value), 1.0)


@pytest.mark.parametrize(
    ("model", "speeds"), [("minimal_flutter", {}), ("brake4dof", {"rotor.x": 10.0}), ("rotor_doublet", {})]
)
def test_linear_scenes_have_the_same_modes_as_mechanisms(model, speeds):
    scene = getattr(fm.models, model)()
    one, two = steady_sliding(scene, speeds=speeds), steady_sliding(with_a_pendulum(scene), speeds=speeds)
    for name in one.system.contact_names:
        np.testing.assert_allclose(two.force(name), one.force(name), rtol=1e-10)
        assert two.normal_force(name) == pytest.approx(one.normal_force(name), rel=1e-12)
    values = np.linalg.eigvals(two.matrix())
    matched(np.linalg.eigvals(one.matrix()), values, 1e-9)
    swing = np.sqrt(5.0 / (0.3 + 2.0 * 0.6**2))
    matched([1j * swing, -1j * swing], values, 1e-10)
    assert values.size == np.linalg.eigvals(one.matrix()).size + 2


def test_double_pendulum_in_both_planes():
    """Point-like bodies on rods: 2 - sqrt(2) and 2 + sqrt(2) times g over length, in the plane and, twice, in space."""
    flat = [fm.RigidBody(n, mass=1.0, inertia=1e-9, position=(0.0, y)) for n, y in (("a", -1.0), ("b", -2.0))]
    plane = [
        fm.Revolute("pin", flat[0].point("top", (0, 1)), fm.ground_point(0, 0)),
        fm.Revolute("link", flat[1].point("top", (0, 1)), flat[0]),
        fm.Gravity("g", acceleration={"y": -9.81}),
    ]
    solid = [
        fm.space.RigidBody(n, mass=1.0, inertia=(1e-9, 1e-9, 1.5e-9), position=(0, 0, z), points={"top": (0, 0, 1)})
        for n, z in (("a", -1.0), ("b", -2.0))
    ]
    space = [
        fm.space.Universal("pin", solid[0].point("top"), axis_a=(1, 0, 0), axis_b=(0, 1, 0)),
        fm.space.Universal("link", solid[1].point("top"), solid[0], axis_a=(1, 0, 0), axis_b=(0, 1, 0)),
        fm.Gravity("g", acceleration={"z": -9.81}),
    ]
    squares = 9.81 * np.array([2 - np.sqrt(2), 2 + np.sqrt(2)])
    for parts, times in (([*flat, *plane], 1), ([*solid, *space], 2)):
        values = np.linalg.eigvals(steady_sliding(fm.Scene("double pendulum", parts)).matrix())
        assert np.abs(values.real).max() < 1e-6
        np.testing.assert_allclose(np.sort(values.imag**2), np.repeat(squares, 2 * times), rtol=1e-7)


def test_load_from_a_reaction_turns_the_stiffness():
    """A block on a moving line; a spring that presses as it moves along."""
    block = fm.Body("block", mass=1.5, axes="xy")
    stiffness = fm.MatrixElement("springs", ["block.x", "block.y"], K=[[40.0, -25.0], [-25.0, 90.0]])
    law = fm.laws.Stribeck(mu_s=0.6, mu_k=0.4, v_s=1.0)
    load = fm.Force("load", block, axis="y", value=-60.0)
    rub = fm.RollerOnLine("line", block, friction=law, push_only=True, slide=2.0)
    steady = steady_sliding(fm.Scene("pressed", [block, stiffness, load, rub]))
    c, slope = float(law.coefficient(2.0)), float(law.derivative(2.0))
    x = c * 60.0 / (40.0 + c * 25.0)
    N = 60.0 - 25.0 * x
    assert steady.position("block.x") == pytest.approx(x, rel=1e-12)
    assert steady.normal_force("line") == pytest.approx(N, rel=1e-12)
    expected = np.roots([1.5, slope * N, 40.0 + c * 25.0])
    matched(expected, np.linalg.eigvals(steady.matrix()), 1e-10)


def test_what_does_not_move_steadily_is_refused():
    top = fm.space.Rotor("top", mass=1.0, inertia_across=0.1, inertia_axial=0.2, position=(0, 0, 1), axis=(1, 0, 3))
    turn = fm.space.Torque("motor", top, axis=(0, 0, 1), value=1.0)
    with pytest.raises(fm.FricmbError, match="no steady motion"):
        steady_sliding(fm.Scene("driven", [top, turn]))
    slider = fm.Body("slider", mass=1.0, axes="xy")
    held = fm.RollerOnLine("line", slider, friction=fm.laws.Coulomb(mu_s=0.3))
    weight = fm.Gravity("g", acceleration={"y": -9.81})
    with pytest.raises(fm.FricmbError, match="'line' does not slide"):
        steady_sliding(fm.Scene("at rest", [slider, held, weight]))
    moved = fm.Force("shake", slider, axis="x", value=fm.t)
    with pytest.raises(fm.FricmbError, match="depend on time"):
        steady_sliding(fm.Scene("shaken", [slider, moved, fm.RollerOnLine("line", slider), weight]))
