"""Forces and loads that bend with the motion: stops, gaps, drag; steps end where they do."""

from dataclasses import dataclass

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

import fricmb as fm
from fricmb.scene import direction

RTOL = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11)
X, V = fm.coordinate("m.x"), fm.speed("m.x")


def by_pieces(rate, side, start, grid):
    """Motion under ``rate(t, y, beyond)``: each smooth piece by itself; ``side(y)`` is above 0 beyond the bend."""
    t, y, found = 0.0, np.array(start), np.zeros((2, grid.size))
    beyond = side(y + 1e-9 * np.array(rate(0.0, y, False))) > 0.0
    while t < grid[-1]:

        def passes(_, y):
            return side(y)

        passes.terminal, passes.direction = True, -1 if beyond else 1
        run = solve_ivp(
            lambda t, y, beyond=beyond: rate(t, y, beyond), (t, grid[-1]), y, method="DOP853", rtol=1e-13, atol=1e-15,
            dense_output=True, events=passes,
        )  # fmt: skip
        inside = (grid >= t) & (grid <= run.t[-1])
        if inside.any():
            found[:, inside] = run.sol(grid[inside])
        t, y, beyond = run.t[-1], run.y[:, -1], not beyond
        if run.status != 1:
            break
    return found


def stop():
    """An end stop of 100 times the stiffness."""

    def rate(t, y, beyond):
        return [y[1], -y[0] + np.cos(1.7 * t) - (100 * (y[0] - 0.5) if beyond else 0.0)]

    return -100 * sympy.Max(0, X - 0.5), rate, lambda y: y[0] - 0.5


def drag():
    """A force that goes with the square of speed."""

    def rate(t, y, beyond):
        return [y[1], -y[0] + np.cos(1.7 * t) - 0.3 * y[1] * y[1] * (1 if beyond else -1)]

    return -0.3 * V * sympy.Abs(V), rate, lambda y: y[1]


def backlash():
    """Two formulas for two sides."""

    def rate(t, y, beyond):
        return [y[1], -y[0] + np.cos(1.7 * t) - 0.2 - (5 * (y[0] - 0.5) if beyond else 0.0)]

    value = sympy.Piecewise((-5 * (X - 0.5) - 0.2, X > 0.5), (-0.2, True))
    return value, rate, lambda y: y[0] - 0.5


def error(sol, found):
    return max(
        np.abs(sol.q[0] - found[0]).max() / np.abs(found[0]).max(),
        np.abs(sol.v[0] - found[1]).max() / np.abs(found[1]).max(),
    )


@pytest.mark.parametrize("make", [stop, drag, backlash])
def test_forces_that_bend_are_as_exact_as_is_asked_for(make):
    value, rate, side = make()
    grid = np.linspace(0.0, 30.0, 301)
    found, worst = by_pieces(rate, side, [0.0, 1.0], grid), {}
    mass = fm.Body("m", mass=1.0, velocity={"x": 1.0})
    push = fm.Force("push", mass, axis="x", value=sympy.cos(1.7 * fm.t))
    spring = fm.Spring("k", mass, axis="x", stiffness=1.0)
    scene = fm.Scene("bends", [mass, spring, push, fm.Force("more", mass, axis="x", value=value)])
    for method in ("auto", "radau", "bdf"):
        for rtol in RTOL:
            sol = fm.simulate(scene, t_end=30.0, rtol=rtol, method=method, t_eval=grid)
            worst[method, rtol] = error(sol, found) / rtol
    assert max(worst.values()) < 10.0, worst
    with pytest.raises(fm.SceneError, match="collocation takes"):
        fm.simulate(scene, t_end=1.0, method="collocation")


