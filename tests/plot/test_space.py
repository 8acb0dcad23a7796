"""Pictures of bodies in space show them as they stand: their turns, where they touch, how large they are."""

import matplotlib as mpl
import numpy as np
import pytest

mpl.use("Agg")
import matplotlib.pyplot as plt
from PIL import Image

import fricmb as fm
from fricmb.plot.space import space_data, space_sketch_of_run, space_sketch_of_scene
from fricmb.plot.space._page import quaternions
from fricmb.plot.space._shapes import cylinder_of, edges_of

WEIGHT = fm.Gravity("weight", acceleration={"z": -9.81})
RADIUS = 0.25


def coin(friction=2.0):
    tilt, m = 1.2, 0.1
    axis = np.array([np.sin(tilt), 0.0, np.cos(tilt)])
    spin = 9.0 * axis
    lowest = -RADIUS * (np.array([0.0, 0.0, 1.0]) - axis[2] * axis) / np.sin(tilt)
    body = fm.space.Rotor(
        "coin", mass=m, inertia_across=m * RADIUS**2 / 4, inertia_axial=m * RADIUS**2 / 2, axis=axis,
        position=(0, 0, RADIUS * np.sin(tilt)), velocity=-np.cross(spin, lowest), angular_velocity=spin,
    )  # fmt: skip
    law = fm.laws.Coulomb(mu_s=friction)
    floor = fm.space.OnPlane("floor", body, normal=(0, 0, 1), radius=RADIUS, push_only=True, friction=law)
    return fm.Scene("coin", [body, floor, WEIGHT])


def ball(spin=(60.0, -30.0, 50.0)):
    one = fm.space.Ball(
        "ball", mass=0.17, radius=0.03, position=(0, 0, 0.03), velocity=(1.5, 0, 0), angular_velocity=spin
    )
    cloth = fm.space.OnPlane("cloth", one, normal=(0, 0, 1), friction=fm.laws.Coulomb(mu_s=0.2), push_only=True)
    return fm.Scene("billiard", [one, cloth, WEIGHT])


def swinging():
    rod = fm.space.RigidBody(
        "rod", mass=2.0, inertia=(0.03, 0.05, 0.04), points={"top": (0, 0, 0.3)}, angular_velocity=(1.0, 2.0, 0.5)
    )
    hook = fm.space.Spherical("hook", rod.point("top"), fm.space.ground_point(0, 0, 0.3))
    stone = fm.Body("stone", mass=1.0, axes="xyz", position={"x": 0.9})
    spring = fm.PointSpring("spring", rod, stone, stiffness=20.0, length=0.3)
    return fm.Scene("swing", [rod, hook, stone, spring, WEIGHT])


@pytest.fixture(autouse=True)
def _no_figures_left():
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def runs():
    return {make.__name__: fm.simulate(make(), t_end=0.5, rtol=1e-7) for make in (coin, ball, swinging)}


@pytest.mark.parametrize("name", ["coin", "ball", "swinging"])
def test_bodies_turn_as_they_do(runs, name):
    """R' R^T of what is drawn is the angular velocity of the run."""
    sol = runs[name]
    t, h = np.linspace(0.01, 0.45, 7), 1e-4
    body = "rod" if name == "swinging" else name
    times = np.sort(np.concatenate([np.linspace(0.0, 0.5, 1001), t - h, t + h]))
    turns = space_sketch_of_run(sol, times).turns[0]
    assert np.einsum("jin,jkn->ikn", turns, turns) == pytest.approx(np.repeat(np.eye(3)[:, :, None], times.size, 2))
    for moment in t:
        before, after = (turns[:, :, np.argmin(np.abs(times - moment - side * h))] for side in (-1, 1))
        rate = (after - before) / (2 * h) @ (0.5 * (after + before)).T
        omega = np.array([rate[2, 1] - rate[1, 2], rate[0, 2] - rate[2, 0], rate[1, 0] - rate[0, 1]]) / 2
        assert omega == pytest.approx(sol.at([moment])[f"{body}.omega"][:, 0], rel=2e-3, abs=2e-2)


