"""Resistance against rolling and spinning by a joint's own reaction: closed forms and integrations by scipy."""

import math
import pickle

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

import fricmb as fm
from tests.sensitivity.differences import worst

M, R, J, G, ARM = 2.0, 0.1, 0.01, 9.81, 0.004
METHODS = ["radau", "bdf"]


def wheel(slope=0.0, arm=ARM, mu=0.5, more=(), **given):
    disc = fm.RigidBody("disc", mass=M, inertia=J, position=(R * math.sin(slope), R * math.cos(slope)), **given)
    floor = fm.Wheel(
        "floor", disc, radius=R, angle=-slope, friction=fm.laws.Coulomb(mu_s=mu), rolling_resistance=arm
    )
    return fm.Scene("wheel", [disc, floor, fm.Gravity("g"), *(make(disc) for make in more)])


@pytest.mark.parametrize("method", METHODS)
def test_a_wheel_rests_on_a_gentle_slope_and_rolls_down_a_steeper_one(method):
    limit = math.atan(ARM / R)
    for slope in (0.5 * limit, 0.999 * limit, 1.001 * limit, 2 * limit):
        sol = fm.simulate(wheel(slope), t_end=2.0, rtol=1e-9, method=method)
        way = sol["disc.x"][-1] - sol["disc.x"][0]
        a = max(0.0, G * math.sin(slope) - ARM / R * G * math.cos(slope)) / (1 + J / (M * R**2))
        assert way == pytest.approx(2 * a * math.cos(slope), rel=1e-9, abs=1e-14)
        assert set(sol.mode("floor_rolling")) == {0 if slope < limit else 1}
        assert set(sol.mode("floor")) == {0}
        held = M * G * R * math.sin(slope) if slope < limit else ARM * M * G * math.cos(slope)
        np.testing.assert_allclose(sol.force("floor_rolling"), held, rtol=1e-9)
        assert sol.audit().ok


@pytest.mark.parametrize("method", METHODS)
def test_break_away_and_rest_of_a_pushed_wheel(method):
    """Pushed by t it breaks away at f m g/R; let go at 2 it rolls out to rest, at f g/R/(1 + J/(m R^2))."""
    push = sympy.Piecewise((fm.t, fm.t < 2), (0, True))
    scene = wheel(more=(lambda disc: fm.Force("push", disc, axis="x", value=push),))
    sol = fm.simulate(scene, t_end=4.0, rtol=1e-9, method=method)
    limit, mass = ARM * M * G / R, M + J / R**2
    speed = (2 - limit) ** 2 / 2 / mass
    kinds = [(event.kind, event.contact) for event in sol.events]
    assert kinds == [("slip", "floor_rolling"), ("stick", "floor_rolling")]
    assert float(sol.events[0].t) == pytest.approx(limit, rel=1e-9)
    assert float(sol.events[1].t) == pytest.approx(2 + speed * mass / limit, rel=1e-9)
    assert np.abs(sol.energy.residual).max() < 1e-10


