"""Bodies in space that several pads or points bring to rest, hold together and let go together."""

import numpy as np
import pytest
import sympy

import fricmb as fm

#: Coefficients of the pads, and where they stand: on a circle.
MU, RADIUS, PRELOAD = (0.4, 0.3, 0.5, 0.35), 0.2, 5.0
#: Moment of inertia about the axis, speed at the start, when the couple begins to grow, and how fast its forces do.
C, SPEED, BEGIN, GROWTH = 0.2, 10.0, 4.0, 4.0


def place(i: int) -> tuple[float, float, float]:
    """Where pad i stands."""
    return (RADIUS * np.cos(2.2 * i), RADIUS * np.sin(2.2 * i), 0.01)


def pads(body: object, count: int) -> list[object]:
    """Pads on the upper face."""
    dry = [fm.laws.Coulomb(mu_s=mu) for mu in MU[:count]]
    pressed = {"normal": (0, 0, 1), "preload": PRELOAD, "stiffness": 1e4, "damping": 1.0}
    return [fm.space.Pad(f"p{i}", body, at=place(i), friction=law, **pressed) for i, law in enumerate(dry)]


def loaded_disc(count: int) -> fm.Scene:
    """A disc on a hinge, stopped by its pads, on which then a couple grows that at last turns it again."""
    disc = fm.space.RigidBody(
        "disc", mass=1.0, inertia=(0.1, 0.1, C), angular_velocity=(0, 0, SPEED),
        points={"a": (RADIUS, 0, 0), "b": (-RADIUS, 0, 0)},
    )  # fmt: skip
    growing = GROWTH * sympy.Piecewise((0, fm.t < BEGIN), (fm.t - BEGIN, True))
    couple = [
        fm.Force(f"f{name}", disc.point(name), axis="y", value=sign * growing) for name, sign in (("a", 1), ("b", -1))
    ]
    return fm.Scene("disc", [disc, fm.space.Revolute("hub", disc, axis=(0, 0, 1)), *pads(disc, count), *couple])


@pytest.mark.parametrize("rtol", [1e-3, 1e-8])
@pytest.mark.parametrize("count", [3, 4])
def test_pads_on_a_hinge_stop_it_as_one_and_let_go_as_one(count: int, rtol: float) -> None:
    """What they can hold is the sum of their moments, however they share it; reactions balance what they do."""
    torque = sum(MU[:count]) * PRELOAD * RADIUS
    stop = C * SPEED / torque
    leaver = 2.0 * RADIUS * GROWTH * abs(np.cos(SPEED * stop / 2.0))
    parts = BEGIN + torque / leaver
    sol = fm.simulate(loaded_disc(count), t_end=parts + 0.02, rtol=rtol, method="radau", time_limit=60.0)
    assert [e.kind for e in sol.events] == ["stick"] * count + ["slip"] * count
    np.testing.assert_allclose([e.t for e in sol.events[:count]], stop, rtol=0.1 * rtol)
    np.testing.assert_allclose([e.t for e in sol.events[count:]], parts, rtol=0.1 * rtol)
    assert abs(sol["disc.omega"][2, -1]) > 0.0
    near = sol.at(np.array([BEGIN + 0.97 * (parts - BEGIN)]))
    forces = np.array([near.force(f"p{i}")[:, 0] for i in range(count)])
    assert (np.hypot(*forces.T) <= np.array(MU[:count]) * PRELOAD * (1.0 + 1e-9)).all()
    np.testing.assert_allclose(near.reaction("hub")[:2, 0], -forces.sum(axis=0), atol=1e-8)
    moment = sum(x * f[1] - y * f[0] for (x, y, _), f in zip(map(place, range(count)), forces, strict=True))
    assert abs(moment) == pytest.approx(0.97 * torque, rel=max(0.1 * rtol, 1e-8))


@pytest.mark.parametrize(("count", "rtol"), [(3, 1e-3), (3, 1e-6), (4, 1e-4)])
def test_the_last_pad_on_a_ball_joint_rests_when_the_others_do(count: int, rtol: float) -> None:
    """Two pads and the joint hold all of the disc: the third has no slip left, and its stop has the same time."""
    kind = {3: fm.space.Rotor, 4: fm.space.RigidBody}[count]
    moments = {3: {"inertia_across": 0.1, "inertia_axial": C}, 4: {"inertia": (0.1, 0.1, C)}}[count]
    disc = kind("disc", mass=1.0, angular_velocity=(0, 0, SPEED), **moments)
    parts = [disc, fm.space.Spherical("hub", disc, fm.GROUND), *pads(disc, count)]
    sol = fm.simulate(fm.Scene("disc", parts), t_end=3.0, rtol=rtol, method="radau", time_limit=60.0)
    assert [e.kind for e in sol.events] == ["stick"] * count
    np.testing.assert_allclose([e.t for e in sol.events], sol.events[0].t, rtol=1e-9)
    assert np.abs(sol["disc.omega"][:, sol.t > sol.events[-1].t]).max() <= 1e-12 * SPEED
    rest = sol.at(np.array([2.5]))
    for i, mu in enumerate(MU[:count]):
        assert np.hypot(*rest.force(f"p{i}")[:, 0]) <= mu * rest.normal_force(f"p{i}")[0] * (1.0 + 1e-9)


def test_a_table_on_three_feet_comes_to_rest_by_bdf_as_by_radau() -> None:
    """Feet that slip by round-off alone come to rest together; at this tolerance one of them never did."""
    feet = {"p": (0.3, 0, -0.1), "q": (-0.2, 0.2, -0.1), "r": (-0.2, -0.25, -0.1)}
    table = fm.space.RigidBody(
        "table", mass=2.0, inertia=(0.1, 0.12, 0.15), position=(0, 0, 0.1), velocity=(1, 0.3, 0),
        angular_velocity=(0, 0, 2.0), points=feet,
    )  # fmt: skip
    dry = fm.laws.Coulomb(mu_s=0.3)
    floor = [fm.space.OnPlane(f"c{name}", table.point(name), normal=(0, 0, 1), friction=dry) for name in feet]
    scene = fm.Scene("table", [table, fm.Gravity("weight", acceleration={"z": -9.81}), *floor])
    sol = fm.simulate(scene, t_end=1.0, rtol=1e-3, method="bdf", time_limit=60.0)
    assert sorted(e.contact for e in sol.events) == ["cp", "cq", "cr"]
    true = fm.simulate(scene, t_end=1.0, rtol=1e-9, method="radau")
    np.testing.assert_allclose(sol.events[-1].t, true.events[-1].t, rtol=1e-4)
    assert sol.energy.friction_loss[-1] == pytest.approx(0.5 * 2.0 * 1.09 + 0.5 * 0.15 * 4.0, rel=1e-4)