def test_a_body_stands_as_its_coordinates_say(runs):
    times = np.linspace(0.0, 0.5, 11)
    sketch = space_sketch_of_run(runs["swinging"], times)
    seen = runs["swinging"].at(times)
    assert sketch.turns[0] == pytest.approx(seen["rod.rotation"], abs=1e-9)
    # the hook is where the rod's point is in every picture, and where it was
    for i in range(11):
        assert sketch.where(sketch.pins[0], i) == pytest.approx([0, 0, 0.3], abs=1e-6)
    (spring,) = sketch.links
    assert sketch.where(spring.b, 10) == pytest.approx([seen[f"stone.{c}"][-1] for c in "xyz"], abs=1e-12)


def test_what_touches_a_plane_touches_it_in_the_picture(runs):
    times = np.linspace(0.0, 0.5, 11)
    for name in ("coin", "ball"):
        sketch = space_sketch_of_run(runs[name], times)
        (touch,) = sketch.touches
        assert touch.at[2] == pytest.approx(0.0, abs=1e-9)
        for i in range(11):
            lowest = sketch.points_at(0, sketch.solids[0].corners(), i)[:, 2].min()
            assert abs(lowest) < 0.1 * sketch.solids[0].corners().max()  # its thickness, its corners
        assert (touch.mode == runs[name].at(times).mode(touch.name)).all()
        assert np.linalg.norm(touch.force, axis=0).max() <= 1.0 + 1e-9
        assert touch.force[2] == pytest.approx(0.0)


def test_forces_act_against_the_slip(runs):
    seen = runs["ball"].at([0.1])
    (touch,) = space_sketch_of_run(runs["ball"], np.array([0.1])).touches
    slip = seen.relative_velocity("cloth")[:, 0]
    assert touch.force[:2, 0] == pytest.approx(-slip / np.linalg.norm(slip), abs=1e-9)


def test_boxes_and_cylinders_have_the_inertia_of_their_bodies():
    a, b, c = edges = np.array([0.3, 0.2, 0.1])
    inertia = 2.0 / 12 * np.array([b**2 + c**2, a**2 + c**2, a**2 + b**2])
    assert edges_of(2.0, inertia) == pytest.approx(edges)
    r, length = 0.2, 0.7
    found = cylinder_of(3.0, 3.0 * (3 * r**2 + length**2) / 12, 3.0 * r**2 / 2)
    assert found == pytest.approx((r, length / 2))


def test_solids_are_closed_and_look_outwards(runs):
    """The volume under the faces, by the divergence theorem, is that of the solid."""
    volumes = {"ball": 4 / 3 * np.pi * 0.03**3, "swinging": None}
    for name, sol in runs.items():
        solid = space_sketch_of_run(sol, np.zeros(1)).solids[0]
        volume = 0.0
        for face in solid.faces:
            for k in range(1, len(face) - 1):
                volume += float(np.linalg.det(np.array([face[0], face[k], face[k + 1]]))) / 6
        if name == "ball":
            assert volume == pytest.approx(volumes["ball"], rel=0.1)
        elif name == "swinging":
            assert volume == pytest.approx(np.prod(edges_of(2.0, np.array([0.03, 0.05, 0.04]))))
        else:
            half = max(face[:, 2].max() for face in solid.faces)
            assert volume == pytest.approx(np.pi * RADIUS**2 * 2 * half, rel=0.02)


def test_a_turntable_turns():
    one = fm.space.Ball("ball", mass=0.1, radius=0.02, position=(0.1, 0, 0.02), angular_velocity=(0, 0, 0))
    law = fm.laws.Coulomb(mu_s=0.5)
    for turning, angle in ((2.0, 1.0), (2.0 * fm.t, 0.25)):
        table = fm.space.OnPlane("table", one, normal=(0, 0, 1), turning=turning, friction=law, push_only=True)
        sol = fm.simulate(fm.Scene("turntable", [one, table, WEIGHT]), t_end=0.5, rtol=1e-6)
        (floor,) = space_sketch_of_run(sol, np.linspace(0.0, 0.5, 101)).floors
        assert floor.angle[-1] == pytest.approx(angle, rel=1e-3)


