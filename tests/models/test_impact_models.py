"""Models with impacts against closed forms, and against a program that knows nothing but their arcs."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import fricmb as fm


@pytest.mark.parametrize("e", [0.5, 0.7])
def test_bounces_are_a_geometric_series(e):
    sol = fm.simulate(fm.models.bouncing_ball(restitution=e), t_end=6.0, rtol=1e-8)
    hits, (rest,) = sol.events.of(kind="impact"), sol.events.of(kind="rest")
    fall = math.sqrt(2 * 1.0 / 9.81)
    closed = [fall * (1 + 2 * sum(e**i for i in range(1, k + 1))) for k in range(10)]
    assert np.allclose(hits.t[:10], closed, rtol=0, atol=1e-12)
    assert abs(rest.t - fall * (1 + e) / (1 - e)) <= rest.bound
    assert sol.audit().ok


def test_friction_in_impacts_takes_the_slip_until_the_ball_rolls():
    e, mu, R, v = 0.7, 0.08, 0.1, math.sqrt(2 * 9.81)
    sol = fm.simulate(fm.models.bouncing_ball(), t_end=3.0, rtol=1e-8)
    slip = 2.0 + R * 10.0
    for k in range(4):
        # at most mu times the impulse, which an effective mass of 2/7 of the ball feels
        slip -= min(slip, 3.5 * mu * (1 + e) * v * e**k)
        after = sol(sol.impulse("floor").t[k])
        assert abs(after[3] + R * after[5] - slip) < 1e-11
    assert slip == 0.0
    # about the floor the angular momentum stays: 7/5 v = v0 - 2/5 R w0
    assert abs(sol.velocity("ball.x")[-1] - (2.0 - 0.4 * R * 10.0) / 1.4) < 1e-11


@pytest.mark.parametrize(("b", "h"), [(0.2, 0.6), (0.1, 0.5)])
def test_an_impact_of_a_rocking_block_leaves_what_housner_found(b, h):
    alpha, start = math.atan2(b, h), 0.5 * math.atan2(b, h)
    scene = fm.models.rocking_block(half_width=b, half_height=h, angle=start)
    sol = fm.simulate(scene, t_end=3.0, rtol=1e-10)
    hits = [event for event in sol.events.of(kind="impact") if event.approach > 1e-3]
    leaves = 1 - 1.5 * math.sin(alpha) ** 2
    # energy of the pendulum about its corner: (4/3) r^2 w^2/2 = g r (cos(alpha - angle) - cos(alpha - start))
    r = math.hypot(b, h)
    rate = math.sqrt(1.5 * 9.81 / r * (math.cos(alpha - start) - math.cos(alpha)))
    for hit in hits[:5]:
        assert abs(hit.approach / (2 * b) - rate) < 1e-8
        rate *= leaves
        assert abs(abs(sol(hit.t)[5]) - rate) < 1e-8
    # the time to the first: angle = start - x^2 takes the root's singularity out
    speed = lambda x: math.sqrt(1.5 * 9.81 / r * (math.cos(alpha - start) - math.cos(alpha - start + x * x)))  # noqa: E731
    first, _ = quad(lambda x: 2 * x / speed(x), 0.0, math.sqrt(start), epsabs=1e-12, epsrel=1e-12)
    assert abs(hits[0].t - first) < 1e-8
    assert sol.audit().ok


def test_a_block_that_is_turned_to_either_side_rocks_alike():
    left, right = (fm.simulate(fm.models.rocking_block(angle=a), t_end=2.0, rtol=1e-8) for a in (0.1, -0.1))
    t = np.linspace(0.0, 2.0, 101)
    assert np.allclose(left.at(t)["block.angle"], -right.at(t)["block.angle"], rtol=0, atol=1e-9)


def arcs(t_end, *, A, w, gap, e, d):
    """Impacts of the loose gear by its parabolas: it slows down by d until it rests, and flanks strike it."""
    t, y, u, found = 0.0, 0.0, 0.0, []

    def place(s):
        still = min(s - t, abs(u) / d)
        return y + u * still - math.copysign(d, u) * still**2 / 2

    def rate(s):
        return u - math.copysign(min(d * (s - t), abs(u)), u)

    while True:
        # first time at which the play is used up
        times = np.arange(t + 1e-9, t_end, 1e-5)
        play = [(A * math.sin(w * s) - place(s)) ** 2 - (gap / 2) ** 2 for s in times]
        out = next((i for i, x in enumerate(play) if x > 0), None)
        if out is None:
            return found
        hit = brentq(lambda s: abs(A * math.sin(w * s) - place(s)) - gap / 2, times[out - 1], times[out], xtol=1e-15)
        drive, before, y = A * w * math.cos(w * hit), rate(hit), place(hit)
        found.append((hit, abs(drive - before)))
        t, u = hit, drive + e * (drive - before)


def test_the_loose_gear_is_struck_where_its_arcs_meet_the_flanks():
    A, w, J = 2e-3, 200.0, 1e-3
    sol = fm.simulate(fm.models.gear_rattle(restitution=0.7), t_end=0.12, rtol=1e-10)
    found = arcs(0.12, A=A, w=w, gap=2e-3, e=0.7, d=0.01 / J)
    impulse = sol.impulse("mesh")
    assert len(found) == len(impulse.t) > 8
    assert abs(impulse.t[0] - math.asin(0.5) / w) < 1e-12
    assert np.allclose(impulse.t, [t for t, _ in found], rtol=0, atol=1e-8)
    assert np.allclose(impulse.normal, [1.7 * J * speed for _, speed in found], rtol=1e-6)
    assert sol.audit().ok


def test_a_flank_that_lets_go_is_no_pull():
    """Driven slowly enough a flank holds the gear, and lets go where friction alone slows it as the drive does."""
    sol = fm.simulate(fm.models.gear_rattle(torque=0.02, restitution=0.5, gap=1e-3), t_end=1.0, rtol=1e-8)
    lets_go = sol.events.of(kind="open").t
    assert len(lets_go) >= 1
    assert np.allclose(np.abs(np.sin(200.0 * lets_go)), 0.02 / (1e-3 * 2e-3 * 200.0**2), rtol=0, atol=1e-6)
    assert sol.audit().ok


def test_gears_without_restitution_pass_their_audit():
    """Flanks that are left as soon as they are hit never pull, not even for the instant."""
    sol = fm.simulate(fm.models.gear_rattle(restitution=0.0), t_end=0.3)
    assert len(sol.events.of(kind="rest")) > 5
    assert sol.audit().ok, sol.audit()
