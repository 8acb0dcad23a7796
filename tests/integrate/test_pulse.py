"""Loads that come and go while nothing moves: no error of a step says that they do, so they are looked at."""

from __future__ import annotations

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import fricmb as fm

AT, WIDTH, PEAK, END = 5.013, 0.05, 30.0, 10.0
PULSE = PEAK * sympy.exp(-(((fm.t - AT) / WIDTH) ** 2))


def pulse(t):
    return PEAK * np.exp(-(((t - AT) / WIDTH) ** 2))


def first_slide(inertia, force, hold, rub, start, since=6.0 * WIDTH):
    """When and where one degree of freedom at rest lets go under ``force(t, x)`` beyond ``hold``, and turns."""
    t0 = brentq(lambda t: force(t, start) - hold, AT - since, AT, xtol=1e-13)

    def turns(_t, y):
        return y[1] if _t > t0 + 0.01 else 1.0

    turns.terminal, turns.direction = True, -1
    run = solve_ivp(
        lambda t, y: [y[1], (force(t, y[0]) - rub) / inertia], (t0, END), [start, 0.0], method="DOP853", rtol=1e-12,
        atol=1e-13, events=turns, max_step=0.01,
    )  # fmt: skip
    return t0, run.t_events[0][0], run.y_events[0][0][0]


@pytest.mark.parametrize("method", ["auto", "radau", "bdf", "taylor"])
def test_a_block_that_rests_is_pushed(method):
    body = fm.Body("block", mass=1.0)
    scene = fm.Scene("pushed", [
        body, fm.Spring("spring", body, axis="x", stiffness=1.0), fm.Force("pulse", body, axis="x", value=PULSE),
        fm.Contact("sole", body, law=fm.laws.Coulomb(mu_s=1.0, mu_k=0.8), normal_force=1.0),
    ])  # fmt: skip
    sol = fm.simulate(scene, t_end=END, rtol=1e-6, method=method)
    lets_go, turns, way = first_slide(1.0, lambda t, x: pulse(t) - x, 1.0, 0.8, 0.0)
    assert [e.t for e in sol.events][:2] == pytest.approx([lets_go, turns], abs=1e-5)
    assert sol(turns)[0] == pytest.approx(way, rel=1e-5)


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_a_slide_that_rests_on_its_guide_is_pushed(method):
    """With a joint, a guide along x that bears the weight: steps grew beyond the pulse and passed it by."""
    body = fm.RigidBody("block", mass=1.0, inertia=1.0)
    law = fm.laws.Coulomb(mu_s=1.0, mu_k=0.8)
    guide = fm.Prismatic("guide", body, fm.ground_point(0.0, 0.0), friction=law)
    scene = fm.Scene("pushed", [
        body, guide, fm.Force("pulse", body, axis="x", value=PULSE),
        fm.Spring("spring", body, axis="x", stiffness=1.0),
        fm.Gravity("gravity", acceleration={"y": -1.0}),
    ])  # fmt: skip
    sol = fm.simulate(scene, t_end=END, rtol=1e-6, method=method)
    lets_go, turns, way = first_slide(1.0, lambda t, x: pulse(t) - x, 1.0, 0.8, 0.0)
    assert [e.t for e in sol.events][:2] == pytest.approx([lets_go, turns], abs=1e-5)
    assert sol.at([turns]).q[sol.dof_names.index("block.x"), 0] == pytest.approx(way, rel=1e-5)


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("width", [0.5, 0.1, 0.02])
def test_a_slide_that_rests_is_pushed_by_what_passes_by(width, method):
    """A force by the place of another body, which no error of the motion shows and no function of time tells of."""
    body, runner = fm.RigidBody("block", mass=1.0, inertia=1.0), fm.Body("runner", mass=1.0, velocity={"x": 1.0})
    value = PEAK * sympy.exp(-(((fm.coordinate("runner.x") - AT) / width) ** 2))
    guide = fm.Prismatic("guide", body, fm.ground_point(0.0, 0.0), friction=fm.laws.Coulomb(mu_s=1.0, mu_k=0.8))
    scene = fm.Scene("pushed", [
        body, runner, guide, fm.Force("pulse", body, axis="x", value=value),
        fm.Gravity("gravity", acceleration={"y": -1.0}), fm.Spring("spring", body, axis="x", stiffness=1.0),
    ])  # fmt: skip
    sol = fm.simulate(scene, t_end=END, rtol=1e-6, method=method)

    def force(t, x):
        return PEAK * np.exp(-(((t - AT) / width) ** 2)) - x

    lets_go, turns, way = first_slide(1.0, force, 1.0, 0.8, 0.0, 6.0 * width)
    assert [e.t for e in sol.events][:2] == pytest.approx([lets_go, turns], abs=1e-5)
    assert sol.at([turns]).q[sol.dof_names.index("block.x"), 0] == pytest.approx(way, rel=1e-5)


#: Half the width of a triangle, its peak, and how far it pushes a unit mass that 1 holds and 0.8 rubs.
HALF, TOP = 5e-4, 4000.0


def pushed_by_triangle():
    """Instants of letting go and coming to rest, and the way between, in closed form: the force is linear by pieces."""
    rise = TOP / HALF
    tau = HALF - 1.0 / rise  # from letting go to the peak
    v = (1.0 - 0.8) * tau + 0.5 * rise * tau**2
    x = 0.5 * (1.0 - 0.8) * tau**2 + rise * tau**3 / 6.0
    x += v * HALF + 0.5 * (TOP - 0.8) * HALF**2 - rise * HALF**3 / 6.0
    v += (TOP - 0.8) * HALF - 0.5 * rise * HALF**2
    return AT - tau, AT + HALF + v / 0.8, x + 0.5 * v**2 / 0.8


@pytest.mark.parametrize(("joint", "method"), [
    (False, "auto"), (False, "radau"), (False, "bdf"), (False, "taylor"), (True, "radau"), (True, "bdf"),
])  # fmt: skip
def test_a_triangle_of_a_ten_thousandth_of_the_run(joint, method):
    """Where it begins and ends was searched for on a grid of the run: what lay between two times was missed."""
    value = TOP * sympy.Max(0, 1 - sympy.Abs(fm.t - AT) / HALF)
    law = fm.laws.Coulomb(mu_s=1.0, mu_k=0.8)
    if joint:
        body = fm.RigidBody("block", mass=1.0, inertia=1.0)
        rest = [
            fm.Prismatic("guide", body, fm.ground_point(0.0, 0.0), friction=law),
            fm.Gravity("gravity", acceleration={"y": -1.0}),
        ]
    else:
        body = fm.Body("block", mass=1.0)
        rest = [fm.Contact("guide", body, law=law, normal_force=1.0)]
    scene = fm.Scene("pushed", [body, *rest, fm.Force("pulse", body, axis="x", value=value)])
    sol = fm.simulate(scene, t_end=END, rtol=1e-6, method=method)
    lets_go, stops, way = pushed_by_triangle()
    assert [e.t for e in sol.events][-2:] == pytest.approx([lets_go, stops], abs=1e-8)
    assert sol.q[sol.dof_names.index("block.x"), -1] == pytest.approx(way, rel=1e-6)
