"""Stops and play beside dry friction, against closed forms and a program of events."""

import math

import numpy as np
import pytest
import sympy
from scipy.integrate import quad, solve_ivp

import fricmb as fm

K, GAP, DRY, M, J = 2000.0, 0.1, 0.3, 0.01, 0.05
#: Steps of the program: shorter than any touch.
STEP = 1e-4


def test_block_between_stops_hits_each_half_a_period():
    block = fm.Body("block", mass=1.0, velocity={"x": 2.0})
    ends = fm.Stop("ends", block, axis="x", lower=-1.0, upper=1.0, stiffness=100.0)
    sol = fm.simulate(fm.Scene("s", [block, ends]), t_end=3.0, rtol=1e-9)
    touches = sol.touches("ends")
    half = math.pi / 10.0
    np.testing.assert_allclose(touches.begin, [0.5, 1.5 + half], atol=1e-10)
    np.testing.assert_allclose(touches.end, [0.5 + half, 1.5 + 2 * half], atol=1e-10)
    assert touches.side == ["upper", "lower"]
    assert len(touches) == 2
    assert np.abs(sol.energy.residual).max() < 1e-9


def test_restitution_of_hunt_and_crossley():
    """v dv/dd = -k d (1 + c v)/m: the speed that it leaves with by its first integral."""
    v, k, c, m = 1.3, 500.0, 0.4, 2.0
    ball = fm.Body("ball", mass=m, velocity={"x": v})
    wall = fm.Stop("wall", ball, axis="x", upper=0.0, stiffness=k, hunt_crossley=c)
    sol = fm.simulate(fm.Scene("s", [ball, wall]), t_end=1.0, rtol=1e-10)
    out = -sol.velocity("ball.x")[-1]

    def stored(speed):
        return quad(lambda w: w / (1 + c * w), 0.0, speed, epsabs=1e-14)[0]

    assert stored(v) == pytest.approx(stored(-out), rel=1e-9)
    lost = sol.energy.damping_loss[-1]
    assert lost == pytest.approx(m * (v**2 - out**2) / 2, rel=1e-9)


def program(t_end, hunt_crossley):
    """A motor drives a dry load through play; flanks and friction by events."""

    def total(z, side):
        d, rate = side * (z[0] - z[1]) - GAP / 2, side * (z[2] - z[3])
        return K * d * (1 + hunt_crossley * rate)

    t, y, rest, side, events = 0.0, np.zeros(4), True, 0, []
    while t < t_end:
        pushed = side * total(y, side) if side else 0.0
        s = 0.0 if rest else math.copysign(1.0, y[3] if y[3] else pushed)

        def rates(t, z, s=s, side=side):
            mesh = side * total(z, side) if side else 0.0
            return [
                z[2],
                z[3] if s else 0.0,
                (math.sin(2 * math.pi * t) - mesh) / M,
                (mesh - DRY * s) / J if s else 0.0,
            ]

        def flank(t, z, side=side):
            return side * (z[0] - z[1]) - GAP / 2 if side else GAP / 2 - abs(z[0] - z[1])

        def dry(t, z, s=s, side=side):
            return z[3] * s if s else DRY - (abs(total(z, side)) if side else 0.0)

        for event in (flank, dry):
            event.terminal, event.direction = True, -1
        run = solve_ivp(
            rates, (t, t_end), y, method="DOP853", rtol=1e-12, atol=1e-14, events=[flank, dry], max_step=STEP
        )
        t, y = run.t[-1], run.y[:, -1].copy()
        if run.status == 0:
            return y, events
        if len(run.t_events[0]):
            events.append(("open" if side else "close", t))
            side = 0 if side else int(np.sign(y[0] - y[1]))
            continue
        y[3] = 0.0
        here = abs(total(y, side)) if side else 0.0
        kind = "slip" if rest else "stick" if here <= DRY else "reversal"
        rest = kind == "stick"
        events.append((kind, t))
    return y, events


@pytest.mark.parametrize("hunt_crossley", [0.0, 0.4])
def test_play_with_a_dry_load(hunt_crossley):
    motor, load = fm.Body("motor", mass=M), fm.Body("load", mass=J)
    scene = fm.Scene(
        "play",
        [
            motor, load, fm.Force("torque", motor, axis="x", value=sympy.sin(2 * sympy.pi * fm.t)),
            fm.Backlash("mesh", motor, load, axis="x", gap=GAP, stiffness=K, hunt_crossley=hunt_crossley),
            fm.DryFriction("dry", load, axis="x", static=DRY),
        ],
    )  # fmt: skip
    t_end, rtol = 0.7, 1e-9
    y, events = program(t_end, hunt_crossley)
    sol = fm.simulate(scene, t_end=t_end, rtol=rtol)
    np.testing.assert_allclose(sol.q[:, -1], y[:2], atol=1e-7)
    assert [e.kind for e in sol.events] == [kind for kind, _ in events if kind not in ("open", "close")]
    touches = sol.touches("mesh")
    begin, end = ([t for kind, t in events if kind == which] for which in ("close", "open"))
    np.testing.assert_allclose(touches.begin, begin, atol=1e-8)
    np.testing.assert_allclose(touches.end[: len(end)], end, atol=1e-8)
    assert sol.audit().ok
    assert np.abs(sol.energy.residual).max() < 1e-8


