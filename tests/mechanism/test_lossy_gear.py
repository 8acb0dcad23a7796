"""Gears with losses: both efficiencies, the lock, stick and slip against a program of events."""

import math

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import fricmb as fm

JA, JB = 1.0, 1.5


def train(drive, load, *, ratio=2.0, start=0.0, gravity=None, **losses):
    a = fm.RigidBody("a", mass=1.0, inertia=JA, angular_velocity=start)
    b = fm.RigidBody("b", mass=1.0, inertia=JB, position=(3.0, 0.0), angular_velocity=-start / ratio)
    pins = [fm.Revolute("pa", a), fm.Revolute("pb", b, fm.ground_point(3.0, 0.0))]
    teeth = fm.Gear("teeth", a, b, ratio=ratio, **losses)
    torques = [fm.Torque("drive", a, value=drive), fm.Torque("load", b, value=load)]
    return fm.Scene("train", [a, b, *pins, teeth, *torques])


@pytest.mark.parametrize(("e", "back"), [(0.9, 0.85), (0.5, 0.5), (0.6, 0.3), (0.7, None), (0.45, -0.2), (0.9, 0.5)])
def test_power_that_arrives_is_the_efficiency(e, back):
    """At steady speed, one side driving or the other: the load is what just keeps it turning evenly."""
    behind = 2.0 - 1.0 / e if back is None else back
    # a drives with 1, turning forward: b gets -ratio e
    sol = fm.simulate(train(1.0, 2.0 * e, start=3.0, efficiency=e, efficiency_back=back), t_end=1.0, rtol=1e-9)
    np.testing.assert_allclose(sol.velocity("a.angle"), 3.0, rtol=1e-10)
    if behind > 0.0:
        # b drives, a is braked with what arrives; turning the other way
        held = train(behind, 2.0, start=-3.0, efficiency=e, efficiency_back=back)
        sol = fm.simulate(held, t_end=1.0, rtol=1e-9)
        np.testing.assert_allclose(sol.velocity("a.angle"), -3.0, rtol=1e-10)
        lost = sol.energy.friction_loss[-1]
        assert lost == pytest.approx(3.0 * (1.0 - behind), rel=1e-9)


@pytest.mark.parametrize("e", [0.35, 0.5])
def test_a_worm_up_to_a_half_locks_itself(e):
    """No torque on b moves it; a small one on a does."""
    load = 200.0 * fm.t
    sol = fm.simulate(train(0.0, load, efficiency=e), t_end=5.0)
    assert len(sol.events) == 0
    assert np.abs(sol["a.angle"]).max() < 1e-15
    np.testing.assert_allclose(sol.normal_force("teeth")[-1] * e / (1 - e), abs(sol.force("teeth")[0, -1]), rtol=1e-9)


def test_a_worm_above_a_half_is_driven_from_behind():
    """JA 2 w' = e_b (T - JB w')/2 for the rate w of b."""
    sol = fm.simulate(train(0.0, 200.0 * fm.t, efficiency=0.55), t_end=0.1, rtol=1e-9)
    back = 2.0 - 1.0 / 0.55
    assert sol.velocity("b.angle")[-1] == pytest.approx(back * 100.0 * 0.1**2 / (4.0 * JA + back * JB), rel=1e-9)


def test_breaks_away_where_the_drive_overcomes_load_and_losses():
    """Against a load of -6 on b: the drive has to reach 3/e; it lets go backward below 3 e_b."""
    e, back = 0.8, 0.6
    up = fm.simulate(train(3.0 + fm.t, 6.0, efficiency=e, efficiency_back=back), t_end=2.0, rtol=1e-9)
    assert [(x.kind, x.t) for x in up.events] == [("slip", pytest.approx(3.0 / e - 3.0, rel=1e-9))]
    down = fm.simulate(train(3.0 - fm.t, 6.0, efficiency=e, efficiency_back=back), t_end=2.0, rtol=1e-9)
    assert [(x.kind, x.t) for x in down.events] == [("slip", pytest.approx(3.0 - 3.0 * back, rel=1e-9))]
    sticky = train(3.0 + fm.t, 6.0, efficiency=e, efficiency_back=back, friction=fm.laws.Coulomb(mu_s=1.3, mu_k=1.0))
    assert fm.simulate(sticky, t_end=2.0).events[0].t > up.events[0].t