def test_it_tells_of_all_that_slides_rolls_and_lifts_off():
    """A disc set down sliding under a growing upward force, against scipy; it lifts off where that bears its weight."""
    up = 30 * (1 - sympy.exp(-fm.t))
    disc = fm.RigidBody("disc", mass=M, inertia=J, position=(0.0, R), velocity=(1.0, 0.0))
    floor = fm.Wheel(
        "floor", disc, radius=R, friction=fm.laws.Coulomb(mu_s=0.1), rolling_resistance=0.02, push_only=True,
        when_lost="open",
    )  # fmt: skip
    scene = fm.Scene("up", [disc, floor, fm.Gravity("g"), fm.Force("up", disc, axis="y", value=up)])
    sol = fm.simulate(scene, t_end=2.0, rtol=1e-10)

    def N(t):
        return M * G - 30 * (1 - math.exp(-t))

    def slides(t, y):  # v, w; it slides forward, and turns clockwise
        return [-0.1 * N(t) / M, (-0.1 * N(t) * R + 0.02 * N(t)) / J]

    # 0.1 R < 0.02: at first it does not turn
    assert sol.mode("floor_rolling")[0] == 0
    own = solve_ivp(lambda t, y: [slides(t, y)[0]], (0.0, 2.0), [1.0], rtol=1e-12, atol=1e-12, events=lambda t, y: y[0])
    assert not own.t_events[0].size  # it slides until it lifts off
    lifts = -math.log(1 - M * G / 30)
    events = [(event.kind, event.contact, float(event.t)) for event in sol.events]
    assert {(kind, contact) for kind, contact, _ in events} == {("open", "floor"), ("open", "floor_rolling")}
    assert all(t == pytest.approx(lifts, rel=1e-9) for _, _, t in events)
    v = 1.0 - 0.1 / M * ((M * G - 30) * lifts + 30 * (1 - math.exp(-lifts)))
    assert sol.velocity("disc.x")[-1] == pytest.approx(v, rel=1e-9)
    assert sol.velocity("disc.angle")[-1] == pytest.approx(0.0, abs=1e-12)


S = fm.space
BALL = {"mass": 0.17, "radius": 0.03}
ROLL, SPIN = 0.0006, 0.0009


def ball(v, w, mu=0.2, **given):
    body = S.Ball("ball", **BALL, position=(0, 0, 0.03), velocity=v, angular_velocity=w)
    cloth = S.OnPlane("cloth", body, normal=(0, 0, 1), friction=fm.laws.Coulomb(mu_s=mu), **given)
    return fm.Scene("ball", [body, cloth, fm.Gravity("g", acceleration={"z": -G})])


@pytest.mark.parametrize("method", METHODS)
def test_a_ball_rolls_out_and_spins_out(method):
    m, r = BALL["mass"], BALL["radius"]
    sol = fm.simulate(
        ball((0.3, 0.4, 0), (-0.4 / r, 0.3 / r, 0), rolling_resistance=ROLL), t_end=6.0, rtol=1e-9, method=method
    )
    assert [(event.kind, event.contact) for event in sol.events] == [("stick", "cloth_rolling")]
    assert float(sol.events[0].t) == pytest.approx(0.5 / (5 / 7 * ROLL * G / r), rel=1e-9)
    sol = fm.simulate(ball((0, 0, 0), (0, 0, 20.0), spinning_resistance=SPIN), t_end=6.0, rtol=1e-9, method=method)
    assert [(event.kind, event.contact) for event in sol.events] == [("stick", "cloth_spinning")]
    assert float(sol.events[0].t) == pytest.approx(0.4 * m * r * r * 20 / (SPIN * m * G), rel=1e-9)


def test_a_ball_that_slides_rolls_and_spins_at_once():
    """Against scipy: sliding, then rolling, each with both resistances."""
    m, r = BALL["mass"], BALL["radius"]
    start = np.array([1.0, 0.2, 5.0, -30.0, 20.0])  # v, omega
    sol = fm.simulate(
        ball((1.0, 0.2, 0), (5.0, -30.0, 20.0), rolling_resistance=ROLL, spinning_resistance=SPIN), t_end=10.0,
        rtol=1e-10,
    )  # fmt: skip
    inertia = 0.4 * m * r * r

    def turns(w):
        across = -ROLL * m * G * w[:2] / np.hypot(*w[:2])
        return np.array([*across, -SPIN * m * G * np.sign(w[2])]) / inertia

    def slide(t, y):
        v, w = y[:2], y[2:]
        g = v + r * np.array([-w[1], w[0]])
        F = -0.2 * m * G * g / np.hypot(*g)
        return [*(F / m), *(turns(w) + np.array([r * F[1], -r * F[0], 0.0]) / inertia)]

    def gone(t, y):
        return np.hypot(y[0] - r * y[3], y[1] + r * y[2]) - 1e-9

    gone.terminal = True
    first = solve_ivp(slide, (0.0, 10.0), start, rtol=1e-12, atol=1e-14, method="DOP853", events=gone)
    rolls, spins, rests = (
        next(float(e.t) for e in sol.events if e.contact == name and e.kind == "stick")
        for name in ("cloth", "cloth_spinning", "cloth_rolling")
    )
    assert rolls == pytest.approx(first.t[-1], abs=1e-8)
    # then its direction stays: it slows down by 5/7 f g/r
    speed = np.hypot(*first.y[:2, -1])
    assert rests == pytest.approx(rolls + speed / (5 / 7 * ROLL * G / r), rel=1e-7)
    assert spins == pytest.approx(20 * inertia / (SPIN * m * G), rel=1e-8)
    assert sol.audit().ok


