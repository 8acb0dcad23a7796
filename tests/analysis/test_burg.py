"""Burg's recursion against its definition and another library's, its order, and signals without noise."""

import numpy as np
import pytest

from fricmb.analysis import maximum_entropy_spectrum
from fricmb.analysis._burg import CRITERIA, burg
from fricmb.analysis._spectrum import autoregression
from fricmb.errors import FricmbError

from .test_spectrum import COEFFICIENTS, ar_process


def by_definition(x, order):
    """Burg's model without his recursion of the errors: each filter is run over the whole signal.

    The energy of both prediction errors is a parabola in the reflection coefficient, so three filters give the least.
    """
    a, variance = np.ones(1), x @ x / len(x)
    for _ in range(order):
        a = np.append(a, 0.0)
        filters = [a + k * a[::-1] for k in (-1.0, 0.0, 1.0)]
        errors = [np.concatenate([np.convolve(x, b, "valid"), np.convolve(x, b[::-1], "valid")]) for b in filters]
        slope, curvature = errors[1] @ (errors[2] - errors[0]), np.sum((errors[2] - errors[0]) ** 2) / 2
        k = -slope / curvature
        a = a + k * a[::-1]
        variance *= 1.0 - k**2
    return a, variance


@pytest.mark.parametrize("order", [4, 60])
def test_agrees_with_its_definition(order):
    x = ar_process(3000)
    coefficients, variance = by_definition(x, order)
    model = burg(x, order)
    assert model.a == pytest.approx(coefficients, abs=1e-12)
    assert model.variance == pytest.approx(variance, rel=1e-12)


@pytest.mark.parametrize("order", [4, 60])
def test_agrees_with_another_library(order):
    spectrum = pytest.importorskip("spectrum")
    x = ar_process(3000)
    coefficients, variance, _ = spectrum.arburg(x, order)
    model = burg(x, order)
    assert model.a[1:] == pytest.approx(coefficients, abs=1e-12)
    assert model.variance == pytest.approx(variance, rel=1e-12)


@pytest.mark.parametrize("criterion", CRITERIA)
def test_criteria_find_the_order_of_a_known_process(criterion):
    model = autoregression("test", ar_process(20_000), 1.0, criterion)
    # FPE and AIC take a few too many with a probability that does not fall with n
    assert 4 <= model.order <= (4 if criterion == "MDL" else 20)
    assert model.a[1:5] == pytest.approx(COEFFICIENTS[1:], abs=0.05)


@pytest.mark.parametrize("order", [2, 4, 50, 300, None])
@pytest.mark.parametrize("amplitudes", [(1.0,), (1.0, 0.1), (1.0, 1e-3, 0.3)])
def test_sines_without_noise_integrate_to_the_variance(order, amplitudes):
    t = 0.1 * np.arange(2000)
    x = sum(a * np.sin((3 + 4 * i) * t + i) for i, a in enumerate(amplitudes))
    omega, power = maximum_entropy_spectrum(x, 0.1, order=order)
    assert np.trapezoid(power, omega) == pytest.approx(x.var(), rel=2e-3)
    if order is None:
        # Burg shifts lines by a part of the resolution (2 pi over 200 here), depending on phase
        assert omega[np.argmax(power)] == pytest.approx(3.0, abs=0.2 * 2 * np.pi / 200)


def test_decaying_sine_integrates_to_the_variance():
    t = 0.1 * np.arange(2000)
    x = np.sin(3 * t) * np.exp(-t / 50)
    omega, power = maximum_entropy_spectrum(x, 0.1)
    assert np.trapezoid(power, omega) == pytest.approx(x.var(), rel=2e-3)


def test_unknown_criterion():
    with pytest.raises(FricmbError, match="FPE"):
        maximum_entropy_spectrum(np.ones(50), 0.1, order="FPA")
    with pytest.raises(FricmbError, match=r"order must lie between .* got 2\.5"):
        maximum_entropy_spectrum(np.ones(50), 0.1, order=2.5)