def program(eta, t_end):
    """A gear of the efficiency eta both ways under 10 sin(2 pi t) and a load ramp, ratio -2: events of rate w of a."""
    mu = 2 * (1 - eta) / (1 + eta)
    drive, load = lambda t: 10 * math.sin(2 * math.pi * t), lambda t: -10 + 2.5 * t

    def rate(t, s):
        for way, k in ((1, eta), (-1, 1 / eta)):
            torque = (JB / 2 * drive(t) - load(t)) / (JB / 2 + 2 * k)
            if torque * s * way >= 0:
                return drive(t) - torque
        raise AssertionError

    def within(t):
        at_a, at_b = drive(t), -load(t) / 2
        return mu * abs(at_a + at_b) / 2 - abs(at_a - at_b)

    t, w, angle, events = 0.0, 0.0, 0.0, []
    mode = 0 if within(0.0) >= 0 else 1 if rate(0.0, 1) > 0 else -1
    while True:
        if mode == 0:
            ahead = np.arange(t + 1e-9, t_end, 1e-4)
            free = [u for u in ahead if within(u) < 0.0]
            if not free:
                return angle, 0.0, events
            t = brentq(within, max(free[0] - 1e-4, t + 1e-9), free[0], xtol=1e-14)
            mode = 1 if rate(t + 1e-9, 1) > 0 else -1
            events.append(("slip", t))
        stops = lambda t, y: y[1]  # noqa: E731
        stops.terminal, stops.direction = True, -mode
        run = solve_ivp(
            lambda t, y, s=mode: [y[1], rate(t, s)], (t, t_end), [angle, w], rtol=1e-11, atol=1e-13, events=stops,
            max_step=2e-3,
        )  # fmt: skip
        t, (angle, w) = run.t[-1], run.y[:, -1]
        if run.status == 0:
            return angle, w, events
        w, mode = 0.0, 0 if within(t) >= 0 else -mode
        events.append(("stick" if mode == 0 else "reversal", t))


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_stick_and_slip_under_a_drive_that_turns_over(method):
    angle, w, events = program(0.5, 1.9)
    scene = train(
        10 * sympy.sin(2 * sympy.pi * fm.t), -10 + 2.5 * fm.t, ratio=-2.0, efficiency=0.5, efficiency_back=0.5
    )
    sol = fm.simulate(scene, t_end=1.9, rtol=1e-8, method=method)
    assert [e.kind for e in sol.events] == [kind for kind, _ in events]
    np.testing.assert_allclose(sol.events.t, [t for _, t in events], atol=2e-8)
    assert sol["a.angle"][-1] == pytest.approx(angle, abs=1e-7)
    assert sol.velocity("a.angle")[-1] == pytest.approx(w, abs=1e-7)
    assert sol.audit().ok
    assert np.abs(sol.energy.residual).max() < 1e-7


def test_sensitivity_to_both_efficiencies():
    """Also where the tooth load passes 0; against differences of runs."""
    scene = train(
        10 * sympy.sin(2 * sympy.pi * fm.t), -10 + 2.5 * fm.t, ratio=-2.0, efficiency=0.5, efficiency_back=0.5
    )
    names = ("teeth.efficiency", "teeth.efficiency_back")
    sol = fm.simulate(scene, t_end=1.9, rtol=1e-9, sensitivities=names)
    for name in names:
        ends = [fm.simulate(scene.with_parameters({name: 0.5 + h}), t_end=1.9, rtol=1e-12) for h in (1e-6, -1e-6)]
        right = (ends[0]["a.angle"][-1] - ends[1]["a.angle"][-1]) / 2e-6
        assert sol.sensitivity("a.angle", name)[-1] == pytest.approx(right, rel=1e-6)


