"""Friction in joints: the pendulum on a dry pin against its reduced equation, jams, lost contact, stick-slip."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm

M, I, L, R, MU, G = 1.3, 0.2, 0.7, 0.05, 0.6, 9.81


def reaction(angle, rate, acceleration):
    return M * (L * acceleration + G * np.sin(angle)), M * (L * rate**2 + G * np.cos(angle))


def acceleration(angle, rate, direction):
    """(I + M L^2) a = -M G L sin(angle) - MU R |reaction| direction, the reaction depending on a."""
    a = 0.0
    for _ in range(300):
        new = (-M * G * L * np.sin(angle) - MU * R * direction * np.hypot(*reaction(angle, rate, a))) / (I + M * L * L)
        if abs(new - a) <= 1e-16 * abs(new):
            break
        a = new
    return new


def turning_points(angle):
    """Times and angles at which the pendulum turns; at the last it stays."""
    t, found = 0.0, []
    while M * G * L * abs(np.sin(angle)) > MU * R * np.hypot(*reaction(angle, 0.0, 0.0)):
        direction = -np.sign(np.sin(angle))

        def stops(t, y):
            return y[1]

        stops.terminal, stops.direction = True, -direction
        run = solve_ivp(
            lambda t, y, s=direction: [y[1], acceleration(y[0], y[1], s)], (t, t + 10.0), [angle, 0.0], method="DOP853",
            rtol=1e-13, atol=1e-14, events=stops, first_step=1e-3,
        )  # fmt: skip
        t, angle = run.t[-1], run.y[0, -1]
        found.append((t, angle))
    return np.array(found).T


def test_pendulum_on_a_dry_pin():
    times, angles = turning_points(1.2)
    sol = fm.simulate(fm.models.dry_pendulum(), t_end=times[-1] + 1.0, rtol=1e-8)
    assert [event.kind for event in sol.events] == ["reversal"] * (len(times) - 1) + ["stick"]
    np.testing.assert_allclose(sol.events.t, times, rtol=0, atol=1e-9)
    at = sol.at(times)
    np.testing.assert_allclose(at["arm.angle"] + np.pi / 2, angles, rtol=0, atol=1e-9)
    np.testing.assert_allclose(sol.reaction("pin")[:, -1], [0.0, M * G], atol=1e-11)
    assert sol.normal_force("pin")[-1] == pytest.approx(M * G, rel=1e-12)
    assert sol.force("pin")[0, -1] * R == pytest.approx(M * G * L * np.sin(angles[-1]), rel=1e-8)
    assert np.abs(sol.energy.residual).max() < 1e-9


def painleve_condition(mu, angle, slip):
    return 1 + 3 * np.cos(angle) ** 2 + 3 * mu * slip * np.sin(angle) * np.cos(angle)


def test_rod_that_slows_down_into_painleves_region_stops_at_its_edge():
    """Friction that rises as slip slows: the load grows without bound towards the edge, which is met in finite time."""
    law = fm.laws.Stribeck(mu_s=2.5, mu_k=1.0, v_s=3.0)
    scene = fm.models.painleve_rod(angle=1.0, speed=-3.6, law=law)
    with pytest.raises(fm.IntegrationError, match="'tip' has no single solution") as caught:
        fm.simulate(scene, t_end=2.0, rtol=1e-8)
    partial = caught.value.partial
    assert 1e-5 < caught.value.t < 1e-4
    slip = np.abs(partial.relative_velocity("tip")[0])
    margin = painleve_condition(law.coefficient(slip), partial["rod.angle"], -1.0)
    assert margin.min() > 0.0
    assert margin[-1] < 1e-4
    assert partial.normal_force("tip")[-1] > 1e3 * partial.normal_force("tip")[0]


def test_rod_that_lifts_off_loses_contact():
    law = fm.laws.Stribeck(mu_s=2.5, mu_k=1.0, v_s=3.0)
    with pytest.raises(fm.IntegrationError, match="contact of 'tip' is lost") as caught:
        fm.simulate(fm.models.painleve_rod(angle=1.0, speed=-8.0, law=law), t_end=2.0, rtol=1e-8)
    assert abs(caught.value.partial.normal_force("tip")[-1]) < 1e-9


@pytest.mark.parametrize(("mu", "angle"), [(1.6, 0.95), (3.0, 0.9)])
def test_rod_that_starts_in_painleves_region_is_refused(mu, angle):
    assert painleve_condition(mu, angle, -1.0) < 0.0
    with pytest.raises(fm.IntegrationError, match="'tip' has no single solution"):
        fm.simulate(fm.models.painleve_rod(mu=mu, angle=angle), t_end=0.1)


def test_rod_outside_of_painleves_region_slides():
    assert painleve_condition(0.5, 1.0, -1.0) > 0.0
    sol = fm.simulate(fm.models.painleve_rod(), t_end=0.05, rtol=1e-9)
    assert (sol.normal_force("tip") > 0.0).all()
    np.testing.assert_allclose(sol["rod.tip.y"], 0.0, atol=1e-13)
    # the first instant by hand: N (1/m + half^2 cos (cos + mu sin)/J) = g for slip to the left at rest
    angle, mu, half, m = 1.0, 0.5, 0.5, 1.0
    J = m * half**2 / 3
    lever = half * np.cos(angle), half * np.sin(angle)
    expected = 9.81 / (1 / m + lever[0] * (lever[0] - mu * lever[1]) / J)
    assert sol.normal_force("tip")[0] == pytest.approx(expected, rel=1e-12)


def test_contact_that_can_only_push_is_lost():
    block = fm.RigidBody("block", mass=1.0, inertia=1.0)
    lift = fm.Force("lift", block, axis="y", value=10.0 * fm.t)
    scene = fm.Scene(
        "lift",
        [block, fm.RollerOnLine("floor", block, push_only=True), lift, fm.Gravity("g", acceleration={"y": -5.0})],
    )
    with pytest.raises(fm.IntegrationError, match="contact of 'floor' is lost") as caught:
        fm.simulate(scene, t_end=1.0)
    assert caught.value.t == pytest.approx(0.5, abs=1e-9)


def test_sprag_jams_where_spurr_says():
    angle, length, mass, support = 0.5, 0.1, 0.2, 50.0
    lever = length**2 / (mass * length**2 / 3)
    limit = (np.sin(angle) ** 2 * lever + 1 / support) / (np.sin(angle) * np.cos(angle) * lever)
    sol = fm.simulate(fm.models.sprag_slip(mu=0.9 * limit), t_end=0.02)
    assert sol.mode("tip")[-1] == 1
    with pytest.raises(fm.IntegrationError, match="'tip' has no single solution"):
        fm.simulate(fm.models.sprag_slip(mu=1.02 * limit), t_end=0.02)


def test_drive_train_is_the_friction_oscillator():
    """The disc's bearing carries its weight: the same as a block on a belt, which other integrators solve."""
    values = {"inertia": 0.4, "mass": 60.0, "radius": 0.03, "stiffness": 25.0, "damping": 0.05}
    train = fm.simulate(fm.models.drive_train(**values), t_end=6.0, rtol=1e-9)
    rate = 3.0 / 2.0
    disc = fm.Body("disc", mass=0.4, velocity={"x": 0.0})
    wheel = fm.Driven("wheel", velocity={"x": rate})
    law = fm.laws.Coulomb(mu_s=0.35, mu_k=0.2)
    # friction torque = radius mu weight at the angular velocity of the disc
    twin = fm.Scene(
        "twin",
        [
            disc,
            wheel,
            fm.Spring("shaft", disc, wheel, axis="x", stiffness=25.0),
            fm.Damper("loss", disc, wheel, axis="x", damping=0.05),
            fm.Contact("bearing", disc, law=law, normal_force=0.03 * 60.0 * 9.81),
        ],
    )
    other = fm.simulate(twin, t_end=6.0, rtol=1e-11, method="bdf")
    assert [e.kind for e in train.events] == [e.kind for e in other.events]
    np.testing.assert_allclose(train.events.t, other.events.t, atol=2e-8)
    times = np.linspace(0.0, 6.0, 50)
    np.testing.assert_allclose(train.at(times)["disc.angle"], other.at(times)["disc.x"], atol=1e-7)


