"""A ball in a tube: certified digits, sliding against a program of vectors, and contact that is lost."""

import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm

sys.path.insert(0, str(Path(__file__).parent))
from cases import DOWN, case, vector

SPACE, G = fm.space, 9.81


def tube(*, mu, axis=(0, 0, 1), spin=None, **options):
    p, found = case("ball_in_cylinder")
    own, off = p["ball_radius"], p["cylinder_radius"] - p["ball_radius"]
    v = np.array([0.0, off * p["phi_rate"], p["z_rate0"]])
    rolling = np.array([p["spin_about_radius0"], v[2] / own, -v[1] / own])
    turned = np.array(SPACE.turned(axis=np.cross((0, 0, 1), axis), angle=np.pi / 2)) if axis != (0, 0, 1) else np.eye(3)
    ball = SPACE.Ball(
        "ball", mass=0.05, radius=own, position=turned @ (off, 0, 0), velocity=turned @ v,
        angular_velocity=turned @ (rolling if spin is None else np.array(spin)),
    )  # fmt: skip
    wall = SPACE.InCylinder(
        "tube", ball, axis=axis, radius=p["cylinder_radius"], push_only=True, friction=fm.laws.Coulomb(mu_s=mu),
        **options,
    )  # fmt: skip
    return p, found, fm.Scene("tube", [ball, wall, DOWN])


@pytest.mark.parametrize(("rtol", "error"), [(1e-6, 1e-8), (1e-8, 1e-9), (1e-10, 1e-11)])
def test_it_rolls_up_again(rtol, error):
    p, found, scene = tube(mu=2.0)
    sol = fm.simulate(scene, t_end=p["t"], rtol=rtol)
    assert sol["ball.z"][-1] == pytest.approx(float(found["z"]), abs=error)
    fine = sol.at(np.linspace(0, p["t"], 4001))["ball.z"]
    assert fine.min() == pytest.approx(float(found["lowest_z"]), abs=1e-6)
    np.testing.assert_allclose(np.hypot(sol["ball.x"], sol["ball.y"]), 0.13, atol=1e-14)
    assert len(sol.events) == 0
    assert np.abs(sol.energy.residual).max() < 1e-8
    assert sol.audit().ok


def test_it_slides():
    p, _, scene = tube(mu=0.3, spin=(20.0, -30.0, 40.0))
    end = 0.4
    sol = fm.simulate(scene, t_end=end, rtol=1e-9)
    m, own, off, J = 0.05, p["ball_radius"], 0.13, 0.4 * 0.05 * p["ball_radius"] ** 2
    assert (sol.mode("tube") == 1).all()

    def rates(t, y):
        r, v, w = y[:3], y[3:6], y[6:]
        out = np.array([r[0], r[1], 0.0]) / off
        slip = v + np.cross(w, own * out)
        slip -= (slip @ out) * out
        N = m * (v[0] ** 2 + v[1] ** 2) / off
        F = -0.3 * N * slip / np.linalg.norm(slip)
        return np.concatenate([v, (F - N * out) / m - [0, 0, G], np.cross(own * out, F) / J])

    start = np.concatenate([[off, 0, 0], [0, off * p["phi_rate"], p["z_rate0"]], [20.0, -30.0, 40.0]])
    exact = solve_ivp(rates, (0, end), start, method="DOP853", rtol=1e-11, atol=1e-13).y[:, -1]
    there = sol.at([end])
    np.testing.assert_allclose(vector(there, "ball", 0), exact[:3], atol=1e-9)
    np.testing.assert_allclose(there["ball.omega"][:, 0], exact[6:], atol=1e-6)
    assert sol.audit().ok