def test_sensitivity_to_the_gap():
    """Through several touches, against differences of runs."""
    motor, load = fm.Body("motor", mass=M), fm.Body("load", mass=J)
    mesh = fm.Backlash("mesh", motor, load, axis="x", gap=GAP, stiffness=K, hunt_crossley=0.5)
    torque = fm.Force("torque", motor, axis="x", value=sympy.sin(2 * sympy.pi * fm.t))
    scene = fm.Scene("play", [motor, load, mesh, torque, fm.DryFriction("dry", load, axis="x", static=DRY)])
    sol = fm.simulate(scene, t_end=0.5, rtol=1e-9, sensitivities=("mesh.gap",))
    up, low = (fm.simulate(scene.with_parameters({"mesh.gap": GAP + h}), t_end=0.5, rtol=1e-11) for h in (1e-6, -1e-6))
    assert sol.sensitivity("load.x", "mesh.gap")[-1] == pytest.approx(
        (up["load.x"][-1] - low["load.x"][-1]) / 2e-6, rel=1e-5
    )


def test_arm_on_a_stop_at_its_joint():
    """It comes to rest on the stop, where spring and weight balance."""
    arm = fm.RigidBody("arm", mass=2.0, inertia=0.1, position=(0.5, 0.0), points={"pin": (-0.5, 0.0)})
    pin = fm.Revolute("pin", arm.point("pin"))
    end = fm.Stop("end", arm, axis=pin, lower=-0.6, stiffness=400.0, hunt_crossley=0.5)
    dry = fm.DryFriction("dry", arm, axis=pin, static=0.2)
    sol = fm.simulate(fm.Scene("arm", [arm, pin, end, dry, fm.Gravity("g")]), t_end=6.0, rtol=1e-7)
    assert sol.events[-1].kind == "stick"
    angle = sol["arm.angle"][-1]
    held = 400.0 * (-0.6 - angle) - 2.0 * 9.81 * 0.5 * math.cos(angle)
    assert sol.force("dry")[0, -1] == pytest.approx(-held, abs=1e-7)
    assert abs(held) <= 0.2
    assert sol.audit().ok


def test_wheels_in_mesh_with_play():
    """Free within the gap, driven as by a gear beyond: a + ratio b stays within half the gap and the spring's give."""
    a = fm.RigidBody("a", mass=1.0, inertia=0.02, angular_velocity=5.0)
    b = fm.RigidBody("b", mass=1.0, inertia=0.1, position=(3.0, 0.0))
    pins = [fm.Revolute("pa", a), fm.Revolute("pb", b, fm.ground_point(3.0, 0.0))]
    mesh = fm.Backlash("mesh", a, b, ratio=2.0, gap=0.02, stiffness=1e4)
    sol = fm.simulate(fm.Scene("mesh", [a, b, *pins, mesh]), t_end=0.1, rtol=1e-9)
    touches = sol.touches("mesh")
    assert touches.begin[0] == pytest.approx(0.002, rel=1e-9)
    # the angular momentum J_a w_a + ratio.. : J_b w_b - ratio J_a w_a is kept, as the teeth push both
    kept = 0.1 * sol.velocity("b.angle") - 2.0 * 0.02 * sol.velocity("a.angle")
    np.testing.assert_allclose(kept, -2.0 * 0.02 * 5.0, atol=1e-9)
    assert sol.energy.kinetic[-1] + sol.energy.potential[-1] == pytest.approx(0.25, rel=1e-9)


@pytest.mark.parametrize("loss", [10.0, 50.0])
@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8])
def test_one_touch_where_the_loss_takes_nearly_all(loss, rtol):
    """The block parts at 1/loss, where the force is 0 to round-off, and is free where the spring is."""
    speed, w2 = 4.0, 100.0
    block = fm.Body("block", mass=1.0, velocity={"x": speed})
    ends = fm.Stop("ends", block, axis="x", upper=1.0, stiffness=w2, hunt_crossley=loss)
    sol = fm.simulate(fm.Scene("s", [block, ends]), t_end=3.0, rtol=rtol)

    def rates(t, y):
        return [y[1], -w2 * y[0] * (1.0 + loss * y[1])]

    def free(t, y):
        return y[0] + (t < 0.01)

    free.terminal = True
    end = solve_ivp(rates, (0.0, 3.0), [0.0, speed], "Radau", events=free, rtol=1e-11, atol=1e-13).t[-1]
    touches = sol.touches("ends")
    assert len(touches) == 1
    np.testing.assert_allclose(touches.begin, 0.25, atol=1e-8)
    np.testing.assert_allclose(touches.end, 0.25 + end, atol=rtol)


def test_a_flank_that_is_pulled_away_faster_than_its_spring_is_told_so():
    """A force pulls for a while, and the block comes back before the spring is free: two touches."""
    k, damping, depth, pull = 100.0, 20.0, 1e-3, 40.0
    block = fm.Body("block", mass=1.0, position={"x": 1.5}, velocity={"x": 0.0})
    force = fm.Force("pull", block, axis="x", value=sympy.Piecewise((-pull, fm.t < 0.07), (2 * pull, True)))
    ends = fm.Stop("ends", block, axis="x", upper=1.0, stiffness=k, damping=damping, damping_depth=depth)
    sol = fm.simulate(fm.Scene("s", [block, ends, force]), t_end=0.2, rtol=1e-8)

    def pushes(d, v):
        return k * d + damping * v

    def rates(t, y):
        return [y[1], -max(0.0, pushes(*y)) + (-pull if t < 0.07 else 2 * pull)]

    def turn(t, y):
        return pushes(*y)

    options = {"events": turn, "rtol": 1e-11, "atol": 1e-13, "max_step": 1e-3}
    first = solve_ivp(rates, (0.0, 0.07), [0.5, 0.0], **options)
    second = solve_ivp(rates, (0.07, 0.2), first.y[:, -1], **options)
    assert second.y[0].min() > depth  # never free
    touches = sol.touches("ends")
    np.testing.assert_allclose(touches.begin, [0.0, second.t_events[0][0]], atol=1e-6)
    np.testing.assert_allclose(touches.end, [first.t_events[0][0], 0.2], atol=1e-6)
