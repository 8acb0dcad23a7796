"""Friction that falls steeply with speed: slip grows slowly at first, on the law's own scale, then runs away."""

from functools import lru_cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm

MU_S, MU_K, BELT = 1.5, 1.0, 0.1


@lru_cache
def length_of_slip(v_s):
    """From break-away (m = k = N = 1) to stick: way u beyond it and slip speed r, by DOP853 from r = u = 0."""

    def rates(t, y):
        fall = -(MU_S - MU_K) * np.expm1(-max(y[1], 0.0) / v_s)
        return [BELT - y[1], fall + y[0]]

    def stick(t, y):
        return y[1]

    stick.terminal, stick.direction = True, -1
    found = solve_ivp(
        rates, (0.0, 10.0), [0.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-22, events=stick, first_step=1e-3 * v_s
    )
    return found.t[-1]


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("v_s", [3e-3, 3e-4, 1e-4, 1e-5])
def test_steps_see_slip_grow_after_break_away(v_s, method):
    """It takes some 10 v_s/(mu_s - mu_k) until slip is there; a long implicit step has a solution without that."""
    block, belt = fm.Body("block", mass=1.0, velocity={"x": BELT}), fm.Driven("belt", velocity={"x": BELT})
    law = fm.laws.Stribeck(mu_s=MU_S, mu_k=MU_K, v_s=v_s, exponent=1.0)
    scene = fm.Scene(
        "belt",
        [block, belt, fm.Spring("k", block, axis="x", stiffness=1.0),
         fm.Contact("sole", block, belt, law=law, normal_force=1.0)],
    )  # fmt: skip
    for rtol in (1e-4, 1e-6, 1e-8):
        slip, stick = (event.t for event in fm.simulate(scene, t_end=20.0, rtol=rtol, method=method).events)
        assert slip == pytest.approx(15.0, abs=1e-9)
        assert stick - slip == pytest.approx(length_of_slip(v_s), abs=2e-4 * (1e4 * rtol) ** 0.75)
