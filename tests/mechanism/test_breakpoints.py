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


@METHODS
@pytest.mark.parametrize("drive", ["speed", "distance"])
def test_a_pivot_whose_speed_jumps(method, drive):
    """The bob keeps its momentum about the pivot; what the drive brings at once was not in the ledger."""
    slow, fast = 0.5, -1.5
    speed = sympy.Piecewise((slow, fm.t < JUMP), (fast, True))
    way = sympy.Piecewise((slow * fm.t, fm.t < JUMP), (slow * JUMP + fast * (fm.t - JUMP), True))
    cart = fm.RigidBody("cart", mass=M, inertia=J, velocity=(slow, 0.0))
    bar = fm.RigidBody(
        "bar", mass=MASS, inertia=J, position=(LENGTH * np.sin(0.8), -LENGTH * np.cos(0.8)), angle=0.8,
        velocity=(slow, 0.0), points={"eye": (0.0, LENGTH)},
    )  # fmt: skip
    scene = fm.Scene("carried", [
        cart, bar, fm.Prismatic("guide", cart), fm.Revolute("pin", bar.point("eye"), cart),
        fm.Gravity("gravity", acceleration={"y": -G}),
        fm.DrivenSlide("drive", cart, **{drive: speed if drive == "speed" else way}),
    ])  # fmt: skip
    sol = fm.simulate(scene, t_end=END, rtol=1e-9, method=method)
    (before, behind) = np.flatnonzero(sol.t == JUMP)
    angle, turns = sol["bar.angle"][behind], sol.velocity("bar.angle")
    kick = -MASS * LENGTH * np.cos(angle) * (fast - slow) / (J + MASS * LENGTH**2)
    np.testing.assert_allclose(turns[behind] - turns[before], kick, rtol=1e-9)

    def rates(t, y):
        return [y[1], -MASS * G * LENGTH * np.sin(y[0]) / (J + MASS * LENGTH**2)]

    swing = solve_ivp(rates, (0.0, JUMP), [0.8, 0.0], method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    swing[1] -= MASS * LENGTH * np.cos(swing[0]) * (fast - slow) / (J + MASS * LENGTH**2)
    swing = solve_ivp(rates, (JUMP, END), swing, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    np.testing.assert_allclose([sol["bar.angle"][-1], turns[-1]], swing, atol=1e-6)
    assert np.abs(sol.energy.residual).max() < 1e-7
    assert not any("ledger" in note for note in sol.stats.notes)
    audit = sol.audit()
    assert audit.ok, str(audit)


def test_friction_of_joints_has_no_part_in_an_impulse():
    """It is not computed, and the run says so; without friction there is nothing to say."""
    speed = sympy.Piecewise((1.0, fm.t < 0.5), (2.0, True))
    rod = fm.RigidBody("rod", mass=MASS, inertia=J, position=(0.0, -LENGTH), points={"eye": (0.0, LENGTH)})
    for friction, notes in ((None, 0), (fm.laws.Coulomb(mu_s=0.2), 1)):
        pin = fm.Revolute("pin", rod.point("eye"), friction=friction, radius=0.05)
        drive = fm.DrivenAngle("drive", rod, speed=speed)
        sol = fm.simulate(fm.Scene("turned", [rod, pin, drive]), t_end=1.0, rtol=1e-8)
        found = [note for note in sol.stats.notes if "velocities jump at t = 0.5" in note]
        assert len(found) == notes
        assert np.abs(sol.energy.residual).max() < 1e-8
