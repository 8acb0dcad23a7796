"""Derivatives through impacts, cycles with impacts: certified values, closed forms, and runs beside."""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy

import fricmb as fm


def block():
    body = fm.Body("block", mass=1.0, velocity={"x": 1.0})
    parts = [
        body,
        fm.Spring("spring", body, axis="x", stiffness=1.0),
        fm.Stop("ends", body, axis="x", lower=-0.8, upper=0.8, restitution=0.6),
        fm.DryFriction("dry", body, axis="x", static=0.36, kinetic=0.3),
        fm.Force("push", body, axis="x", value=0.9 * sympy.cos(0.7 * fm.t)),
    ]
    return fm.Scene("block", parts)


@pytest.mark.parametrize("rtol", [1e-6, 1e-8, 1e-10])
def test_a_block_that_hits_two_stops_has_the_certified_derivatives(rtol):
    sol = fm.simulate(block(), t_end=5.5, rtol=rtol, sensitivities="block.velocity.x")
    assert [event.kind for event in sol.events] == ["impact", "reversal"] * 2
    # by central differences of the closed flow in 40 digits
    by = "block.velocity.x"
    assert sol.sensitivity("block.x", by)[-1] == pytest.approx(-0.0908232883906432, abs=100 * rtol)
    assert sol.sensitivity("block.x.velocity", by)[-1] == pytest.approx(0.4426217454865822, abs=100 * rtol)
    assert not sol.stats.notes


def test_a_ball_thrown_with_backspin_has_the_derivatives_of_closed_forms():
    """The first impact slips and the second one stops slip; flights are parabolas."""
    g, h, e, mu, R, u, w = 9.81, 1.0, 0.7, 0.08, 0.1, 2.0, 10.0
    names = ("floor.friction.mu_s", "floor.restitution", "ball.velocity.x", "ball.angular_velocity")
    sol = fm.simulate(fm.models.bouncing_ball(), t_end=1.3, rtol=1e-10, sensitivities=names)
    assert len(sol.events.of(kind="impact")) == 2

    def motion(mu, e, u, w):
        V = sympy.sqrt(2 * g * h)
        first, second = V / g, V / g * (1 + 2 * e)
        slides = u - mu * (1 + e) * V  # behind the first impact
        turns = w - mu * (1 + e) * V / (sympy.Rational(2, 5) * R)
        rolls = slides - sympy.Rational(2, 7) * (slides + R * turns)
        x = u * first + slides * (second - first) + rolls * (1.3 - second)
        return x, rolls, -rolls / R, second

    symbols = sympy.symbols("mu e u w")
    values = dict(zip(symbols, (mu, e, u, w), strict=True))
    wanted = motion(*symbols)
    for name, symbol in zip(names, symbols, strict=True):
        x, v, spin, time = (float(sympy.diff(one, symbol).subs(values)) for one in wanted)
        assert sol.sensitivity("ball.x", name)[-1] == pytest.approx(x, abs=1e-9)
        assert sol.sensitivity("ball.x.velocity", name)[-1] == pytest.approx(v, abs=1e-9)
        assert sol.sensitivity("ball.angle.velocity", name)[-1] == pytest.approx(spin, abs=1e-8)
        assert sol.events.of(kind="impact")[-1].sensitivity(name) == pytest.approx(time, abs=1e-9)


def beside(scene, name, signal, t_end):
    """A derivative by runs at values beside that of a parameter."""
    p = float(fm.values.value_of(scene.parameters[name]))
    h = 1e-6 * abs(p)
    more, less = (fm.simulate(scene, t_end=t_end, rtol=1e-12, parameters={name: p + x})[signal][-1] for x in (h, -h))
    return (more - less) / (2 * h)


def pendulum():
    angle = 1.2
    place = (0.5 * math.sin(angle), -0.5 * math.cos(angle))
    arm = fm.RigidBody("arm", mass=1.0, inertia=0.1, position=place, angle=angle, points={"pin": (0.0, 0.5)})
    parts = [
        arm,
        fm.Revolute("pin", arm.point("pin"), radius=0.05, friction=fm.laws.Coulomb(mu_s=0.3)),
        fm.Stop("stop", arm, axis="angle", lower=0.2, restitution=0.6),
        fm.Gravity("g"),
    ]
    return fm.Scene("pendulum", parts)


