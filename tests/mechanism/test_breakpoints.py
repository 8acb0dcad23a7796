"""Loads and belts that jump in scenes with bodies that turn: against equations of their own on either side."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

import fricmb as fm

METHODS = pytest.mark.parametrize("method", ["radau", "bdf"])
JUMP, END = 1.65, 4.2
M, K, LENGTH, MASS, J, G = 0.57, 0.7, 0.5, 1.0, 0.1, 9.81


def load(t, sin=np.sin):
    return -0.36 + 1.6 * sin(0.34 * t + 4.18)


def swung(before):
    """A block tied to a pendulum, in two pieces of smooth motion."""

    def rates(t, y, late):
        x, angle = y[:2]
        f = K * (x - LENGTH * np.sin(angle))
        turns = (f * LENGTH * np.cos(angle) - MASS * G * LENGTH * np.sin(angle)) / (J + MASS * LENGTH**2)
        return [*y[2:], ((load(t) if late else before) - f) / M, turns]

    y = np.zeros(4)
    for span, late in (((0.0, JUMP), False), ((JUMP, END), True)):
        y = solve_ivp(rates, span, y, method="DOP853", rtol=1e-12, atol=1e-13, args=(late,)).y[:, -1]
    return y


@METHODS
@pytest.mark.parametrize("before", [0.0, 0.3])
def test_a_load_that_jumps_beside_a_pendulum(method, before):
    """Steps ended on the jump and went on as if it had not come, with all functions of time standing still."""
    value = sympy.Piecewise((before, fm.t < JUMP), (load(fm.t, sympy.sin), True))
    block = fm.Body("block", mass=M)
    bar = fm.RigidBody("bar", mass=MASS, inertia=J, position=(0.0, -LENGTH), points={"eye": (0.0, LENGTH)})
    scene = fm.Scene("tied", [
        block, bar, fm.Revolute("pin", bar.point("eye")), fm.Gravity("gravity", acceleration={"y": -G}),
        fm.Spring("tie", block, bar, axis="x", stiffness=K), fm.Force("push", block, axis="x", value=value),
    ])  # fmt: skip
    sol = fm.simulate(scene, t_end=END, rtol=1e-9, method=method)
    found = [sol["block.x"][-1], sol["bar.angle"][-1], sol.velocity("block.x")[-1], sol.velocity("bar.angle")[-1]]
    np.testing.assert_allclose(found, swung(before), atol=1e-7)


@METHODS
@pytest.mark.parametrize("later", [-0.4, 0.9])
def test_a_body_that_rests_on_a_belt_whose_speed_jumps(method, later):
    """It slips from there on, and is not thrown; once it goes with the belt it rests again."""
    speed, mu, N = 0.5, 0.2, 4.0
    belt = fm.Driven("belt", axes="xy", velocity={"x": sympy.Piecewise((speed, fm.t < JUMP), (later, True))})
    body = fm.RigidBody("body", mass=M, inertia=J, velocity=(speed, 0.0), points={"foot": (0.0, 0.0)})
    foot = fm.Contact("foot", body.point("foot"), belt, law=fm.laws.Coulomb(mu_s=0.3, mu_k=mu), normal_force=N)
    sol = fm.simulate(fm.Scene("carried", [body, belt, foot]), t_end=END, rtol=1e-9, method=method)
    lasts = abs(later - speed) * M / (mu * N)
    assert [e.kind for e in sol.events] == ["slip", "stick"]
    np.testing.assert_allclose(sol.events.t, [JUMP, JUMP + lasts], atol=1e-9)
    way = speed * JUMP + 0.5 * (speed + later) * lasts + later * (END - JUMP - lasts)
    np.testing.assert_allclose([sol["body.x"][-1], sol.velocity("body.x")[-1]], [way, later], atol=1e-8)
    assert np.abs(sol.energy.residual).max() < 1e-7
