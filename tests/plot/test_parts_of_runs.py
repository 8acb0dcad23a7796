"""Parts of a run, enlarged stretches, paths, frequencies in Hz, themes: what stands in the axes and in the files."""

from types import SimpleNamespace

import matplotlib as mpl
import numpy as np
import pytest

mpl.use("Agg")
import matplotlib.pyplot as plt

import fricmb as fm
from fricmb.plot import _fine
from fricmb.plot._contact import draw_phases, phases
from fricmb.plot._fine import period_of, reversals, window_of
from fricmb.plot._style import _SHEETS


@pytest.fixture(scope="module")
def swing():
    """A mass on a spring of angular frequency 4, started with velocity 1, hardly damped."""
    mass = fm.Body("mass", mass=1.0, axes="xy", velocity={"x": 1.0}, position={"y": 0.25})
    parts = [mass, fm.Damper("damper", mass, axis="x", damping=1e-4)]
    parts += [fm.Spring(f"spring_{c}", mass, axis=c, stiffness=16.0) for c in "xy"]
    return fm.simulate(fm.Scene("swing", parts, units=fm.Units("s", "m", "N")), t_end=300.0, rtol=1e-7)


@pytest.fixture(scope="module")
def belt():
    return fm.simulate(fm.models.belt_oscillator(), t_end=60.0, rtol=1e-7)


@pytest.fixture(autouse=True)
def _no_figures_left():
    yield
    plt.close("all")


def test_reversals_of_a_sine():
    t = np.linspace(0.0, 10.0, 4001)
    x = np.sin(2 * np.pi * t) + 0.005 * np.sin(2 * np.pi * 50 * t)
    assert reversals(x, 0.03 * np.ptp(x)) == 20


def test_period_and_window(swing):
    def signals(seen):
        return [seen.velocity("mass.x")]

    assert period_of(swing, signals, 0.0, 300.0) == pytest.approx(np.pi / 2, rel=5e-3)
    begin, end = window_of(swing, signals, 0.0, 300.0, swings=5)
    assert end == 300.0
    assert end - begin == pytest.approx(5 * np.pi / 2, rel=5e-3)
    assert window_of(swing, signals, 0.0, 5.0, swings=5) is None


def test_many_swings_are_enlarged(swing):
    figure = swing.plot.velocities(["mass.x"])
    whole, close = figure.axes
    assert whole.lines[0].get_xdata()[[0, -1]].tolist() == [0.0, 300.0]
    t, v = close.lines[0].get_data()
    assert t[-1] - t[0] == pytest.approx(8 * np.pi / 2, rel=5e-3)
    assert v == pytest.approx(np.exp(-0.5e-4 * t) * np.cos(4 * t), abs=1e-4)
    assert len(swing.plot.velocities(["mass.x"], zoom=False).axes) == 1
    assert swing.plot.velocities(zoom=(1.0, 2.0)).axes[1].get_xlim() == (1.0, 2.0)
    assert len(swing.plot.velocities(t_end=20.0).axes) == 2  # x and y, nothing to enlarge


@pytest.mark.parametrize("name", ["velocities", "transitions", "energy"])
def test_a_part_of_the_run(belt, name):
    axes = getattr(belt.plot, name)(t_start=20.0, t_end=40.0).axes
    low, high = axes[-1].get_xlim()
    assert low == pytest.approx(20.0, abs=0.6)
    assert high == pytest.approx(40.0, abs=0.6)
    with pytest.raises(fm.FricmbError, match="got 40, 20; they must rise and lie in 0 to 60"):
        getattr(belt.plot, name)(t_start=40.0, t_end=20.0)


def test_part_of_a_phase_plane_and_of_a_force(belt):
    x = belt.plot.phase("mass.x", t_start=20.0, t_end=30.0).axes[0].lines[0].get_xdata()
    seen = belt.at(np.linspace(20.0, 30.0, 2001))["mass.x"]
    assert (x.min(), x.max()) == pytest.approx((seen.min(), seen.max()), abs=1e-5)
    t = belt.plot.force("sole", t_start=20.0, t_end=30.0).axes[0].lines[0].get_xdata()
    assert (t[0], t[-1]) == (20.0, 30.0)


def test_path(swing):
    (ax,) = swing.plot.path("mass", t_end=1.5).axes
    x, y = ax.lines[0].get_data()
    assert (4 * x) ** 2 + (4 * y) ** 2 == pytest.approx(1.0, abs=1e-3)  # x = sin(4 t)/4, y = cos(4 t)/4
    assert (ax.get_xlabel(), ax.get_ylabel(), ax.get_aspect()) == ("mass.x [m]", "mass.y [m]", 1.0)
    assert swing.plot.path("mass.y", "mass.x", t_end=1.5).axes[0].get_xlabel() == "mass.y [m]"
    with pytest.raises(fm.FricmbError, match=r"mass\.x"):
        swing.plot.path("mas")


def test_contacts_stand_beside_modes():
    scene = fm.models.pad_rotor()
    sol = fm.simulate(scene, t_end=1e-3, rtol=1e-5)
    axes = sol.plot.velocities().axes
    labels = [ax.get_ylabel() for ax in axes]
    assert labels[:2] == ["modal velocity of pad [m/s]", "modal velocity of rotor [m/s]"]
    assert labels[2:] == ["relative velocity [m/s]"] * 2
    assert (axes[2].lines[0].get_ydata()[0]) == pytest.approx(sol.relative_velocity("c1")[0, 0])