def test_a_coin_on_its_edge_and_a_turntable():
    """The edge of a disc rolls out as a wheel does; what spins with its turntable is not held back."""
    coin = S.Rotor(
        "coin", mass=1.0, inertia_across=0.0025, inertia_axial=0.005, axis=(0, 1, 0), position=(0, 0, 0.1),
        velocity=(0.5, 0, 0), spin=5.0,
    )  # fmt: skip
    edge = S.OnPlane(
        "edge", coin, normal=(0, 0, 1), radius=0.1, friction=fm.laws.Coulomb(mu_s=0.5), rolling_resistance=0.002
    )
    sol = fm.simulate(fm.Scene("coin", [coin, edge, fm.Gravity("g", acceleration={"z": -G})]), t_end=5.0, rtol=1e-9)
    stops = [float(e.t) for e in sol.events if e.contact == "edge_rolling"]
    assert stops[0] == pytest.approx(0.5 * 1.5 / (0.002 / 0.1 * G), rel=1e-8)
    scene = ball((0, 0, 0), (0, 0, 3.0), spinning_resistance=SPIN, turning=3.0)
    sol = fm.simulate(scene, t_end=1.0, rtol=1e-9)
    assert np.abs(sol.force("cloth_spinning")).max() < 1e-12
    assert set(sol.mode("cloth_spinning")) == {0}


def test_the_part_beside_a_joint_follows_it():
    scene = wheel()
    assert [part.name for part in scene.parts] == ["disc", "floor", "floor_rolling", "g"]
    assert scene.parameters["floor_rolling.friction.mu_s"] == ARM
    other = scene.with_parameters({"floor_rolling.friction.mu_s": 0.3})
    assert other["floor_rolling"].friction.mu_s == 0.3
    assert other.with_parameters({"floor.radius": 0.2})["floor_rolling"].friction.mu_s == 0.3
    assert scene.replace("floor", rolling_resistance=0.5)["floor_rolling"].friction.mu_s == 0.5
    assert "floor_rolling" not in scene.replace("floor", rolling_resistance=None)
    assert [part.name for part in pickle.loads(pickle.dumps(other)).parts] == [part.name for part in scene.parts]
    turned = ball((0, 0, 0), (0, 0, 0), spinning_resistance=SPIN, turning=1.0)
    turned = turned.with_parameters({"cloth_spinning.friction.mu_s": 0.02}).with_parameters({"cloth.turning": 2.0})
    assert turned["cloth_spinning"].turning == 2.0
    assert turned["cloth_spinning"].friction.mu_s == 0.02


def test_what_cannot_be_is_refused_by_name():
    with pytest.raises(fm.SceneError, match="rolling_resistance must be"):
        wheel(arm=-1.0)


