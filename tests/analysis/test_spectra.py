"""Welch, spectrograms, peaks, order maps and uniform sampling against signals whose spectra are known."""

import warnings
from functools import partial

import numpy as np
import pytest

import fricmb as fm
from fricmb.analysis import (
    AliasingWarning,
    maximum_entropy_spectrum,
    order_map,
    sliding_speed,
    spectral_peaks,
    spectrogram,
    uniform,
    welch_spectrum,
)

from .test_spectrum import ar_process, true_density


def test_welch_of_a_known_process():
    dt = 0.25
    omega, power = welch_spectrum(ar_process(400_000), dt, segment=1024)
    inside = slice(20, -20)  # the ends hold half the degrees of freedom, the first none of the mean
    ratio = power[inside] / true_density(omega[inside], dt)
    assert np.abs(ratio.mean() - 1) < 0.01
    assert ratio.std() == pytest.approx(np.sqrt(1.056 * 1024 / 800_000), rel=0.15)  # Hann, half overlap


def test_spectrogram_follows_a_chirp():
    dt = 0.01
    t = dt * np.arange(20_000)
    x = np.sin(0.5 * 0.2 * t**2 + 10 * t)  # omega = 10 + 0.2 t
    running = spectrogram(x, dt, t_start=5.0, segment=1000)
    ridge = running.omega[np.argmax(running.power, axis=0)]
    assert ridge == pytest.approx(10 + 0.2 * (running.t - 5.0), abs=2 * np.pi / (1000 * dt))
    assert np.trapezoid(running.power, running.omega, axis=0) == pytest.approx(0.5, rel=0.02)


def test_what_is_tied_to_the_surface_stays_at_one_order():
    dt = 0.01
    t = dt * np.arange(20_000)
    speed = 10 - 0.04 * t
    x = np.sin(2.5 * np.cumsum(speed) * dt)
    running = spectrogram(x, dt, segment=1000)
    found = order_map(running, 10 - 0.04 * running.t, np.linspace(0, 50, 2001))
    half_a_bin = np.pi / (1000 * dt) / found.speed
    assert (np.abs(found.order[np.argmax(found.power, axis=0)] - 2.5) < half_a_bin + 0.025).all()
    inside = found.power.filled(0.0)
    assert np.trapezoid(inside, found.order, axis=0) == pytest.approx(0.5, rel=0.02)
    assert found.power.mask[-1, 0]
    assert not found.power.mask[-1, -1]  # 50 times 2 lies below pi/dt, 50 times 10 does not


@pytest.mark.parametrize(
    "estimate", [partial(maximum_entropy_spectrum, order=100), partial(welch_spectrum, segment=1000)]
)
def test_peaks_hold_the_truth_within_their_uncertainty(estimate):
    dt, inside, count = 0.05, 0, 30
    t = dt * np.arange(6000)
    for seed in range(count):
        rng = np.random.default_rng(seed)
        x = np.sin(3 * t + seed) + 0.5 * np.sin(8.2 * t) + 0.5 * rng.standard_normal(t.size)
        peaks = spectral_peaks(x, dt, estimate=estimate, prominence=15, between=(1, 12))
        k = [peaks.near(3.0), peaks.near(8.2)]
        assert peaks.omega[k] == pytest.approx([3.0, 8.2], abs=2 * peaks.resolution)
        inside += int((np.abs(peaks.omega[k] - [3.0, 8.2]) < 3 * peaks.uncertainty[k]).sum())
        assert (peaks.uncertainty[k] < peaks.resolution).all()
        assert (peaks.uncertainty[k] > 0).all()
    assert inside >= 0.9 * 2 * count


