"""Loops that are redundant by nature, flat bodies in them, long chains, and what rotors do not take."""

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import fricmb as fm

sys.path.insert(0, str(Path(__file__).parent))
from cases import DOWN

SPACE, G = fm.space, 9.81


def other_angle(angle):
    """Of a Bricard loop with twists of 90 degrees: ``cos t + cos p + cos t cos p = 0`` (Chen, You and Tarnai 2005)."""
    return np.arccos(-np.cos(angle) / (1.0 + np.cos(angle)))


def bricard(angle):
    """Frames (7, 4, 4) along six equal links with twists of 90 degrees by turns, hinged along each frame's z."""

    def link(turn, twist):
        c, s = np.cos(turn), np.sin(turn)
        cross = np.array([[1, 0, 0], [0, 0, -twist], [0, twist, 0]])
        T = np.eye(4)
        T[:3, :3] = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ cross
        T[:3, 3] = (c, s, 0)
        return T

    frames = [np.eye(4)]
    for i in range(6):
        frames.append(frames[-1] @ link((angle, other_angle(angle))[i % 2], 1.0 if i % 2 == 0 else -1.0))
    return np.array(frames)


@pytest.mark.parametrize("flat", [False, True])
def test_bricard_loop_moves_as_its_closure_says(flat):
    """Six hinges hold six bodies once too often; the loop moves with one degree of freedom all the same.

    ``flat``: of links without thickness, an axis of which has no mass.
    """
    angle = 2.0
    frames = bricard(angle)
    np.testing.assert_allclose(frames[6], np.eye(4), atol=1e-14)
    inertia = (0.02, 0.03, 0.05) if flat else (0.02, 0.03, 0.04)
    links, joints = [], []
    before = SPACE.ground_point(0.0, 0.0, 0.0)
    for i in range(1, 6):
        # link i lies between the hinges i - 1 and i; its own axes are those of frame i
        R, low, high = frames[i][:3, :3], frames[i - 1][:3, 3], frames[i][:3, 3]
        body = SPACE.RigidBody(
            f"link{i}", mass=1.0, inertia=inertia, position=(low + high) / 2, orientation=R,
            points={"low": tuple(R.T @ (low - high) / 2), "high": tuple(R.T @ (high - low) / 2)},
        )  # fmt: skip
        links.append(body)
        joints.append(SPACE.Revolute(f"hinge{i - 1}", body.point("low"), before, axis=frames[i - 1][:3, 2]))
        before = body.point("high")
    tip = frames[5][:3, 3]
    joints.append(SPACE.Revolute("hinge5", before, SPACE.ground_point(*tip), axis=frames[5][:3, 2]))
    scene = fm.Scene("Bricard", [*links, *joints, DOWN])
    sol = fm.simulate(scene, t_end=1.0, rtol=1e-9)
    (note,) = [note for note in sol.stats.notes if "redundant" in note]
    assert note.startswith("redundant constraints: 1 of")
    assert "link" not in note  # what keeps bodies rigid is nobody's joint
    # every link's angle about its hinge, from the axes of both
    turns = []
    for first, second in pairwise(range(1, 6)):
        a, b = (sol[f"link{k}.rotation"] for k in (first, second))
        turns.append(np.arctan2((a[:, 1] * b[:, 0]).sum(axis=0), (a[:, 0] * b[:, 0]).sum(axis=0)))
    turns = np.abs(np.unwrap(np.array(turns), axis=1))
    assert np.ptp(turns[0]) > 0.3
    np.testing.assert_allclose(turns[0], turns[2], atol=1e-10)
    np.testing.assert_allclose(turns[1], turns[3], atol=1e-10)
    np.testing.assert_allclose(np.cos(turns[0]) + np.cos(turns[1]) * (1 + np.cos(turns[0])), 0.0, atol=1e-10)
    # one degree of freedom: its energy is the whole motion; in numbers of this test alone
    velocity = np.array([[sol.velocity(f"{link.name}.{c}") for c in "xyz"] for link in links])
    energy = 0.5 * (velocity**2).sum(axis=(0, 1))
    for link in links:
        energy += G * sol[f"{link.name}.z"]
        omega = np.einsum("jit,jt->it", sol[f"{link.name}.rotation"], sol[f"{link.name}.omega"])
        energy += 0.5 * (np.array(inertia) @ omega**2)
    np.testing.assert_allclose(energy, energy[0], atol=1e-8)
    for one, other in pairwise(links):
        for c in "xyz":
            np.testing.assert_allclose(sol[f"{one.name}.high.{c}"], sol[f"{other.name}.low.{c}"], atol=2e-14)
    assert np.abs(sol.energy.residual).max() < 1e-8
    assert sol.audit().ok


