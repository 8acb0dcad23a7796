"""Mechanisms in the suite: Andrews' equations written by hand, and chains of links."""

import math

import numpy as np
import pytest

import fricmb as fm
from fricmb.bench import _andrews as hand
from fricmb.bench._dae_methods import Explicit, Mechanism, dae_methods, measure_dae
from fricmb.bench._daes import dae_cases
from fricmb.bench._run import Setting
from fricmb.bench._size import capstan, links, measure_size

CASE = next(case for case in dae_cases() if case.name == "andrews")


def test_start_satisfies_the_equations_written_by_hand():
    out = np.zeros(27)
    hand.andrews(0.0, CASE.y0, CASE.yp0, out)
    assert np.abs(out).max() < 1e-9


def test_the_same_accelerations_as_the_bodies():
    """In motion, not only at the start: the scene's run satisfies the hand-written equations of the angles."""
    sol = fm.simulate(fm.models.andrews(), t_end=0.01, rtol=1e-10)
    h = 1e-6
    p = [hand.angles(sol.at(np.array([0.0, 0.005 + k * h]))) for k in (-1, 0, 1)]
    y, rate = np.zeros(27), np.zeros(27)
    y[:14] = p[1]
    y[14:21] = (p[2][7:] - p[0][7:]) / (2.0 * h)
    out = np.zeros(27)
    hand.andrews(0.0, y, rate, out)
    # second derivatives of the constraints
    np.testing.assert_allclose(out[21:27], 0.0, atol=1e-5 * np.abs(y[14:21]).max())
    # motion, with the multipliers that fit best
    A = np.zeros((7, 6))
    for j in range(6):
        y[21:] = np.eye(6)[j]
        other = np.zeros(27)
        hand.andrews(0.0, y, rate, other)
        A[:, j] = other[14:21] - out[14:21]
    lam = np.linalg.lstsq(A, -out[14:21], rcond=None)[0]
    np.testing.assert_allclose(out[14:21] + A @ lam, 0.0, atol=1e-4 * np.abs(out[14:21]).max())


@pytest.mark.parametrize("method", [m for m in dae_methods() if m.takes(CASE) and m.name != "solve_dae"], ids=str)
def test_methods_reach_the_published_digits(method):
    found = measure_dae(CASE, method, Setting(rtol=1e-6))
    assert found.metrics.state < (1e-5 if method.name == "simulate" else 1e-2)


def test_a_chain_of_links_is_measured_by_the_step():
    found = measure_size("links", "auto", 6)
    assert 0.0 < found["seconds"] < 1.0
    assert found["energy"] < 1e-3
    assert len(links(6).joints) == 6


def test_a_heavy_top_by_hand_and_as_a_body_in_space():
    """Euler's angles by another's integrator, the scene by ours: both at the certified end."""
    case = next(case for case in dae_cases() if case.name == "heavy_top")
    left = np.empty(6)
    case.residual(0.0, case.y0, case.yp0, left)
    assert not left.any()
    for method in (Mechanism(), Explicit()):
        assert method.takes(case)
        found, counters = method.solve(case, 1e-10)
        np.testing.assert_allclose(found[:2], case.end, rtol=1e-9)
        assert counters["n_rhs"] > 100
    assert not Explicit().takes(CASE)


def test_a_rope_costs_a_twentieth_of_one_by_hand():
    """30 masses and springs on half a drum beside one part, which slips at e^(mu pi)."""
    rope, chain = (measure_size("capstan", "auto", n) for n in (1, 30))
    assert rope["seconds"] < 0.05 * chain["seconds"]
    sol = fm.simulate(capstan(1), t_end=4.2)
    assert float(sol.events[0].t) == pytest.approx(math.exp(0.5 * math.pi) - 1, rel=1e-12)
    slip = [event.t for event in fm.simulate(capstan(10), t_end=4.2).events if event.kind == "slip"]
    turn = 0.5 * math.sin(math.pi / 20)
    assert float(slip[-1]) == pytest.approx(((1 + turn) / (1 - turn)) ** 10 - 1, rel=1e-3)