@pytest.mark.parametrize(
    ("scene", "t_end", "names", "signal"),
    [
        (pendulum(), 1.5, ("stop.lower", "stop.restitution", "pin.friction.mu_s", "arm.inertia"), "arm.angle.velocity"),
        (
            fm.models.gear_rattle(),
            0.03,
            ("mesh.gap", "mesh.restitution", "mesh.ratio", "gear.inertia", "shaft.law.mu_s"),
            "gear.angle.velocity",
        ),
    ],
)
def test_joints_take_part_in_derivatives_through_impacts(scene, t_end, names, signal):
    sol = fm.simulate(scene, t_end=t_end, rtol=1e-10, sensitivities=names)
    assert len(sol.events.of(kind="impact")) >= 2
    for name in names:
        assert sol.sensitivity(signal, name)[-1] == pytest.approx(beside(scene, name, signal, t_end), rel=1e-5)


def test_a_run_in_which_bounces_end_is_refused_by_the_surface_that_holds():
    with pytest.raises(fm.SceneError, match=r"'floor' holds from t = 2\.5586.* after its last bounce"):
        fm.simulate(fm.models.bouncing_ball(), t_end=4.0, sensitivities="floor.restitution")


def test_an_impact_that_only_touches_has_no_sound_derivative():
    body = fm.Body("block", mass=1.0, velocity={"x": 1.0})
    stop = fm.Stop("stop", body, axis="x", upper=1.0 - 1e-9, restitution=0.5)
    scene = fm.Scene("grazes", [body, fm.Spring("spring", body, axis="x", stiffness=1.0), stop])
    sol = fm.simulate(scene, t_end=2.0, rtol=1e-10, sensitivities="spring.stiffness")
    assert [event.kind for event in sol.events] == ["impact"]
    assert sol.events[0].transversality == pytest.approx(math.sqrt(2e-9), rel=1e-3)
    assert any("grow as one over that" in note for note in sol.stats.notes)


# -- a ball on an oscillating table ---------------------------------------------------------------------------------
GRAVITY, OMEGA, E = 9.81, 100.0, 0.8
PERIOD = 2 * math.pi / OMEGA


def table(amplitude):
    """The orbit that hits the table once a period, a little beside it, from the middle of its flight on."""
    phase = math.acos(GRAVITY * PERIOD / 2 * (1 - E) / (1 + E) / (amplitude * OMEGA))
    gone = 0.3 * PERIOD
    v = GRAVITY * PERIOD / 2
    place = amplitude * math.sin(phase) + v * gone - GRAVITY * gone**2 / 2
    body = fm.Body("ball", mass=1.0, axes="y", position={"y": place + 1e-5}, velocity={"y": v - GRAVITY * gone})
    A = fm.parameter("A", amplitude)
    moves = fm.Driven("table", position={"y": A * sympy.sin(OMEGA * fm.t + phase + OMEGA * gone)}, axes="y")
    stop = fm.Stop("contact", body, moves, axis="y", lower=0.0, restitution=E)
    return fm.Scene("table", [body, moves, stop, fm.Gravity("g", acceleration={"y": -GRAVITY})])


def multipliers(amplitude):
    """Of the map from impact to impact: its determinant is e^2, its trace follows from the table's acceleration."""
    lift = math.sqrt(1 - (GRAVITY * PERIOD / 2 * (1 - E) / (1 + E) / (amplitude * OMEGA)) ** 2)
    k = amplitude * OMEGA**2 * lift / GRAVITY
    trace = 1 + E**2 - (1 + E) ** 2 * k
    return np.roots([1.0, -trace, E**2])


def test_a_ball_on_a_table_has_the_cycle_and_the_multipliers_of_closed_forms():
    cycle = fm.analysis.limit_cycle(table(1e-3), period=PERIOD)
    assert cycle.period == pytest.approx(PERIOD, rel=1e-14)
    found, wanted = np.sort_complex(cycle.multipliers), np.sort_complex(multipliers(1e-3))
    # certified: real part -0.7315373007402559, size 0.8
    assert wanted[0].real == pytest.approx(-0.7315373007402559, abs=1e-12)
    assert np.abs(found - wanted).max() < 1e-10


def test_a_branch_of_cycles_with_impacts_doubles_its_period_where_a_closed_form_says():
    cycle = fm.analysis.limit_cycle(table(1e-3), period=PERIOD)
    branch = fm.analysis.continue_cycle(cycle, over="A", to=1.2e-3, points=20, progress=False)
    (flip,) = branch.special
    assert type(flip) is fm.analysis.Flip
    k = 2 * (1 + E**2) / (1 + E) ** 2  # where the trace is -(1 + e^2)
    w = GRAVITY * PERIOD / 2 * (1 - E) / (1 + E)
    assert flip.value == pytest.approx(math.hypot(k * GRAVITY / OMEGA**2, w / OMEGA), rel=1e-9)
    last = branch.cycles[-1]
    assert np.abs(last.multipliers).max() > 1.5
    assert np.abs(np.sort(last.multipliers.real) - np.sort(multipliers(branch.values[-1]).real)).max() < 1e-7
