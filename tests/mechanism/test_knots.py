"""Laws with bends in joints: a pendulum on a dry pin, from bend to bend by a program of its own."""

from dataclasses import dataclass

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator

import fricmb as fm

M, INERTIA, LENGTH, RADIUS, GRAVITY, START, END = 1.3, 0.2, 0.7, 0.05, 9.81, 0.3, 6.0
SPEED, MU = (0.0, 0.01, 0.03, 0.06, 0.1), (0.5, 0.42, 0.33, 0.31, 0.35)


@dataclass(frozen=True, kw_only=True)
class Corner(fm.FrictionLaw):
    """A straight fall to a constant coefficient."""

    mu_s: float
    mu_k: float
    v_0: float

    def define_coefficient(self, r):
        falling = self.mu_s - (self.mu_s - self.mu_k) * r / self.v_0
        return sympy.Piecewise((falling, r < self.v_0), (self.mu_k, True))


def table():
    curve = PchipInterpolator(SPEED, MU)
    pieces = [*(np.poly1d(curve.c[:, i]) for i in range(len(SPEED) - 1)), np.poly1d([MU[-1]])]
    return fm.laws.Tabulated(speed=SPEED, mu=MU), lambda r, i: pieces[i](r - SPEED[i]), SPEED[1:]


def corner():
    return Corner(mu_s=0.5, mu_k=0.3, v_0=0.05), lambda r, i: 0.5 - 0.2 * r / 0.05 if i == 0 else 0.3, (0.05,)


def angular_acceleration(angle, rate, way, mu):
    """The load, which depends on it, is found by iteration."""
    c, s = np.cos(angle), np.sin(angle)
    found = 0.0
    for _ in range(60):
        before = found
        load = M * np.hypot(LENGTH * (-found * s - rate**2 * c), LENGTH * (found * c - rate**2 * s) + GRAVITY)
        found = (-M * GRAVITY * LENGTH * c - way * RADIUS * mu * load) / (INERTIA + M * LENGTH**2)
        if abs(found - before) < 1e-15:
            break
    return found


def by_pieces(coefficient, knots, grid):
    """Angle and rate; ``way`` is the sense of turning."""
    t, y, way, piece, edges = 0.0, np.array([START, 0.0]), -1.0, 0, [0.0, *knots, 1e9]
    found = np.zeros((2, grid.size))
    while t < END:

        def rate(_, y, way=way, piece=piece):
            return [y[1], angular_acceleration(y[0], y[1], way, coefficient(RADIUS * way * y[1], piece))]

        def above(_, y, way=way, edge=edges[piece + 1]):
            return RADIUS * way * y[1] - edge

        def below(at, y, way=way, edge=edges[piece], begun=t):
            return RADIUS * way * y[1] - edge if at > begun else 1.0

        above.terminal = below.terminal = True
        above.direction, below.direction = 1, -1
        run = solve_ivp(
            rate, (t, END), y, method="DOP853", rtol=1e-12, atol=1e-14, max_step=0.02, events=[above, below],
            dense_output=True,
        )  # fmt: skip
        inside = (grid >= t) & (grid <= run.t[-1])
        if inside.any():
            found[:, inside] = run.sol(grid[inside])
        t, y = run.t[-1], run.y[:, -1].copy()
        if run.status != 1:
            break
        up = bool(run.t_events[0].size)
        y[1] = way * edges[piece + 1 if up else piece] / RADIUS
        if up or piece > 0:
            piece += 1 if up else -1
        else:
            way = -way
    return found


@pytest.mark.parametrize("make", [table, corner])
def test_a_pin_whose_friction_bends_is_as_exact_as_is_asked_for(make):
    law, coefficient, knots = make()
    grid = np.linspace(0.0, END, 61)
    exact, worst = by_pieces(coefficient, knots, grid), {}
    place = (LENGTH * np.cos(START), LENGTH * np.sin(START))
    arm = fm.RigidBody("arm", mass=M, inertia=INERTIA, angle=START, position=place, points={"pin": (-LENGTH, 0.0)})
    pin = fm.Revolute("pin", arm.point("pin"), radius=RADIUS, friction=law)
    scene = fm.Scene("pendulum", [arm, pin, fm.Gravity("gravity")])
    for method in ("radau", "bdf"):
        for rtol in (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10):
            sol = fm.simulate(scene, t_end=END, rtol=rtol, t_eval=grid, method=method)
            error = np.abs(np.array([sol["arm.angle"], sol.velocity("arm.angle")]) - exact).max(axis=1)
            worst[method, rtol] = (error / np.abs(exact).max(axis=1)).max() / rtol
    assert max(worst.values()) < 10.0, worst
