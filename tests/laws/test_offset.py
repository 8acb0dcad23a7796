"""Friction that differs by direction, against closed forms and a program of its own."""

import math

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import fricmb as fm

METHODS = ("auto", "radau", "bdf", "taylor")
BY_SENSE = fm.laws.Offset.by_sense(mu_s=(0.2, 0.6), mu_k=(0.1, 0.5))


def block(law, value, mass=2.0, N=10.0):
    body = fm.Body("b", mass=mass)
    return fm.Scene(
        "block", [body, fm.Contact("feet", body, law=law, normal_force=N), fm.Force("f", body, axis="x", value=value)]
    )


@pytest.mark.parametrize("method", METHODS)
def test_it_sticks_between_both_limits(method):
    """Let go at 2 forward, at 6 back: 8 sin t reaches the one at asin(1/4); of -7 sin t the other at asin(6/7)."""
    for value, limit in ((8 * sympy.sin(fm.t), math.asin(0.25)), (-7 * sympy.sin(fm.t), math.asin(6 / 7))):
        sol = fm.simulate(block(BY_SENSE, value), t_end=2.0, rtol=1e-10, method=method)
        assert sol.events[0].kind == "slip"
        assert float(sol.events[0].t) == pytest.approx(limit, rel=1e-10)
        assert sol.audit().ok


@pytest.mark.parametrize("method", METHODS)
def test_force_and_losses_are_those_of_both_senses(method):
    sol = fm.simulate(block(BY_SENSE, 8 * sympy.sin(fm.t)), t_end=12.0, rtol=1e-10, method=method)
    force, speed = sol.force("feet")[0], sol.relative_velocity("feet")[0]
    np.testing.assert_allclose(force[speed > 1e-6], -1.0, rtol=1e-12)
    np.testing.assert_allclose(force[speed < -1e-6], 5.0, rtol=1e-12)
    way = np.abs(np.diff(sol["b.x"]))
    forward = np.diff(sol["b.x"]) > 0
    # between samples the velocity may turn round, at a located reversal: a sample
    assert sol.energy.friction_loss[-1] == pytest.approx(way[forward].sum() + 5 * way[~forward].sum(), rel=1e-9)
    assert np.abs(sol.energy.residual).max() < 1e-11
    assert sol.energy.potential[-1] == 0.0


def steady_robot(P, a, b, w):
    """Phase at which it sets out forward, and way in a period, of v' = P sin(w t + phase) - a forward, + b back.

    Over a period friction brings no momentum: forward slip takes the share b/(a + b) of it; over forward slip the
    velocity comes back to 0: ``2 P/w sin(m) sin(w s/2) = a s`` with the phase m at its middle.
    """
    T = 2 * math.pi / w
    s = T * b / (a + b)
    middle = math.pi - math.asin(a * s * w / (2 * P * math.sin(w * s / 2)))
    way = 0.0
    for length, pull, phase in ((s, a, middle - w * s / 2), (T - s, -b, middle + w * s / 2)):
        swing = length * math.cos(phase) - (math.sin(phase + w * length) - math.sin(phase)) / w
        way += P / w * swing - pull * length**2 / 2
    return middle - w * s / 2, way


def test_mean_drift_of_a_robot_that_shakes_itself_along():
    """It never sticks: the drive exceeds friction wherever it turns round."""
    m, N, w, force = 2.0, 10.0, 5.0, 60.0
    law = fm.laws.Offset.by_sense(mu_s=(0.2, 0.6))
    phase, way = steady_robot(force / m, 0.2 * N / m, 0.6 * N / m, w)
    T = 2 * math.pi / w
    for method in METHODS:
        sol = fm.simulate(
            block(law, force * sympy.sin(w * fm.t + phase)), t_end=40 * T, rtol=1e-10, method=method,
            t_eval=np.arange(41) * T,
        )
        np.testing.assert_allclose(sol["b.x"], np.arange(41) * way, rtol=1e-8, atol=1e-8)
        assert {event.kind for event in sol.events} <= {"reversal", "slip"}
    # and from rest at another phase it comes to the same drift
    sol = fm.simulate(block(law, force * sympy.sin(w * fm.t)), t_end=80 * T, rtol=1e-10, t_eval=np.array([79, 80]) * T)
    assert np.diff(sol["b.x"])[0] == pytest.approx(way, rel=1e-7)


