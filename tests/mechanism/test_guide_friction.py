"""Dry friction along guides that turn, against an integration by scipy in the coordinate of the guide."""

import pickle

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import fricmb as fm

M, F, G, TILT, W = 1.3, 4.0, 9.81, 0.5, 2.5


def tilting(rubs, angle=0.0, **more):
    """A block on a guide of a table that is tilted to and fro about its hub, 0.5 away from it."""
    table = fm.RigidBody("table", mass=5.0, inertia=1.0)
    block = fm.RigidBody("block", mass=M, inertia=0.02, position=(0.5 * np.cos(angle), 0.5 * np.sin(angle)))
    guide = fm.Prismatic("guide", block, table, angle=angle, **more)
    tilt = fm.DrivenAngle("tilt", table, angle=TILT * sympy.sin(W * fm.t))
    parts = [table, block, fm.Revolute("hub", table), tilt, guide, fm.Gravity("g")]
    return fm.Scene("tilting", [*parts, *rubs(block, guide)])


def swing(t):
    """Tilt, its rate and acceleration."""
    return TILT * np.sin(W * t), TILT * W * np.cos(W * t), -TILT * W**2 * np.sin(W * t)


def own_run(slip, hold, t_end):
    """Way and speed at t_end and the transitions; ``slip(t, y)``, ``hold(t, s)``: friction force of slip, and limit."""

    def needed(t, s):
        angle, rate, _ = swing(t)
        return M * (G * np.sin(angle) - s * rate**2)

    def slide(t, y):
        return [y[1], (-needed(t, y[0]) - np.sign(way) * slip(t, y)) / M]

    t, y, way, events = 0.0, np.array([0.5, 0.0]), 0.0, []
    while t < t_end:
        if way == 0.0:
            beyond = lambda time: abs(needed(time, y[0])) - hold(time, y[0])  # noqa: B023, E731
            grid = np.linspace(t + 1e-9, t_end, 4001)
            over = np.flatnonzero([beyond(time) > 0 for time in grid])
            if not over.size:
                break
            t = brentq(beyond, grid[over[0] - 1], grid[over[0]], xtol=1e-14)
            way = -np.sign(needed(t, y[0]))
            events.append(("slip", t))
            continue
        begin = t
        stop = lambda time, y: y[1] * way if time > begin + 1e-6 else 1.0  # noqa: B023, E731
        stop.terminal, stop.direction = True, -1
        found = solve_ivp(slide, (t, t_end), y, rtol=1e-12, atol=1e-13, method="DOP853", events=stop)
        t, y = float(found.t[-1]), found.y[:, -1]
        if found.status == 0:
            break
        y[1] = 0.0
        held = abs(needed(t, y[0])) <= hold(t, y[0])
        way = 0.0 if held else -np.sign(needed(t, y[0]))
        events.append(("stick" if held else "reversal", t))
    return y, events


def compare(scene, contact, own, events, method):
    sol = fm.simulate(scene, t_end=4.0, rtol=1e-9, method=method)
    found = [(event.kind, float(event.t)) for event in sol.events]
    assert [kind for kind, _ in found] == [kind for kind, _ in events]
    np.testing.assert_allclose([t for _, t in found], [t for _, t in events], atol=1e-8)
    assert np.hypot(sol["block.x"][-1], sol["block.y"][-1]) == pytest.approx(abs(own[0]), rel=1e-8)
    assert sol.relative_velocity(contact)[0, -1] == pytest.approx(own[1], abs=1e-7)
    assert sol.audit().ok


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_a_block_on_a_tilting_table_under_a_constant_limit(method):
    make = lambda block, guide: [fm.DryFriction("dry", block, axis=guide, static=1.2 * F, kinetic=F)]  # noqa: E731
    own, events = own_run(lambda t, y: F, lambda t, s: 1.2 * F, 4.0)
    assert len(events) > 5
    compare(tilting(make), "dry", own, events, method)


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_it_holds_along_a_guide_that_leans_in_its_table(method):
    angle = 0.3
    make = lambda block, guide: [fm.DryFriction("dry", block, axis=guide, static=50.0)]  # noqa: E731
    sol = fm.simulate(tilting(make, angle), t_end=2.0, rtol=1e-9, method=method)
    assert set(sol.mode("dry")) == {0}  # 50 holds it wherever the table goes
    tilt, rate, _ = swing(sol.t)
    np.testing.assert_allclose(sol.force("dry")[0], M * (G * np.sin(tilt + angle) - 0.5 * rate**2), atol=1e-6)


