"""Scenes with impacts whose solutions are known to 15 digits, each computed in two ways that share no code.

The ways: closed forms, quadratures and closed flows between impacts in 30 to 40 digits; and an event-driven program
with an explicit method of order 8 in each mode at 2e-14, roots with real steps, and enumeration of modes and impulses.
"""

import math

import numpy as np
import pytest
import sympy

import fricmb as fm

RTOL = [1e-6, 1e-8, 1e-10]
#: Errors are at most so many times rtol.
PARTS = 10.0


def near(found, wanted, rtol, growth=1.0):
    assert abs(float(found) - wanted) <= PARTS * rtol * growth * max(1.0, abs(wanted)), (found, wanted)


def of(sol, kind):
    return list(sol.events.of(kind=kind))


def ball(e=0.8):
    ball = fm.Body("ball", mass=1.0, axes="xy", position={"y": 1.0})
    floor = fm.RollerOnLine("floor", ball, push_only=True, restitution=e)
    return fm.Scene("ball", [ball, floor, fm.Gravity("g")])


@pytest.mark.parametrize("rtol", RTOL)
def test_a_ball_bounces_until_it_rests(rtol):
    sol = fm.simulate(ball(), t_end=5.0, rtol=rtol)
    hits, (rest,) = of(sol, "impact"), of(sol, "rest")
    for i, t in ((0, 0.4515236409857309), (1, 1.1739614665629), (9, 3.578892951020438)):
        assert abs(hits[i].t - t) < 1e-12
    assert abs(rest.t - 4.063712768871578) < min(rest.bound, 1e-11)
    assert rest.left > 0.0
    assert abs(0.8 * hits[9].approach - 0.4756082413119682) < 1e-12
    height = sol.at(np.array([2.0]))["ball.y"][0]
    assert abs(height - 0.2607417283270572) < 1e-12
    # what is held while bounces would still fade bears its weight
    assert abs(sol.impulse("floor").normal.sum() + 9.81 * rest.left - 39.86502226263018) < 1e-9
    assert abs(sol.energy.impact_loss[-1] - 9.81) < 1e-12
    assert np.abs(sol.energy.residual).max() < 1e-13
    assert sol["ball.y"].min() > -1e-12


@pytest.mark.parametrize("rtol", RTOL)
def test_a_ball_on_an_oscillating_table_keeps_its_period(rtol):
    A, w, phase, v, period = 0.001, 100.0, 1.221290450550073, 0.3081902393171587, 0.06283185307179586
    body = fm.Body("ball", mass=1.0, axes="xy", position={"y": A * math.sin(phase)}, velocity={"y": v})
    table = fm.Driven("table", position={"y": A * sympy.sin(w * fm.t + phase)}, axes="y")
    stop = fm.Stop("contact", body, table, axis="y", lower=0.0, restitution=0.8)
    sol = fm.simulate(fm.Scene("table", [body, table, stop, fm.Gravity("g")]), t_end=20.5 * period, rtol=rtol)
    hits = of(sol, "impact")
    assert len(hits) == 20
    near(hits[-1].t, 20 * period, rtol)
    near(sol.impulse("contact").normal[7], 0.6163804786343174, rtol)
    now = sol.at(np.array([2.25 * period]))
    near(now["ball.y"][0] - now["table.y"][0], 0.004227889151924393, rtol)
    assert np.abs(sol.energy.residual).max() < 100 * rtol


@pytest.mark.parametrize("rtol", RTOL)
def test_a_block_between_stops_rubs_and_sticks(rtol):
    block = fm.Body("block", mass=1.0, velocity={"x": 1.0})
    parts = [
        block,
        fm.Spring("spring", block, axis="x", stiffness=1.0),
        fm.Stop("ends", block, axis="x", lower=-0.8, upper=0.8, restitution=0.6),
        fm.DryFriction("dry", block, axis="x", static=0.36, kinetic=0.3),
        fm.Force("push", block, axis="x", value=0.9 * sympy.cos(0.7 * fm.t)),
    ]
    sol = fm.simulate(fm.Scene("block", parts), t_end=40.0, rtol=rtol)
    hits, sticks = of(sol, "impact"), of(sol, "stick")
    assert len(hits) == 9
    assert len(sticks) == 8
    assert [hit.side for hit in hits] == ["upper", "lower"] * 4 + ["upper"]
    at_first = [event.kind for event in sol.events if event.t == hits[0].t]
    assert at_first == ["impact", "reversal"]
    near(hits[0].t, 0.7168891340397369, rtol)
    near(hits[-1].t, 36.07644723876578, rtol)
    near(0.6 * hits[-1].approach, 0.5311845807723397, rtol)
    near(sticks[0].t, 5.980267254253956, rtol)
    near(sticks[-1].t, 37.22835464800472, rtol)
    near(sol["block.x"][-1], -0.2947692746566221, rtol)
    near(sol.velocity("block.x")[-1], -0.8596699513236375, rtol)
    near(sol.energy.impact_loss[-1], 2.286531320404552, rtol)
    assert np.abs(sol.energy.residual).max() < 1e-10