@pytest.mark.parametrize("method", ["auto", "radau", "bdf"])
@pytest.mark.parametrize("ratio", [1.0, 1.5])
def test_a_cone_about_another_centre_in_two_directions(method, ratio):
    """A puck that slides to rest, and is pulled loose: against an integration of the slip by scipy and a quadratic."""
    mu, c, N = 0.4, np.array([0.1, -0.2]), 2.0
    S = np.array([1.0, ratio])
    inner = fm.laws.Coulomb(mu_s=mu) if ratio == 1.0 else fm.laws.Elliptic(law=fm.laws.Coulomb(mu_s=mu), ratio=ratio)
    puck = fm.Body("p", mass=1.0, axes="xy", velocity={"x": 3.0, "y": -2.0})
    scene = fm.Scene("puck", [
        puck, fm.Contact("c", puck, law=fm.laws.Offset(law=inner, offset=tuple(c)), normal_force=N),
        fm.Force("f", puck, axis=(3.0, 4.0), value=sympy.Max(0, fm.t - 8)),
    ])  # fmt: skip
    sol = fm.simulate(scene, t_end=12.0, rtol=1e-10, method=method)
    stick, slip = [event for event in sol.events if event.kind in ("stick", "slip")][:2]

    def slide(t, y):
        v = y[2:]
        return [*v, *(-mu * N * S * (S * v) / np.hypot(*(S * v)) - c * N)]

    own = solve_ivp(
        slide, (0.0, 8.0), [0.0, 0.0, 3.0, -2.0], rtol=1e-12, atol=1e-13, method="DOP853",
        events=[_slow],
    )  # fmt: skip
    # the last stretch: the speed of 1e-7 is lost within 1e-6
    assert float(stick.t) == pytest.approx(own.t_events[0][0], abs=1e-6)
    at = sol(float(stick.t) + 0.1)
    np.testing.assert_allclose(at[:2], own.y_events[0][0][:2], atol=1e-10)
    pull = np.array([0.6, 0.8])
    limit = brentq(lambda F: np.hypot(*((F * pull - c * N) / S)) - mu * N, 0.0, 5.0, xtol=1e-14)
    assert float(slip.t) == pytest.approx(8.0 + limit, rel=1e-9)
    assert sol.audit().ok


def _slow(t, y):
    return np.hypot(y[2], y[3]) - 1e-7


_slow.terminal = True


def test_derivatives_know_the_offset():
    def make(**more):
        given = {"feet.law.law.mu_s": 0.4, "feet.law.law.mu_k": 0.3, "feet.law.offset": -0.2, "feet.normal_force": 10.0}
        return block(BY_SENSE, 8 * sympy.sin(fm.t)).with_parameters({**given, **more})

    names = ("feet.law.offset", "feet.normal_force", "feet.law.law.mu_k", "feet.law.law.mu_s")
    sol = fm.simulate(make(), t_end=7.0, rtol=1e-10, sensitivities=names)
    for name, d in zip(names, (1e-5, 1e-4, 1e-5, 1e-5), strict=True):
        at = make().parameters[name]
        high, low = (fm.simulate(make(**{name: at + s}), t_end=7.0, rtol=1e-12)["b.x"][-1] for s in (d, -d))
        assert sol.sensitivity("b.x", name)[-1] == pytest.approx((high - low) / (2 * d), rel=1e-5)


