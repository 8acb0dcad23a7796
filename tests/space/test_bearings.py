"""Dry journals: loads of both ends and of the thrust in closed form, and against the plane."""

import sys
from pathlib import Path

import numpy as np
import pytest

import fricmb as fm

sys.path.insert(0, str(Path(__file__).parent))
from cases import DOWN, wheel_on_an_arm

SPACE, G = fm.space, 9.81
M, C, MU, R = 2.0, 0.02, 0.1, 0.02


def running_out(axis, first=True, station=0.0, **bearing):
    """A wheel in a bearing off its centre of mass: the whole load is its weight."""
    wheel = SPACE.Rotor(
        "wheel", mass=M, inertia_across=0.1, inertia_axial=C, axis=axis, spin=40.0, stations={"journal": station}
    )
    n = wheel.start_axis()
    place = SPACE.ground_point(*(station * n))
    ends = (wheel.station("journal"), place) if first else (fm.GROUND, wheel)
    dry = SPACE.Revolute("axle", *ends, axis=axis, radius=R, friction=fm.laws.Coulomb(mu_s=MU), **bearing)
    return fm.Scene("running out", [wheel, dry, DOWN])


@pytest.mark.parametrize(
    ("axis", "options", "load"),
    [
        ((0, 1, 0), {}, M * G),
        ((0, 1, 0), {"first": False}, M * G),
        ((0, -3, 0), {"length": 0.2}, M * G),  # both ends bear half
        ((0, 1, 0), {"length": 0.2, "station": 0.05}, M * G),  # the centre of mass between the ends
        ((0, 1, 0), {"length": 0.2, "station": 0.15}, 2 * M * G * 0.15 / 0.2),  # overhung: one end pulls
        ((0, 0, 1), {"thrust_radius": 0.05}, M * G * 0.05 / R),
        ((0, 3, 4), {"thrust_radius": 0.05}, M * G * (0.6 + 0.8 * 0.05 / R)),
    ],
)
def test_wheel_runs_out_on_its_journal(axis, options, load):
    stop = C * 40.0 / (MU * R * load)
    sol = fm.simulate(running_out(axis, **options), t_end=1.2 * stop, rtol=1e-8)
    (event,) = sol.events
    assert (event.kind, event.t) == ("stick", pytest.approx(stop, rel=1e-10))
    np.testing.assert_allclose(sol.normal_force("axle"), load, rtol=1e-9)
    # force on a against its slip; b turns the other way
    direction = 1.0 if options.get("first", True) else -1.0
    assert np.sign(sol.relative_velocity("axle")[0, 0]) == direction
    assert np.sign(sol.force("axle")[0, 0]) == -direction
    assert sol["wheel.spin"][-1] == pytest.approx(40.0 * stop / 2, rel=1e-10)
    assert np.abs(sol.energy.residual).max() < 1e-9 * sol.energy.kinetic[0]
    assert sol.audit().ok


def test_dry_pendulum_in_space_is_that_of_the_plane():
    """The same pin, once by three axes and thirteen more constraints, once in the plane."""
    law, pin = fm.laws.Coulomb(mu_s=0.4, mu_k=0.3), {"radius": 0.05}
    flat = fm.RigidBody("arm", mass=1.5, inertia=0.04, position=(0.3, 0.0), points={"eye": (-0.3, 0.0)})
    down = fm.Gravity("g", acceleration={"y": -G})
    plane = fm.Scene("plane", [flat, fm.Revolute("pin", flat.point("eye"), friction=law, **pin), down])
    body = SPACE.RigidBody(
        "arm", mass=1.5, inertia=(0.02, 0.03, 0.04), position=(0.3, 0.0, 0.0), points={"eye": (-0.3, 0.0, 0.0)}
    )
    hinge = SPACE.Revolute("pin", body.point("eye"), axis=(0, 0, 1), friction=law, **pin)
    one, two = (fm.simulate(scene, t_end=6.0, rtol=1e-9) for scene in (plane, fm.Scene("space", [body, hinge, down])))
    assert [e.kind for e in two.events] == [e.kind for e in one.events]
    assert len(one.events) > 4
    np.testing.assert_allclose([e.t for e in two.events], [e.t for e in one.events], atol=1e-7)
    np.testing.assert_allclose(two["arm.y"][-1], one["arm.y"][-1], atol=1e-8)
    np.testing.assert_allclose(two.energy.friction_loss[-1], one.energy.friction_loss[-1], rtol=1e-7)
    assert two.audit().ok


def test_gyroscope_with_a_dry_axle():
    """A spinning wheel on a swinging arm: its axle bears what turns the axis, and the ledger closes."""
    arm, wheel, hook = wheel_on_an_arm()
    axle = SPACE.Revolute(
        "axle", wheel, arm.point("hub"), axis=(0, 1, 0), radius=0.01, length=0.05, thrust_radius=0.01,
        friction=fm.laws.Coulomb(mu_s=0.2),
    )  # fmt: skip
    sol = fm.simulate(fm.Scene("gyroscope", [arm, wheel, hook, axle, DOWN]), t_end=1.0, rtol=1e-8)
    assert np.abs(sol.energy.residual).max() < 1e-7
    # torque about the wheel's axis is friction alone: C s'' = -mu r N, the load from the reaction
    reaction, seen = sol.reaction("axle"), sol["wheel.axis"]
    along = (reaction[:3] * seen).sum(axis=0)
    rotation = sol["arm.rotation"]
    u, w = rotation[:, 2], rotation[:, 0]  # u x w = e for e = y
    lever = (reaction[4] * u - reaction[3] * w) / 0.05
    across = reaction[:3] - along * seen
    ends = np.linalg.norm(across / 2 + lever, axis=0) + np.linalg.norm(across / 2 - lever, axis=0)
    np.testing.assert_allclose(sol.normal_force("axle"), ends + np.abs(along), rtol=1e-9)
    np.testing.assert_allclose(np.abs(sol.force("axle")[0]), 0.2 * sol.normal_force("axle"), rtol=1e-9)
    spin = sol.velocity("wheel.spin")
    lost = np.trapezoid(0.2 * 0.01 * sol.normal_force("axle"), sol.t) if hasattr(np, "trapezoid") else 0.0
    assert spin[0] - spin[-1] == pytest.approx(lost / 0.02, rel=2e-2)
    assert sol.audit().ok
