"""The peak of a friction law near rest, in joints: steps that pass a reversal must not pass over it."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm

M, INERTIA, LENGTH, RADIUS, GRAVITY, START, END = 1.3, 0.2, 0.7, 0.05, 9.81, 0.3, 6.0
MU_S, MU_K = 0.5, 0.3


def angular_acceleration(angle, rate, way, v_s):
    """Of a pendulum on a dry pin: the load, which depends on it, is found by iteration."""
    c, s = np.cos(angle), np.sin(angle)
    mu = MU_K + (MU_S - MU_K) * np.exp(-((RADIUS * rate / v_s) ** 2))
    found = 0.0
    for _ in range(60):
        before = found
        load = M * np.hypot(LENGTH * (-found * s - rate**2 * c), LENGTH * (found * c - rate**2 * s) + GRAVITY)
        found = (-M * GRAVITY * LENGTH * c - way * RADIUS * mu * load) / (INERTIA + M * LENGTH**2)
        if abs(found - before) < 1e-15:
            break
    return found


def reference(v_s, grid):
    """Angle and rate: smooth pieces between reversals, in steps shorter than what the peak lasts."""

    def reversal(t, y, way):
        return way * y[1] if t > begin else 1.0

    reversal.terminal, reversal.direction = True, -1
    begin, y, way = 0.0, np.array([START, 0.0]), -1.0
    found = np.zeros((2, grid.size))
    while begin < END:
        piece = solve_ivp(
            lambda t, y, way: [y[1], angular_acceleration(y[0], y[1], way, v_s)], (begin, END), y, args=(way,),
            method="DOP853", rtol=1e-12, atol=1e-14, max_step=0.6 * v_s, events=reversal, dense_output=True,
        )  # fmt: skip
        inside = (grid >= begin) & (grid <= piece.t[-1])
        found[:, inside] = piece.sol(grid[inside])
        begin, y, way = piece.t[-1], np.array([piece.y[0, -1], 0.0]), -way
    return found


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_a_narrow_peak_is_seen_at_reversals(method):
    v_s, grid = 0.002, np.linspace(0.0, END, 61)
    place = (LENGTH * np.cos(START), LENGTH * np.sin(START))
    arm = fm.RigidBody("arm", mass=M, inertia=INERTIA, angle=START, position=place, points={"pin": (-LENGTH, 0.0)})
    law = fm.laws.Stribeck(mu_s=MU_S, mu_k=MU_K, v_s=v_s)
    pin = fm.Revolute("pin", arm.point("pin"), radius=RADIUS, friction=law)
    scene = fm.Scene("pendulum", [arm, pin, fm.Gravity("gravity")])
    exact = reference(v_s, grid)
    worst = 0.0
    for rtol in (1e-4, 1e-5, 1e-6, 1e-7, 1e-8):
        sol = fm.simulate(scene, t_end=END, rtol=rtol, t_eval=grid, method=method)
        error = np.abs(np.array([sol["arm.angle"], sol.velocity("arm.angle")]) - exact).max(axis=1)
        worst = max(worst, (error / np.abs(exact).max(axis=1)).max() / rtol)
    assert worst < 10.0, worst
