"""Contacts that are hit together, or in turn; what is held, opens and closes again."""

import math

import numpy as np
import pytest
import sympy

import fricmb as fm


def corners(*, half, height, angle, at, e, mu=None, velocity=(0.0, 0.0), angular_velocity=0.0):
    """A block of mass 1 above the floor, with both lower corners."""
    block = fm.RigidBody(
        "block", mass=1.0, inertia=(half**2 + height**2) / 3, position=at, angle=angle, velocity=velocity,
        angular_velocity=angular_velocity, points={"l": (-half, -height), "r": (half, -height)},
    )  # fmt: skip
    law = {} if mu is None else {"friction": fm.laws.Coulomb(mu_s=mu)}
    feet = [
        fm.RollerOnLine(name, block.point(end), push_only=True, restitution=e, **law)
        for name, end in (("left", "l"), ("right", "r"))
    ]
    return fm.Scene("block", [block, *feet, fm.Gravity("g")])


def test_a_rocking_block_comes_to_rest_by_impacts_of_its_corners_in_turn():
    """Housner's block: each impact leaves 1 - 1.5 sin^2(alpha) of its rate; values by quadratures in 40 digits."""
    b, h = 0.2, 0.6
    th = 0.5 * math.atan2(b, h)
    at = (b * math.cos(th) - h * math.sin(th), b * math.sin(th) + h * math.cos(th))
    sol = fm.simulate(corners(half=b, height=h, angle=th, at=at, e=0.0, mu=5.0), t_end=5.0, rtol=1e-8)
    times = [
        0.3872950763147931, 0.9430696788322329, 1.377100630858416, 1.727842175484057, 2.016434025060314,
        2.256450013155342, 2.457433538350902, 2.62649531873848,
    ]  # fmt: skip
    hits = [event for event in sol.events.of(kind="impact") if event.approach > 1e-9]
    assert np.allclose([hit.t for hit in hits[:8]], times, rtol=0, atol=1e-9)
    assert abs(hits[0].approach - 2 * b * 0.9452665029648559) < 1e-8
    assert abs(abs(sol(hits[0].t)[5]) - 0.85 * 0.9452665029648559) < 1e-8
    rest = sol.events.of(kind="rest")[-1]
    assert abs(rest.t - 3.566762261753892) <= rest.bound
    assert abs(rest.t - 3.566762261753892) < 1e-8
    assert np.abs(sol.v[:, -1]).max() < 1e-12
    assert sol.audit().ok


@pytest.mark.parametrize("mu", [None, 0.3])
@pytest.mark.parametrize("angle", [0.0, 0.3])
def test_a_box_that_falls_on_its_face_or_a_corner_ends_at_rest(angle, mu):
    scene = corners(half=0.5, height=0.5, angle=angle, at=(0.0, 1.1), e=0.3, mu=mu, velocity=(0.5 if mu else 0.0, 0.0))
    sol = fm.simulate(scene, t_end=3.0, rtol=1e-8)
    assert abs(sol["block.y"][-1] - 0.5) < 1e-9
    assert abs(sol.velocity("block.y")[-1]) < 1e-10
    assert abs(sol.velocity("block.angle")[-1]) < 1e-10
    assert {event.contact for event in sol.events.of(kind="rest")} == {"left", "right"}
    assert np.abs(sol.energy.residual).max() < 1e-9
    assert sol.audit().ok


def test_a_block_on_a_table_that_drops_lifts_off_bounces_and_rests_again():
    body = fm.Body("body", mass=1.0, axes="y")
    table = fm.Driven("table", position={"y": 0.4 * (sympy.cos(6.0 * fm.t) - 1.0)}, axes="y")
    stop = fm.Stop("contact", body, table, axis="y", lower=0.0, restitution=0.3)
    sol = fm.simulate(fm.Scene("table", [body, table, stop, fm.Gravity("g")]), t_end=1.5, rtol=1e-9)
    # the table falls with 14.4 cos(6 t), more than g at the start; where it comes to g again, the block is left behind
    (lift,) = sol.events.of(kind="open")
    assert abs(14.4 * math.cos(6.0 * lift.t) - 9.81) < 1e-6
    assert len(sol.events.of(kind="rest")) >= 1
    assert (sol["body.y"] - sol["table.y"]).min() > -1e-9
    assert sol.audit().ok