def test_four_hinges_of_one_direction_hold_three_times_too_much():
    """A parallelogram of flat bars: its coupler moves on a circle, as a pendulum of one number does."""
    r, width, start = 0.4, 0.7, 0.3
    arm = np.array([r * np.sin(start), 0.0, -r * np.cos(start)])
    R = SPACE.turned(axis=(0, -1, 0), angle=start)
    flat = {"mass": 0.5, "inertia": (0.01, 0.012, 0.022)}
    cranks = [
        SPACE.RigidBody(
            name, **flat, position=np.array([x, 0, 0]) + arm / 2, orientation=R,
            points={"hub": (0, 0, r / 2), "pin": (0, 0, -r / 2)},
        )
        for name, x in (("left", 0.0), ("right", width))
    ]  # fmt: skip
    ends = {"left": (-width / 2, 0, 0), "right": (width / 2, 0, 0)}
    middle = (arm[0] + width / 2, 0, arm[2])
    bar = SPACE.RigidBody("bar", mass=2.0, inertia=(1e-3, 0.1, 0.1), position=middle, points=ends)
    joints = [
        joint
        for crank, x in zip(cranks, (0.0, width), strict=True)
        for joint in (
            SPACE.Revolute(f"{crank.name} hub", crank.point("hub"), SPACE.ground_point(x, 0, 0), axis=(0, 1, 0)),
            SPACE.Revolute(f"{crank.name} pin", bar.point(crank.name), crank.point("pin"), axis=(0, 1, 0)),
        )
    ]
    sol = fm.simulate(fm.Scene("parallelogram", [*cranks, bar, *joints, DOWN]), t_end=2.0, rtol=1e-9)
    (note,) = [note for note in sol.stats.notes if "redundant" in note]
    assert note.startswith("redundant constraints: 3 of")
    J = 2 * (0.012 + 0.5 * r**2 / 4) + 2.0 * r**2
    weight = G * (2 * 0.5 * r / 2 + 2.0 * r)
    exact = solve_ivp(lambda t, y: [y[1], -weight * np.sin(y[0]) / J], (0, 2), [start, 0], method="DOP853",
                      rtol=1e-12, atol=1e-13).y[:, -1]  # fmt: skip
    x = np.array([sol[f"bar.{c}"][-1] for c in "xyz"])
    np.testing.assert_allclose(x, (width / 2 + r * np.sin(exact[0]), 0.0, -r * np.cos(exact[0])), atol=1e-8)
    np.testing.assert_allclose(sol["bar.rotation"][:, :, -1], np.eye(3), atol=1e-11)
    assert sol.audit().ok


def test_hundred_links_stay_together():
    """A chain in space, swinging: joints close to round-off, whatever the number of links."""
    links = [
        SPACE.RigidBody(
            f"l{i}", mass=1.0, inertia=(0.1, 0.1, 0.02), position=(i + 0.5, 0, 0),
            orientation=SPACE.turned(axis=(0, 1, 0), angle=-np.pi / 2),
            points={"top": (0, 0, 0.5), "low": (0, 0, -0.5)},
        )
        for i in range(100)
    ]  # fmt: skip
    ends = [SPACE.ground_point(0, 0, 0), *(link.point("low") for link in links)]
    joints = [SPACE.Spherical(f"j{i}", link.point("top"), ends[i]) for i, link in enumerate(links)]
    side = fm.Force("side", links[-1], axis="y", value=3.0)
    sol = fm.simulate(fm.Scene("chain", [*links, *joints, side, DOWN]), t_end=0.5, rtol=1e-6)
    for one, other in pairwise(links):
        for c in "xyz":
            np.testing.assert_allclose(sol[f"{one.name}.low.{c}"], sol[f"{other.name}.top.{c}"], atol=1e-13)
    assert np.abs(sol.energy.residual).max() < 1e-8 * sol.energy.kinetic.max()


def test_what_a_rotor_does_not_tell_is_refused():
    """Its angle of spin depends on the way its axis has gone."""
    wheel = SPACE.Rotor("wheel", mass=1.0, inertia_across=1.0, inertia_axial=1.0)
    arm = SPACE.RigidBody("arm", mass=1.0, inertia=(1, 1, 1))
    other = SPACE.Rotor("other", mass=1.0, inertia_across=1.0, inertia_axial=1.0)
    refused = [
        lambda: fm.TorsionSpring("k", wheel, arm, stiffness=1.0),
        lambda: fm.TorsionDamper("d", wheel, arm, damping=1.0),
        lambda: fm.Gear("gear", wheel, other, ratio=2.0),
        lambda: fm.DrivenAngle("drive", wheel, speed=1.0),
        lambda: SPACE.Revolute("axle", wheel, other, axis=(0, 0, 1)),
    ]
    for make in refused:
        with pytest.raises(fm.FricmbError):
            make()


def test_closure_of_the_loop_is_that_of_its_frames():
    """The relation of the angles, solved from the product of the frames instead."""
    for angle in (1.6, 1.8, 2.0):
        found = brentq(lambda p, a=angle: np.cos(a) + np.cos(p) + np.cos(a) * np.cos(p), 0.0, np.pi)
        assert found == pytest.approx(float(other_angle(angle)), rel=1e-12)
        np.testing.assert_allclose(bricard(angle)[6], np.eye(4), atol=1e-13)