def test_frequencies_in_hertz(swing):
    (plain,) = swing.plot.spectrum("mass.x", highest=10.0).axes
    (hertz,) = swing.plot.spectrum("mass.x", highest=10.0 / (2 * np.pi), hz=True).axes
    omega, density = plain.lines[0].get_data()
    frequency, other = hertz.lines[0].get_data()
    assert frequency == pytest.approx(omega / (2 * np.pi))
    assert np.trapezoid(other, frequency) == pytest.approx(np.trapezoid(density, omega))
    assert frequency[np.argmax(other)] == pytest.approx(4 / (2 * np.pi), rel=1e-2)
    assert (plain.get_xlabel(), hertz.get_xlabel()) == ("angular frequency [rad/s]", "frequency [Hz]")


def test_one_phase_of_round_off_does_not_span_the_axis():
    times = np.array([0.0, 1.0, 1.0 + 1e-15, 2.0, 3.5, 4.0])
    modes = np.array([1, 0, 1, 0, 1], dtype=np.int8)
    sol = SimpleNamespace(
        contact_names=("c",),
        dof_names=(),
        t_start=0.0,
        t_end=4.0,
        events=[SimpleNamespace(t=t, contact="c") for t in times[1:-1]],
        at=lambda t: SimpleNamespace(mode=lambda name: modes),
    )
    _, ax = plt.subplots()
    draw_phases(sol, ax, fm.Units(), (0.0, 4.0))
    assert ax.get_ylim()[0] > 1e-5
    assert ax.get_title(loc="left").startswith("1 shorter than 5e-04, down to 1e-15")
    stick = next(line for line in ax.lines if line.get_label() == "stick")
    assert stick.get_ydata().tolist() == [1.5]


def test_residual_says_what_the_summary_says(belt):
    remark = belt.plot.energy().axes[1].get_title(loc="right")
    told = belt.summary().partition("ledger residual ")[2].partition("\n")[0]
    assert remark.startswith(f"largest {told} at the solution's times")


def test_joints_of_a_locked_linkage_stick_together():
    """Two pins would lock it; all four stick, as a group with shares that are not determined, and none moves."""
    scene = fm.models.four_bar(friction=fm.laws.Coulomb(mu_s=0.3), pin=0.02)
    sol = fm.simulate(scene, t_end=3.0, rtol=1e-6)
    last = sol.events.of(kind="stick").t[-1]
    assert len(sol.contact_names) == 4
    for name in sol.contact_names:
        assert (sol.mode(name)[sol.t > last] == 0).all()
        assert np.abs(sol.at(np.linspace(last + 0.1, 3.0, 50)).relative_velocity(name)).max() < 1e-12
    assert "stick together" in sol.stats.notes[0]


@pytest.mark.parametrize("name", ["light", "dark"])
def test_themes(belt, name, tmp_path):
    with fm.plot.theme(name):
        figure = belt.plot.velocities()
    sheet = _SHEETS[name]
    face = figure.get_facecolor()
    assert mpl.colors.to_hex(face) == mpl.colors.to_hex(sheet["figure.facecolor"])
    (ax,) = figure.axes
    assert mpl.colors.to_hex(ax.xaxis.label.get_color()) == mpl.colors.to_hex(sheet["axes.labelcolor"])
    for kind in ("svg", "pdf", "png"):
        figure.savefig(tmp_path / f"a.{kind}")
        assert (tmp_path / f"a.{kind}").stat().st_size > 5000
    ticks = [label.get_color() for label in ax.get_xticklabels()]
    assert {mpl.colors.to_hex(c) for c in ticks} == {mpl.colors.to_hex(sheet["xtick.labelcolor"])}


def test_theme_follows_the_page(belt):
    with plt.style.context("dark_background"):
        _, ax = plt.subplots()
        belt.plot.velocities(ax=ax)
        assert ax.lines[0].get_color() == "#6DB3E6"
    fm.plot.use("dark")
    try:
        assert mpl.colors.to_hex(belt.plot.energy().get_facecolor()) == "#14181e"
    finally:
        fm.plot.use(None)
    assert mpl.colors.to_hex(belt.plot.energy().get_facecolor()) == "#ffffff"
    with plt.style.context("fricmb.plot.dark"):  # matplotlib finds the sheets by name
        assert plt.rcParams["lines.linewidth"] == 0.9
    with pytest.raises(fm.FricmbError, match="light"):
        fm.plot.use("night")


@pytest.mark.parametrize("numbers", [50_000_000, 1000])
def test_phases_of_all_contacts_are_looked_up_together(numbers, monkeypatch):
    """A run by Taylor steps is gone through again for each look: once, not once a contact."""
    sol, looked = fm.simulate(fm.models.stick_slip_chain(n=5), t_end=60.0), []
    at = type(sol).at
    monkeypatch.setattr(type(sol), "at", lambda sol, t: looked.append(len(t)) or at(sol, t))
    monkeypatch.setattr(_fine, "_NUMBERS", numbers)
    found = phases(sol)
    whole, most = sum(looked), max(1, numbers // (2 * 5 + 6 * 5))
    assert len(looked) == -(-whole // most)
    assert len(found) == 5
    for name, (bounds, mode) in zip(sol.contact_names, found, strict=True):
        assert bounds[1:-1].tolist() == [event.t for event in sol.events if event.contact == name]
        assert np.array_equal(mode, at(sol, 0.5 * (bounds[:-1] + bounds[1:])).mode(name))


def test_phases_without_contacts():
    assert phases(fm.simulate(fm.models.car_axis(), t_end=0.1)) == []


def test_panels_share_what_they_look_at(monkeypatch):
    """Whether the swings of a panel are too many to be told apart is asked of each: the run is seen once for all."""
    sol, looked = fm.simulate(fm.models.turntable(), t_end=3.0), []
    at = type(sol).at
    monkeypatch.setattr(type(sol), "at", lambda sol, t: looked.append(tuple(t)) or at(sol, t))
    plt.close(sol.plot.velocities())
    assert len(looked) == len(set(looked))
