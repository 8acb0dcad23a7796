"""Dry sleeves and guides: loads of their ends and shoes in closed form, slip in two directions at once."""

import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import fricmb as fm

sys.path.insert(0, str(Path(__file__).parent))
from cases import DOWN

SPACE, G = fm.space, 9.81
M, MU, R = 1.5, 0.2, 0.04


def sleeve(*, rotor, J, station=0.0, length=0.0, speed=0.9, spin=20.0):
    """What turns and slides in a level sleeve, its centre of mass off the sleeve's middle by ``station``."""
    axis = np.array([0.0, 1.0, 0.0])
    given = {"mass": M, "velocity": speed * axis}
    if rotor:
        body = SPACE.Rotor(
            "shaft", inertia_across=0.1, inertia_axial=J, axis=axis, spin=spin, stations={"mid": station}, **given
        )
        end = body.station("mid")
    else:
        body = SPACE.RigidBody(
            "shaft", inertia=(0.02, J, 0.02), angular_velocity=spin * axis, points={"mid": station * axis}, **given
        )
        end = body.point("mid")
    dry = SPACE.Cylindrical("sleeve", end, axis=axis, radius=R, length=length, friction=fm.laws.Coulomb(mu_s=MU))
    return fm.Scene("sleeve", [body, dry, DOWN])


@pytest.mark.parametrize("rotor", [True, False])
@pytest.mark.parametrize(("station", "length", "part"), [(0.0, 0.0, 1.0), (0.03, 0.2, 1.0), (0.15, 0.2, 1.5)])
def test_turning_and_sliding_stop_together(rotor, station, length, part):
    """J = m R^2: both slow down in proportion, so that the direction of slip stays."""
    sol = fm.simulate(sleeve(rotor=rotor, J=M * R**2, station=station, length=length), t_end=1.0, rtol=1e-8)
    load = part * M * G
    stop = M * np.hypot(R * 20.0, 0.9) / (MU * load)
    (event,) = sol.events
    assert (event.kind, event.t) == ("stick", pytest.approx(stop, rel=1e-8))
    assert sol["shaft.y"][-1] == pytest.approx(0.9 * stop / 2, rel=1e-8)
    before = sol.at([0.5 * stop])
    np.testing.assert_allclose(before.relative_velocity("sleeve")[:, 0], [R * 10.0, 0.45], rtol=1e-7)
    assert before.normal_force("sleeve")[0] == pytest.approx(load, rel=1e-8)
    np.testing.assert_allclose(before["shaft.omega"][:, 0], [0.0, 10.0, 0.0], atol=1e-6)
    assert sol.audit().ok


