"""Slip that dies out without an end: the spring pulls exactly as friction at rest could hold."""

import math

import numpy as np
import pytest

import fricmb as fm


@pytest.mark.parametrize("rtol", [1e-6, 1e-8, 1e-10])
def test_slip_that_dies_out_is_not_followed_into_round_off(rtol):
    # critically damped, towards 0.84, where the spring pulls with 0.8 = mu N: x = 0.84 (1 - (1 + w t) exp(-w t))
    mass, stiffness = 0.02, 5.0
    w = math.sqrt(stiffness / mass)
    block = fm.Body("block", mass=mass)
    scene = fm.Scene("dies out", [
        block, fm.Spring("spring", block, axis="x", stiffness=stiffness, length=1.0),
        fm.Damper("damper", block, axis="x", damping=2.0 * mass * w),
        fm.Contact("sole", block, law=fm.laws.Coulomb(mu_s=0.8), normal_force=1.0, axes="x"),
    ])  # fmt: skip
    t = np.linspace(0.0, 10.0, 41)
    sol = fm.simulate(scene, t_end=10.0, rtol=rtol, t_eval=t, method="collocation", time_limit=30.0)
    assert sol["block.x"] == pytest.approx(0.84 * (1.0 - (1.0 + w * t) * np.exp(-w * t)), abs=10.0 * rtol)
    assert sol.velocity("block.x") == pytest.approx(0.84 * w * w * t * np.exp(-w * t), abs=10.0 * rtol * w)
    assert sol.stats.n_steps < 100  # 613 000 to t = 2.35 where r was resolved in parts of itself, whatever its size