def test_a_varying_load_between_two_bodies_and_a_file(tmp_path):
    """The whole force is within both limits, momentum is exchanged, and a file keeps it."""
    a, b = fm.Body("a", mass=2.0), fm.Body("b", mass=3.0)
    N = 10 * (1 + 0.5 * sympy.sin(3 * fm.t))
    scene = fm.Scene("two", [
        a, b, fm.Contact("c", a, b, law=BY_SENSE, normal_force=N),
        fm.Force("f", a, axis="x", value=8 * sympy.sin(fm.t)),
    ])  # fmt: skip
    sol = fm.simulate(scene, t_end=12.0, rtol=1e-10)
    share, slip = sol.force("c")[0] / sol.normal_force("c"), sol.relative_velocity("c")[0]
    np.testing.assert_allclose(share[slip > 1e-6], -0.1, rtol=1e-9)
    np.testing.assert_allclose(share[slip < -1e-6], 0.5, rtol=1e-9)
    assert share.min() >= -0.2 - 1e-9
    assert share.max() <= 0.6 + 1e-9
    assert len(sol.events) == 4
    momentum = 2 * sol.velocity("a.x") + 3 * sol.velocity("b.x")
    np.testing.assert_allclose(momentum, 8 * (1 - np.cos(sol.t)), atol=1e-8)
    assert sol.audit().ok
    sol.save(tmp_path / "run.npz")
    np.testing.assert_allclose(fm.Solution.load(tmp_path / "run.npz").force("c"), sol.force("c"), rtol=1e-14)


def test_a_servo_drive_with_an_offset():
    """Dry friction of a motor, 0.3 one way and 0.1 the other."""
    motor = fm.RigidBody("motor", mass=1.0, inertia=0.5, angular_velocity=1.0)
    pin = fm.Revolute("pin", motor)
    law = fm.laws.Offset.by_sense(mu_s=(0.3, 0.1))
    sol = fm.simulate(fm.Scene("servo", [motor, pin, fm.DryFriction("dry", motor, axis=pin, law=law)]), t_end=3.0)
    assert float(sol.events[0].t) == pytest.approx(0.5 / 0.3, rel=1e-8)
    assert sol.energy.friction_loss[-1] == pytest.approx(0.25, rel=1e-8)


def test_what_is_no_cone_about_a_centre_is_refused():
    coulomb = fm.laws.Coulomb(mu_s=0.2)
    body = fm.RigidBody("b", mass=1.0, inertia=1.0)
    refused = {
        "within the cone of slow slip": lambda: fm.laws.Offset(law=coulomb, offset=0.3),
        "at most mu_s forward and back": lambda: fm.laws.Offset.by_sense(mu_s=(0.3, 0.6), mu_k=(0.2, 0.7)),
        "two coefficients": lambda: fm.laws.Offset.by_sense(mu_s=0.3),
        "a set-valued law of the slip speed": lambda: fm.laws.Offset(law=fm.laws.LuGre.example(), offset=0.1),
        "without an offset": lambda: fm.laws.Offset.example().regularised(1e-3),
        "isotropic": lambda: fm.laws.Elliptic(law=fm.laws.Offset.example(), ratio=2.0),
        "a law without an offset": lambda: fm.Revolute("p", body, radius=0.1, friction=fm.laws.Offset.example()),
        "left out beside a law": lambda: block(fm.laws.Offset.example(), 0.0) and fm.Contact(
            "c", fm.Body("x", mass=1.0), law=fm.laws.Offset.example(), normal_force=1.0, slide=1.0
        ),
        "a number or an expression": lambda: fm.Contact(
            "c", fm.Body("x", mass=1.0, axes="xy"), law=fm.laws.Offset.example(),
            normal_force=fm.normal.Spring(axis="y", stiffness=1.0),
        ),
    }  # fmt: skip
    for words, make in refused.items():
        with pytest.raises(fm.FricmbError, match=words):
            make()