BRISTLES = {"sigma0": 200.0, "mu_s": 0.3, "mu_k": 0.2, "v_s": 0.1}
BENT = {
    "LuGre": (
        fm.laws.LuGre(sigma1=0.5, sigma2=0.1, **BRISTLES),
        lambda r: 200.0 * r / (0.2 + 0.1 * np.exp(-((r / 0.1) ** 2))), 0.5, 0.1,
    ),
    "Dahl": (fm.laws.Dahl(sigma0=200.0, mu=0.3), lambda r: 200.0 * r / 0.3, 0.0, 0.0),
}  # fmt: skip


@pytest.mark.parametrize("law", BENT)
@pytest.mark.parametrize("rise", [0.1, 1.0])
@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_it_rolls_on_bristles(law, rise, method):
    """Round the wall nothing bends the bristles but round-off at first: they have no size of their own there."""
    friction, torn, damped, viscous = BENT[law]
    sol = fm.simulate(fm.models.ball_in_cylinder(law=friction, rise=rise), t_end=0.5, rtol=1e-8, method=method)
    m, own, off, J = 0.05, 0.02, 0.13, 0.4 * 0.05 * 0.02**2

    def rates(t, y):
        r, v, w, z = y[:3], y[3:6], y[6:9], y[9:]
        out = np.array([r[0], r[1], 0.0]) / off
        around = np.array([-out[1], out[0], 0.0])
        slip = v + np.cross(w, own * out)
        slip = np.array([slip @ around, slip[2]])
        bent = slip - torn(np.linalg.norm(slip)) * z
        N = m * (v[0] ** 2 + v[1] ** 2) / off
        along = -N * (200.0 * z + damped * bent + viscous * slip)
        F = along[0] * around + [0.0, 0.0, along[1]]
        return np.concatenate([v, (F - N * out) / m - [0, 0, G], np.cross(own * out, F) / J, bent])

    speed = off * 9.0
    start = np.concatenate([[off, 0, 0], [0, speed, rise], [0.0, rise / own, -speed / own], [0.0, 0.0]])
    exact = solve_ivp(rates, (0, 0.5), start, method="DOP853", rtol=1e-11, atol=1e-14).y[:, -1]
    there = sol.at([0.5])
    np.testing.assert_allclose(vector(there, "ball", 0), exact[:3], atol=1e-9)
    np.testing.assert_allclose(there["ball.omega"][:, 0], exact[6:9], atol=1e-6)
    assert sol.audit().ok


def test_it_falls_from_the_roof_of_a_level_tube():
    """Round a level tube without friction: contact is lost where v^2/r falls to g cos."""
    _, _, scene = tube(mu=0.0, axis=(0, 1, 0), when_lost="open")
    ball = scene["ball"]
    start, v = (np.array([float(x[c]) for c in "xyz"]) for x in (ball.position, ball.velocity))
    sol = fm.simulate(scene, t_end=0.5, rtol=1e-9)
    event = sol.events[0]
    assert event.kind == "open"
    there = sol.at([event.t])
    height, speed = there["ball.z"][0], np.hypot(there.velocity("ball.x")[0], there.velocity("ball.z")[0])
    across = v[0] ** 2 + v[2] ** 2
    assert speed**2 == pytest.approx(across + 2 * G * (start[2] - height), rel=1e-9)
    assert speed**2 / 0.13 == pytest.approx(G * height / 0.13, rel=1e-7)


def test_what_does_not_fit_is_refused():
    ball, box = SPACE.Ball("b", mass=1.0, radius=0.1), SPACE.RigidBody("box", mass=1.0, inertia=(1, 1, 1))
    for make, words in (
        (lambda: SPACE.InCylinder("t", box, axis=(0, 0, 1), radius=1.0), "a Ball"),
        (lambda: SPACE.InCylinder("t", ball, axis=(0, 0, 1), radius=0.1), "more than that of the ball"),
        (lambda: SPACE.InCylinder("t", ball, box, axis=(0, 0, 1), radius=1.0), "the cylinder is fixed"),
        (lambda: SPACE.InCylinder("t", ball, axis=(0, 0, 0), radius=1.0), "not all 0"),
    ):
        with pytest.raises(fm.FricmbError, match=words):
            make()
