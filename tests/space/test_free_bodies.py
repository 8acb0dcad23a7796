"""Bodies that no joint holds, tops, and what declarations refuse."""

import pickle
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm

sys.path.insert(0, str(Path(__file__).parent))
from cases import DOWN, case, heavy_top, top, vector

SPACE = fm.space


@pytest.mark.parametrize(
    ("method", "rtol", "error"), [("radau", 1e-8, 1e-7), ("radau", 1e-10, 1e-9), ("bdf", 1e-8, 1e-6)]
)
def test_asymmetric_body_tumbles_as_jacobi_says(method, rtol, error):
    """A flat body: its third axis has no mass of its own."""
    p, found = case("free_asymmetric_body")
    body = SPACE.RigidBody("book", mass=1.0, inertia=p["J"], angular_velocity=p["omega0_body"])
    sol = fm.simulate(fm.Scene("tumbling", [body]), t_end=p["t"], rtol=rtol, method=method)
    R = sol["book.rotation"][:, :, -1]
    np.testing.assert_allclose(R.ravel(), found["R_rows"], atol=error)
    np.testing.assert_allclose(R.T @ sol["book.omega"][:, -1], found["omega_body"], atol=error)
    everywhere = sol["book.rotation"]
    np.testing.assert_allclose(
        np.einsum("ijt,ikt->jkt", everywhere, everywhere), np.eye(3)[:, :, None] * np.ones(sol.t.size), atol=2e-15
    )
    assert sol.audit().ok


@pytest.mark.parametrize(
    ("method", "rtol", "error"), [("radau", 1e-8, 1e-9), ("radau", 1e-10, 1e-11), ("bdf", 1e-8, 1e-8)]
)
def test_heavy_top_with_cusps(method, rtol, error):
    _, found = case("heavy_top_cusps")
    sol = fm.simulate(heavy_top(), t_end=1.0, rtol=rtol, method=method)
    np.testing.assert_allclose(sol["top.axis"][:, -1], found["axis_n"], atol=error)
    np.testing.assert_allclose((sol["top.axis"] ** 2).sum(axis=0), 1.0, atol=1e-15)
    np.testing.assert_allclose([sol[f"top.tip.{c}"] for c in "xyz"], 0.0, atol=1e-15)
    assert np.abs(sol.energy.residual).max() < 1e-8 * sol.energy.kinetic[0]
    # spin: what the angle of a quasi-coordinate adds up to is certified, too
    assert sol["top.spin"][-1] == pytest.approx(120.0, rel=1e-12)
    assert sol.audit().ok


def test_one_body_in_both_types():
    """A body of revolution, once as a rotor, once by its three axes, under a torque and a spring off its centre."""

    def parts(body, eye):
        pull = fm.PointSpring("pull", eye, SPACE.ground_point(0.3, -0.2, 0.9), stiffness=40.0, length=0.2)
        return [body, pull, SPACE.Torque("motor", body, axis=(1.0, 2.0, -1.0), value=0.3), DOWN]

    omega = np.array([0.4, -0.7, 5.0])
    given = {"mass": 1.3, "velocity": (0.1, 0.2, 0.0)}
    rotor = SPACE.Rotor(
        "body", inertia_across=0.05, inertia_axial=0.08, angular_velocity=omega, stations={"eye": 0.3}, **given
    )
    solid = SPACE.RigidBody(
        "body", inertia=(0.05, 0.05, 0.08), angular_velocity=omega, points={"eye": (0.0, 0.0, 0.3)}, **given
    )
    one, two = (
        fm.simulate(fm.Scene("turning", parts(body, eye)), t_end=1.5, rtol=1e-9)
        for body, eye in ((rotor, rotor.station("eye")), (solid, solid.point("eye")))
    )
    np.testing.assert_allclose(one["body.omega"][:, -1], two["body.omega"][:, -1], atol=2e-7)
    np.testing.assert_allclose(vector(one, "body.eye"), vector(two, "body.eye"), atol=2e-8)
    np.testing.assert_allclose(one["body.axis"][:, -1], two["body.rotation"][:, 2, -1], atol=2e-8)
    for sol in (one, two):
        assert np.abs(sol.energy.residual).max() < 1e-7
        assert sol.audit().ok