@pytest.mark.parametrize("rtol", RTOL)
def test_a_ball_thrown_with_backspin_slips_then_rolls_in_impacts(rtol):
    m, R = 0.2, 0.1
    body = fm.RigidBody(
        "ball", mass=m, inertia=0.4 * m * R**2, position=(0.0, 1.0 + R), velocity=(2.0, 0.0), angular_velocity=-50.0
    )
    law = fm.laws.Coulomb(mu_s=0.08)
    floor = fm.Wheel("floor", body, radius=R, push_only=True, restitution=0.7, friction=law)
    sol = fm.simulate(fm.Scene("ball", [body, floor, fm.Gravity("g")]), t_end=3.0, rtol=rtol)
    hits, (rest,), impulse = of(sol, "impact"), of(sol, "rest"), sol.impulse("floor")
    near(hits[0].t, 0.4515236409857309, 1e-13)
    near(hits[1].t, 1.083656738365754, 1e-13)
    assert np.allclose(impulse.normal[:2], [1.506011952143807, 1.054208366500665], rtol=0, atol=1e-12)
    assert np.allclose(impulse.tangential[:2], [0.1204809561715045, 0.05094761525706688], rtol=0, atol=1e-12)
    assert np.abs(impulse.tangential[2:]).max() < 1e-13
    after = sol(0.5)
    assert abs(after[3] - 2.602404780857523) < 1e-12
    assert abs(after[5] + 34.93988047856193) < 1e-11
    assert abs(rest.t - 2.558633965585808) < min(rest.bound, 1e-11)
    near(sol["ball.x"][-1], 8.023379938543639, 1e-12)
    assert abs(sol.velocity("ball.angle")[-1] + 28.57142857142857) < 1e-11
    assert sol.mode("floor")[-1] == 0  # it rolls
    assert abs(sol.energy.impact_loss[-1] - 2.219142857142857) < 1e-11


@pytest.mark.parametrize("rtol", RTOL)
def test_a_rod_catches_on_its_tip_where_no_slip_has_a_solution(rtol):
    rod = fm.RigidBody(
        "rod", mass=1.0, inertia=1 / 3, position=(0.0, 0.5 + math.sin(1.0)), angle=1.0, velocity=(-3.0, 0.0),
        points={"tip": (-1.0, 0.0)},
    )  # fmt: skip
    law = fm.laws.Coulomb(mu_s=2.0)
    floor = fm.RollerOnLine("floor", rod.point("tip"), push_only=True, restitution=0.3, friction=law)
    sol = fm.simulate(fm.Scene("rod", [rod, floor, fm.Gravity("g")]), t_end=0.58, rtol=rtol)
    impulse = sol.impulse("floor")
    times = [0.3192754284070505, 0.5118283334590739, 0.5695383963150857]
    assert np.allclose(impulse.t, times, rtol=0, atol=1e-12)
    assert np.allclose(impulse.normal, [4.203196768692192, 0.9902338294445496, 0.294162513229409], rtol=0, atol=1e-11)
    along = [2.795236346043693, 0.3942385543483421, 0.1201238008808046]
    assert np.allclose(impulse.tangential, along, rtol=0, atol=1e-11)
    after = [sol(t)[3:] for t in impulse.t]
    assert np.allclose(after[0], [-0.2047636539563075, 1.071104816019027, 0.2433401242029206], rtol=0, atol=1e-11)
    assert np.allclose(after[2], [0.3095987012728393, -0.09957855648483999, -0.360221515743039], rtol=0, atol=1e-11)


@pytest.mark.parametrize("rtol", RTOL)
def test_a_pendulum_with_a_dry_pin_rests_on_its_stop(rtol):
    """Friction turns round on each hop, so that they shrink by e sqrt(a2/a1)."""
    at = 1.4
    bob = fm.RigidBody(
        "bob", mass=1.0, inertia=0.5, position=(math.sin(at), -math.cos(at)), angle=at, points={"pin": (0.0, 1.0)}
    )
    parts = [
        bob,
        fm.Revolute("pin", bob.point("pin"), fm.GROUND),
        fm.DryFriction("dry", bob, axis="angle", static=0.6 * 1.5),
        fm.Stop("stop", bob, axis="angle", lower=0.3, restitution=0.7),
        fm.Gravity("g", acceleration={"y": -9.81 * 1.5}),
    ]
    sol = fm.simulate(fm.Scene("pendulum", parts), t_end=4.0, rtol=rtol)
    hits, (rest,) = of(sol, "impact"), of(sol, "rest")
    times = [0.5134969787921993, 1.339220508362074, 2.01714059296383, 2.526883944505081]
    speeds = [3.753524553395337, 2.348779648637492, 1.422750589395917, 0.8360195141302381]
    for hit, t, speed in zip(hits, times, speeds, strict=False):
        near(hit.t, t, rtol)
        near(hit.approach, speed, rtol)
    near(rest.t, 3.358532583895605, rtol)
    assert abs(rest.t - 3.358532583895605) <= rest.bound


def test_three_equal_balls_in_touch_share_an_elastic_impact_together():
    balls = [fm.Body(f"b{i}", mass=1.0, position={"x": float(i)}, velocity={"x": float(i == 0)}) for i in range(3)]
    touch = [fm.Stop(f"c{i}", balls[i + 1], balls[i], axis="x", lower=1.0, restitution=1.0) for i in range(2)]
    sol = fm.simulate(fm.Scene("balls", [*balls, *touch]), t_end=1.0)
    assert np.allclose(sol.v[:, -1], [-1 / 3, 2 / 3, 2 / 3], rtol=0, atol=1e-15)
    assert np.allclose(sol.impulse("c0").normal, [4 / 3], rtol=0, atol=1e-15)
    assert np.allclose(sol.impulse("c1").normal, [2 / 3], rtol=0, atol=1e-15)
    assert [hit.others for hit in sol.events.of(kind="impact")] == [1, 1]
