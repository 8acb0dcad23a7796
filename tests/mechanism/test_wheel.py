"""A wheel on a line: when it rolls, how it slides, rolling resistance, lifting off."""

import math

import numpy as np
import pytest

import fricmb as fm

M, R, J, G = 2.0, 0.1, 0.01, 9.81
RATIO = 1.0 + M * R**2 / J  # 1 + R^2/k^2


def on_slope(alpha, law, *parts, **start):
    body = fm.RigidBody("disc", mass=M, inertia=J, position=(R * math.sin(alpha), R * math.cos(alpha)), **start)
    line = fm.Wheel("line", body, radius=R, angle=-alpha, friction=law)
    return fm.Scene("slope", [body, line, fm.Gravity("g"), *(make(body) for make in parts)])


def test_a_bowl_slides_until_it_rolls():
    sol = fm.simulate(on_slope(0.0, fm.laws.Coulomb(mu_s=0.2), velocity=(3.0, 0.0)), t_end=1.0, rtol=1e-9)
    end = 3.0 / (0.2 * G * RATIO)
    assert [(e.kind, e.t) for e in sol.events] == [("stick", pytest.approx(end, rel=1e-9))]
    assert sol.velocity("disc.x")[-1] == pytest.approx(3.0 - 0.2 * G * end, rel=1e-9)
    np.testing.assert_allclose(sol.reaction("line")[0], M * G, rtol=1e-9)
    assert sol.audit().ok
    assert np.abs(sol.energy.residual).max() < 1e-9


@pytest.mark.parametrize("side", [-1, 1])
def test_on_a_slope_it_rolls_up_to_a_slope_and_slides_beyond(side):
    mu = 0.15
    alpha = math.atan(mu * RATIO * (1.0 + 1e-6 * side))
    sol = fm.simulate(on_slope(alpha, fm.laws.Coulomb(mu_s=mu)), t_end=0.5, rtol=1e-9)
    down = sol.velocity("disc.x")[-1] / math.cos(alpha) / 0.5
    if side < 0:
        assert set(sol.mode("line")) == {0}
        assert down == pytest.approx(G * math.sin(alpha) / (1.0 + J / (M * R**2)), rel=1e-8)
    else:
        assert set(sol.mode("line")) == {1}
        assert down == pytest.approx(G * (math.sin(alpha) - mu * math.cos(alpha)), rel=1e-8)


def test_a_torque_makes_it_spin_on_the_spot():
    """Rolling asks the floor for w R/(R^2 + k^2) of a torque w; slip sets in at mu N."""
    drive = lambda body: fm.Torque("drive", body, value=-2.0 * fm.t)  # noqa: E731
    mu_s, mu_k = 0.4, 0.3
    sol = fm.simulate(on_slope(0.0, fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k), drive), t_end=3.0, rtol=1e-9)
    slips = mu_s * M * G * (R**2 + J / M) / R / 2.0
    assert [(e.kind, e.t) for e in sol.events] == [("slip", pytest.approx(slips, rel=1e-9))]
    rolled = 2.0 * slips**2 / 2.0 * R / (M * R**2 + J)
    assert sol.velocity("disc.x")[-1] == pytest.approx(rolled + mu_k * G * (3.0 - slips), rel=1e-8)


def test_a_belt_takes_it_along():
    body = fm.RigidBody("disc", mass=M, inertia=J, position=(0.0, R))
    belt = fm.Wheel("belt", body, radius=R, slide=1.2, friction=fm.laws.Coulomb(mu_s=0.3))
    sol = fm.simulate(fm.Scene("s", [body, belt, fm.Gravity("g")]), t_end=1.0, rtol=1e-9)
    assert [(e.kind, e.t) for e in sol.events] == [("stick", pytest.approx(1.2 / (0.3 * G * RATIO), rel=1e-9))]
    assert sol.velocity("disc.x")[-1] + R * sol.velocity("disc.angle")[-1] == pytest.approx(1.2, rel=1e-9)


@pytest.mark.parametrize(("arm", "rests"), [(0.0021, True), (0.0019, False)])
def test_rolling_resistance_holds_it_on_a_gentle_slope(arm, rests):
    alpha = math.atan(0.02)
    resists = lambda body: fm.DryFriction("arm", body, axis="angle", static=arm * M * G * math.cos(alpha))  # noqa: E731
    sol = fm.simulate(on_slope(alpha, fm.laws.Coulomb(mu_s=0.2), resists), t_end=2.0, rtol=1e-9)
    force = M * G * (math.sin(alpha) - arm / R * math.cos(alpha))
    down = 0.0 if rests else force / (M + J / R**2)
    assert sol.velocity("disc.x")[-1] / math.cos(alpha) == pytest.approx(2.0 * down, abs=1e-9)


def test_rolling_resistance_brings_it_to_rest():
    arm, v = 0.002, 1.0
    resists = lambda body: fm.DryFriction("arm", body, axis="angle", static=arm * M * G)  # noqa: E731
    start = {"velocity": (v, 0.0), "angular_velocity": -v / R}
    sol = fm.simulate(on_slope(0.0, fm.laws.Coulomb(mu_s=0.2), resists, **start), t_end=12.0, rtol=1e-9)
    (event,) = sol.events.of(contact="arm")
    assert (event.kind, event.t) == ("stick", pytest.approx(v * (M + J / R**2) * R / (arm * M * G), rel=1e-8))


def test_it_lifts_off_where_it_would_have_to_be_pulled():
    body = fm.RigidBody("disc", mass=M, inertia=J, position=(0.0, R))
    floor = fm.Wheel("floor", body, radius=R, push_only=True, when_lost="open")
    lift = fm.Force("lift", body, axis="y", value=10.0 * fm.t)
    sol = fm.simulate(fm.Scene("s", [body, floor, lift, fm.Gravity("g")]), t_end=3.0)
    assert sol.reaction("floor")[0, 0] == pytest.approx(M * G)
    t = M * G / 10.0
    assert sol["disc.y"][-1] == pytest.approx(R + 10.0 * (3.0 - t) ** 3 / 6.0 / M, rel=1e-6)


def test_what_cannot_be_is_refused_by_name():
    body = fm.RigidBody("disc", mass=M, inertia=J)
    for match, given in [
        ("radius must be a finite number > 0", {"radius": 0.0}),
        ("slide must be one value", {"radius": 1.0, "slide": (1.0, 2.0)}),
        ("a must turn", {"radius": 1.0, "a": fm.Body("b", mass=1.0, axes="xy")}),
    ]:
        with pytest.raises(fm.SceneError, match=match):
            fm.Wheel("w", given.pop("a", body), **given)
