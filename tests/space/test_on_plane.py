"""Rolling and sliding on a plane: certified digits, closed forms, a top that an own program follows."""

import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm

sys.path.insert(0, str(Path(__file__).parent))
from cases import DOWN, case, vector

SPACE, UP = fm.space, (0.0, 0.0, 1.0)
G = 9.81


def coulomb(mu):
    return fm.laws.Coulomb(mu_s=mu)


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_billiard_ball_slides_until_it_rolls(method):
    p, found = case("billiard_ball")
    ball = SPACE.Ball(
        "ball", mass=p["mass"], radius=p["radius"], position=(0, 0, p["radius"]), velocity=(*p["v0"], 0.0),
        angular_velocity=p["omega0"],
    )  # fmt: skip
    cloth = SPACE.OnPlane("cloth", ball, normal=UP, push_only=True, friction=coulomb(p["mu"]))
    sol = fm.simulate(fm.Scene("billiard", [ball, cloth, DOWN]), t_end=1.0, rtol=1e-8, method=method)
    (event,) = sol.events
    assert (event.kind, event.contact) == ("stick", "cloth")
    assert event.t == pytest.approx(float(found["onset_of_rolling"]), abs=1e-12)
    there = sol.at([float(found["onset_of_rolling"])])
    np.testing.assert_allclose(vector(there, "ball")[:2], found["centre_at_onset"], atol=1e-12)
    np.testing.assert_allclose(vector(sol, "ball")[:2], found["centre_at_1"], atol=1e-12)
    np.testing.assert_allclose(sol["ball.omega"][:, -1], found["omega_rolling"], atol=1e-11)
    np.testing.assert_allclose(sol.normal_force("cloth"), p["mass"] * G, rtol=1e-12)
    assert np.abs(sol.energy.residual).max() < 1e-12
    assert sol.audit().ok


def coin(mu):
    p, found = case("rolling_coin")
    R, angle, m = p["radius"], p["tilt_theta0"], p["mass"]
    n = np.array([np.sin(angle), 0.0, np.cos(angle)])
    omega = 9.0 * n + 0.5 * np.array([-np.cos(angle), 0.0, np.sin(angle)]) - 0.3 * np.array([0.0, 1.0, 0.0])
    lowest = -R * (np.array(UP) - n[2] * n) / np.sin(angle)
    body = SPACE.Rotor(
        "coin", mass=m, inertia_across=m * R**2 / 4, inertia_axial=m * R**2 / 2, position=(0, 0, R * np.sin(angle)),
        axis=n, angular_velocity=omega, velocity=-np.cross(omega, lowest),
    )  # fmt: skip
    floor = SPACE.OnPlane("floor", body, normal=UP, radius=R, push_only=True, friction=coulomb(mu))
    return fm.Scene("coin", [body, floor, DOWN]), found


@pytest.mark.parametrize(("rtol", "error"), [(1e-6, 1e-8), (1e-8, 1e-10), (1e-10, 1e-11)])
def test_coin_rolls(rtol, error):
    scene, found = coin(mu=2.0)
    sol = fm.simulate(scene, t_end=2.0, rtol=rtol)
    np.testing.assert_allclose(vector(sol, "coin"), found["centre"], atol=error)
    np.testing.assert_allclose(sol["coin.axis"][:, -1], found["axis"], atol=error)
    assert sol.velocity("coin.spin")[-1] == pytest.approx(float(found["spin_w3"]), abs=error)
    assert len(sol.events) == 0
    assert np.abs(sol.relative_velocity("floor")).max() == 0.0
    assert sol.audit().ok


def test_coin_begins_to_slip_where_it_has_to():
    scene, found = coin(mu=0.35)
    sol = fm.simulate(scene, t_end=0.5, rtol=1e-10)
    assert sol.events[0].kind == "slip"
    assert sol.events[0].t == pytest.approx(float(found["slips_first_if_mu_is_0.35_at"]), abs=1e-10)
    assert np.abs(sol.energy.residual).max() < 1e-10
    assert sol.audit().ok


def test_ball_circles_on_a_turntable():
    p, found = case("ball_on_turntable")
    R, start, v = 0.05, np.array([*p["centre0"], 0.05]), np.array([*p["v0"], 0.0])
    table = np.cross((0.0, 0.0, p["Omega"]), start) - v  # what the turns have to bring at the lowest point
    ball = SPACE.Ball(
        "ball", mass=1.0, radius=R, position=start, velocity=v, angular_velocity=(table[1] / R, -table[0] / R, 0.0)
    )
    plane = SPACE.OnPlane("table", ball, normal=UP, turning=p["Omega"], friction=coulomb(5.0))
    sol = fm.simulate(fm.Scene("turntable", [ball, plane, DOWN]), t_end=p["t"], rtol=1e-8)
    np.testing.assert_allclose(vector(sol, "ball")[:2], found["centre"], atol=1e-11)
    assert np.abs(sol.energy.residual).max() < 1e-11  # the drive brings and takes energy
    assert sol.audit().ok