def test_derivatives_are_those_of_the_closed_form():
    """A wheel that rolls to rest by its resistance goes v^2/(2 d), and stops at v/d, with d in the ratio of the arm."""
    v, name = 1.0, "floor_rolling.friction.mu_s"
    scene = wheel(velocity=(v, 0.0), angular_velocity=-v / R)
    d = ARM / R * G / (1 + J / (M * R**2))
    sol = fm.simulate(scene, t_end=1.2 * v / d, rtol=1e-9, sensitivities=(name, "disc.velocity.x"))
    assert sol.sensitivity("disc.x", name)[-1] == pytest.approx(-(v**2) / (2 * d) / ARM, rel=1e-7)
    stop = next(e for e in sol.events if e.contact == "floor_rolling")
    assert stop.sensitivity(name) == pytest.approx(-v / d / ARM, rel=1e-7)
    spinning = ball((0, 0, 0), (0, 0, 3.0), spinning_resistance=SPIN)
    sol = fm.simulate(spinning, t_end=2.0, rtol=1e-9, sensitivities=("cloth_spinning.friction.mu_s",))
    (stop,) = (e for e in sol.events if e.contact == "cloth_spinning")
    assert stop.sensitivity("cloth_spinning.friction.mu_s") == pytest.approx(-float(stop.t) / SPIN, rel=1e-7)


def test_derivatives_are_those_of_differences_where_load_slip_and_resistance_hang_together():
    """A disc that is thrown on a lean floor, slides, rolls on a spring, and turns round."""
    slope = 0.05
    scene = wheel(
        slope, mu=0.15, velocity=(math.cos(slope), -math.sin(slope)),
        more=(lambda disc: fm.Spring("k", disc, axis="x", stiffness=6.0),),
    )  # fmt: skip
    names = ("floor_rolling.friction.mu_s", "floor.friction.mu_s", "disc.mass", "k.stiffness")
    errors = worst(scene, names, rtol=1e-8, t_end=2.5)
    assert len(errors) == len(names)
    assert max(errors.values()) < 100.0, errors


def test_steady_motion_sees_the_load_of_the_other_joint():
    """A disc held by a spring spins on the floor."""
    scene = wheel(mu=0.2, more=(lambda disc: fm.Spring("k", disc, axis="x", stiffness=50.0),))
    steady = fm.analysis.steady_sliding(scene, speeds={"disc.angle": -4.0})
    assert steady.position("disc.x") == pytest.approx(0.2 * M * G / 50, rel=1e-9)
    assert steady.force("floor_rolling")[0] == pytest.approx(ARM * M * G, rel=1e-9)


def test_a_wheel_that_has_bounced_to_rest_is_slowed_down():
    """It bounces, rolls with 2/3 of its speed, and loses f/R g/(1 + k^2/R^2) then; derivatives are refused."""
    m, R, f, g = 2.0, 0.1, 0.002, 9.81
    disc = fm.RigidBody("disc", mass=m, inertia=m * R * R / 2, position=(0.0, 0.5), velocity=(1.0, 0.0))
    floor = fm.Wheel(
        "floor", disc, radius=R, friction=fm.laws.Coulomb(mu_s=0.2), rolling_resistance=f, push_only=True,
        restitution=0.5,
    )  # fmt: skip
    scene = fm.Scene("bounces", [disc, floor, fm.Gravity("g", acceleration={"y": -g})])
    sol = fm.simulate(scene, t_end=2.5, rtol=1e-8)
    (rest,) = [float(event.t) for event in sol.events if event.kind == "rest"]
    # two bounces take sqrt(2 h/g), and what follows halves: 3 sqrt(2 h/g) in all
    assert rest == pytest.approx(3 * math.sqrt(2 * 0.4 / g), rel=1e-6)
    # it is held from before its last hops on, whose sum dates the rest
    (held,) = [float(event.t) for event in sol.events if event.kind == "close"]
    assert 0.0 <= rest - held < 1e-5
    speed = 2 / 3 - f / R * g / 1.5 * (2.5 - held)
    assert sol.velocity("disc.x")[-1] == pytest.approx(speed, rel=1e-10)
    assert sol.audit().ok
    with pytest.raises(fm.FricmbError, match="resistance beside impacts is not covered"):
        fm.simulate(scene, t_end=0.6, sensitivities=("disc.velocity.x",))