def test_gears_with_rigid_flanks_rattle():
    motor, load = fm.Body("motor", mass=1.0), fm.Body("load", mass=0.7)
    parts = [
        motor,
        load,
        fm.Spring("spring", motor, axis="x", stiffness=4.0),
        fm.Force("drive", motor, axis="x", value=2.0 * sympy.cos(1.7 * fm.t)),
        fm.Backlash("mesh", motor, load, axis="x", gap=0.2, restitution=0.6),
        fm.DryFriction("shaft", load, axis="x", static=0.3, kinetic=0.25),
    ]
    sol = fm.simulate(fm.Scene("rattle", parts), t_end=10.0, rtol=1e-8)
    play = sol["motor.x"] - sol["load.x"]
    assert np.abs(play).max() < 0.1 + 1e-9
    assert set(sol.impulse("mesh").side) == {"lower", "upper"}
    assert np.abs(sol.energy.residual).max() < 1e-7
    assert sol.audit().ok
    late = sol.t > sol.events.of(kind="rest")[0].t + 1e-3
    assert sol.reaction("mesh").shape == (1, sol.t.size)
    assert late.any()


def test_newtons_cradle_of_five():
    """Together, by Newton's law; balls that do not touch pass the whole speed on."""
    for gap in (0.0, 1e-3):
        balls = [
            fm.Body(f"b{i}", mass=1.0, position={"x": (1.0 + gap) * i}, velocity={"x": float(i == 0)}) for i in range(5)
        ]
        touch = [fm.Stop(f"c{i}", balls[i + 1], balls[i], axis="x", lower=1.0, restitution=1.0) for i in range(4)]
        sol = fm.simulate(fm.Scene("cradle", [*balls, *touch]), t_end=1.0)
        assert abs(sol.v[:, -1].sum() - 1.0) < 1e-14
        assert abs((sol.v[:, -1] ** 2).sum() - 1.0) < 1e-14
        if gap:
            assert np.allclose(sol.v[:, -1], [0, 0, 0, 0, 1], rtol=0, atol=1e-14)


def test_a_pad_on_modes_lifts_off_and_comes_back():
    plate = fm.ModalBody(
        "plate", frequencies=[3.0, 11.0, 23.0], damping_ratios=0.01, shapes={"tip": [[1.0, -1.0, 1.0]]}, axes="y"
    )
    stop = fm.Stop("stop", plate.point("tip"), axis="y", lower=-0.3, restitution=0.5)
    push = fm.Force("push", plate.point("tip"), axis="y", value=3.0 * sympy.cos(2.9 * fm.t))
    sol = fm.simulate(fm.Scene("plate", [plate, stop, push]), t_end=8.0, rtol=1e-8)
    assert len(sol.events.of(kind="rest")) >= 1
    assert len(sol.events.of(kind="open")) >= 1
    assert sol["plate.tip.y"].min() > -0.3 - 1e-9
    assert sol.audit().ok


def test_a_block_that_a_stop_and_dry_friction_hold_at_once_rests_for_as_long_as_it_is_pressed():
    """How they share the load is nothing that equations tell: polynomials through it grew from step to step."""
    block = fm.Body("block", mass=1.0, velocity={"x": 1.0})
    scene = fm.Scene("block", [
        block,
        fm.Stop("stop", block, axis="x", upper=0.1, restitution=0.0),
        fm.DryFriction("dry", block, axis="x", static=0.5, kinetic=0.3),
        fm.Force("push", block, axis="x", value=4.0 - fm.t / 20),
    ])  # fmt: skip
    sol = fm.simulate(scene, t_end=95.0, rtol=1e-6)
    (lifts,) = sol.events.of(kind="open")
    (slips,) = sol.events.of(kind="slip")
    assert abs(lifts.t - 80.0) < 1e-8
    assert abs(slips.t - 90.0) < 1e-8
    assert sol.stats.n_steps < 400
    # from there on x'' = -0.2 - (t - 90)/20
    left = 95.0 - slips.t
    assert abs(sol["block.x"][-1] - (0.1 - 0.2 * left**2 / 2 - left**3 / 120)) < 1e-6