def test_what_cannot_be_is_refused_by_name():
    a, b = fm.RigidBody("a", mass=1.0, inertia=1.0), fm.RigidBody("b", mass=1.0, inertia=1.0, position=(1.0, 0.0))
    for match, given in [
        ("efficiency must be a finite number > 0 and < 1; without losses it is left out, got 1", {"efficiency": 1.0}),
        ("efficiency must be a finite number > 0", {"efficiency": 0.0}),
        ("efficiency_back must be a finite number < 1", {"efficiency": 0.9, "efficiency_back": 1.0}),
        ("efficiency_back must be left out without efficiency", {"efficiency_back": 0.9}),
        ("friction must be left out without efficiency", {"friction": fm.laws.Coulomb(mu_s=0.1)}),
        ("ratio must be another than 0", {"ratio": 0.0, "efficiency": 0.9}),
        ("ratio must be another than 0", {"ratio": 0.0}),
        ("pressure_angle must be a number between -pi/2 and pi/2", {"pressure_angle": 1.6}),
        ("pressure_angle must be left out where centres are in one place", {"ratio": -1.0, "pressure_angle": 0.3}),
        ("centres must be four numbers", {"pressure_angle": 0.3, "centres": 1.0}),
    ]:
        with pytest.raises(fm.SceneError, match=match):
            fm.Gear("g", a, b, **{"ratio": 1.0, **given})


@pytest.mark.parametrize(("ratio", "apart"), [(2.0, (0.6, 0.0)), (2.0, (0.0, -0.6)), (-3.0, (0.4, 0.3))])
def test_teeth_load_the_bearings(ratio, apart):
    """With the torque T on a: T/(r cos alpha) on both, that on a apart from b by T tan(alpha)/r, along by T/r."""
    alpha, T = math.radians(20.0), 5.0
    a = fm.RigidBody("a", mass=1.0, inertia=JA)
    b = fm.RigidBody("b", mass=1.0, inertia=JB, position=apart)
    pins = [fm.Revolute("pa", a), fm.Revolute("pb", b, fm.ground_point(*apart))]
    teeth = fm.Gear("teeth", a, b, ratio=ratio, pressure_angle=alpha)
    loads = [fm.Torque("drive", a, value=-T), fm.Torque("load", b, value=-ratio * T)]
    sol = fm.simulate(fm.Scene("s", [a, b, *pins, teeth, *loads]), t_end=1.0, rtol=1e-9)
    assert sol.reaction("teeth")[0, -1] == pytest.approx(T, rel=1e-12)
    np.testing.assert_allclose(sol.velocity("a.angle"), 0.0, atol=1e-12)
    D = np.array(apart)
    e = D / np.linalg.norm(D) * (1.0 if ratio > -1.0 else -1.0)
    r = np.linalg.norm(D) / abs(1.0 + ratio)
    t = np.array([-e[1], e[0]])
    force = T / r * t - T / r * math.tan(alpha) * e
    np.testing.assert_allclose(sol.reaction("pa")[:, -1], -force, rtol=1e-10)
    np.testing.assert_allclose(sol.reaction("pb")[:, -1], force, rtol=1e-10)
    # torque of the force at the pitch point about both centres
    about = lambda arm, push: arm[0] * push[1] - arm[1] * push[0]  # noqa: E731
    assert about(r * e, force) == pytest.approx(T)
    assert about(r * e - D, -force) == pytest.approx(ratio * T)


