"""Joints in space against certified digits, programs written down here, and one another."""

import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm

sys.path.insert(0, str(Path(__file__).parent))
from cases import DOWN, case, pendulum, slider_crank, vector, wheel_on_an_arm

SPACE = fm.space


@pytest.mark.parametrize(
    ("method", "rtol", "error"), [("radau", 1e-8, 1e-8), ("radau", 1e-10, 1e-10), ("bdf", 1e-8, 1e-7)]
)
def test_pendulum_on_a_ball_joint(method, rtol, error):
    _, found = case("spatial_pendulum_ball_joint")
    sol = fm.simulate(pendulum(), t_end=2.0, rtol=rtol, method=method)
    np.testing.assert_allclose(vector(sol, "bob"), found["com_at_2"], atol=error)
    omega = sol["bob.rotation"][:, :, -1].T @ sol["bob.omega"][:, -1]
    np.testing.assert_allclose(omega, found["omega_body_at_2"], atol=10 * error)
    np.testing.assert_allclose(vector(sol.at([1.0]), "bob"), found["com_at_1"], atol=error)
    np.testing.assert_allclose([sol[f"bob.joint.{c}"] for c in "xyz"], 0.0, atol=2e-15)
    # the reaction is what the centre of mass needs beside its weight
    t, h = 1.3, 1e-3
    near = np.array([[sol.velocity(f"bob.{c}") for c in "xyz"] for sol in [sol.at(t + h * np.array([-2, -1, 1, 2]))]])[
        0
    ]
    a = (near @ [1, -8, 8, -1]) / (12 * h)
    np.testing.assert_allclose(sol.at([t]).reaction("hook")[:, 0], 2.0 * (a + np.array([0, 0, 9.81])), atol=1e-6)
    assert sol.audit().ok


@pytest.mark.parametrize(("rtol", "error"), [(1e-8, 1e-7), (1e-10, 1e-9)])
def test_slider_crank_in_space(rtol, error):
    _, found = case("spatial_slider_crank")
    sol = fm.simulate(slider_crank(), t_end=5.0, rtol=rtol)
    for time in (1, 5):
        seen = sol.at([float(time)])
        angle = float(found[f"crank_angle_at_{time}"])
        np.testing.assert_allclose(seen["crank.rotation"][:, 2, 0], (0.0, -np.sin(angle), np.cos(angle)), atol=error)
        assert seen["crank.omega"][0, 0] == pytest.approx(float(found[f"crank_rate_at_{time}"]), abs=10 * error)
        assert seen["slider.x"][0] == pytest.approx(float(found[f"slider_x_at_{time}"]), abs=error)
    for c in "xyz":
        np.testing.assert_allclose(sol[f"rod.top.{c}"], sol[f"crank.tip.{c}"], atol=2e-15)
    assert sol.audit().ok


def inclined(kind, **options):
    """A body of three different moments on an axis that leans, off its centre of mass."""
    e = np.array([0.0, np.sin(0.5), np.cos(0.5)])
    R = SPACE.turned(axis=(0.3, -1.0, 0.2), angle=0.7)
    arm = np.array([0.2, -0.1, 0.05])
    body = SPACE.RigidBody(
        "arm", mass=1.5, inertia=(0.02, 0.03, 0.04), orientation=R, position=np.array(R) @ arm,
        points={"eye": tuple(-arm)},
    )  # fmt: skip
    return e, np.array(R), arm, fm.Scene("leaning", [body, kind("joint", body.point("eye"), axis=e, **options), DOWN])


def inertia_about(e, R, arm):
    """About the axis through the point of the joint, and how far off it the centre is."""
    c = R @ arm
    J = R @ np.diag([0.02, 0.03, 0.04]) @ R.T
    return float(e @ J @ e + 1.5 * (c @ c - (e @ c) ** 2)), c


def turned_about(e, angle):
    return np.array(SPACE.turned(axis=e, angle=angle))


