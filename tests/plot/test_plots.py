"""Pictures show the solution's own numbers, with names and units."""

import matplotlib as mpl
import numpy as np
import pytest

mpl.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.figure import Figure

import fricmb as fm
from fricmb.plot import SolutionPlots, Units


@pytest.fixture(scope="module")
def belt():
    return fm.simulate(fm.models.belt_oscillator(), t_end=60.0, rtol=1e-7)


@pytest.fixture(scope="module")
def puck():
    return fm.simulate(fm.models.puck_on_belt(), t_end=1.0, rtol=1e-7)


@pytest.fixture(autouse=True)
def _no_figures_left():
    yield
    plt.close("all")


def curve(ax, label=None):
    return next(line for line in ax.lines if label in (None, line.get_label())).get_data()


@pytest.mark.parametrize("name", ["velocities", "transitions", "energy"])
def test_each_is_a_figure_or_draws_where_it_is_told(belt, name):
    assert isinstance(getattr(belt.plot, name)(), Figure)
    _, ax = plt.subplots()
    before = len(plt.get_fignums())
    assert getattr(belt.plot, name)(ax=ax) is ax.figure
    assert len(plt.get_fignums()) == before
    assert ax.lines or ax.collections
    assert ax.get_xlabel() == "time"


def test_velocities_are_the_solutions(belt):
    (ax,) = belt.plot.velocities().axes
    t, v = curve(ax, "mass.x")
    assert v == pytest.approx(belt(t)[1], abs=1e-12)
    assert np.diff(t).max() < 60 / 2000
    assert ax.get_ylabel() == "velocity"


def test_a_panel_for_each_direction(puck):
    assert len(puck.plot.velocities().axes) == 2
    assert len(puck.plot.velocities(["puck.y"]).axes) == 1


def test_phase_planes(belt, puck):
    (ax,) = belt.plot.phase("mass.x").axes
    fine = belt.plot.curves
    assert (curve(ax)[0] == fine["mass.x"]).all()
    assert (curve(ax)[1] == fine.velocity("mass.x")).all()
    (ax,) = belt.plot.phase("sole").axes
    assert (curve(ax)[1] == fine.force("sole")[0]).all()
    (ax,) = puck.plot.phase("sole").axes
    assert (np.array(curve(ax)) == puck.plot.curves.relative_velocity("sole")).all()
    with pytest.raises(fm.FricmbError, match=r"mass\.x"):
        belt.plot.phase("mas.x")


def test_cone_has_the_radius_of_break_away(puck):
    history, plane, close = puck.plot.force("sole").axes
    for ax in (plane, close):
        assert np.hypot(*curve(ax, "cone")) == pytest.approx(0.25 * 0.16 * 9.81)
    assert curve(history, "break-away force")[1] == pytest.approx(0.25 * 0.16 * 9.81)


def test_cone_in_one_dimension_bounds_the_force(belt):
    (ax,) = belt.plot.force("sole").axes
    limit = curve(ax, "break-away force")[1]
    assert (np.abs(curve(ax, "friction force")[1]) <= limit * (1 + 1e-6)).all()


def test_transitions_fill_the_share_that_sticks(belt):
    modes, phases = belt.plot.transitions().axes
    (stick, _) = modes.collections
    filled = sum(path.get_extents().width for path in stick.get_paths())
    bounds = np.array([0.0, *belt.events.t, 60.0])
    assert filled == pytest.approx(np.diff(bounds)[::2].sum())
    t, length = curve(phases, "slip")
    assert t == pytest.approx(belt.events.of(kind="slip").t)
    assert length[0] == pytest.approx(3.536383773, rel=1e-5)


def test_curves_jump_at_transitions(belt):
    """Both sides of a transition are drawn: the force drops from break-away to slip at one time."""
    fine = belt.plot.curves
    t = belt.events.of(kind="slip").t[0]
    at = np.searchsorted(fine.t, t)
    assert fine.t[at] == t
    assert fine.t[at - 1] == pytest.approx(t, abs=1e-12)
    assert fine.force("sole")[0, at - 1 : at + 1] == pytest.approx([1.5, 1.0], abs=1e-5)


def test_units_stand_on_the_axes(puck):
    plots = SolutionPlots(puck, Units(time="s", length="m", force="N"))
    assert plots.velocities().axes[0].get_ylabel() == "velocity [m/s]"
    assert plots.energy().axes[0].get_ylabel() == "energy [N m]"
    plain = SolutionPlots(puck, Units(time="1", length="1", force="1"))
    assert plain.velocities().axes[0].get_ylabel() == "velocity"


def test_angles_have_units_of_their_own():
    sol = fm.simulate(fm.models.dry_pendulum(), t_end=0.5, rtol=1e-4)
    plots = fm.plot.SolutionPlots(sol, fm.plot.Units(time="s", length="m", force="N"))
    labels = [ax.get_ylabel() for ax in plots.velocities(["arm.x", "arm.angle"]).axes]
    assert labels == ["velocity [m/s]", "angular velocity [rad/s]"]
    (ax,) = plots.phase("arm.angle").axes
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("arm.angle [rad]", "velocity of arm.angle [rad/s]")


def test_one_name_is_a_name_not_its_letters(belt):
    (panel,) = belt.plot.velocities("mass.x").axes
    assert len(panel.lines) >= 1
    with pytest.raises(fm.FricmbError, match="'mas'"):
        belt.plot.velocities("mas")
