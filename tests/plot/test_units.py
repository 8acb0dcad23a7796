"""Units go with a scene into its solutions, files and pictures; they are names and change no number."""

import json
import pickle

import matplotlib as mpl
import numpy as np
import pytest

mpl.use("Agg")
import matplotlib.pyplot as plt

import fricmb as fm
from fricmb.cli import main
from fricmb.models import catalogue
from fricmb.solution import _files

SI = fm.Units("s", "m", "N")


@pytest.fixture(scope="module")
def scene():
    mass = fm.Body("mass", mass=1.0, velocity={"x": 1.0})
    parts = [
        mass,
        fm.Spring("spring", mass, axis="x", stiffness=4.0),
        fm.Contact("sole", mass, law=fm.laws.Coulomb(mu_s=0.1), normal_force=1.0),
    ]
    return fm.Scene("one mass", parts, units=SI)


@pytest.fixture(autouse=True)
def _no_figures_left():
    yield
    plt.close("all")


def test_names_of_units():
    assert (SI.velocity, SI.angular_velocity, SI.frequency, SI.energy) == ("m/s", "rad/s", "Hz", "N m")
    assert fm.Units("ms", "mm", "N").frequency == "kHz"
    assert fm.Units("1", "1", "1").frequency == fm.Units("1", "1", "1").energy == "1"
    assert fm.Units().velocity == "length/time"
    with pytest.raises(fm.SceneError, match="time must be a non-empty string, got 1"):
        fm.Units(1, "m", "N")
    with pytest.raises(fm.SceneError, match="units must be a Units"):
        fm.Scene("empty", [fm.Body("a", mass=1.0)], units="SI")


def test_a_scene_keeps_its_units(scene):
    assert scene.with_parameters({"mass.mass": 2.0}).units == SI
    assert scene.replace("spring", stiffness=1.0).units == SI
    assert pickle.loads(pickle.dumps(scene)).units == SI
    other = scene.with_units(fm.Units("ms", "mm", "kN"))
    assert (other.units.length, other.parts, other == scene) == ("mm", scene.parts, False)


def test_a_file_keeps_them(scene, tmp_path):
    sol = fm.simulate(scene, t_end=2.0, rtol=1e-6)
    assert sol.units == sol.at([0.0, 1.0]).units == SI
    sol.save(tmp_path / "solution.npz")
    loaded = fm.Solution.load(tmp_path / "solution.npz")
    assert loaded.units == SI
    assert not hasattr(loaded._run, "pieces")  # read without opening the run
    assert loaded.scene.units == SI
    assert loaded.plot.velocities().axes[0].get_ylabel() == "velocity [m/s]"


def test_a_file_from_before_there_were_units(scene, tmp_path, monkeypatch):
    """Neither the scene nor the words of an older file name units."""
    sol = fm.simulate(scene, t_end=0.5, rtol=1e-6)
    words = _files._words(sol)
    del words["units"]
    monkeypatch.setattr(_files, "_words", lambda sol: words)
    monkeypatch.setattr(fm.Scene, "_stored", ("name", "parts"))
    sol.save(tmp_path / "old.npz")
    monkeypatch.undo()
    with np.load(tmp_path / "old.npz") as data:
        assert "units" not in json.loads(str(data["about"]))
    loaded = fm.Solution.load(tmp_path / "old.npz")
    assert loaded.units == loaded.scene.units == fm.Units()
    assert loaded.scene.parts == scene.parts


def test_models_name_the_units_that_the_catalogue_says():
    wrong = {name for name, model in catalogue.items() if name != "pad_rotor" and model.build().units != model.units}
    assert not wrong


def test_command_draws_the_units_of_the_run(tmp_path, capsys, monkeypatch):
    """`fricmb plot` on what `fricmb run` wrote: the same labels."""
    file = tmp_path / "model.py"
    file.write_text(
        "import fricmb as fm\n"
        "m = fm.Body('m', mass=1.0, velocity={'x': 1.0})\n"
        "scene = fm.Scene('m', [m, fm.Spring('k', m, axis='x', stiffness=1.0)])\n"
        "t_end = 2.0\nunits = fm.Units('s', 'm', 'N')\n"
    )
    assert main(["run", str(file), "--format", "svg", "--out", str(tmp_path / "out")]) == 0
    pictures = {path.name for path in (tmp_path / "out").glob("*.*") if path.suffix in (".svg", ".png")}
    assert pictures == {"velocities.svg", "phase.svg", "energy.svg"}
    seen = []
    monkeypatch.setattr(mpl.figure.Figure, "savefig", lambda self, *a, **k: seen.append(self.axes[0].get_ylabel()))
    assert main(["plot", str(tmp_path / "out" / "solution.npz"), "velocities"]) == 0
    assert seen == ["velocity [m/s]"]


def test_command_writes_lines_and_hertz_on_dark_pages(scene, tmp_path, capsys):
    sol = fm.simulate(scene, t_end=20.0, rtol=1e-6)
    sol.save(tmp_path / "run.npz")
    out = tmp_path / "spectrum.svg"
    command = ["plot", str(tmp_path / "run.npz"), "spectrum", "--of", "mass.x", "--hz", "--theme", "dark"]
    assert main([*command, "--out", str(out), "--t-end", "10"]) == 0
    text = out.read_text()
    assert "#14181e" in text  # the page
    assert main(["plot", str(tmp_path / "run.npz"), "energy", "--hz"]) == 2
    assert "--hz: only spectrum, spectrogram, orders have frequencies" in capsys.readouterr().err
    path = ["path", "--of", "mass.x,mass.x", "--out", str(tmp_path / "p.pdf")]
    assert main(["plot", str(tmp_path / "run.npz"), *path]) == 0
    assert (tmp_path / "p.pdf").read_bytes()[:4] == b"%PDF"
