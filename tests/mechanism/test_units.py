"""Metamorphic: a mechanism in other units, or of another size, moves alike."""

import numpy as np
import pytest

import fricmb as fm

#: Units of mass and length in those of kg and m; sizes are such that periods stay.
UNITS = {
    "g mm": (1e3, 1e3), "t mm": (1e-3, 1e3), "kg um": (1.0, 1e6), "ug m": (1e9, 1.0), "kt m": (1e-6, 1.0),
    "kg km": (1.0, 1e-3), "1/1000 of the size": (1e-9, 1e-3), "MEMS": (1e-12, 1e-4),
}  # fmt: skip


def pendulum(M=1.0, L=1.0):
    return fm.models.dry_pendulum(
        mass=1.3 * M, inertia=0.2 * M * L**2, length=0.7 * L, radius=0.05 * L, gravity=9.81 * L
    )


def bob(M=1.0, L=1.0):
    inertia = tuple(x * M * L**2 for x in (0.03, 0.05, 0.02))
    arm = tuple(x * L for x in (0.1, 0.05, -0.3))
    return fm.models.dry_ball_joint(mass=2.0 * M, inertia=inertia, arm=arm, radius=0.02 * L, gravity=9.81 * L)


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("model", [pendulum, bob], ids=["pendulum", "ball joint"])
def test_units_say_nothing_of_the_motion(model, units):
    base, other = (fm.simulate(model(*u), t_end=2.0, rtol=1e-8) for u in ((1.0, 1.0), UNITS[units]))
    # the error of a step is a last coefficient of seven, known to 1e-5: one step more or less is rejected, in any units
    assert other.stats.n_steps == pytest.approx(base.stats.n_steps, rel=0.1)
    assert [e.kind for e in other.events] == [e.kind for e in base.events]
    np.testing.assert_allclose([e.t for e in other.events], [e.t for e in base.events], rtol=1e-11)
    # what is scaled alike: angles, or entries of the axes
    grid = np.linspace(0.0, 2.0, 21)
    free = np.abs(base.q).max(axis=1) > 1e-6
    alike = np.isclose(np.abs(other.q).max(axis=1), np.abs(base.q).max(axis=1), rtol=1e-6) & free
    assert alike.any()
    np.testing.assert_allclose(other.at(grid).q[alike], base.at(grid).q[alike], atol=1e-10)


def flat_parallelogram(M, L, lean):
    """Two legs of equal length and what ties their heads; in one line with the ground it may go on in two ways."""
    c, s = np.cos(lean), np.sin(lean)
    legs = [
        fm.RigidBody(f"leg{i}", mass=M, inertia=0.1 * M * L**2, position=((i + 0.5 * c) * L, 0.5 * s * L), angle=lean,
                     points={"foot": (-0.5 * L, 0.0), "head": (0.5 * L, 0.0)})
        for i in range(2)
    ]  # fmt: skip
    top = fm.RigidBody(
        "top", mass=M, inertia=0.3 * M * L**2, position=((0.5 + c) * L, s * L),
        points={"h0": (-0.5 * L, 0.0), "h1": (0.5 * L, 0.0)},
    )  # fmt: skip
    feet = [fm.Revolute(f"foot{i}", legs[i].point("foot"), fm.ground_point(i * L, 0.0)) for i in range(2)]
    heads = [fm.Revolute(f"head{i}", top.point(f"h{i}"), legs[i].point("head")) for i in range(2)]
    return fm.Scene("parallelogram", [*legs, top, *feet, *heads])


