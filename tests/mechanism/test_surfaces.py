"""Points on surfaces that can only push, several joints that rub at once, singular positions."""

import numpy as np
import pytest

import fricmb as fm

G = 9.81


def lifted(**options):
    """A block on the floor, pulled up with a force that grows: lost at t = 0.5, y = 10/6 (t - 0.5)^3 afterwards."""
    block = fm.RigidBody("block", mass=1.0, inertia=1.0, velocity=(2.0, 0.0))
    return fm.Scene(
        "lift",
        [
            block,
            fm.RollerOnLine("floor", block, push_only=True, friction=fm.laws.Coulomb(mu_s=0.2), **options),
            fm.Force("pull", block, axis="y", value=10.0 * fm.t),
            fm.Gravity("g", acceleration={"y": -5.0}),
        ],
    )


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_a_joint_declared_to_open_lets_go(method):
    sol = fm.simulate(lifted(when_lost="open"), t_end=1.0, rtol=1e-8, method=method)
    assert [(e.kind, e.contact) for e in sol.events] == [("open", "floor")]
    assert sol.events.t[0] == pytest.approx(0.5, abs=1e-9)
    times = np.array([0.2, 0.5, 0.6, 0.9])
    at = sol.at(times)
    np.testing.assert_allclose(at["block.y"], 10 / 6 * np.maximum(times - 0.5, 0.0) ** 3, atol=1e-8)
    # rubbing takes mu times the impulse of the load, 1.25
    assert sol.velocity("block.x")[-1] == pytest.approx(2.0 - 0.2 * 1.25, abs=1e-7)
    assert sol.normal_force("floor")[-1] == 0.0
    assert sol.reaction("floor")[0, [0, -1]] == pytest.approx([5.0, 0.0], abs=1e-9)
    assert np.abs(sol.energy.residual).max() < 1e-6
    further = fm.simulate(lifted(when_lost="open"), t_end=1.2, rtol=1e-8, method=method, initial=sol)
    assert further["block.y"][-1] == pytest.approx(10 / 6 * 0.7**3, abs=1e-6)


def test_a_joint_not_declared_to_open_ends_the_run():
    with pytest.raises(fm.IntegrationError, match="contact of 'floor' is lost"):
        fm.simulate(lifted(), t_end=1.0)
    with pytest.raises(fm.SceneError, match="when_lost"):
        lifted(when_lost="bounce")


def test_contact_made_again_ends_the_run():
    ball = fm.RigidBody("ball", mass=1.0, inertia=1.0, position=(0.0, 1.0), velocity=(1.0, 0.0))
    floor = fm.RollerOnLine("floor", ball, push_only=True, when_lost="open")
    with pytest.raises(fm.IntegrationError, match="'floor' closes again, and impacts are not computed") as caught:
        fm.simulate(fm.Scene("drop", [ball, floor, fm.Gravity("g")]), t_end=1.0)
    assert caught.value.t == pytest.approx(np.sqrt(2.0 / G), abs=1e-9)


def test_a_bead_leaves_the_top_of_a_circle_where_galileo_says():
    """From rest near the top of a smooth circle a point leaves it at cos = 2/3 of the height it started from."""
    start = 0.1
    bead = fm.Body("bead", mass=1.0, axes="xy", position={"x": np.sin(start), "y": np.cos(start)})
    wheel = fm.RollerOnCircle("wheel", bead, radius=1.0, push_only=True)
    with pytest.raises(fm.IntegrationError, match="contact of 'wheel' is lost") as caught:
        fm.simulate(fm.Scene("wheel", [bead, wheel, fm.Gravity("g")]), t_end=5.0, rtol=1e-10)
    assert caught.value.partial["bead.y"][-1] == pytest.approx(2.0 / 3.0 * np.cos(start), abs=1e-8)


@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_a_bead_that_rubs_on_a_circle(mu):
    """Without gravity the speed on a rough circle falls by exp(-mu angle)."""
    bead = fm.Body("bead", mass=2.0, axes="xy", position={"x": 1.5}, velocity={"y": 2.0})
    law = fm.laws.Coulomb(mu_s=mu) if mu else None
    sol = fm.simulate(
        fm.Scene("wire", [bead, fm.RollerOnCircle("wire", bead, radius=1.5, friction=law)]), t_end=2.0, rtol=1e-10
    )
    angle = np.unwrap(np.arctan2(sol["bead.y"], sol["bead.x"]))[-1]
    turned = np.log1p(mu * 2.0 * 2.0 / 1.5) / mu if mu else 2.0 * 2.0 / 1.5
    assert angle == pytest.approx(turned, abs=1e-8)
    assert np.hypot(sol.velocity("bead.x")[-1], sol.velocity("bead.y")[-1]) == pytest.approx(
        2.0 * np.exp(-mu * turned), abs=1e-8
    )


