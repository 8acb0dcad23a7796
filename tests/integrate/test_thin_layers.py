"""Friction that is flat at rest and falls within a slip speed far below those of a step: slip waits before it grows.

No stage of a step that is over the fall sees it; beside programs of scipy that know when slip sets out.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm

BELT = 0.378


def on_belt(law):
    """A block of mass 1 on a spring of stiffness 1, moving with a belt until the spring's force is mu_s N = 2."""
    belt = fm.Driven("belt", velocity={"x": BELT})
    block = fm.Body("block", mass=1.0, velocity={"x": BELT})
    spring = fm.Spring("ground", block, axis="x", stiffness=1.0)
    return fm.Scene("one", [belt, block, spring, fm.Contact("sole", block, belt, law=law, normal_force=1.0)])


def slip_of_one(v_s, exponent, times):
    """Slip speeds after the break-away: r' = x - mu(r), x' = V - r."""

    def rates(t, y):
        return [BELT - y[1], y[0] - 1.0 - np.exp(-((max(y[1], 0.0) / v_s) ** exponent))]

    run = solve_ivp(rates, (0.0, times[-1]), [2.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-18, t_eval=times)
    return run.y[1]


@pytest.mark.parametrize("method", ["auto", "radau", "bdf"])
@pytest.mark.parametrize(("v_s", "exponent"), [(1e-4, 2.0), (1e-5, 2.0), (1e-4, 3.0)])
@pytest.mark.parametrize("rtol", [1e-6, 1e-9])
def test_one_block_waits(v_s, exponent, rtol, method):
    scene = on_belt(fm.laws.Stribeck(mu_s=2.0, mu_k=1.0, v_s=v_s, exponent=exponent))
    times, begin = np.array([1e-3, 3e-3, 1e-2, 3e-2]), 2.0 / BELT
    sol = fm.simulate(scene, t_end=begin + 0.03, t_eval=begin + times, rtol=rtol, method=method)
    np.testing.assert_allclose(BELT - sol.v[0], slip_of_one(v_s, exponent, times), atol=10.0 * rtol * BELT, rtol=1e-3)


@pytest.mark.parametrize("method", ["radau", "bdf", "taylor"])
def test_two_blocks_that_reach_their_limits_together(method):
    """Slip 5 ms after the break-away was 6.5e-3 by three methods; it is 5.1e-6."""
    law = fm.laws.Stribeck(mu_s=2.3, mu_k=1.0, v_s=1e-4, exponent=3.0)
    belt = fm.Driven("belt", velocity={"x": BELT})
    blocks = [fm.Body(name, mass=1.0, velocity={"x": BELT}) for name in ("one", "two")]
    scene = fm.Scene("two", [
        belt, *blocks, *[fm.Spring(f"to {b.name}", b, axis="x", stiffness=1.0) for b in blocks],
        fm.Spring("tie", *blocks, axis="x", stiffness=10.0),
        fm.Contact("first", blocks[0], belt, law=law, normal_force=1.0),
        fm.Contact("second", blocks[1], belt, law=fm.laws.Coulomb(mu_s=2.3, mu_k=1.0), normal_force=1.0),
    ])  # fmt: skip
    times, begin = np.array([1e-3, 5e-3, 1e-2, 2e-2]), 2.3 / BELT

    def rates(t, y):
        x, r = y[:2], y[2:]
        friction = np.array([1.0 + 1.3 * np.exp(-((max(r[0], 0.0) / 1e-4) ** 3)), 1.0])
        return np.concatenate([BELT - r, x + 10.0 * (x - x[::-1]) - friction])

    own = solve_ivp(rates, (0.0, 0.02), [2.3, 2.3, 0.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-18, t_eval=times)
    sol = fm.simulate(scene, t_end=begin + 0.02, t_eval=begin + times, rtol=1e-10, method=method)
    np.testing.assert_allclose(BELT - sol.v[0], own.y[2], rtol=1e-6, atol=1e-10)


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_a_slide_on_its_guide_waits(method):
    """The same with a joint, whose friction is of its own reaction; a load that grows in time in place of the belt."""
    v_s = 1e-4
    body = fm.RigidBody("block", mass=1.0, inertia=1.0)
    law = fm.laws.Stribeck(mu_s=2.0, mu_k=1.0, v_s=v_s)
    scene = fm.Scene("guide", [
        body, fm.Prismatic("guide", body, fm.ground_point(0.0, 0.0), friction=law),
        fm.Gravity("gravity", acceleration={"y": -1.0}), fm.Force("pull", body, axis="x", value=BELT * fm.t),
    ])  # fmt: skip
    times, begin = np.array([1e-3, 3e-3, 1e-2, 3e-2]), 2.0 / BELT

    def rates(t, y):
        return [BELT * t + 1.0 - np.exp(-((max(y[0], 0.0) / v_s) ** 2))]

    own = solve_ivp(rates, (0.0, 0.03), [0.0], method="DOP853", rtol=1e-12, atol=1e-18, t_eval=times)
    sol = fm.simulate(scene, t_end=begin + 0.03, t_eval=begin + times, rtol=1e-8, method=method)
    np.testing.assert_allclose(sol.v[sol.dof_names.index("block.x")], own.y[0], rtol=1e-4, atol=1e-8)
