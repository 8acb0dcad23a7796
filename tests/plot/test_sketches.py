"""Drawings of scenes show where bodies are, what hangs on what, and which force acts; to scale for mechanisms."""

import matplotlib as mpl
import numpy as np
import pytest

mpl.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.colors import to_hex

import fricmb as fm
from fricmb.models import catalogue
from fricmb.plot._animation import Drawing, arrow_lines, canvas, link_lines, strokes
from fricmb.plot._layout import layout
from fricmb.plot._make_sketch import shown_span, sketch_of_run, sketch_of_scene
from fricmb.plot._style import _PAINTS


@pytest.fixture(scope="module")
def belt():
    return fm.simulate(fm.models.belt_oscillator(damping=0.05), t_end=60.0, rtol=1e-7)


@pytest.fixture(autouse=True)
def _no_figures_left():
    yield
    plt.close("all")


def number(sketch, name):
    return next(k for k, shape in enumerate(sketch.shapes) if shape.name == name)


def test_boxes_move_with_their_bodies(belt):
    t = np.linspace(0, 60, 61)
    sketch = sketch_of_run(belt, t, 2.0)
    x = belt.at(t)["mass.x"]
    drawn = sketch.places[number(sketch, "mass"), 0]
    assert drawn - drawn[0] == pytest.approx(2 * (x - x[0]), abs=1e-12)
    (touch,) = sketch.touches
    assert (touch.mode == belt.at(t).mode("sole")).all()
    assert touch.force[0] == pytest.approx(belt.at(t).force("sole")[0] / 1.5, rel=1e-6, abs=1e-9)
    # the belt runs: strokes on it go on by what it has moved
    k = number(sketch, "belt")
    assert set(sketch.strokes) == {k}
    moved = 2 * (belt.at(t)["belt.x"] - belt.at(t)["belt.x"][0])
    assert sketch.strokes[k] == pytest.approx(moved, abs=1e-12)
    first, later = (np.sort([line[0, 0] for line in strokes(sketch, k, i)]) for i in (0, 1))
    width = sketch.shapes[k].band
    assert np.sort((first + width / 2 + moved[1]) % width) == pytest.approx(later + width / 2, abs=1e-9)


def test_contacts_have_the_colour_of_their_mode(belt):
    sketch = sketch_of_run(belt, np.linspace(0, 60, 61))
    _, ax = canvas(sketch)
    drawing = Drawing(sketch, ax)
    paint = _PAINTS["light"]
    assert arrow_lines(sketch.touches[0], np.zeros(2), sketch.reach, 0, sketch.unit) == []  # no force at the start
    for i in (10, 17, 40):
        drawing.show(i)
        face = to_hex(drawing.touches[0][0].get_facecolor())
        assert face == to_hex(paint.stick if sketch.touches[0].mode[i] == 0 else paint.slip)
        shaft = arrow_lines(sketch.touches[0], np.zeros(2), sketch.reach, i, sketch.unit)[0]
        assert shaft[1] == pytest.approx(sketch.reach * sketch.touches[0].force[:, i], abs=1e-12)


def test_bodies_stand_on_what_they_touch():
    places = layout(fm.models.block_stack(3)).places
    heights = [places[name][1] for name in ("table", "block1", "block2", "block3")]
    assert heights == sorted(heights)
    assert len({x for x, _ in places.values()}) == 1


def test_a_contact_in_the_plane_is_seen_from_above():
    found = layout(fm.models.brake4dof("1"))
    assert found.above
    assert found.under == {"pad": "rotor", "rotor": "ground"}
    (x, y), (width, height) = found.places["pad"], found.sizes["pad"]
    (u, v), (wide, high) = found.places["rotor"], found.sizes["rotor"]
    assert abs(x - u) + width / 2 < wide / 2
    assert abs(y - v) + height / 2 < high / 2


def test_springs_lie_along_their_direction():
    sketch = sketch_of_scene(fm.models.brake4dof("1"))
    links = {link.name: link for link in sketch.links}
    for name, across in (("k1x", 1), ("c1x", 1), ("k1y", 0), ("k2y", 0)):
        a, b = sketch.where(links[name].a, 0), sketch.where(links[name].b, 0)
        assert a[across] == pytest.approx(b[across], abs=1e-12), name
        assert abs(a - b).max() > 0.5
    assert links["c1x"].kind == "damper"
    tilted = sketch_of_scene(fm.models.minimal_flutter())
    part = next(p for p in fm.models.minimal_flutter().elements if not isinstance(p.axis, str))
    link = next(link for link in tilted.links if link.name == part.name)
    along = tilted.where(link.a, 0) - tilted.where(link.b, 0)
    axis = np.array(part.axis) / np.hypot(*part.axis)
    assert abs(along @ axis) == pytest.approx(np.hypot(*along), rel=1e-9)