def test_a_top_stands_on_its_tip():
    n = np.array([0.3, 0.0, 1.0]) / np.hypot(0.3, 1.0)
    one = fm.space.Rotor(
        "top", mass=0.1, inertia_across=2.5e-4, inertia_axial=8e-5, axis=n, spin=200.0,
        position=0.05 * n, stations={"tip": -0.05},
    )  # fmt: skip
    table = fm.space.OnPlane("table", one.station("tip"), normal=(0, 0, 1))
    sketch = space_sketch_of_scene(fm.Scene("top", [one, table, WEIGHT]))
    corners = sketch.points_at(0, sketch.solids[0].corners(), 0)
    assert corners[np.argmin(corners[:, 2])] == pytest.approx([0, 0, 0], abs=1e-12)


def test_pictures_and_pages(runs, tmp_path):
    for name, sol in runs.items():
        figure = sol.scene.draw()
        (ax,) = figure.axes
        assert ax.name == "3d"
        figure.savefig(tmp_path / f"{name}.png")
        page = sol.plot.view(tmp_path / f"{name}.html").read_text(encoding="utf-8")
        assert "drag to turn" in page
        assert "NaN" not in page.split("const data =")[1].split("\n")[0]
    sol.animate(tmp_path / "swing.gif", frames=3)
    with Image.open(tmp_path / "swing.gif") as moving:
        assert moving.n_frames == 3
    assert "<img" in sol.scene._repr_html_()
    with pytest.raises(fm.FricmbError, match="projection='3d'"):
        sol.scene.draw(ax=plt.figure().subplots())
    assert sol.scene.draw(ax=plt.figure().add_subplot(projection="3d")).axes


def test_turns_of_a_page_do_not_jump(runs):
    sketch = space_sketch_of_run(runs["ball"], np.linspace(0.0, 0.5, 400))
    found = quaternions(sketch.turns[0])
    assert np.linalg.norm(np.diff(found, axis=1), axis=0).max() < 0.2
    data = space_data(sketch)
    assert data["touches"][0]["mode"].count(0) > 0
    assert len(data["solids"][0]["place"][0]) == 400


def test_wheels_stand_on_their_rails():
    axle = fm.space.Rotor(
        "axle", mass=1250.0, inertia_across=700.0, inertia_axial=100.0, position=(0, 0, 0.45), axis=(0, 1, 0),
        spin=100.0, stations={"left": 0.75, "right": -0.75},
    )  # fmt: skip
    creep = fm.space.LinearCreep(f11=8e6, f22=7e6, speed=45.0)
    wheels = [
        fm.space.WheelRail(side, axle.station(side), through=(0, y, 0), rolling_radius=0.45, speed=45.0, friction=creep)
        for side, y in (("left", 0.75), ("right", -0.75))
    ]
    sketch = space_sketch_of_scene(fm.Scene("axle", [axle, *wheels, WEIGHT]))
    assert [touch.at[:, 0].round(12).tolist() for touch in sketch.touches] == [[0, 0.75, 0], [0, -0.75, 0]]
    for rail, y in zip(sketch.rails, (0.75, -0.75), strict=True):
        assert rail[:, 1:] == pytest.approx(np.array([[y, 0.0]] * 2))
        assert np.ptp(rail[:, 0]) > 1.0
    corners = sketch.points_at(0, sketch.solids[0].corners(), 0)
    assert corners[:, 2].min() == pytest.approx(0.0, abs=0.01)
    assert np.ptp(corners[:, 1]) == pytest.approx(1.5, abs=0.1)