def test_friction_in_the_pins_feels_the_teeth():
    """Steady turning: T = lam (1 + mu p/(r cos alpha)) at a, and the load on b is less by the same at b."""
    alpha, mu, p, T, ratio, D = -math.radians(20.0), 0.2, 0.03, 6.0, 2.0, 0.6
    rub = {"radius": p, "friction": fm.laws.Coulomb(mu_s=mu)}
    a = fm.RigidBody("a", mass=1.0, inertia=JA, angular_velocity=4.0)
    b = fm.RigidBody("b", mass=1.0, inertia=JB, position=(D, 0.0), angular_velocity=-2.0)
    pins = [fm.Revolute("pa", a, **rub), fm.Revolute("pb", b, fm.ground_point(D, 0.0), **rub)]
    teeth = fm.Gear("teeth", a, b, ratio=ratio, pressure_angle=alpha)
    arm = D / (1.0 + ratio) * math.cos(alpha)
    lam = T / (1.0 + mu * p / arm)
    loads = [fm.Torque("drive", a, value=T), fm.Torque("load", b, value=ratio * lam - mu * p / arm * lam)]
    sol = fm.simulate(fm.Scene("s", [a, b, *pins, teeth, *loads]), t_end=1.0, rtol=1e-9)
    np.testing.assert_allclose(sol.velocity("a.angle"), 4.0, rtol=1e-9)
    np.testing.assert_allclose(sol.reaction("teeth")[0], -lam, rtol=1e-9)
    assert sol.audit().ok


def test_sensitivity_to_the_pressure_angle():
    rub = {"radius": 0.03, "friction": fm.laws.Coulomb(mu_s=0.2)}
    a = fm.RigidBody("a", mass=1.0, inertia=JA, angular_velocity=4.0)
    b = fm.RigidBody("b", mass=1.0, inertia=JB, position=(0.6, 0.0), angular_velocity=-2.0)
    pins = [fm.Revolute("pa", a, **rub), fm.Revolute("pb", b, fm.ground_point(0.6, 0.0), **rub)]
    loads = [fm.Torque("drive", a, value=6.0), fm.Torque("load", b, value=9.0)]
    scene = fm.Scene("s", [a, b, *pins, fm.Gear("teeth", a, b, ratio=2.0, pressure_angle=-0.35), *loads])
    name = "teeth.pressure_angle"
    sol = fm.simulate(scene, t_end=1.0, rtol=1e-9, sensitivities=(name,))
    up, low = (fm.simulate(scene.with_parameters({name: -0.35 + h}), t_end=1.0, rtol=1e-12) for h in (1e-4, -1e-4))
    right = (up["a.angle"][-1] - low["a.angle"][-1]) / 2e-4
    assert sol.sensitivity("a.angle", name)[-1] == pytest.approx(right, rel=1e-6)


@pytest.mark.parametrize("by_points", [False, True])
def test_centres_that_move_are_told(by_points):
    """A wheel without a pin is pushed away by the teeth; with one, or on a carriage that carries both, it stays."""

    def run(held):
        a = fm.RigidBody("a", mass=1.0, inertia=JA)
        b = fm.RigidBody("b", mass=1.0, inertia=JB, position=(0.6, 0.0))
        base = fm.RigidBody("base", mass=2.0, inertia=1.0)
        ends = (a.point("c", (0.0, 0.0)), b.point("c", (0.0, 0.0))) if by_points else (a, b)
        teeth = fm.Gear("teeth", *ends, ratio=2.0, pressure_angle=0.35)
        parts = [a, b, teeth, fm.Torque("drive", a, value=1.0)]
        if held == "carriage":
            at = base.point("pa", (0.0, 0.0)), base.point("pb", (0.6, 0.0))
            parts += [base, fm.Revolute("pa", a, at[0]), fm.Revolute("pb", b, at[1])]
            parts += [fm.Prismatic("rail", base, fm.GROUND), fm.Force("F", base, axis="x", value=3.0)]
        else:
            parts += [fm.Revolute("pa", a)]
            parts += [fm.Revolute("pb", b, fm.ground_point(0.6, 0.0))] if held == "pin" else []
        return fm.simulate(fm.Scene("s", parts), t_end=1.0, rtol=1e-8)

    for held in ("pin", "carriage"):
        assert not any("centres" in note for note in run(held).stats.notes)
    sol = run("")
    way = np.hypot(sol["b.x"] - sol["a.x"] - 0.6, sol["b.y"] - sol["a.y"]).max() / 0.6
    (note,) = (note for note in sol.stats.notes if "centres" in note)
    assert "gear 'teeth'" in note
    assert f"moved by up to {way:.2g} of their distance" in note