def test_a_disc_that_rolls_back_to_a_wall_between_two_slips_comes_to_rest_there():
    """Its way back has no acceleration: times between impacts alone are a series, of ratio (k - e)/(1 + k)."""
    e, mu, g, speed, inertia = 0.3, 0.4, 9.81, 0.5, 0.5  # k = J/mR^2
    disc = fm.RigidBody(
        "disc", mass=1.0, inertia=inertia, position=(0.25, 1.0), velocity=(-speed, 0.0), angular_velocity=speed
    )
    scene = fm.Scene("disc", [
        disc,
        fm.Wheel("floor", disc, radius=1.0, friction=fm.laws.Coulomb(mu_s=mu)),
        fm.Stop("wall", disc, axis="x", lower=0.0, restitution=e),
        fm.Gravity("g"),
    ])  # fmt: skip
    sol = fm.simulate(scene, t_end=3.0, rtol=1e-8)
    ratio = (inertia - e) / (1 + inertia)
    (rest,) = sol.events.of(kind="rest")
    exact = 0.25 / speed + speed * (e + ratio) ** 2 / (2 * ratio * mu * g * (1 - ratio))
    assert abs(rest.t - exact) < 1e-9
    assert abs(rest.t - exact) <= rest.bound
    assert np.abs(sol.v[:, -1]).max() < 1e-9


def test_a_note_says_that_the_order_of_impacts_at_one_instant_matters():
    balls = [fm.Body(f"b{i}", mass=1.0, position={"x": 2.0 * i}, velocity={"x": 1.0 - i}) for i in range(3)]
    touch = [fm.Stop(f"t{i}", balls[i + 1], balls[i], axis="x", lower=1.0, restitution=0.5) for i in range(2)]
    sol = fm.simulate(fm.Scene("balls", [*balls, *touch]), t_end=2.0)
    (note,) = (note for note in sol.stats.notes if "in_turn" in note)
    assert "'t0', 't1' are hit at one instant, t = 1" in note


@pytest.mark.parametrize("mu", [None, 0.3])
def test_both_corners_of_a_box_let_go_at_one_instant_where_its_table_drops(mu):
    """Their loads fall to 0 together, and what is left of the second one is round-off."""
    A, w, g, high, slide = 0.1, 12.0, 9.81, 0.2, 0.4
    under = fm.Driven("table", position={"y": A * sympy.sin(w * fm.t)})
    box = fm.RigidBody(
        "box", mass=1.2, inertia=0.03, position=(0.0, high), velocity=(slide, A * w),
        points={"l": (-0.3, -high), "r": (0.3, -high)},
    )  # fmt: skip
    rub = {} if mu is None else {"friction": fm.laws.Coulomb(mu_s=mu)}
    feet = [
        fm.RollerOnLine(end, box.point(end), under, push_only=True, restitution=0.0, **rub) for end in ("l", "r")
    ]
    sol = fm.simulate(fm.Scene("box", [under, box, *feet, fm.Gravity("g")]), t_end=0.2, rtol=1e-8)
    lifts = math.asin(g / (A * w * w)) / w
    assert np.allclose([event.t for event in sol.events.of(kind="open")], lifts, rtol=0, atol=1e-9)
    assert {event.contact for event in sol.events.of(kind="open")} == {"l", "r"}
    left = 0.2 - lifts
    exact = high + A * math.sin(w * lifts) + A * w * math.cos(w * lifts) * left - g * left**2 / 2
    assert abs(sol["box.y"][-1] - exact) < 1e-9
    assert np.abs(sol["box.angle"]).max() < 1e-9
    assert len(sol.events.of(kind="impact")) == 0
