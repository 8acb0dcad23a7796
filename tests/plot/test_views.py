"""Spectra, animations, sound and views show the run's own numbers, and stand alone."""

import json
import re

import matplotlib as mpl
import numpy as np
import pytest

mpl.use("Agg")
import matplotlib.pyplot as plt
from PIL import Image
from scipy.io import wavfile

import fricmb as fm
from fricmb.cli import main
from fricmb.plot._layout import layout
from fricmb.solution._stored import Stored


@pytest.fixture(scope="module")
def belt():
    return fm.simulate(fm.models.belt_oscillator(damping=0.05), t_end=60.0, rtol=1e-7)


@pytest.fixture(autouse=True)
def _no_figures_left():
    yield
    plt.close("all")


def test_spectrum_has_its_peak_where_the_motion_repeats(belt):
    (ax,) = belt.plot.spectrum("mass.x", highest=3.0).axes
    omega, power = ax.lines[0].get_data()
    sticks = belt.events.of(kind="stick").t
    assert omega[0] >= 0
    assert omega[-1] <= 3.0
    inside = omega > 0.2
    assert omega[inside][np.argmax(power[inside])] == pytest.approx(2 * np.pi / np.diff(sticks)[-1], rel=0.05)
    assert "mass.x" in ax.get_ylabel()


def test_maps(belt):
    for figure in (belt.plot.spectrogram("mass.x", highest=5.0), belt.plot.orders("mass.x", highest=20.0)):
        ax, bar = figure.axes
        assert ax.collections
        assert "mass.x" in bar.get_ylabel()


def test_stability_pictures():
    law = fm.laws.Stribeck(mu_s=0.5, mu_k=0.3, v_s=0.2, exponent=1.0)
    scene = fm.models.belt_oscillator(damping=0.05, law=law)
    speeds = np.linspace(0.2, 1.0, 5)
    found = fm.analysis.complex_eigenvalues(scene, over="belt.velocity.x", values=speeds)
    top, bottom = fm.plot.eigenvalues(found).axes
    given = np.isin(found.fine_values, speeds)
    assert top.lines[0].get_ydata()[given] == pytest.approx(found.frequency[:, 0])
    assert bottom.lines[0].get_ydata()[given] == pytest.approx(found.growth[:, 0])
    omega = np.sqrt(1.0 - found.fine_eigenvalues[:, 0].real ** 2)  # |eigenvalue| = 1: the mass is held by its spring
    assert top.lines[0].get_ydata() == pytest.approx(omega, abs=1e-9)
    hertz = fm.plot.eigenvalues(found, hz=True).axes[0]
    assert hertz.lines[0].get_ydata() == pytest.approx(omega / (2 * np.pi), abs=1e-9)
    assert hertz.get_ylabel() == "frequency"
    assert bottom.lines[1].get_xdata()[0] == found.critical[0].value
    assert bottom.get_xlabel() == "belt.velocity.x"
    chart = fm.analysis.stability_map(
        scene, over=("belt.velocity.x", "damper.damping"), values=(speeds, [0.0, 0.05, 0.1])
    )
    ax, _ = fm.plot.stability(chart).axes
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("damper.damping", "belt.velocity.x")


def test_animation_files(belt, tmp_path):
    gif = belt.plot.animation(tmp_path / "a.gif", frames=4)
    assert Image.open(gif).n_frames == 4
    page = belt.animate(tmp_path / "a.html", t_start=10.0, t_end=20.0).read_text()
    assert data_of(page)["span"] == [10.0, 20.0]
    with pytest.raises(fm.FricmbError, match=r"\.mp4, \.gif or \.html"):
        belt.plot.animation(tmp_path / "a.avi")


def test_without_ffmpeg_mp4_says_so(belt, tmp_path, monkeypatch):
    monkeypatch.setattr("matplotlib.animation.writers.is_available", lambda name: False)
    with pytest.raises(fm.FricmbError, match="needs ffmpeg"):
        belt.plot.animation(tmp_path / "a.mp4")
    assert not list(tmp_path.iterdir())


def test_sound_has_the_pitch_of_the_signal(tmp_path):
    sol = fm.simulate(fm.models.friction_oscillator(friction=0.0, stiffness=100.0), t_end=20.0, rtol=1e-8)
    rate, samples = wavfile.read(sol.plot.sound("mass.x", tmp_path / "a.wav", speed=44.0))
    power = np.abs(np.fft.rfft(samples.astype(float)))
    pitch = np.argmax(power) * rate / len(samples)
    assert len(samples) / rate == pytest.approx(20 / 44, abs=1e-3)
    assert pitch == pytest.approx(10 * 44 / (2 * np.pi), abs=rate / len(samples))
    assert np.abs(samples).max() == pytest.approx(0.9 * 32767, abs=2)
    with pytest.raises(fm.FricmbError, match="it would last 20000 s"):
        sol.plot.sound("mass.x", tmp_path / "b.wav", speed=1e-3)