def test_torque_and_spring_against_euler_equations():
    """Euler's equations with a quaternion, written down here."""
    J, m, k, rest = np.diag([0.03, 0.05, 0.06]), 1.2, 30.0, 0.1
    eye, hook, tau = np.array([0.2, -0.1, 0.15]), np.array([0.5, 0.4, 1.0]), np.array([0.1, -0.05, 0.2])
    R0 = np.array(SPACE.turned(axis=(1.0, -1.0, 0.5), angle=0.8))
    omega0 = np.array([1.0, 2.0, -1.5])

    def rotation(p):
        e0, e = p[0], p[1:]
        K = np.array([[0, -e[2], e[1]], [e[2], 0, -e[0]], [-e[1], e[0], 0]])
        return np.eye(3) + 2 * e0 * K + 2 * K @ K

    def rates(t, y):
        r, v, p, w = y[:3], y[3:6], y[6:10], y[10:]  # w in the axes of the body
        R = R0 @ rotation(p / np.linalg.norm(p))
        arm = R @ eye
        d = hook - r - arm
        force = k * (1 - rest / np.linalg.norm(d)) * d
        torque = R.T @ (np.cross(arm, force) + tau)
        turn = 0.5 * np.concatenate([[-p[1:] @ w], p[0] * w + np.cross(p[1:], w)])
        return np.concatenate([v, force / m + [0, 0, -9.81], turn, np.linalg.solve(J, torque - np.cross(w, J @ w))])

    start = np.concatenate([np.zeros(6), [1, 0, 0, 0], R0.T @ omega0])
    exact = solve_ivp(rates, (0, 2.0), start, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    body = SPACE.RigidBody(
        "body", mass=m, inertia=np.diag(J), orientation=R0, angular_velocity=omega0, points={"eye": eye}
    )
    size = float(np.linalg.norm(tau))
    parts = [
        body, fm.PointSpring("spring", body.point("eye"), SPACE.ground_point(*hook), stiffness=k, length=rest),
        SPACE.Torque("motor", body, axis=tau, value=size), DOWN,
    ]  # fmt: skip
    sol = fm.simulate(fm.Scene("pulled", parts), t_end=2.0, rtol=1e-10)
    R = sol["body.rotation"][:, :, -1]
    np.testing.assert_allclose(vector(sol, "body"), exact[:3], atol=1e-8)
    np.testing.assert_allclose(R.T @ sol["body.omega"][:, -1], exact[10:], atol=1e-7)
    np.testing.assert_allclose(R, R0 @ rotation(exact[6:10] / np.linalg.norm(exact[6:10])), atol=1e-8)


@pytest.mark.slow
def test_energy_and_angular_momentum_over_ten_thousand_turns():
    omega = np.array([0.3, 0.4, 6.2])
    wheel = SPACE.Rotor("wheel", mass=1.0, inertia_across=0.6, inertia_axial=1.0, angular_velocity=omega)
    sol = fm.simulate(fm.Scene("free", [wheel]), t_end=1e4, rtol=1e-10)
    n, n_dot, s_dot = (
        sol["wheel.axis"],
        np.array([sol.velocity(f"wheel.axis_{c}") for c in "xyz"]),
        sol.velocity("wheel.spin"),
    )
    L = 0.6 * np.cross(n, n_dot, axis=0) + s_dot * n
    assert np.abs(L - L[:, :1]).max() < 1e-7 * np.linalg.norm(L[:, 0])
    # written down here: that of the run adds up losses over all rows, which takes longer than the run
    moves = sum(sol.velocity(f"wheel.{c}") ** 2 for c in "xyz")
    kinetic = 0.5 * (moves + 0.6 * (n_dot**2).sum(axis=0) + s_dot**2)
    assert kinetic[0] == pytest.approx(0.5 * (0.6 * 0.25 + 6.2**2), rel=1e-12)
    assert np.ptp(kinetic) < 1e-8 * kinetic[0]


def test_a_ball_keeps_what_it_has():
    ball = SPACE.Ball("ball", mass=0.17, radius=0.03, velocity=(1, 2, 3), angular_velocity=(0, 5, 0))
    sol = fm.simulate(fm.Scene("thrown", [ball, DOWN]), t_end=1.0)
    np.testing.assert_allclose(vector(sol, "ball"), (1.0, 2.0, 3.0 - 9.81 / 2), rtol=1e-12)
    assert sol["ball.turn_y"][-1] == pytest.approx(5.0)
    assert sol.energy.kinetic[0] == pytest.approx(0.5 * 0.17 * 14 + 0.5 * 0.4 * 0.17 * 0.03**2 * 25)
    sol = fm.simulate(fm.Scene("turned", [ball, SPACE.Torque("t", ball, axis=(0, 3, 4), value=1e-4)]), t_end=1.0)
    J = 0.4 * 0.17 * 0.03**2
    np.testing.assert_allclose(sol["ball.omega"][:, -1], (0.0, 5.0 + 6e-5 / J, 8e-5 / J), rtol=1e-9)


def test_results_are_kept_in_files_and_pickles(tmp_path):
    sol = fm.simulate(heavy_top(), t_end=0.1)
    sol.save(tmp_path / "top.npz")
    for other in (fm.Solution.load(tmp_path / "top.npz"), pickle.loads(pickle.dumps(sol))):
        np.testing.assert_array_equal(other["top.omega"], sol["top.omega"])
        np.testing.assert_array_equal(other.at([0.05])["top.axis"], sol.at([0.05])["top.axis"])
    assert fm.Solution.load(tmp_path / "top.npz").scene == sol.scene


def test_equations_show_inner_constraints_and_gyroscopic_forces():
    equations = heavy_top().equations()
    assert [c.name for c in equations.constraints] == ["top", "tip"]
    assert "C_top" in str(equations)
    # M a - rhs from the symbols, at one state of a run, with its reactions
    sol = fm.simulate(heavy_top(), t_end=0.3, rtol=1e-11)
    t, h = 0.2, 1e-4
    seen = sol.at([t - h, t, t + h])
    M, rhs = equations.with_numbers()
    system = sol.run.pieces[0].mechanics.reactions(sol.at([t]).record.samples)
    numbers = {s: x for c in equations.constraints for s, x in zip(c.multipliers, system[c.name][:, 0], strict=True)}
    numbers |= dict(zip(equations.q, seen.q[:, 1], strict=True)) | dict(zip(equations.v, seen.v[:, 1], strict=True))
    forces = np.array(rhs.subs(numbers), dtype=float).ravel()
    a = (seen.v[:, 2] - seen.v[:, 0]) / (2 * h)
    np.testing.assert_allclose(np.array(M, dtype=float) @ a, forces, atol=1e-4 * np.abs(forces).max())


def test_what_cannot_be_is_refused():
    body = SPACE.RigidBody("rod", mass=1.0, inertia=(1, 1, 1), points={"end": (0, 0, 1)})
    round_one = {"mass": 1.0, "inertia_across": 1.0, "inertia_axial": 1.0}
    wheel = SPACE.Rotor("wheel", **round_one)
    refused = [
        (lambda: fm.Scene("s", [body, fm.Gravity("g")]), "acceleration has to be given"),
        (lambda: fm.Revolute("pin", body), "take the joints of fm.space"),
        (lambda: fm.Rod("rod", fm.RigidBody("a", mass=1, inertia=1), SPACE.ground_point(0, 0, 1), length=1), "plane"),
        (lambda: fm.TorsionSpring("k", wheel, stiffness=1.0), "of the plane"),
        (lambda: SPACE.Revolute("pin", wheel, axis=(1, 0, 0)), "must be that of the Rotor 'wheel'"),
        (lambda: SPACE.Fixed("weld", wheel, body), "must be that of the Rotor"),
        (lambda: SPACE.Spherical("ball", body, fm.ground_point(0, 0)), "fm.space.ground_point"),
        (lambda: SPACE.Universal("u", body, axis_a=(1, 0, 0), axis_b=(1, 1, 0)), "right angles"),
        (lambda: SPACE.RigidBody("b", mass=1, inertia=(1, 1, 3)), "above the other two together"),
        (lambda: SPACE.RigidBody("b", mass=1, inertia=(1, 1, 1), orientation=np.ones((3, 3))), "a rotation matrix"),
        (lambda: SPACE.RigidBody("b", mass=1, inertia=(1, 1, 1), points={"omega": (0, 0, 0)}), "'omega'"),
        (lambda: SPACE.Rotor("r", **round_one, axis=(0, 0, 0)), "not all 0"),
        (lambda: SPACE.Rotor("r", **round_one, spin=1, angular_velocity=(0, 0, 1)), "not both"),
        (lambda: SPACE.Ball("b", mass=1, radius=0), "radius must be a finite number > 0"),
        (lambda: SPACE.Torque("t", body, axis=(0, 0, 1), value=fm.t), "value must be a finite number"),
        (lambda: SPACE.turned(axis=(0, 0, 1), angle=np.inf), "angle must be a finite number"),
    ]  # fmt: skip
    for make, words in refused:
        with pytest.raises(fm.FricmbError, match=words):
            make()


def test_what_a_run_does_not_know_is_said():
    sol = fm.simulate(heavy_top(), t_end=0.01)
    with pytest.raises(fm.FricmbError, match="unknown joint 'top'"):
        sol.reaction("top")
    with pytest.raises(fm.FricmbError, match="no coordinate whose rate"):
        sol.velocity("top.omega")
    assert "heavy top" in sol._repr_html_()
    assert "heavy top" in sol.scene._repr_html_()


def test_points_are_motions():
    body = top()
    pull = fm.Force("pull", body.station("tip"), axis="x", value=-2.0 * fm.coordinate("top.tip.x"))
    sol = fm.simulate(fm.Scene("s", [body, pull, DOWN]), t_end=0.2, rtol=1e-9)
    spring = fm.Spring("pull", body.station("tip"), stiffness=2.0, axis="x")
    other = fm.simulate(fm.Scene("s", [body, spring, DOWN]), t_end=0.2, rtol=1e-9)
    assert sol["top.tip.x"][-1] == pytest.approx(other["top.tip.x"][-1], rel=1e-9)
    assert sol.at([0.1])["top.axis"].shape == (3, 1)