def test_hinge_is_a_physical_pendulum():
    e, R, arm, scene = inclined(SPACE.Revolute)
    J, c = inertia_about(e, R, arm)

    def rates(t, y):
        pull = np.cross(turned_about(e, y[0]) @ c, (0.0, 0.0, -1.5 * 9.81))
        return [y[1], e @ pull / J]

    exact = solve_ivp(rates, (0, 3), [0, 0], method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    sol = fm.simulate(scene, t_end=3.0, rtol=1e-10)
    np.testing.assert_allclose(sol["arm.rotation"][:, :, -1], turned_about(e, exact[0]) @ R, atol=1e-8)
    np.testing.assert_allclose(sol["arm.omega"][:, -1], exact[1] * e, atol=1e-8)
    # the torques of the reaction: what the angular momentum about the joint needs beside the weight's
    t, h = 2.0, 1e-3
    seen = sol.at(t + h * np.array([-2, -1, 0, 1, 2]))
    turn = seen["arm.rotation"]
    J_point = np.diag([0.02, 0.03, 0.04]) + 1.5 * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    L = np.einsum("ijt,jk,lkt,lt->it", turn, J_point, turn, seen["arm.omega"])
    need = L @ [1, -8, 0, 8, -1] / (12 * h) - np.cross(turn[:, :, 2] @ arm, (0, 0, -1.5 * 9.81))
    from fricmb.space._turn import triad

    u, w = triad(e)
    torque = seen.reaction("joint")[3:, 2]
    np.testing.assert_allclose(torque, [need @ u, need @ w], atol=1e-6)
    assert abs(need @ e) < 1e-6
    assert sol.audit().ok


def test_sleeve_slides_and_swings():
    e, R, arm, scene = inclined(SPACE.Cylindrical)
    J, c = inertia_about(e, R, arm)
    sol = fm.simulate(scene, t_end=1.0, rtol=1e-10)

    def rates(t, y):
        pull = np.cross(turned_about(e, y[0]) @ c, (0.0, 0.0, -1.5 * 9.81))
        return [y[1], e @ pull / J]

    angle, _ = solve_ivp(rates, (0, 1), [0, 0], method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    slid = -0.5 * 9.81 * e[2]
    np.testing.assert_allclose(vector(sol, "arm.eye"), slid * e, atol=1e-9)
    np.testing.assert_allclose(sol["arm.rotation"][:, :, -1], turned_about(e, angle) @ R, atol=1e-8)
    assert sol.audit().ok


def test_guide_lets_slide_alone():
    e, R, arm, scene = inclined(SPACE.Prismatic)
    sol = fm.simulate(scene, t_end=1.0, rtol=1e-9)
    np.testing.assert_allclose(vector(sol, "arm.eye"), -0.5 * 9.81 * e[2] * e, atol=1e-9)
    np.testing.assert_allclose(sol["arm.rotation"][:, :, -1], R, atol=1e-13)
    from fricmb.space._turn import triad

    u, w = triad(e)
    weight = np.array([0.0, 0.0, -1.5 * 9.81])
    force, torque = sol.reaction("joint")[:2, -1], sol.reaction("joint")[2:, -1]
    np.testing.assert_allclose(force, [-weight @ u, -weight @ w], atol=1e-9)
    # about the centre of mass: the force at the eye and the torque balance
    lever = np.cross(-(R @ arm), force[0] * u + force[1] * w)
    np.testing.assert_allclose(torque, [-lever @ u, -lever @ w, -lever @ e], atol=1e-9)


def test_two_welded_bodies_are_one():
    """A dumb-bell of two welded halves, against the one body that it is."""
    halves = [
        SPACE.RigidBody(
            name, mass=1.0, inertia=(0.02, 0.03, 0.04), position=(x, 0, 0),
            velocity=np.cross((1.0, 3.0, 2.0), (x, 0, 0)),
            angular_velocity=(1.0, 3.0, 2.0), points={"inner": (-x, 0, 0)},
        )
        for name, x in (("left", -0.2), ("right", 0.2))
    ]  # fmt: skip
    weld = SPACE.Fixed("weld", halves[0].point("inner"), halves[1].point("inner"))
    whole = SPACE.RigidBody("whole", mass=2.0, inertia=(0.04, 0.14, 0.16), angular_velocity=(1.0, 3.0, 2.0))
    sol = fm.simulate(fm.Scene("welded", [*halves, weld]), t_end=5.0, rtol=1e-9)
    one = fm.simulate(fm.Scene("whole", [whole]), t_end=5.0, rtol=1e-9)
    np.testing.assert_allclose(sol["left.rotation"][:, :, -1], one["whole.rotation"][:, :, -1], atol=2e-7)
    np.testing.assert_allclose(sol["right.omega"][:, -1], one["whole.omega"][:, -1], atol=1e-6)
    assert sol.audit().ok


def test_universal_joint_turns_unevenly():
    """Hooke's joint between shafts at an angle: tan(out) = tan(in) / cos(lean) (or times it, by where one starts)."""
    lean = 0.6
    out = np.array([np.cos(lean), np.sin(lean), 0.0])
    driving = SPACE.RigidBody("in", mass=1.0, inertia=(1e3, 1e3, 1e3), angular_velocity=(2.0, 0, 0))
    # pins: of the driving shaft along z, of the driven one in the plane of both shafts
    pin = np.cross(out, (0.0, 0.0, 1.0))
    R = np.column_stack([out, np.array([-np.sin(lean), np.cos(lean), 0.0]), (0.0, 0.0, 1.0)])
    driven = SPACE.RigidBody(
        "out", mass=1.0, inertia=(1e-3, 1e-3, 1e-3), orientation=R, angular_velocity=2.0 * np.cos(lean) * out
    )
    parts = [
        driving, driven, SPACE.Revolute("first", driving, axis=(1, 0, 0)),
        SPACE.Cylindrical("second", driven, axis=out),
        SPACE.Universal("cross", driven, driving, axis_a=pin, axis_b=(0, 0, 1)),
    ]  # fmt: skip
    sol = fm.simulate(fm.Scene("shafts", parts), t_end=2.0, rtol=1e-9)
    assert any("redundant" in note for note in sol.stats.notes)  # three forces of the cross on fixed bearings
    angle = np.unwrap(np.arctan2(sol["in.rotation"][2, 1], sol["in.rotation"][1, 1]))
    R_out = sol["out.rotation"]
    across = R[:, 1]
    turned = np.unwrap(np.arctan2(R_out[2, 1], across @ R_out[:, 1]))
    expected = np.unwrap(np.arctan2(np.sin(angle) * np.cos(lean), np.cos(angle)))
    np.testing.assert_allclose(turned, expected, atol=1e-5)


def test_rod_is_a_spherical_pendulum():
    ball = SPACE.Ball(
        "bob", mass=1.0, radius=0.01, position=(0.6, 0, -0.8), velocity=(0, 1.1, 0), angular_velocity=(0, 0, 7)
    )
    sol = fm.simulate(fm.Scene("pendulum", [ball, SPACE.Rod("thread", ball, length=1.0), DOWN]), t_end=3.0, rtol=1e-10)

    def rates(t, y):
        r, v = y[:3], y[3:]
        pull = -(v @ v) + 9.81 * r[2]
        return np.concatenate([v, np.array([0, 0, -9.81]) + pull * r])

    exact = solve_ivp(rates, (0, 3), [0.6, 0, -0.8, 0, 1.1, 0], method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    np.testing.assert_allclose(vector(sol, "bob"), exact[:3], atol=1e-8)
    assert sol["bob.omega"][2, -1] == pytest.approx(7.0)
    assert sol.reaction("thread")[0].max() < 0.0  # it pulls


def test_rotor_on_either_end_of_a_hinge():
    """A wheel in a swinging arm: declared as wheel on arm, and as arm on wheel; the torques only change sign."""

    def scene(first):
        arm, wheel, hook = wheel_on_an_arm()
        ends = (wheel, arm.point("hub")) if first else (arm.point("hub"), wheel)
        return fm.Scene("gyroscope", [arm, wheel, hook, SPACE.Revolute("axle", *ends, axis=(0, 1, 0)), DOWN])

    one, two = (fm.simulate(scene(first), t_end=0.5, rtol=1e-9) for first in (True, False))
    np.testing.assert_allclose(one["wheel.axis"][:, -1], two["wheel.axis"][:, -1], atol=1e-9)
    t = np.linspace(0.1, 0.4, 5)
    np.testing.assert_allclose(one.at(t).reaction("axle"), -two.at(t).reaction("axle"), atol=1e-6)
    np.testing.assert_allclose([one[f"wheel.{c}"] for c in "xyz"], [one[f"arm.hub.{c}"] for c in "xyz"], atol=2e-15)
    assert one.audit().ok
    assert np.ptp(one.velocity("wheel.spin")) < 1e-6  # nothing turns it about its axis


def test_a_chain_costs_as_much_a_link_whatever_its_length():
    """Bands: the matrices of a chain keep their width."""
    from fricmb.integrate.implicit.scene.problem_structs import mech_of
    from fricmb.system import build

    def chain(n):
        links = [
            SPACE.RigidBody(
                f"l{i}",
                mass=1.0,
                inertia=(0.1, 0.1, 0.02),
                position=(0, 0, -i - 0.5),
                points={"top": (0, 0, 0.5), "low": (0, 0, -0.5)},
            )
            for i in range(n)
        ]
        ends = [SPACE.ground_point(0, 0, 0), *(link.point("low") for link in links)]
        joints = [
            SPACE.Spherical(f"j{i}", link.point("top"), end)
            for i, (link, end) in enumerate(zip(links, ends, strict=False))
        ]
        return fm.Scene("chain", [*links, *joints, DOWN])

    widths = [int(mech_of(build(chain(n)).problem).order.sizes[1]) for n in (10, 40)]
    assert widths[1] <= widths[0]
