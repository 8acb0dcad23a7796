"""Modes from finite element meshes, against closed forms."""

import numpy as np
import pytest

import fricmb as fm

skfem = pytest.importorskip("skfem")

STEEL = {"young": 2.1e11, "poisson": 0.3, "density": 7800.0}


def beam(length=1.0, height=0.02, nx=40, ny=2):
    return skfem.MeshQuad.init_tensor(np.linspace(0, length, nx + 1), np.linspace(0, height, ny + 1))


def test_a_cantilever():
    """Slender: Euler and Bernoulli's frequencies, less what shear and rotary inertia take."""
    body = fm.ModalBody.from_mesh(
        "beam", beam(), **STEEL, n_modes=3, points={"tip": (1.0, 0.01)}, fixed=lambda x: np.isclose(x[0], 0.0)
    )
    radius = 0.02 / np.sqrt(12)
    euler = np.array([1.875104068711961, 4.694091132974174]) ** 2 * radius * np.sqrt(2.1e11 / 7800.0)
    np.testing.assert_allclose(np.array(body.frequencies[:2]) / euler, 1.0, atol=2e-3)
    assert body.axes == "xy"
    # static: P L^3/(3 E I) across, P L/(E A) along, which the residual modes make good
    shapes = body.shapes["tip"]
    flexible = (shapes**2 / np.square(body.frequencies)).sum(axis=1)
    across, along = 1.0 / (3 * 2.1e11 * 0.02**3 / 12), 1.0 / (2.1e11 * 0.02)
    assert flexible[1] == pytest.approx(across, rel=2e-3)
    assert flexible[0] > along  # a force at a point dents a plane body without limit as the mesh is refined
    assert body.residual == 2


def test_a_free_plate_has_its_rigid_modes():
    body = fm.ModalBody.from_mesh("plate", beam(nx=12), **STEEL, n_modes=5, points={"p": (0.5, 0.01)}, residual=False)
    assert body.frequencies[:3] == (0.0, 0.0, 0.0)
    free = 4.730040744862704**2 * 0.02 / np.sqrt(12) * np.sqrt(2.1e11 / 7800.0)
    assert body.frequencies[3] == pytest.approx(free, rel=3e-3)


@pytest.mark.parametrize("mesh", ["MeshTri", "MeshTet", "MeshHex"])
def test_other_meshes(mesh):
    """The axial frequency of a clamped bar with nu = 0 is exact: (pi/2) sqrt(E/rho)/L."""
    made = getattr(skfem, mesh)().refined(1)
    place = (1.0, 0.5) if made.dim() == 2 else (1.0, 0.5, 0.5)
    body = fm.ModalBody.from_mesh(
        "bar", made, young=1.0, poisson=1e-9, density=1.0, n_modes=8, points={"end": place},
        fixed=lambda x: np.isclose(x[0], 0.0),
    )  # fmt: skip
    assert np.abs(np.array(body.frequencies) - np.pi / 2).min() < 2e-3


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"young": -1.0}, "young must be a number > 0"),
        ({"poisson": 0.5}, "poisson must be"),
        ({"plane": "stretch"}, "plane must be"),
        ({"points": {"p": (5.0, 5.0)}}, "outside the mesh"),
        ({"points": {"p": (5.0,)}}, "2 coordinates"),
        ({"fixed": "left"}, "boundary of the mesh"),
        ({"fixed": lambda x: x[0] > 9}, "no part of the boundary"),
    ],
)
def test_bad_meshes_are_refused(changes, words):
    given = {**STEEL, "points": {"p": (0.5, 0.01)}, "n_modes": 2} | changes
    with pytest.raises(fm.SceneError, match=words):
        fm.ModalBody.from_mesh("b", beam(nx=4), **given)
    with pytest.raises(fm.SceneError, match="mesh must be one of"):
        fm.ModalBody.from_mesh("b", "a mesh", **{**given, "young": 1.0, "poisson": 0.3, "plane": "stress"})