@pytest.mark.parametrize("mu", [0.1, 0.5])
def test_ball_on_a_slope_from_rest(mu):
    """It rolls with 5/7 of g sin(slope) where mu > 2/7 tan(slope), else it slides off."""
    slope = 0.5
    normal = np.array([-np.sin(slope), 0.0, np.cos(slope)])
    ball = SPACE.Ball("ball", mass=2.0, radius=0.1, position=0.1 * normal)
    sol = fm.simulate(
        fm.Scene("slope", [ball, SPACE.OnPlane("plane", ball, normal=normal, friction=coulomb(mu)), DOWN]), t_end=1.0
    )
    down = np.array([-np.cos(slope), 0.0, -np.sin(slope)])
    a = G * (np.sin(slope) - mu * np.cos(slope)) if mu < 2 / 7 * np.tan(slope) else 5 / 7 * G * np.sin(slope)
    assert (vector(sol, "ball") - 0.1 * normal) @ down == pytest.approx(a / 2, rel=1e-9)
    np.testing.assert_allclose(sol.normal_force("plane"), 2.0 * G * np.cos(slope), rtol=1e-12)


def test_sliding_top_rises_as_its_momentum_says():
    """Axis, momentum and the normal force that keeps the tip on the plane, written down here."""
    m, A, C, reach, rho, mu = 0.05, 2e-5, 1.5e-5, 0.02, 0.004, 0.3
    start, spin, e = np.array([np.sin(0.3), 0.0, np.cos(0.3)]), 250.0, np.array(UP)
    top = SPACE.Rotor(
        "top", mass=m, inertia_across=A, inertia_axial=C, position=reach * start + rho * e, axis=start, spin=spin,
        stations={"tip": -reach},
    )  # fmt: skip
    tip = SPACE.OnPlane("floor", top.station("tip"), normal=UP, radius=rho, push_only=True, friction=coulomb(mu))
    sol = fm.simulate(fm.Scene("rising top", [top, tip, DOWN]), t_end=0.06, rtol=1e-9)

    def rates(t, y):
        v, n, L = y[3:6], y[6:9], y[9:]
        along = L @ n
        omega = (L - along * n) / A + along / C * n
        touch = -reach * n - rho * e
        slip = v + np.cross(omega, touch)
        slip[2] = 0.0
        push = e - mu * slip / np.linalg.norm(slip)
        n_dot = np.cross(omega, n)

        def rises(N):  # second derivative of the axis' height
            a = (along * np.cross(n, n_dot) + np.cross(np.cross(touch, N * push), n)) / A
            return (a - (a @ n) * n - (n_dot @ n_dot) * n)[2]

        free = rises(0.0)
        N = m * (reach * free + G) / (1.0 - m * reach * (rises(1.0) - free))
        return np.concatenate([v, N * push / m - G * e, n_dot, np.cross(touch, N * push)])

    begin = np.concatenate([reach * start + rho * e, np.zeros(3), start, C * spin * start])
    exact = solve_ivp(rates, (0, 0.06), begin, method="DOP853", rtol=1e-11, atol=1e-14).y[:, -1]
    np.testing.assert_allclose(sol["top.axis"][:, -1], exact[6:9], atol=1e-8)
    np.testing.assert_allclose(vector(sol, "top"), exact[:3], atol=1e-9)
    assert sol["top.axis_z"][-1] > start[2] + 0.005  # friction at the tip has raised it
    assert (sol.mode("floor") == 1).all()
    assert sol.audit().ok


def test_sledge_on_three_points_presses_as_statics_say():
    slope, mu, h = 0.5, 0.2, 0.05
    normal = np.array([-np.sin(slope), 0.0, np.cos(slope)])
    R = np.array(SPACE.turned(axis=(0, 1, 0), angle=-slope))
    down, feet = -R[:, 0], {"front": (-0.1, 0.0, -h), "left": (0.1, 0.08, -h), "right": (0.1, -0.08, -h)}
    box = SPACE.RigidBody(
        "box", mass=2.0, inertia=(0.01, 0.012, 0.015), orientation=R, position=R @ (0, 0, h), velocity=down, points=feet
    )
    contacts = [
        SPACE.OnPlane(f"on {foot}", box.point(foot), normal=normal, push_only=True, friction=coulomb(mu))
        for foot in feet
    ]
    sol = fm.simulate(fm.Scene("sledge", [box, *contacts, DOWN]), t_end=0.2, rtol=1e-8)
    way = 0.2 + 0.02 * G * (np.sin(slope) - mu * np.cos(slope))
    assert (vector(sol, "box") - R @ (0, 0, h)) @ down == pytest.approx(way, rel=1e-10)
    whole = 2.0 * G * np.cos(slope)
    # moments about the centre of mass: friction below it presses the front foot
    front = whole * (0.5 + mu * h / 0.2)
    loads = [sol.normal_force(f"on {foot}")[-1] for foot in feet]
    np.testing.assert_allclose(loads, [front, (whole - front) / 2, (whole - front) / 2], rtol=1e-9)
    assert sol.audit().ok