def data_of(page):
    return json.loads(re.search(r"const data = (\{.*?\}), root", page, re.DOTALL)[1])


def test_view_holds_the_run_and_asks_no_network(belt, tmp_path):
    page = belt.plot.view(tmp_path / "view.html").read_text()
    assert not re.search(r"""(src|href)\s*=\s*["']?(https?:)?//|fetch\(|import\s""", page)
    data = data_of(page)
    assert data["signals"]["mass.x"] == pytest.approx(belt.at(data["t"])["mass.x"], rel=1e-5, abs=1e-5)
    stuck = sum(b - a for a, b in data["stick"]["sole"])
    assert stuck == pytest.approx(60 * belt.time_share("sole", 0), rel=1e-6)
    assert (data["t"][0], data["t"][-1], data["span"]) == (0.0, 60.0, [0.0, 60.0])
    assert data["bounds"] is None  # a few swings: the times show them all
    names = ("mass.x", "mass.x.velocity", "sole.force.x", "sole.mode")
    assert [data["labels"][name] for name in names] == ["", "", "", "0 stick, 1 slip, 2 open"]


def test_view_of_many_swings(tmp_path):
    """The file shows a few swings first, and bounds of the whole, between which every value lies."""
    sol = fm.simulate(fm.models.friction_oscillator(friction=0.0, stiffness=100.0), t_end=200.0, rtol=1e-6)
    data = data_of(sol.plot.view(tmp_path / "view.html").read_text())
    begin, end = data["span"]
    assert end - begin == pytest.approx(6 * 2 * np.pi / 10, rel=1e-2)
    assert data["seconds"] == pytest.approx(6 * 1.3)
    low, high = (np.array(row) for row in data["bounds"]["values"]["mass.x"])
    seen = sol.at(data["bounds"]["t"])["mass.x"]
    missed = 0.5 * (0.5 * 10 * 200 / (500 * 24)) ** 2  # how far the tip of a swing rises above samples beside it
    assert (seen > low - missed).all()
    assert (seen < high + missed).all()
    inside = (np.array(data["t"]) >= begin) & (np.array(data["t"]) <= end)
    assert inside.sum() > 6 * 100


def test_notebooks_show_scene_plan_run_and_law(belt):
    scene = fm.models.belt_oscillator()
    for thing, shown in (
        (scene, "spring.stiffness"),
        (scene.plan(), "damper: damping = 0"),
        (belt, "<canvas"),
        (fm.laws.Stribeck(mu_s=0.5, mu_k=0.3, v_s=0.1), "v_s"),
    ):
        html = thing._repr_html_()
        assert shown in html
        assert html.startswith('<div class="fricmb">')
        assert html.count("<div") == html.count("</div>")
    odd = fm.Scene("<b>&", [fm.Body("a", mass=1.0)])
    assert "&lt;b&gt;&amp;" in odd._repr_html_()


def test_a_loaded_run_is_not_opened_unasked(belt, tmp_path):
    belt.save(tmp_path / "run.npz")
    loaded = fm.Solution.load(tmp_path / "run.npz")
    assert f"{len(belt.events)} events" in loaded._repr_html_()
    assert isinstance(loaded._run, Stored)
    assert "<canvas" in loaded.plot.view(tmp_path / "view.html").read_text()


def test_large_scenes_are_listed_not_drawn():
    stack = fm.models.block_stack(1500, mu_s=[0.5] * 1500)
    html = stack._repr_html_()
    assert "<img" not in html
    assert "block1500" in html
    assert layout(stack).places["block1500"][1] > 1000


def test_command(belt, tmp_path, capsys):
    belt.save(tmp_path / "solution.npz")
    for kind, name, ending in (("spectrum", "mass.x", "png"), ("sound", "mass.x", "wav"), ("view", None, "html")):
        of = [] if name is None else ["--of", name]
        assert main(["plot", str(tmp_path / "solution.npz"), kind, *of]) == 0
        assert (tmp_path / f"{kind}.{ending}").stat().st_size > 1000
    assert main(["plot", str(tmp_path / "solution.npz"), "spectrum"]) == 2
    assert main(["plot", str(tmp_path / "solution.npz"), "pie"]) == 2
    assert "--of is missing" in capsys.readouterr().err
