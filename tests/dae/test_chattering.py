"""Where fun jumps and drives y to the jump from both sides, a run ends with a sentence; elsewhere it goes on."""

import warnings
from types import SimpleNamespace

import numba
import numpy as np
import pytest

import fricmb as fm
from fricmb.dae._chattering import Chattering


def sliding(t, y, yp):
    return np.array([yp[0] + np.sign(y[0])])


@pytest.mark.parametrize("fun", [sliding, numba.njit(sliding)], ids=["python", "compiled"])
@pytest.mark.parametrize(("rtol", "atol"), [(1e-3, 1e-6), (1e-8, 1e-10)])
def test_sliding_ends_with_the_component(fun, rtol, atol):
    """Y' = -sign(y) from 1: y = 1 - t up to t = 1, and no solution but y = 0 beyond."""
    found = fm.solve_dae(fun, (0.0, 3.0), [1.0], rtol=rtol, atol=atol)
    assert not found.success
    assert found.message.startswith("Chattering at t = 1")
    assert "the derivative of y[0] jumps" in found.message
    assert found.t[-1] == pytest.approx(1.0, abs=10.0 * rtol)
    assert found.nfev < 30_000
    before = found.t <= 1.0
    assert found.y[0, before] == pytest.approx(1.0 - found.t[before], abs=10.0 * (rtol + atol))


def test_the_component_that_slides_is_the_one_that_is_named():
    """A mass on a spring under dry friction by sign: x = 0.8 + 0.2 cos t up to pi, where it comes to rest for good."""

    def fun(t, y, yp):
        return np.array([yp[0] - np.cos(3.0 * t), yp[1] - y[2], yp[2] + y[1] + 0.8 * np.sign(y[2])])

    found = fm.solve_dae(fun, (0.0, 30.0), [0.0, 1.0, 0.0], rtol=1e-6, atol=1e-8, t_eval=np.linspace(0.0, 30.0, 31))
    assert "the derivative of y[2] jumps" in found.message
    assert float(found.message.split("t = ")[1].split(":")[0]) == pytest.approx(np.pi, abs=1e-4)
    assert found.y[1] == pytest.approx(0.8 + 0.2 * np.cos(found.t), abs=1e-5)


@pytest.mark.parametrize("omega", [1e3, 1e6])
def test_fast_oscillations_and_jumps_that_are_crossed_are_none(omega):
    def fun(t, y, yp):
        return np.array([yp[0] - omega * y[1], yp[1] + omega * y[0], yp[2] - np.sign(np.sin(t)) - 2.0])

    span = 2e3 / omega
    found = fm.solve_dae(fun, (0.0, span), [1.0, 0.0, 0.0], rtol=1e-6, atol=1e-9)
    assert found.success, found.message


@pytest.mark.parametrize(("size", "found"), [(1e-13, False), (1e-3, True)])
def test_noise_within_the_tolerance_is_none(size, found):
    """Y' changes its sign at every step: chattering where y moves by more than its tolerance, else round-off."""
    n = 400
    signs = (-1.0) ** np.arange(n)
    record = SimpleNamespace(size=n, t=1.0 + 1e-9 * np.arange(n), y=np.zeros((n, 1)), yp=size * signs[:, None])
    said = Chattering(1, 0.0, 1e5).look(record, 1, np.array([1e-6]), np.array([1e-6]))
    assert ("the derivative of y[0] jumps" in said) == found


def test_no_warnings_come_out_of_trials():
    """Y' = -1/(2 sqrt y) ends at t = 4/3, where trials go below 0."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = fm.solve_dae(lambda t, y, yp: np.array([yp[0] + 0.5 / np.sqrt(y[0])]), (0.0, 3.0), [1.0], rtol=1e-8)
    assert "fun is not finite" in found.message
    assert found.t[-1] == pytest.approx(4.0 / 3.0, abs=1e-3)