def wedged(speed):
    """A body on two lines whose frictions press on one another: each margin is positive given the other's, and yet.

    With A = 1 + mu n dN/dF the minors are about -3.6, -1.8 and -1.4.
    """
    points = {"one": (0.98, -0.74), "two": (-0.52, -0.95)}
    motion = speed * np.array([-0.71930492, -0.01165314, 0.69459675])
    body = fm.RigidBody(
        "body", mass=1.0, inertia=0.0433, points=points, velocity=tuple(motion[:2]), angular_velocity=motion[2]
    )
    lines = [
        fm.RollerOnLine(name, body.point(name), fm.ground_point(*points[name]), angle=angle, push_only=True,
                        friction=fm.laws.Coulomb(mu_s=mu))
        for name, angle, mu in (("one", 5.0135, 1.925), ("two", 4.5564, 1.1727))
    ]  # fmt: skip
    loads = [
        fm.Force("fx", body, axis="x", value=-0.73), fm.Force("fy", body, axis="y", value=3.39),
        fm.Torque("turn", body, value=-5.19),
    ]  # fmt: skip
    return fm.Scene("wedge", [body, *lines, *loads])


def test_joints_that_jam_one_another_are_found_together():
    with pytest.raises(fm.IntegrationError, match="'one', 'two' together has no single solution"):
        fm.simulate(wedged(1.0), t_end=0.01)


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("t_end", [0.7, 1.0])
def test_a_singular_position_ends_the_run_where_it_is(method, t_end):
    with pytest.raises(fm.IntegrationError, match=r"singular position.*'left'") as caught:
        fm.simulate(parallelogram(), t_end=t_end, rtol=1e-6, method=method)
    assert caught.value.t == pytest.approx(np.pi / 6, abs=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("rtol", [1e-3, 1e-4, 1e-5, 1e-7, 1e-8, 1e-10])
def test_no_length_of_a_run_lets_a_step_pass_a_singular_position(rtol):
    """Other lengths are other steps: at tight tolerances one run in three went on behind the position."""
    for t_end in (0.6, 0.9, 1.1, 1.3, 1.5):
        with pytest.raises(fm.IntegrationError, match="singular position") as caught:
            fm.simulate(parallelogram(), t_end=t_end, rtol=rtol, method="radau")
        assert caught.value.t == pytest.approx(np.pi / 6, abs=1e-5 + rtol)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("start", [0.2, 1.0])
def test_a_singular_position_is_seen_from_afar_and_from_another_one(method, start):
    """The way there begins near the other position, or goes through the largest least singular value."""
    flat = (np.pi - start) / 3.0
    for part in (1.05, 2.0, 5.0):
        for rtol in (1e-2, 1e-5, 1e-10):
            with pytest.raises(fm.IntegrationError, match="singular position") as caught:
                fm.simulate(parallelogram(start), t_end=part * flat, rtol=rtol, method=method)
            assert caught.value.t == pytest.approx(flat, abs=3e-5 + 0.2 * rtol)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("start", [0.2, 1.0])
def test_a_crank_and_a_rod_of_equal_lengths_lock_upright(method, start):
    """The slider then stands on the axis of the crank, and the rod may go on about it or move the slider."""
    for rtol in (1e-2, 1e-5, 1e-7, 1e-10):
        with pytest.raises(fm.IntegrationError, match="singular position") as caught:
            fm.simulate(equal_crank(start), t_end=3.0, rtol=rtol, method=method)
        assert caught.value.partial["crank.end.x"][-1] == pytest.approx(0.0, abs=1e-4 + 10.0 * rtol)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_two_equal_cranks_lock_as_one_does(method):
    """Two values change their signs at once, and the determinant keeps its own."""
    for rtol in (1e-2, 1e-3, 1e-4, 1e-5, 1e-8):
        for t_end in (0.5, 1.0, 3.0):
            with pytest.raises(fm.IntegrationError, match="singular position") as caught:
                fm.simulate(twin_cranks(), t_end=t_end, rtol=rtol, method=method)
            end = caught.value.partial
            for name in ("left crank.end.x", "right crank.end.x"):
                assert end[name][-1] == pytest.approx(0.0, abs=1e-4 + rtol)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("longer", [1e-4, 1e-6])
def test_a_rod_that_is_a_little_longer_lets_the_crank_pass(method, longer):
    """No step ends where the joints are open: those near the upright position either close them or are taken back."""
    for rtol in (1e-2, 1e-3, 1e-5):
        stopped = ""
        try:
            sol = fm.simulate(equal_crank(1.0, longer=longer), t_end=3.0, rtol=rtol, method=method)
        except fm.IntegrationError as error:
            sol, stopped = error.partial, str(error)
        assert not stopped or "singular position" in stopped
        np.testing.assert_allclose(sol["rod.slider.y"], 0.0, atol=1e-9)
        np.testing.assert_allclose(sol["crank.end.x"], sol["rod.pin.x"], atol=1e-9)
        assert np.abs(sol.velocity("crank.end.x")).max() < 1e3


def test_three_parallel_legs_pass_upright_and_say_what_is_not_looked_for():
    """The constraints that are kept depend on one another there, all of them together do not."""
    sol = fm.simulate(parallelogram(0.2, legs=3), t_end=0.9, rtol=1e-6)
    assert sol["leg0.head.x"][-1] == pytest.approx(np.cos(0.2 + 3.0 * 0.9), abs=1e-6)
    assert any("no singular position is looked for" in note for note in sol.stats.notes)


def twin_cranks():
    """Two such mechanisms that do not know of one another, and move alike."""
    return fm.Scene("twins", [*crank_parts(0.8, "left "), *crank_parts(0.8, "right ")])


def equal_crank(angle, longer=0.0):
    """A crank that turns, and a rod as long as it to a slider on a line through its axis."""
    return fm.Scene("crank and rod", crank_parts(angle, longer=longer))


def crank_parts(angle, tag="", longer=0.0):
    """Crank, rod and joints; the rod may be a little longer."""
    c, s = np.cos(angle), np.sin(angle)
    crank = fm.RigidBody(f"{tag}crank", mass=1.0, inertia=0.1, position=(0.5 * c, 0.5 * s), angle=angle,
                         velocity=(-1.5 * s, 1.5 * c), angular_velocity=3.0,
                         points={"axis": (-0.5, 0.0), "end": (0.5, 0.0)})  # fmt: skip
    rod = fm.RigidBody(f"{tag}rod", mass=1.0, inertia=0.1, position=(1.5 * c, 0.5 * s), angle=-angle,
                       velocity=(-4.5 * s, 1.5 * c), angular_velocity=-3.0,
                       points={"pin": (-0.5, 0.0), "slider": (0.5 + longer, 0.0)})  # fmt: skip
    joints = (
        fm.Revolute(f"{tag}axis", crank.point("axis"), fm.ground_point(0.0, 0.0)),
        fm.Revolute(f"{tag}pin", rod.point("pin"), crank.point("end")),
        fm.RollerOnLine(f"{tag}slider", rod.point("slider"), fm.ground_point(0.0, 0.0), angle=0.0),
    )
    return [crank, rod, *joints]


def parallelogram(angle=np.pi / 2, legs=2):
    """Legs, side by side, and a top that turn steadily; they lie flat at the angle pi."""
    c, s = np.cos(angle), np.sin(angle)
    legs = [
        fm.RigidBody(f"leg{i}", mass=1.0, inertia=0.1, position=(i + 0.5 * c, 0.5 * s), angle=angle,
                     velocity=(-1.5 * s, 1.5 * c), angular_velocity=3.0,
                     points={"foot": (-0.5, 0.0), "head": (0.5, 0.0)})
        for i in range(legs)
    ]  # fmt: skip
    ends = {"l": (-0.5, 0.0), "r": (0.5, 0.0), "next": (1.5, 0.0)}
    top = fm.RigidBody("top", mass=1.0, inertia=0.3, position=(0.5 + c, s), velocity=(-3.0 * s, 3.0 * c), points=ends)
    parts = [
        *legs, top, *(fm.Revolute(f"foot{i}", leg.point("foot"), fm.ground_point(float(i), 0.0))
                      for i, leg in enumerate(legs)),
        fm.Revolute("left", top.point("l"), legs[0].point("head")),
        fm.Revolute("right", top.point("r"), legs[1].point("head")),
        *(fm.Revolute("third", top.point("next"), leg.point("head")) for leg in legs[2:]),
    ]  # fmt: skip
    return fm.Scene("parallelogram", parts)
