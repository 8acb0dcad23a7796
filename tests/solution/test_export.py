"""Signals as files of other programs, natural modes, and eigenvalues of a scene as it is."""

import csv
from itertools import pairwise

import numpy as np
import pytest
from scipy.io import loadmat

import fricmb as fm
from fricmb.analysis import AnalysisError
from fricmb.cli import main
from fricmb.errors import UnknownNameError


@pytest.fixture(scope="module")
def sol():
    return fm.simulate(fm.models.belt_oscillator(), t_end=20.0)


def test_matlab(sol, tmp_path):
    held = loadmat(sol.export(tmp_path / "run.mat"))
    assert held["mass_x"][:, 0] == pytest.approx(sol["mass.x"], abs=0)
    assert held["t"].shape == (sol.t.size, 1)
    assert [name[0] for name in held["names"][:, 0]][:2] == ["t", "mass.x"]
    events = held["events"][0, 0]
    assert events["t"][:, 0] == pytest.approx(sol.events.t, abs=0)
    assert [kind[0] for kind in events["kind"][:, 0]] == [event.kind for event in sol.events]


def test_hdf5(sol, tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(sol.export(tmp_path / "run.h5", ["mass.x.acceleration", "sole.force"])) as held:
        assert (held["mass.x.acceleration"][:] == sol["mass.x.acceleration"]).all()
        assert set(held) == {"t", "mass.x.acceleration", "sole.force", "events"}
        assert [kind.decode() for kind in held["events/kind"]] == [event.kind for event in sol.events]


def test_text_and_the_command(sol, tmp_path):
    sol.save(tmp_path / "run.npz")
    run = str(tmp_path / "run.npz")
    assert main(["export", run, str(tmp_path / "some.csv"), "--signals", "mass.x,spring.force"]) == 0
    with (tmp_path / "some.csv").open() as file:
        rows = list(csv.reader(file))
    assert rows[0] == ["t", "mass.x", "spring.force"]
    assert [float(row[1]) for row in rows[1:]] == sol["mass.x"].tolist()
    assert main(["export", run, str(tmp_path / "run.mat")]) == 0
    assert main(["export", run, str(tmp_path / "run.xyz")]) == 2
    with pytest.raises(UnknownNameError, match=r"unknown ending of a file '.matt'; did you mean '.mat'"):
        sol.export(tmp_path / "run.matt")


def test_natural_modes_of_a_chain_are_the_closed_form():
    n, k, m = 5, 3.0, 2.0
    blocks = [fm.Body(f"b{i}", mass=m) for i in range(n)]
    ends = [fm.GROUND, *blocks, fm.GROUND]
    springs = [
        fm.Spring(f"k{i}", *((b, a) if a is fm.GROUND else (a, b)), axis="x", stiffness=k)
        for i, (a, b) in enumerate(pairwise(ends))
    ]
    dampers = [fm.Damper(f"c{i}", block, axis="x", damping=0.1) for i, block in enumerate(blocks)]
    belt = fm.Driven("belt", velocity={"x": 1.0})
    sole = fm.Contact("sole", blocks[0], belt, law=fm.laws.Coulomb(mu_s=0.5), normal_force=1.0)
    modes = fm.Scene("chain", [*blocks, *springs, *dampers, belt, sole]).modes()
    closed = 2 * np.sqrt(k / m) * np.sin(np.arange(1, n + 1) * np.pi / (2 * (n + 1)))
    assert modes.frequencies == pytest.approx(closed, rel=1e-12)
    assert modes.damping_ratios == pytest.approx(0.1 / m / (2 * closed), rel=1e-12)
    assert modes.shapes.T @ (m * np.eye(n)) @ modes.shapes == pytest.approx(np.eye(n), abs=1e-12)
    assert (modes.shape("b2.x") == modes.shapes[2]).all()
    assert len(str(modes).splitlines()) == n + 1
    with pytest.raises(AnalysisError, match="the scene has joints"):
        fm.models.slider_crank().modes()


def test_eigenvalues_of_a_scene_as_it_is():
    law = fm.laws.Stribeck(mu_s=0.5, mu_k=0.3, v_s=0.2, exponent=1.0)
    scene = fm.models.belt_oscillator(damping=0.05, law=law, belt=0.4)
    found = fm.analysis.complex_eigenvalues(scene)
    over = fm.analysis.complex_eigenvalues(scene, over="belt.velocity.x", values=[0.4])
    assert (found.eigenvalues == over.eigenvalues).all()
    assert "growth rate" in str(found)
    with pytest.raises(AnalysisError, match="values need over="):
        fm.analysis.complex_eigenvalues(scene, values=[0.4])