def lifted(lost, rate=20.0):
    ball = SPACE.Ball("ball", mass=1.0, radius=0.1, position=(0, 0, 0.1), velocity=(1, 0, 0))
    floor = SPACE.OnPlane("floor", ball, normal=UP, push_only=True, when_lost=lost, friction=coulomb(0.1))
    return fm.Scene("lifted", [ball, floor, DOWN, fm.Force("up", ball, axis="z", value=rate * fm.t)])


def test_contact_opens_and_the_run_goes_on():
    sol = fm.simulate(lifted("open"), t_end=1.0, rtol=1e-8)
    event = sol.events[-1]
    assert (event.kind, event.t) == ("open", pytest.approx(G / 20.0, abs=1e-12))
    assert sol["ball.z"][-1] == pytest.approx(0.1 + 20.0 * (1.0 - G / 20.0) ** 3 / 6, rel=1e-12)
    assert sol.mode("floor")[-1] == 2
    assert sol.audit().ok
    assert sol.velocity("ball.x")[-1] == pytest.approx(1.0 - 0.1 * G * (G / 20.0) / 2, rel=1e-12)


def test_contact_is_lost_and_the_run_ends():
    with pytest.raises(fm.IntegrationError, match="contact of 'floor' is lost") as stop:
        fm.simulate(lifted("end"), t_end=1.0)
    assert stop.value.t == pytest.approx(G / 20.0, abs=1e-9)


def test_what_cannot_touch_is_refused():
    body = SPACE.RigidBody("rod", mass=1.0, inertia=(1, 1, 1), points={"end": (0, 0, 1)})
    ball = SPACE.Ball("ball", mass=1.0, radius=1.0)
    wheel = SPACE.Rotor("wheel", mass=1.0, inertia_across=1.0, inertia_axial=1.0)
    refused = [
        (lambda: SPACE.OnPlane("p", body, normal=UP), "name the point that touches"),
        (lambda: SPACE.OnPlane("p", ball, normal=UP, radius=2.0), "a ball has its own"),
        (lambda: SPACE.OnPlane("p", wheel, normal=UP), "radius must be a finite number > 0"),
        (lambda: SPACE.OnPlane("p", body.point("end"), normal=UP, radius=0.1), "has no radius"),
        (lambda: SPACE.OnPlane("p", ball, normal=(0, 0, 0)), "not all 0"),
        (lambda: SPACE.OnPlane("p", ball, body, normal=UP), "the plane is fixed"),
        (lambda: SPACE.OnPlane("p", ball, normal=UP, when_lost="open"), "without push_only contact is never lost"),
        (
            lambda: SPACE.OnPlane("p", ball, normal=UP, friction=fm.laws.Elliptic.example()),
            "same in all directions",
        ),
    ]
    for make, words in refused:
        with pytest.raises(fm.FricmbError, match=words):
            make()


def test_directions_are_named_by_axes_where_they_are_along_them():
    ball = SPACE.Ball("ball", mass=1.0, radius=1.0)
    names = {
        normal: SPACE.OnPlane("p", ball, normal=normal).labels() for normal in [UP, (1, 0, 0), (0, 1, 0), (0, 1, 1)]
    }
    assert names == {UP: ("x", "y"), (1, 0, 0): ("y", "z"), (0, 1, 0): ("z", "x"), (0, 1, 1): ("x", "2")}


@pytest.mark.parametrize(("angle", "mu"), [(0.3, 0.0), (0.8, 5.0)])
def test_coin_that_falls_flat_ends_with_words(angle, mu):
    """On ice it falls straight; on a rough floor it tips about its edge."""
    n, R, m = np.array([np.sin(angle), 0.0, np.cos(angle)]), 0.05, 0.02
    body = SPACE.Rotor(
        "coin", mass=m, inertia_across=m * R**2 / 4, inertia_axial=m * R**2 / 2, position=(0, 0, R * n[0]), axis=n
    )
    friction = {"friction": coulomb(mu)} if mu else {}
    floor = SPACE.OnPlane("floor", body, normal=UP, radius=R, push_only=True, **friction)
    with pytest.raises(fm.IntegrationError, match="'coin' has come to lie flat on the plane of 'floor'") as stop:
        fm.simulate(fm.Scene("falling", [body, floor, DOWN]), t_end=1.0, rtol=1e-6)

    def rates(t, y):  # about the edge, which slides freely or stays
        held = m * R**2 if mu else m * R**2 * np.cos(y[0]) ** 2
        pull = -m * G * R * np.cos(y[0])
        turn = 0.0 if mu else m * R**2 * np.cos(y[0]) * np.sin(y[0]) * y[1] ** 2
        return [y[1], (pull + turn) / (m * R**2 / 4 + held)]

    def flat(t, y):
        return y[0]

    flat.terminal = True
    exact = solve_ivp(rates, (0, 1), [angle, 0.0], method="DOP853", rtol=1e-11, atol=1e-13, events=flat)
    assert stop.value.t == pytest.approx(exact.t[-1], abs=1e-4)
