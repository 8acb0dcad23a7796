"""Pictures of laws: parameters and titles, loops of laws with memory, labels that stay apart."""

import matplotlib as mpl
import numpy as np
import pytest

mpl.use("Agg")
import itertools

import matplotlib.pyplot as plt

import fricmb as fm
from fricmb.plot._law import loop_length


@pytest.fixture(autouse=True)
def _no_figures_left():
    yield
    plt.close("all")


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_parameters_and_titles(theme):
    with fm.plot.theme(theme):
        figure = fm.plot.law_figure(fm.laws.Dahl(mu=0.3, sigma0=2e4))
    assert "mu = 0.3" in figure.get_suptitle()
    assert [ax.get_title(loc="left") for ax in figure.axes] == [
        "steady slip",
        "hysteresis in harmonic cycles",
        "break-away",
        "lag behind a swinging speed",
    ]
    low, high = figure.axes[3].get_ylim()
    assert (low, high) == pytest.approx((0.27, 0.33), rel=1e-3)  # a constant, not its round-off


def test_loops_of_a_law_with_memory():
    """Dahl: dF/dx = sigma0 (1 - F/mu) on the way up, so pulled from rest F = mu (1 - exp(-sigma0 x/mu))."""
    law = fm.laws.Dahl(mu=0.3, sigma0=2e4)
    assert loop_length(law) == pytest.approx(0.3 / 2e4, rel=0.05)
    (ax,) = fm.plot.law(law).axes
    assert len(ax.lines) == 3
    x, force = ax.lines[2].get_data()
    assert np.abs(x).max() == pytest.approx(8.0, rel=1e-3)
    assert np.abs(force).max() == pytest.approx(0.3, rel=2e-3)
    area = np.abs(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(x)))
    assert area > 0.5 * 4 * 8 * 0.3  # a loop, not a line


def test_a_law_without_memory_shows_its_coefficient():
    (ax,) = fm.plot.law(fm.laws.Stribeck(mu_s=0.5, mu_k=0.3, v_s=0.1)).axes
    r, mu = ax.lines[0].get_data()
    assert mu == pytest.approx(0.3 + 0.2 * np.exp(-((r / 0.1) ** 2)))


def test_labels_of_a_narrow_axis_stay_apart():
    figure = fm.plot.law_figure(fm.laws.Karnopp.example())
    figure.draw_without_rendering()
    ax = figure.axes[0]
    boxes = [label.get_window_extent() for label in ax.get_xticklabels(which="both") if label.get_text()]
    shown = sorted((b for b in boxes if ax.bbox.x0 <= b.x0 + b.width / 2 <= ax.bbox.x1), key=lambda b: b.x0)
    assert len(shown) >= 2
    assert all(a.x1 < b.x0 for a, b in itertools.pairwise(shown))