def upright_crank(M, L, lean):
    """A crank and a rod as long as it, at right angles to the line of the slider, which then stands on the axis."""
    c, s = np.sin(lean), np.cos(lean)
    turn, I = 0.5 * np.pi - lean, 0.1 * M * L**2
    crank = fm.RigidBody("crank", mass=M, inertia=I, position=(0.5 * c * L, 0.5 * s * L), angle=turn,
                         points={"axis": (-0.5 * L, 0.0), "end": (0.5 * L, 0.0)})  # fmt: skip
    rod = fm.RigidBody("rod", mass=M, inertia=I, position=(1.5 * c * L, 0.5 * s * L), angle=-turn,
                       points={"pin": (-0.5 * L, 0.0), "slider": (0.5 * L, 0.0)})  # fmt: skip
    origin = fm.ground_point(0.0, 0.0)
    joints = (
        fm.Revolute("axis", crank.point("axis"), origin), fm.Revolute("pin", rod.point("pin"), crank.point("end")),
        fm.RollerOnLine("slider", rod.point("slider"), origin, angle=0.0),
    )  # fmt: skip
    return fm.Scene("crank and rod", [crank, rod, *joints])


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("scene", [flat_parallelogram, upright_crank])
def test_a_singular_start_is_refused_in_all_units_and_one_next_to_it_is_not(scene, units):
    with pytest.raises(fm.FricmbError, match="singular position"):
        fm.simulate(scene(*UNITS[units], 0.0), t_end=1e-3)
    assert fm.simulate(scene(*UNITS[units], 0.01), t_end=1e-3).stats.n_steps > 0


@pytest.mark.parametrize("units", UNITS)
def test_a_start_that_is_all_but_singular_is_refused_alike(units):
    """The rank of the constraints is whole there, to round-off."""
    with pytest.raises(fm.FricmbError, match="singular position"):
        fm.simulate(upright_crank(*UNITS[units], 1e-8), t_end=1e-3)


def crank_with_friction(M=1.0, L=1.0):
    return fm.models.slider_crank(
        crank=0.1 * L, rod=0.3 * L, masses=(M, 0.6 * M, 0.8 * M), speed=30.0, gravity=9.81 * L, pin=0.01 * L,
        friction=fm.laws.Coulomb(mu_s=0.2),
    )  # fmt: skip


def moves_as(base, other):
    """Both have the same events, and end alike."""
    assert [(e.contact, e.kind) for e in other.events] == [(e.contact, e.kind) for e in base.events]
    np.testing.assert_allclose([e.t for e in other.events], [e.t for e in base.events], atol=1e-6)
    assert other["crank.angle"][-1] == pytest.approx(base["crank.angle"][-1], rel=1e-6)


def test_a_loop_with_friction_moves_alike_in_all_units():
    base = fm.simulate(crank_with_friction(), t_end=0.5, rtol=1e-8)
    for units in UNITS.values():
        moves_as(base, fm.simulate(crank_with_friction(*units), t_end=0.5, rtol=1e-8, time_limit=60.0))


@pytest.mark.parametrize("inertia", [1e-9, 1e-13, 1e-15])
def test_a_body_that_cannot_turn_may_have_hardly_any_inertia(inertia):
    """What friction in its pin could turn the slider by, were there no guide, is no measure of accelerations."""
    scene = crank_with_friction()
    light = fm.simulate(scene.with_parameters({"slider.inertia": inertia}), t_end=0.5, rtol=1e-8, time_limit=60.0)
    moves_as(fm.simulate(scene, t_end=0.5, rtol=1e-8), light)


def dry_links(L, T):
    link = 0.1 * L
    parts, last = [fm.Gravity("weight", acceleration={"y": -9.81 * L / T**2})], fm.ground_point(0, 0)
    for i in range(3):
        points = {"a": (-0.5 * link, 0.0), "b": (0.5 * link, 0.0)}
        body = fm.RigidBody(f"l{i}", mass=0.1, inertia=1e-4 * L**2, position=((i + 0.5) * link, 0.0), points=points)
        law = fm.laws.Coulomb(mu_s=0.4, mu_k=0.3)
        parts += [body, fm.Revolute(f"p{i}", body.point("a"), last, radius=0.004 * L, friction=law)]
        last = body.point("b")
    return fm.Scene("links", parts), 0.5 * T, "l2.angle"