@pytest.mark.parametrize("method", ["auto", "radau"])
def test_kinetic_above_static_is_held_up_to_kinetic(method):
    """What a user insists on: the note says what is solved."""
    law = fm.laws.Coulomb(mu_s=0.2, mu_k=0.3, insist=True)
    sol = fm.simulate(block(law, fm.t), t_end=6.0, method=method)
    assert float(sol.events[0].t) == pytest.approx(3.0, rel=1e-9)
    assert any("sticks up to mu_k" in note for note in sol.stats.notes)
    with pytest.raises(fm.LawError, match="insist=True takes more"):
        fm.laws.Coulomb(mu_s=0.2, mu_k=0.3)
    with pytest.raises(fm.LawError, match="left out where mu_k is not above mu_s"):
        fm.laws.Coulomb(mu_s=0.3, mu_k=0.3, insist=True)


def test_pictures_show_the_limits_of_both_senses():
    import matplotlib.pyplot as plt

    sol = fm.simulate(block(BY_SENSE, 8 * sympy.sin(fm.t)), t_end=12.0)
    (ax,) = sol.plot.force("feet").axes
    limits = sorted({round(float(line.get_ydata()[0]), 9) for line in ax.lines if np.ptp(line.get_ydata()) < 1e-9})
    assert limits == pytest.approx([-2.0, 6.0])
    plt.close("all")


def row(n, tied, by_hand):
    """Blocks in a row; by hand the offset is a force."""
    parts = []
    for i in range(n):
        body = fm.Body(f"b{i}", mass=1.0, velocity={"x": 0.3 * (-1) ** i})
        law = fm.laws.Coulomb(mu_s=0.4) if by_hand else fm.laws.Offset.by_sense(mu_s=(0.2, 0.6))
        held = parts[-1][0] if tied and parts else fm.GROUND
        parts.append((
            body, fm.Spring(f"k{i}", body, held, axis="x", stiffness=20.0),
            fm.Contact(f"c{i}", body, law=law, normal_force=1.0),
            *([fm.Force(f"o{i}", body, axis="x", value=0.2)] if by_hand else []),
        ))  # fmt: skip
    push = fm.Force("f", parts[-1][0], axis="x", value=1.2 * sympy.sin(2 * fm.t))
    return fm.Scene("row", [*(part for own in parts for part in own), push])


@pytest.mark.parametrize(("n", "tied"), [(5, True), (5, False), (100, True)])
def test_it_is_coulombs_law_beside_a_force(n, tied):
    """By islands, in bulk, and in part; the same to round-off."""
    law, hand = (fm.simulate(row(n, tied, by_hand), t_end=3.0, rtol=1e-8) for by_hand in (False, True))
    assert len(law.events) == len(hand.events) > 5
    for i in range(n):
        assert law[f"b{i}.x"][-1] == pytest.approx(hand[f"b{i}.x"][-1], abs=1e-13)
    assert law.force("c0")[0, -1] == pytest.approx(hand.force("c0")[0, -1] + 0.2, abs=1e-9)
    assert np.abs(law.energy.residual).max() < 1e-9
    if not tied:
        part = fm.simulate(row(n, tied, False), t_end=3.0, rtol=1e-8, observe=["b4.x"])
        assert part.names.dofs == ("b4.x",)
        assert part.force("c4")[0, -1] == pytest.approx(law.force("c4")[0, -1], abs=1e-7)


def test_a_mass_on_a_belt_swings_about_what_slip_takes():
    """A limit cycle: the offset moves it along and leaves its period, 2 (pi - atan(D w/v))/w + 2 D/v."""
    body, belt = fm.Body("m", mass=1.0), fm.Driven("belt", velocity={"x": 0.2})
    scene = fm.Scene("belt", [
        body, belt, fm.Spring("k", body, axis="x", stiffness=1.0),
        fm.Contact("c", body, belt, law=BY_SENSE, normal_force=1.0),
    ])  # fmt: skip
    assert fm.analysis.steady_sliding(scene).position("m.x") == pytest.approx(0.5, rel=1e-12)
    cycle = fm.analysis.limit_cycle(scene, start=fm.simulate(scene, t_end=40.0, rtol=1e-9))
    D = 0.1
    assert cycle.period == pytest.approx(2 * (np.pi - np.arctan(D / 0.2)) + 2 * D / 0.2, rel=1e-9)