def under_its_own_load(*, mu_s, mu_k):
    """The block on the table by an own program, its friction by the force across the guide."""

    def across(t, s, speed):
        angle, rate, acceleration = swing(t)
        return abs(M * (G * np.cos(angle) + s * acceleration + 2 * rate * speed))

    return own_run(lambda t, y: mu_k * across(t, *y), lambda t, s: mu_s * across(t, s, 0.0), 4.0)


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_a_block_on_a_tilting_table_under_its_own_load(method):
    """Two guides that move on each other: friction of the guide itself, by the force across."""
    own, events = under_its_own_load(mu_s=0.35, mu_k=0.3)
    assert len(events) > 3
    scene = tilting(lambda block, guide: [], friction=fm.laws.Coulomb(mu_s=0.35, mu_k=0.3))
    compare(scene, "guide", own, events, method)


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_a_point_on_a_moving_line(method):
    """The same without the guide holding the block's angle: a point that slides on a line fixed in the table."""
    mu_s, mu_k = 0.35, 0.3
    own, events = under_its_own_load(mu_s=mu_s, mu_k=mu_k)
    table = fm.RigidBody("table", mass=5.0, inertia=1.0)
    block = fm.Body("block", mass=M, axes="xy", position={"x": 0.5})
    scene = fm.Scene("line", [
        table, block, fm.Revolute("hub", table), fm.DrivenAngle("tilt", table, angle=TILT * sympy.sin(W * fm.t)),
        fm.RollerOnLine("line", block, table, friction=fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k)), fm.Gravity("g"),
    ])  # fmt: skip
    compare(scene, "line", own, events, method)


def test_it_follows_its_guide_and_is_refused_by_name():
    make = lambda block, guide: [fm.DryFriction("dry", block, axis=guide, static=F)]  # noqa: E731
    scene = tilting(make)
    assert scene.with_parameters({"guide.angle": 0.1})["dry"].angle == 0.1
    assert pickle.loads(pickle.dumps(scene))["dry"].friction == fm.laws.Coulomb(mu_s=F)
    table, block = scene["table"], scene["block"]
    with pytest.raises(fm.SceneError, match="that slides"):
        fm.DryFriction("d", table, axis=scene["guide"], static=1.0)
    with pytest.raises(fm.SceneError, match="left out along a guide"):
        fm.DryFriction("d", block, axis=scene["guide"], static=1.0, slide=1.0)
    with pytest.raises(fm.SceneError, match="static or law must be given"):
        fm.DryFriction("d", block, axis=scene["guide"])


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("angle", [0.0, 0.4])
def test_a_stop_along_a_guide_that_spins(method, angle):
    """s'' = w^2 s, and in the stop s'' = -W^2 (s - s_e): it touches at acosh(u/s)/w, and for 2 (pi + atan(..))/W."""
    w, u, s, k = 2.0, 0.8, 0.3, 500.0
    table = fm.RigidBody("table", mass=5.0, inertia=1.0, angular_velocity=w)
    block = fm.RigidBody(
        "block", mass=M, inertia=0.02, position=(s * np.cos(angle), s * np.sin(angle)),
        velocity=(-s * w * np.sin(angle), s * w * np.cos(angle)), angular_velocity=w,
    )  # fmt: skip
    guide = fm.Prismatic("guide", block, table, angle=angle)
    stop = fm.Stop("end", block, axis=guide, upper=u, stiffness=k)
    drive = fm.DrivenAngle("drive", table, angle=w * fm.t)
    scene = fm.Scene("spinning", [table, block, fm.Revolute("hub", table), drive, guide, stop])
    sol = fm.simulate(scene, t_end=1.1, rtol=1e-9, method=method)
    begin = np.arccosh(u / s) / w
    fast = np.sqrt(k / M - w**2)
    away = u - k * u / M / fast**2
    end = begin + 2 * (np.pi + np.arctan(s * w * np.sinh(w * begin) / fast / away)) / fast
    touches = sol.touches("end")
    assert touches.side == ["upper"]
    assert float(touches.begin[0]) == pytest.approx(begin, rel=1e-8)
    assert float(touches.end[0]) == pytest.approx(end, rel=1e-8)
    assert sol.audit().ok
    assert scene.with_parameters({"guide.angle": 0.1})["end"].angle == 0.1


def test_play_along_a_guide_is_that_along_its_direction():
    """On a table that stays, the guide is a direction."""
    def scene(axis, angle):
        table = fm.RigidBody("table", mass=5.0, inertia=1.0)
        block = fm.RigidBody("block", mass=M, inertia=0.02)
        guide = fm.Prismatic("guide", block, table, angle=angle)
        made = fm.Backlash(
            "play", block, table, axis=guide if axis is None else axis, gap=0.1, stiffness=300.0, hunt_crossley=0.5
        )
        push = fm.Force("f", block, axis=(np.cos(angle), np.sin(angle)), value=5 * sympy.sin(3 * fm.t))
        return fm.Scene("play", [table, block, fm.Fixed("weld", table), guide, made, push])

    angle = 0.7
    along, direct = (
        fm.simulate(scene(axis, angle), t_end=3.0, rtol=1e-9) for axis in (None, (np.cos(angle), np.sin(angle)))
    )
    assert along["block.x"][-1] == pytest.approx(direct["block.x"][-1], abs=1e-10)
    np.testing.assert_allclose(along.touches("play").begin, direct.touches("play").begin, atol=1e-9)