def test_powers_of_peaks_are_those_of_the_sines():
    dt = 0.05
    t = dt * np.arange(6000)
    x = 2 * np.sin(3 * t) + 0.5 * np.sin(8.2 * t) + 0.01 * np.random.default_rng(2).standard_normal(t.size)
    peaks = spectral_peaks(x, dt, estimate=partial(welch_spectrum, segment=1500))
    assert peaks.power[[peaks.near(3.0), peaks.near(8.2)]] == pytest.approx([2.0, 0.125], rel=0.02)
    assert "omega" in str(peaks)
    assert len(str(peaks).splitlines()) == len(peaks) + 1


@pytest.fixture(scope="module")
def belt():
    return fm.simulate(fm.models.belt_oscillator(damping=0.05), t_end=200.0, rtol=1e-8)


def test_interval_is_chosen_so_that_nothing_folds(belt):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = uniform(belt, "mass.x")
    assert found.folded < 1e-5
    assert found.x == pytest.approx(belt.at(found.t)["mass.x"], abs=1e-14)
    assert np.diff(found.t) == pytest.approx(found.dt)


def test_too_few_samples_warn(belt):
    with pytest.warns(AliasingWarning, match=r"mass\.x\.velocity: .* % of its power lies above pi/dt"):
        found = uniform(belt, "mass.x.velocity", 7.0)
    assert found.folded > 1e-3


def test_short_phases_warn():
    sol = fm.simulate(fm.models.brake4dof("2"), t_end=700.0, rtol=1e-6)
    with pytest.warns(AliasingWarning, match="phases between transitions are shorter|power lies above"):
        found = uniform(sol, "lining.force.x", 0.5)
    assert found.short == pytest.approx(np.mean(np.diff(sol.events.t) < 1.0))


def test_any_column_is_a_signal(belt):
    t = np.linspace(0, 200, 400)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", AliasingWarning)  # a force and a mode jump
        for name in ("mass.x", "mass.x.velocity", "belt.x", "sole.force.x", "sole.mode"):
            assert uniform(belt, name, 0.125).x.shape == (1601,)
    with pytest.raises(fm.FricmbError, match=r"mass\.x"):
        uniform(belt, "mas.x")
    assert sliding_speed(belt, "sole", t) == pytest.approx(np.abs(belt.at(t).velocity("mass.x") - 0.1), abs=1e-12)


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (lambda: welch_spectrum(np.ones(50), 0.1, segment=60), "segment must lie between 2 and 50; got 60"),
        (lambda: spectrogram(np.ones(50), 0.1, overlap=1.0), "overlap must lie between 0 and 0.95; got 1.0"),
        (lambda: welch_spectrum(np.ones(50), 0.1, window="hand"), "window"),
        (lambda: spectral_peaks(np.ones(50), 0.1, parts=1), "parts must lie between 2 and 50; got 1"),
        (lambda: spectral_peaks(np.ones(50), 0.1, between=(3, 1)), "between"),
        (lambda: order_map(spectrogram(np.ones(64), 0.1), np.ones(3), [1.0]), "speed must be"),
    ],
)
def test_bad_input_names_the_argument(call, named):
    with pytest.raises(fm.FricmbError) as caught:
        call()
    assert named in str(caught.value)


def test_peaks_say_in_print_why_there_is_no_spread_and_that_there_are_none():
    """A burst in the last eighth of a record: no more than one of its overlapping quarters holds it."""
    t = np.arange(8000) * 0.05
    x = np.random.default_rng(3).normal(size=t.size) + np.where(t > 350.0, 40.0 * np.sin(5.0 * t), 0.0)
    peaks = spectral_peaks(x, 0.05, estimate=partial(welch_spectrum, segment=800), prominence=25.0)
    assert abs(peaks.omega[peaks.near(5.0)] - 5.0) < 0.1
    assert np.isinf(peaks.uncertainty[peaks.near(5.0)])
    assert "found again in fewer than two parts of the record" in str(peaks)
    none = spectral_peaks(np.random.default_rng(3).normal(size=4000), 0.1, prominence=60.0)
    assert len(none) == 0
    assert str(none).startswith("no peaks")
