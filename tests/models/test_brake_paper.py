"""What the source of the brake says about its figures, in numbers."""

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.figure import Figure

import fricmb as fm
from fricmb.models.brake_paper import FIGURES, T_END, run, shift_of, slope, spikes, valleys

#: Statements of the source that the runs here do not show, by figure and place; each page says why.
DIFFERENT = {2: {2}, 4: {5}, 12: {1, 2}}


@pytest.mark.slow
@pytest.mark.parametrize("number", FIGURES)
def test_statements(number):
    figure = FIGURES[number]
    findings = figure.check(run(figure.case))
    assert {i for i, finding in enumerate(findings) if not finding.agrees} == DIFFERENT.get(number, set())
    assert all(finding.found in str(finding) for finding in findings)


@pytest.mark.parametrize("number", [2, 4, 12])
def test_drawings(number):
    figure = FIGURES[number]
    drawn = figure.draw(run(figure.case))
    assert isinstance(drawn, Figure)
    assert all(ax.get_xlabel() or ax.get_ylabel() for ax in drawn.axes)
    plt.close(drawn)


def test_shift_on_the_circle():
    mean, spread = shift_of(np.array([3.98, 5.02, 6.98, 8.02]))
    assert min(mean, 1 - mean) < 1e-9
    assert spread == pytest.approx(0.02, rel=0.01)
    assert shift_of(np.array([2.25, 3.25, 7.25]))[0] == pytest.approx(0.25)


def test_slope_in_decibels():
    omega = np.arange(5.0)
    assert slope(omega, 10 ** (-0.3 * omega)) == pytest.approx(-3.0)


def test_spectrum_integrates_to_the_variance():
    found = spikes(run("4"))
    total = np.trapezoid(found.power, found.omega)
    assert total == pytest.approx(run("4").at(np.linspace(0, T_END, 14001))["pad.y"].var(), rel=0.05)


def test_impulse_of_a_valley_is_the_momentum_across():
    """What friction brings across is what the pad gains, less what its spring takes."""
    sol = run("2")
    kicks = valleys(sol)
    assert len(kicks.begin) == 111
    assert kicks.begin[0] == pytest.approx(8.0239, abs=2e-3)
    # valleys are placed on a grid of 2 pi over 6000
    assert np.diff(kicks.begin)[1:80] == pytest.approx(2 * np.pi, abs=2.1 * 2 * np.pi / 6000)
    k = 3
    t = np.linspace(kicks.begin[k] - 1, kicks.begin[k] + 1, 20001)
    seen = sol.at(t)
    gained = seen.velocity("pad.y")[-1] - seen.velocity("pad.y")[0]
    spring = -((10 * np.sqrt(np.pi / 2)) ** 2) * np.trapezoid(seen["pad.y"], t)
    away = np.linspace(0, np.pi - 1, 2001)
    background = sol.at(np.concatenate([t[0] - away, t[-1] + away])).force("lining")[1].mean()
    assert kicks.impulse[k] == pytest.approx(gained - spring - 2 * background, rel=2e-2)


def test_valleys_before_the_first_stick():
    sol = fm.simulate(fm.models.brake4dof("2", mu_k_N=5.0, mass_ratio=100.0), t_end=140.0, rtol=1e-8)
    kicks = valleys(sol)
    first = sol.events[0].t
    assert (kicks.sticks == (kicks.end > first - 1e-2)).all()
    # the rotor loses 5 * 2 pi / 100 a swing, and so does the valley
    assert np.diff(kicks.least[~kicks.sticks]) == pytest.approx(-np.pi / 10, rel=1e-3)