#: Joints refuse a law with an offset.
IN_PINS = [name for name in fm.laws.names if name != "Offset" and 1 in getattr(fm.laws, name).example().dimensions]


@pytest.mark.parametrize("name", IN_PINS)
def test_every_law_of_the_catalogue_works_in_a_pin(name):
    law = getattr(fm.laws, name).example()
    sol = fm.simulate(fm.models.dry_pendulum(law=law), t_end=0.6, rtol=1e-7)
    assert np.abs(sol.energy.residual).max() < 1e-5
    assert sol.energy.friction_loss[-1] > 0.0


@pytest.mark.parametrize("pull", [(9.81, 0.0), (-9.81, 0.0), (0.0, -9.81)])
def test_two_straight_arms_held_by_their_dry_pins_stay(pull):
    ends = {"left": (-0.5, 0.0), "right": (0.5, 0.0)}
    arms = [fm.RigidBody(f"arm{i}", mass=1.0, inertia=1 / 12, position=(i + 0.5, 0.0), points=ends) for i in range(2)]
    law = fm.laws.Coulomb(mu_s=30.0)
    gravity = fm.Gravity("g", acceleration={"x": pull[0], "y": pull[1]})
    pins = [
        fm.Revolute("root", arms[0].point("left"), radius=0.05, friction=law),
        fm.Revolute("elbow", arms[1].point("left"), arms[0].point("right"), radius=0.05, friction=law),
    ]
    sol = fm.simulate(fm.Scene("arms", [*arms, *pins, gravity]), t_end=3.0, rtol=1e-7)
    assert not sol.events
    assert np.abs(sol.q[:, -1] - sol.q[:, 0]).max() < 1e-12
    # moment of the weight of both about the root
    assert sol.force("root")[0, -1] * 0.05 == pytest.approx(-2.0 * pull[1], abs=1e-9)