def test_a_load_that_bends():
    """Block that always slips, pressed harder beyond a place."""
    grid = np.linspace(0.0, 30.0, 301)

    def rate(t, y, beyond):
        return [y[1], -2 * y[0] + 0.3 * np.cos(1.1 * t) + 0.5 * (1 + (2 * (y[0] - 0.6) if beyond else 0.0))]

    found, worst = by_pieces(rate, lambda y: y[0] - 0.6, [0.0, 0.0], grid), {}
    block, belt = fm.Body("m", mass=1.0), fm.Driven("belt", velocity={"x": 2.0})
    load = 1 + 2 * sympy.Max(0, X - 0.6)
    parts = [
        fm.Spring("k", block, axis="x", stiffness=2.0),
        fm.Force("f", block, axis="x", value=0.3 * sympy.cos(1.1 * fm.t)),
        fm.Contact("c", block, belt, law=fm.laws.Coulomb(mu_s=0.5), normal_force=load, axes="x"),
    ]
    scene = fm.Scene("load", [block, belt, *parts])
    for method in ("auto", "radau", "bdf"):
        for rtol in RTOL:
            sol = fm.simulate(scene, t_end=30.0, rtol=rtol, method=method, t_eval=grid)
            assert not sol.events
            worst[method, rtol] = error(sol, found) / rtol
    assert max(worst.values()) < 10.0, worst


@dataclass(frozen=True, kw_only=True)
class Buffer(fm.Element):
    """Somebody's own element: a spring that pushes beyond a gap."""

    body: fm.Body
    stiffness: float
    gap: float

    def local_coordinates(self):
        return (direction(self, "axis", "x", self.body, fm.GROUND).form,)

    def define_potential(self, x):
        return self.stiffness * sympy.Max(0, x[0] - self.gap) ** 2 / 2


def test_an_element_of_ones_own_that_bends():
    _, rate, side = stop()
    grid = np.linspace(0.0, 10.0, 101)
    found, worst = by_pieces(rate, side, [0.0, 1.0], grid), {}
    mass = fm.Body("m", mass=1.0, velocity={"x": 1.0})
    push = fm.Force("push", mass, axis="x", value=sympy.cos(1.7 * fm.t))
    buffer = Buffer(name="buffer", body=mass, stiffness=100.0, gap=0.5)
    scene = fm.Scene("own", [mass, fm.Spring("k", mass, axis="x", stiffness=1.0), push, buffer])
    for method in ("radau", "bdf"):
        for rtol in RTOL:
            sol = fm.simulate(scene, t_end=10.0, rtol=rtol, method=method, t_eval=grid)
            worst[method, rtol] = error(sol, found) / rtol
    assert max(worst.values()) < 10.0, worst


def test_a_stop_in_a_mechanism():
    """A pendulum whose body is pushed back beyond a line."""
    mass, inertia, length, start = 1.3, 0.2, 0.7, -1.2
    grid = np.linspace(0.0, 6.0, 61)

    def rate(t, y, beyond):
        push = -80 * (length * np.cos(y[0]) - 0.1) if beyond else 0.0
        moment = -mass * 9.81 * length * np.cos(y[0]) - push * length * np.sin(y[0])
        return [y[1], moment / (inertia + mass * length**2)]

    found = by_pieces(rate, lambda y: length * np.cos(y[0]) - 0.1, [start, 0.0], grid)
    place = (length * np.cos(start), length * np.sin(start))
    arm = fm.RigidBody("arm", mass=mass, inertia=inertia, angle=start, position=place, points={"pin": (-length, 0.0)})
    value = -80 * sympy.Max(0, fm.coordinate("arm.x") - 0.1)
    parts = [fm.Revolute("pin", arm.point("pin")), fm.Gravity("gravity"), fm.Force("stop", arm, axis="x", value=value)]
    scene, worst = fm.Scene("pendulum", [arm, *parts]), {}
    for method in ("radau", "bdf"):
        for rtol in RTOL:
            sol = fm.simulate(scene, t_end=6.0, rtol=rtol, method=method, t_eval=grid)
            gap = np.abs(np.array([sol["arm.angle"], sol.velocity("arm.angle")]) - found).max(axis=1)
            worst[method, rtol] = (gap / np.abs(found).max(axis=1)).max() / rtol
    assert max(worst.values()) < 10.0, worst
