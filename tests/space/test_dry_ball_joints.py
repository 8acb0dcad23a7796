"""Dry ball joints: a cone in three directions; closed forms, a program with quaternions, and stops."""

import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm

sys.path.insert(0, str(Path(__file__).parent))
from cases import DOWN, case

SPACE, G = fm.space, 9.81


def dry(mu, **options):
    return {"radius": 0.02, "friction": fm.laws.Coulomb(mu_s=mu, **options)}


@pytest.mark.parametrize("kind", ["ball", "body", "rotor"])
@pytest.mark.parametrize("first", [True, False])
def test_what_spins_about_its_centre_stops_as_its_inertia_says(kind, first):
    """All moments alike: the torque keeps its direction, the angular velocity falls evenly."""
    omega, J, m, mu = np.array([3.0, -2.0, 6.0]), 0.05, 2.0, 0.3
    made = {
        "ball": lambda: SPACE.Ball("it", mass=m, radius=0.1, inertia=J, angular_velocity=omega),
        "body": lambda: SPACE.RigidBody("it", mass=m, inertia=(J, J, J), angular_velocity=omega),
        "rotor": lambda: SPACE.Rotor("it", mass=m, inertia_across=J, inertia_axial=J, angular_velocity=omega),
    }
    body = made[kind]()
    ends = (body, fm.GROUND) if first else (fm.GROUND, body)
    joint = SPACE.Spherical("joint", *ends, **dry(mu))
    sol = fm.simulate(fm.Scene("spinning", [body, joint, DOWN]), t_end=5.0, rtol=1e-8)
    stop = J * np.linalg.norm(omega) / (mu * 0.02 * m * G)
    (event,) = sol.events
    error = {"ball": 1e-12, "rotor": 1e-8, "body": 1e-8}[kind]
    assert (event.kind, event.t) == ("stick", pytest.approx(stop, rel=error))
    t = np.array([0.3, 0.9]) * stop
    seen = sol.at(t)
    np.testing.assert_allclose(seen["it.omega"], np.outer(omega, 1 - t / stop), rtol=1e-7)
    sense = 1.0 if first else -1.0
    torque = 0.02 * seen.force("joint")
    np.testing.assert_allclose(torque, -sense * np.outer(omega, [1, 1]) * J / stop, rtol=1e-6)
    np.testing.assert_allclose(seen.normal_force("joint"), m * G, rtol=1e-9)
    assert sol.audit().ok