def test_mechanisms_are_drawn_to_scale():
    """The pins of a four-bar linkage keep their distances in every picture, and stay on the bodies they join."""
    sol = fm.simulate(fm.models.four_bar(), t_end=0.5, rtol=1e-6)
    sketch = sketch_of_run(sol, np.linspace(0.0, 0.5, 7))
    pins = [mark for mark in sketch.marks if mark.kind == "pin"]
    fixed = [mark for mark in sketch.marks if mark.kind == "support"]
    assert (len(pins), len(fixed)) == (4, 2)
    for i in range(7):
        A, B, C, D = (sketch.where(pin.at, i) for pin in pins)
        lengths = [np.hypot(*(p - q)) for p, q in ((A, B), (B, C), (C, D), (D, A))]
        assert lengths == pytest.approx([0.1, 0.3, 0.25, 0.32], abs=1e-6)
        assert sketch.where(fixed[1].at, i) == pytest.approx([0.32, 0.0])
    assert sketch.places[number(sketch, "crank"), 2] == pytest.approx(sol.at(sketch.t)["crank.angle"])
    outline = sketch.shapes[number(sketch, "coupler")].outline
    assert np.ptp(outline[:, 0]) == pytest.approx(0.3 + 2 * 0.55 * sketch.unit, rel=1e-2)


def test_gears_touch():
    scene = fm.models.drive_train(ratio=2.0)
    sketch = sketch_of_scene(scene)
    motor, wheel = (number(sketch, name) for name in ("motor", "wheel"))
    radii = [sketch.shapes[k].outline[:, 0].max() for k in (motor, wheel)]
    assert radii[1] / radii[0] == pytest.approx(2.0)
    apart = np.hypot(*(sketch.places[motor, :2, 0] - sketch.places[wheel, :2, 0]))
    assert apart == pytest.approx(sum(radii))


def test_what_stands_at_the_ground_is_in_view():
    bead = fm.RigidBody("bead", mass=1.0, inertia=0.01, position=(1.0, 0.0))
    sketch = sketch_of_scene(fm.Scene("ring", [bead, fm.RollerOnCircle("ring", bead, radius=1.0)]))
    left, right, bottom, top = sketch.view
    assert left < -1.0 < 1.0 < right
    assert bottom < -1.0 < 1.0 < top


def test_coils_and_pots_reach_both_ends(belt):
    sketch = sketch_of_run(belt, np.array([0.0, 10.0]))
    for link in sketch.links:
        points = np.concatenate(link_lines(sketch, link, 1))
        for end in (link.a, link.b):
            assert np.hypot(*(points - sketch.where(end, 1)).T).min() < 1e-9


def test_pictures_are_many_enough_for_a_swing():
    sol = fm.simulate(fm.models.friction_oscillator(friction=0.0, stiffness=100.0), t_end=200.0, rtol=1e-6)
    begin, end, count = shown_span(sol, None, None)
    period = 2 * np.pi / 10
    assert end == 200.0
    assert (end - begin) / count == pytest.approx(period / 32, rel=1e-2)
    begin, end, count = shown_span(sol, 0.0, period * 4)
    assert (begin, end) == (0.0, period * 4)
    assert count >= 32 * 3


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_every_model_is_drawn(theme, tmp_path):
    with fm.plot.theme(theme):
        for name, model in catalogue.items():
            scene = model.build()
            figure = scene.draw()
            texts = {text.get_text() for text in figure.axes[0].texts}
            assert {body.name for body in scene.bodies} <= texts, name
            assert figure.get_suptitle() == scene.name
    figure.savefig(tmp_path / "scene.svg")
    scene = fm.models.drive_train()
    _, ax = plt.subplots()
    assert scene.draw(ax=ax) is ax.figure


def test_crowds_are_not_drawn():
    with pytest.raises(fm.FricmbError, match="a scene of 1501 bodies is not drawn; at most 60 are"):
        fm.models.block_stack(1500, mu_s=[0.5] * 1500).draw()


def test_balls_that_strike_each_other_are_drawn_as_large_as_they_are():
    sketch = sketch_of_scene(fm.models.newtons_cradle(n=3, radius=0.02))
    sizes = [np.hypot(*shape.outline.T).max() for shape in sketch.shapes if shape.name.startswith("ball")]
    assert np.allclose(sizes, 0.02)
    assert "circle" not in {mark.kind for mark in sketch.marks}


def test_stops_and_play_that_do_not_give_are_drawn_as_those_that_do():
    for given in ({"restitution": 0.5}, {"stiffness": 1e3}):
        box, loose = (fm.Body(name, mass=1.0) for name in ("box", "loose"))
        parts = [
            box, loose,
            fm.Spring("spring", box, axis="x", stiffness=1.0),
            fm.Stop("stop", box, axis="x", upper=0.5, **given),
            fm.Backlash("play", loose, box, axis="x", gap=0.2, **given),
        ]
        sketch = sketch_of_scene(fm.Scene("blocks", parts))
        assert {(link.name, link.kind) for link in sketch.links} == {
            ("spring", "spring"), ("stop", "play"), ("play", "play"),
        }  # fmt: skip
    gears = sketch_of_scene(fm.models.gear_rattle())
    assert "play" in {link.kind for link in gears.links}


def test_stops_of_a_body_to_scale_are_walls_that_its_rim_runs_against():
    cart = fm.RigidBody("cart", mass=1.0, inertia=0.02, position=(0.1, 0.2))
    parts = [
        cart, fm.Wheel("floor", cart, radius=0.2),
        fm.Stop("ends", cart, axis="x", lower=-0.8, upper=0.5, restitution=0.7),
    ]
    walls = [mark for mark in sketch_of_scene(fm.Scene("cart", parts)).marks if mark.kind == "wall"]
    assert np.allclose([mark.at[1] for mark in walls], [-1.0, 0.7])
    assert np.allclose([mark.angle for mark in walls], [np.pi, 0.0])