def dry_pin(L, T):
    model = fm.models.dry_pendulum(
        mass=1.3, inertia=0.2 * L**2, length=0.7 * L, radius=0.05 * L, gravity=9.81 * L / T**2
    )
    return model, 2.0 * T, "arm.angle"


def dry_pin_beside_a_rotor(L, T, speed=1e6):
    scene, t_end, angle = dry_pin(L, T)
    rotor = fm.RigidBody("rotor", mass=1.0, inertia=L**2, angular_velocity=speed / T)
    return fm.Scene("beside", [*scene.parts, rotor]), t_end, angle


def hinge_on_a_slider(L, T):
    law = fm.laws.Coulomb(mu_s=0.3, mu_k=0.2)
    slider = fm.RigidBody(
        "slider", mass=1.0, inertia=0.1 * L**2, velocity=(L / T, 0.0), points={"end": (0.1 * L, 0.05 * L)}
    )
    arm = fm.RigidBody(
        "arm", mass=0.3, inertia=0.01 * L**2, position=(0.1 * L, -0.2 * L), points={"top": (0.0, 0.25 * L)}
    )
    hinge = fm.Revolute("hinge", arm.point("top"), slider.point("end"), radius=0.02 * L, friction=law)
    weight = fm.Gravity("weight", acceleration={"y": -9.81 * L / T**2})
    return fm.Scene("hinge", [slider, arm, fm.Prismatic("rail", slider), hinge, weight]), 2.0 * T, "arm.angle"


def fast_crank(L, T):
    law = fm.laws.Coulomb(mu_s=0.2)
    scene = fm.models.slider_crank(
        crank=0.1 * L, rod=0.3 * L, masses=(1.0, 0.6, 0.8), speed=30.0 / T, gravity=9.81 * L / T**2, pin=0.01 * L,
        friction=law,
    )  # fmt: skip
    return scene, 0.5 * T, "crank.angle"


#: Units of length and of time in those that numbers are of the order of 1 in.
FAR = [(1e-9, 1.0), (1e-4, 1.0), (1e4, 1.0), (1e9, 1.0), (1.0, 1e-6), (1.0, 1e6), (1e-9, 1e-6), (1e9, 1e6)]


#: What units may change of the digits: of a loop pivots are others, and the error of a step, a last coefficient with
#: seven digits of its own, then rejects one step more or less.
DIGITS = {dry_pin: 1e-13, dry_pin_beside_a_rotor: 1e-13, dry_links: 1e-13, hinge_on_a_slider: 1e-13, fast_crank: 1e-9}


@pytest.mark.parametrize("make", DIGITS)
def test_lengths_and_times_of_any_size_give_the_same_digits(make):
    def run(L, T):
        scene, t_end, angle = make(L, T)
        sol = fm.simulate(scene, t_end=t_end, rtol=1e-8, method="radau")
        return sol[angle][-1], [(e.contact, e.kind) for e in sol.events], [e.t / T for e in sol.events]

    angle, kinds, times = run(1.0, 1.0)
    for units in FAR:
        found = run(*units)
        assert found[1] == kinds
        assert found[0] == pytest.approx(angle, abs=DIGITS[make] * max(1.0, abs(angle)))
        np.testing.assert_allclose(found[2], times, rtol=10.0 * DIGITS[make])


@pytest.mark.parametrize("rtol", [1e-6, 1e-10])
def test_an_idle_rotor_takes_no_accuracy_away(rtol):
    scene, t_end, angle = dry_pin(1.0, 1.0)
    want = fm.simulate(scene, t_end=t_end, rtol=1e-11, method="radau")[angle][-1]
    for speed in (1e4, 1e8):
        beside = dry_pin_beside_a_rotor(1.0, 1.0, speed)[0]
        assert abs(fm.simulate(beside, t_end=t_end, rtol=rtol, method="radau")[angle][-1] - want) < rtol