@cache
def reference(mu, t):
    """Euler's equations about the joint with a quaternion; the reaction and its torque by iteration."""
    p, _ = case("spatial_pendulum_ball_joint")
    m, arm, J = p["mass"], np.array(p["com_from_joint"]), np.array(p["J_com"])
    J_joint = np.diag(J) + m * (arm @ arm * np.eye(3) - np.outer(arm, arm))

    def rotation(e):
        K = np.array([[0, -e[3], e[2]], [e[3], 0, -e[1]], [-e[2], e[1], 0]])
        return np.eye(3) + 2 * e[0] * K + 2 * K @ K

    def rates(t, y):
        e, w = y[:4] / np.linalg.norm(y[:4]), y[4:]
        down = rotation(e).T @ np.array([0, 0, -G])
        own = np.cross(arm, m * down) - np.cross(w, J_joint @ w)
        load, turn = m * G, w / np.linalg.norm(w)
        for _ in range(9):  # each leaves a hundredth of the error
            a = np.linalg.solve(J_joint, own - mu * 0.02 * load * turn)
            load = np.linalg.norm(m * (np.cross(a, arm) + np.cross(w, np.cross(w, arm)) - down))
        return np.concatenate([0.5 * np.concatenate([[-e[1:] @ w], e[0] * w + np.cross(e[1:], w)]), a])

    start = np.concatenate([[1, 0, 0, 0], p["omega0_body"]])
    y = solve_ivp(rates, (0, t), start, method="DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
    return rotation(y[:4] / np.linalg.norm(y[:4])), y[4:]


def pendulum(mu, **options):
    p, _ = case("spatial_pendulum_ball_joint")
    arm, omega = np.array(p["com_from_joint"]), np.array(p["omega0_body"], dtype=float)
    body = SPACE.RigidBody(
        "bob", mass=p["mass"], inertia=p["J_com"], position=arm, velocity=np.cross(omega, arm),
        angular_velocity=omega, points={"joint": tuple(-arm)},
    )  # fmt: skip
    return fm.Scene("pendulum", [body, SPACE.Spherical("hook", body.point("joint"), **dry(mu, **options)), DOWN])


@pytest.mark.parametrize(("method", "rtol", "error"), [("radau", 1e-6, 1e-6), ("radau", 1e-9, 1e-8)])
def test_dry_pendulum_against_quaternions(method, rtol, error):
    sol = fm.simulate(pendulum(0.3), t_end=2.0, rtol=rtol, method=method)
    R, omega = reference(0.3, 2.0)
    np.testing.assert_allclose(sol["bob.rotation"][:, :, -1], R, atol=error)
    np.testing.assert_allclose(R.T @ sol["bob.omega"][:, -1], omega, atol=10 * error)
    assert np.abs(sol.energy.residual).max() < 1e-8
    np.testing.assert_allclose(np.linalg.norm(sol.force("hook"), axis=0), 0.3 * sol.normal_force("hook"), rtol=1e-9)
    assert sol.audit().ok


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_dry_pendulum_comes_to_rest_out_of_plumb(method):
    """It swings in all directions, loses, and stays where friction bears what gravity turns; runs agree on when."""
    sol = fm.simulate(pendulum(1.6), t_end=4.0, rtol=1e-8, method=method)
    finer = fm.simulate(pendulum(1.6), t_end=4.0, rtol=1e-11)
    assert [e.kind for e in sol.events] == [e.kind for e in finer.events]
    assert sol.events[-1].kind == "stick"
    np.testing.assert_allclose([e.t for e in sol.events], [e.t for e in finer.events], atol=1e-5)
    arm = sol["bob.rotation"][:, :, -1] @ case("spatial_pendulum_ball_joint")[0]["com_from_joint"]
    held = np.cross(arm, [0.0, 0.0, -2.0 * G])  # what friction has to bear
    np.testing.assert_allclose(0.02 * sol.force("hook")[:, -1], -held, atol=1e-8)
    assert 1e-3 < np.linalg.norm(held) < 1.6 * 0.02 * 2.0 * G
    np.testing.assert_allclose(sol["bob.omega"][:, -1], 0.0, atol=1e-12)
    assert np.abs(sol.energy.residual).max() < 1e-7


def test_more_friction_at_rest_than_in_slip_holds_until_it_is_overcome():
    """A leaning arm on a dry ball, pushed sideways harder and harder: it breaks away where statics say."""
    lean, m, reach, push = 0.02, 2.0, 0.4, 0.3
    arm = SPACE.RigidBody(
        "arm", mass=m, inertia=(0.03, 0.03, 0.01), position=(reach * np.sin(lean), 0, -reach * np.cos(lean)),
        orientation=SPACE.turned(axis=(0, 1, 0), angle=-lean), points={"top": (0, 0, reach)},
    )  # fmt: skip
    joint = SPACE.Spherical("joint", arm.point("top"), **dry(0.7, mu_k=0.5))
    side = fm.Force("push", arm, axis="y", value=push * fm.t)
    sol = fm.simulate(fm.Scene("pushed", [arm, joint, side, DOWN]), t_end=2.0, rtol=1e-9)
    low, off = reach * np.cos(lean), reach * np.sin(lean)

    def spare(t):
        F = np.array([0.0, push * t, -m * G])
        return 0.7 * 0.02 * np.linalg.norm(F) - np.linalg.norm(np.cross((off, 0.0, -low), F))

    from scipy.optimize import brentq

    assert sol.events[0].kind == "slip"
    assert sol.events[0].t == pytest.approx(brentq(spare, 0.0, 2.0, xtol=1e-14), rel=1e-9)
    assert sol.audit().ok


def test_what_a_dry_ball_does_not_take():
    body = SPACE.RigidBody("box", mass=1.0, inertia=(1, 1, 1))
    with pytest.raises(fm.FricmbError, match="radius must be"):
        SPACE.Spherical("j", body, friction=fm.laws.Coulomb(mu_s=0.1))
    for law in (fm.laws.Contensou.example(), fm.laws.LuGre.example(), fm.laws.Elliptic.example()):
        with pytest.raises(fm.FricmbError, match="law that sticks, with a cone in 3 directions"):
            SPACE.Spherical("j", body, radius=0.1, friction=law)
    flat = fm.Body("pad", mass=1.0, axes="xyz")
    with pytest.raises(fm.FricmbError, match="where there is friction"):
        SPACE.Spherical("j", body, flat, **dry(0.1))