def test_turning_and_sliding_share_friction():
    """Another moment of inertia: the direction of slip changes on the way."""
    J = 3.0 * M * R**2
    sol = fm.simulate(sleeve(rotor=True, J=J), t_end=0.3, rtol=1e-9)

    def rates(t, y):
        slip = np.array([R * y[0], y[1]])
        force = -MU * M * G * slip / np.linalg.norm(slip)
        return [R * force[0] / J, force[1] / M, y[1]]

    exact = solve_ivp(rates, (0, 0.3), [20.0, 0.9, 0.0], method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    seen = [sol.velocity("shaft.spin")[-1], sol.velocity("shaft.y")[-1], sol["shaft.y"][-1]]
    np.testing.assert_allclose(seen, exact, rtol=1e-8)


@pytest.mark.parametrize(("length", "width"), [(0.0, 0.0), (0.2, 0.0), (0.2, 0.15)])
def test_slide_on_four_shoes(length, width):
    """The centre of mass beside and above the guide: every torque loads the shoes, its inertia's included."""
    c, v = np.array([0.06, 0.05, 0.09]), 1.2
    body = SPACE.RigidBody(
        "slide", mass=M, inertia=(0.01, 0.02, 0.03), position=c, velocity=(v, 0, 0), points={"mid": tuple(-c)}
    )
    law = fm.laws.Coulomb(mu_s=MU)
    guide = SPACE.Prismatic(
        "guide", body.point("mid"), axis=(1, 0, 0), length=length, width=width, friction=law
    )
    sol = fm.simulate(fm.Scene("slide", [body, guide, DOWN]), t_end=2.0, rtol=1e-9)

    def load(a):
        """Sum over the shoes at the acceleration a; u = y, w = z."""
        F, M_ = np.array([0.0, M * G]), -np.cross(c, [-M * a, 0.0, -M * G])
        total = 0.0
        for end in (1, -1):
            held = F / 2 + (end * np.array([M_[2], -M_[1]]) / length if length else 0.0)
            for side in (1, -1):
                twist = side * M_[0] / width / 2 if width else 0.0
                total += np.hypot(held[0] / 2, held[1] / 2 + twist)
        return total

    a = brentq(lambda a: M * a + MU * load(a), -50.0, 0.0, xtol=1e-14)
    assert sol.normal_force("guide")[0] == pytest.approx(load(a), rel=1e-9)
    (event,) = sol.events
    assert event.t == pytest.approx(-v / a, rel=1e-9)
    assert sol["slide.x"][-1] == pytest.approx(c[0] - v**2 / (2 * a), rel=1e-9)
    assert np.abs(sol.energy.residual).max() < 1e-10


def test_what_a_sleeve_does_not_take():
    body = SPACE.RigidBody("box", mass=1.0, inertia=(1, 1, 1))
    law = fm.laws.Coulomb(mu_s=0.1)
    for make in (
        lambda: SPACE.Cylindrical("s", body, axis=(0, 0, 1), friction=law),
        lambda: SPACE.Cylindrical("s", body, axis=(0, 0, 1), radius=0.1, length=-1.0),
        lambda: SPACE.Prismatic("s", body, axis=(0, 0, 1), width=-1.0),
    ):
        with pytest.raises(fm.FricmbError, match="must be a finite number"):
            make()


@pytest.mark.parametrize(("mu", "share"), [(0.8, 0.5), (1.6, 0.25), (0.5, 0.8)])
def test_guide_that_jams_says_how_much_friction_it_bears(mu, share):
    """Friction at a guide, d off the centre: N = max(m g, 2 d/length mu N) has no solution once 2 d mu > length."""
    box = SPACE.RigidBody(
        "box", mass=2.0, inertia=(0.1, 0.1, 0.1), points={"rail": (0.0, 0.0, -0.5)}, position=(0.0, 0.0, 0.5),
        velocity=(1.0, 0.0, 0.0),
    )  # fmt: skip

    def scene(part):
        rail = SPACE.Prismatic(
            "rail", box.point("rail"), SPACE.ground_point(0, 0, 0), axis=(1, 0, 0), length=0.4,
            friction=fm.laws.Coulomb(mu_s=part * mu),
        )  # fmt: skip
        return fm.Scene("jammed", [box, rail, fm.Gravity("g", acceleration={"z": -9.81})])

    said = f"friction of 'rail' has no solution.* up to some {share:.2f} of"
    for method in ("bdf", "radau"):
        with pytest.raises(fm.IntegrationError, match=said):
            fm.simulate(scene(1.0), t_end=0.01, method=method)
        sol = fm.simulate(scene(0.99 * share), t_end=0.01, method=method)
        assert sol.normal_force("rail")[0] == pytest.approx(2.0 * 9.81)


@pytest.mark.parametrize("axis", [(0.0, 0.0, 1.0), (-8e-17, -3e-17, 1.0), (3e-17, -8e-17, 1.0), (2e-13, 1e-13, 1.0)])
def test_round_off_of_an_axis_does_not_turn_the_shoes(axis):
    """Shoes side by side along x bear a push P along y, and its torque P l about the guide, by ``(P/2 +- P l/b)/2``."""
    push, arm, width, speed = 7.0, 0.1, 0.1, -1.5
    body = SPACE.RigidBody(
        "slide", mass=M, inertia=(0.02, 0.03, 0.04), velocity=(0, 0, speed), points={"mid": (arm, 0.0, 0.0)}
    )
    guide = SPACE.Prismatic(
        "guide", body.point("mid"), SPACE.ground_point(arm, 0.0, 0.0), axis=axis, width=width,
        friction=fm.laws.Coulomb(mu_s=MU),
    )  # fmt: skip
    sol = fm.simulate(
        fm.Scene("guide", [body, guide, fm.Force("push", body, axis="y", value=push), DOWN]), t_end=0.5, rtol=1e-9
    )
    load = 2.0 * (abs(push / 4 + push * arm / width / 2) + abs(push / 4 - push * arm / width / 2))
    np.testing.assert_allclose(sol.normal_force("guide"), load, rtol=1e-9)
    assert sol["slide.z"][-1] == pytest.approx(speed * 0.5 + 0.5 * (MU * load / M - G) * 0.25, rel=1e-8)
