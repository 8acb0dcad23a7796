"""Slip across a guide: part of the cone, against own integrations of the equations of motion."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

import fricmb as fm

LAW = fm.laws.Coulomb(mu_s=1.0)
BLOCK = fm.Body("b", mass=1.0)
SPRING = fm.Spring("k", BLOCK, axis="x", stiffness=1.0)
IDLE = fm.RigidBody("idle", mass=1.0, inertia=1.0)
#: By the general method, and beside a body that turns by that for mechanisms.
DRIVERS = pytest.mark.parametrize("beside", [(), (IDLE,)], ids=["blocks", "mechanism"])


def across(speed):
    return fm.Driven("belt", velocity={"x": 0.1, "y": speed})


def scene(belt, *beside, **contact):
    given = {"law": LAW, "normal_force": 1.0, **contact}
    return fm.Scene("guided", [BLOCK, SPRING, belt, fm.Contact("c", BLOCK, belt, **given), *beside])


def motion(across, times, N=1.0, start=(0.0, 0.0)):
    """X of the block while it slips, friction along its velocity relative to the belt."""

    def rates(t, y):
        slip = y[1] - 0.1
        return [y[1], -y[0] - N * slip / np.sqrt(slip**2 + across(t) ** 2 + 1e-26)]

    found = solve_ivp(rates, (times[0], times[-1]), start, t_eval=times, rtol=1e-10, atol=1e-12, method="Radau")
    return found.y[0]


@DRIVERS
@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_block_in_a_guide_creeps_on_a_belt_that_moves_across(beside, method):
    times = np.linspace(0.0, 20.0, 101)
    sol = fm.simulate(scene(across(1.0), *beside), t_end=20.0, rtol=1e-8, method=method)
    assert not len(sol.events)
    assert sol.at(times)["b.x"] == pytest.approx(motion(lambda t: 1.0, times), abs=1e-8)
    assert np.abs(sol.energy.residual).max() < 1e-8
    assert sol.audit().ok, sol.audit()
    # the guide bears the force across; the belt's work is that of both components
    assert np.hypot(*sol.force("c")) == pytest.approx(1.0)


def test_two_components_of_slide_are_those_of_a_belt():
    times = np.linspace(0.0, 20.0, 101)
    contact = fm.Contact("c", BLOCK, law=LAW, normal_force=1.0, axes="xy", slide=(-0.1, 1.0))
    sol = fm.simulate(fm.Scene("slide", [BLOCK, SPRING, contact]), t_end=20.0, rtol=1e-8)
    assert sol.at(times)["b.x"] == pytest.approx(motion(lambda t: 1.0, times), abs=1e-8)


def test_point_of_a_modal_body_that_no_mode_moves_across():
    times = np.linspace(0.0, 20.0, 101)
    shapes = {"p": np.array([[1.0], [0.0]])}
    body = fm.ModalBody("m", frequencies=[1.0], damping_ratios=0.0, shapes=shapes, axes="xy")
    belt = across(1.0)
    contact = fm.Contact("c", body.point("p"), belt, law=LAW, normal_force=1.0)
    sol = fm.simulate(fm.Scene("modal", [body, belt, contact]), t_end=20.0, rtol=1e-8)
    assert sol.at(times)["m.mode1"] == pytest.approx(motion(lambda t: 1.0, times), abs=1e-8)
    assert sol.audit().ok, sol.audit()


def test_roller_on_a_surface_that_moves_across():
    times = np.linspace(0.0, 20.0, 101)
    body = fm.Body("b", mass=1.0, axes="xy")
    roller = fm.RollerOnLine("r", body, friction=fm.laws.Coulomb(mu_s=0.5), slide=(0.1, 1.0))
    parts = [body, roller, fm.Spring("k", body, axis="x", stiffness=1.0), fm.Gravity("g")]
    sol = fm.simulate(fm.Scene("roller", parts), t_end=20.0, rtol=1e-8)
    N = 0.5 * fm.Gravity("g").acceleration["y"]
    assert sol.at(times)["b.x"] == pytest.approx(motion(lambda t: 1.0, times, N=abs(N)), abs=1e-8)
    with pytest.raises(fm.SceneError, match=r"slide.*along the line and across"):
        fm.RollerOnLine("r", body, friction=LAW, slide=(0.1, 1.0, 2.0))
    with pytest.raises(fm.SceneError, match="b must be an end that stays in the plane"):
        fm.RollerOnLine("r", body, fm.Driven("d", velocity={"z": 1.0}), friction=LAW)


@DRIVERS
@pytest.mark.parametrize("N", [1.0, 4.9])
def test_slip_across_that_turns_round_is_no_stick(beside, N):
    """The heavier block has come to rest along its guide where the belt turns round across it."""
    times = np.linspace(0.0, 5.0, 51)
    sol = fm.simulate(scene(across(1.0 - fm.t), *beside, normal_force=N), t_end=5.0, rtol=1e-9)
    assert not len(sol.events)
    assert sol.at(times)["b.x"] == pytest.approx(motion(lambda t: 1.0 - t, times, N=N), abs=1e-8)
    assert sol.audit().ok, sol.audit()


@DRIVERS
def test_block_that_sticks_lets_go_when_the_belt_sets_out_across(beside):
    speed = sympy.Piecewise((0, fm.t < 3), (1, fm.t < 5), (0, True))
    sol = fm.simulate(scene(across(speed), *beside), t_end=10.0, rtol=1e-9)
    assert [e.kind for e in sol.events] == ["stick", "slip", "stick"]
    t_stick = np.arcsin(0.0) + sol.events[0].t
    before = sol.at([3.0])
    times = np.linspace(3.0, 5.0, 21)
    start = [float(before["b.x"][0]), 0.1]
    assert start[0] == pytest.approx(float(sol.at([t_stick])["b.x"][0]) + 0.1 * (3.0 - t_stick), abs=1e-9)
    assert sol.at(times)["b.x"] == pytest.approx(motion(lambda t: 1.0, times, start=start), abs=1e-8)
    assert sol.events[1].t == 3.0
    assert sol.audit().ok, sol.audit()


def test_table_with_two_axes_under_a_block_with_one():
    """Friction brakes the table across, too: its momentum across falls by the impulse of the force there."""
    table = fm.Body("table", mass=2.0, axes="xy", velocity={"x": 0.5, "y": 1.0})
    contact = fm.Contact("c", BLOCK, table, law=LAW, normal_force=1.0)
    sol = fm.simulate(fm.Scene("two", [BLOCK, table, contact]), t_end=1.0)

    def rates(t, y):
        slip = np.array([y[0] - y[1], -y[2]])
        force = -slip / np.hypot(*slip)
        return [force[0], -force[0] / 2.0, -force[1] / 2.0]

    found = solve_ivp(rates, (0.0, 1.0), [0.0, 0.5, 1.0], rtol=1e-11, atol=1e-13).y[:, -1]
    assert [sol.velocity(name)[-1] for name in ("b.x", "table.x", "table.y")] == pytest.approx(found, abs=1e-6)


def test_belt_beside_joints_has_its_old_speed_up_to_the_jump():
    speed = sympy.Piecewise((2.0, fm.t < 3), (3.0, True))
    sol = fm.simulate(scene(fm.Driven("belt", velocity={"x": speed}), IDLE), t_end=4.0)
    at = np.flatnonzero(sol.t == 3.0)
    assert sol.relative_velocity("c")[0, at] - sol.velocity("b.x")[at] == pytest.approx([-2.0, -3.0])
