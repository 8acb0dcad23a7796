"""The graph of a scene: what is in it, and that its connected parts and loops are those that a plan finds."""

import subprocess
import sys

import networkx as nx
import pytest

import fricmb as fm
from fricmb.models import catalogue
from fricmb.scene import topology


def test_nodes_and_edges_hold_the_declarations():
    scene = fm.models.brake4dof("2")
    graph = scene.graph()
    assert dict(graph.nodes(data="kind")) == {"ground": "ground", "pad": "body", "rotor": "body"}
    assert graph.nodes["ground"]["part"] is fm.GROUND
    assert graph.nodes["rotor"]["part"] is scene["rotor"]
    between = {name: held["kind"] for name, held in graph["pad"]["rotor"].items()}
    assert between == {"lining": "contact"}
    assert all(held["part"] is scene[name] for _, _, name, held in graph.edges(keys=True, data=True))
    assert {name for _, _, name in graph.edges(keys=True)} == {part.name for part in scene.parts} - {"pad", "rotor"}
    assert not any(held["reads"] for *_, held in graph.edges(data=True))


def test_parts_on_one_body_on_several_and_those_that_only_look():
    a, b, c, d = (fm.Body(name, mass=1.0) for name in "abcd")
    belt = fm.Driven("belt", velocity={"x": 1.0})
    parts = [
        fm.Force("push", a, axis="x", value=fm.coordinate("b.x")),
        fm.MatrixElement("three", ["b.x", "c.x", "d.x"], K=[[2, -1, 0], [-1, 2, -1], [0, -1, 1]]),
        fm.Contact("sole", d, belt, law=fm.laws.Coulomb(mu_s=0.5), normal_force=1.0),
        fm.Gravity("weight", acceleration={"x": 0.1}),
    ]
    graph = fm.Scene("s", [a, b, c, d, belt, *parts]).graph()
    found = {(*sorted(pair), name, held["reads"]) for *pair, name, held in graph.edges(keys=True, data=True)}
    assert found == {
        ("a", "ground", "push", False), ("a", "b", "push", True), ("b", "c", "three", False),
        ("b", "d", "three", False), ("belt", "d", "sole", False),
        *((name, "ground", "weight", False) for name in "abcd"),
    }  # fmt: skip
    assert graph.nodes["belt"]["kind"] == "driven"


def test_a_graph_is_free_to_be_changed():
    scene = fm.models.belt_oscillator()
    scene.graph().remove_node("ground")
    assert "ground" in scene.graph()


def test_a_body_may_be_called_ground():
    body, other = (fm.Body(name, mass=1.0) for name in ("ground", "other"))
    parts = [fm.Spring("k", body, other, axis="x", stiffness=1.0), fm.Force("f", body, axis="x", value=1.0)]
    graph = fm.Scene("s", [body, other, *parts]).graph()
    assert graph.graph["ground"] == "ground_"
    assert set(graph["ground"]["ground_"]) == {"f"}


MODELS = {name: model.build() for name, model in catalogue.items()}


@pytest.mark.parametrize("name", MODELS)
def test_connected_parts_are_the_islands_of_the_plan(name):
    """Where the plan leaves nothing out; it knows islands of single motions, and a body may be in several."""
    scene = MODELS[name]
    plan = scene.plan()
    if plan.left_out:
        scene = fm.Scene(
            scene.name, [p for p in scene.parts if p.name not in {n for o in plan.left_out for n in o.names}]
        )
        plan = scene.plan()
    graph = scene.graph()
    moving = [node for node, kind in graph.nodes(data="kind") if kind == "body"]
    planned = nx.Graph()
    for island in plan.islands:
        nx.add_path(planned, island.bodies)
    found = [set(part) for part in nx.connected_components(graph.subgraph(moving))]
    assert sorted(map(sorted, found)) == sorted(map(sorted, nx.connected_components(planned)))


@pytest.mark.parametrize("name", [name for name, scene in MODELS.items() if scene.joints])
def test_loops_are_as_many_as_the_graph_of_joints_has(name):
    scene = MODELS[name]
    graph = scene.graph()
    holds = (  # what may let go closes no loop
        (a, b, key)
        for a, b, key, part in graph.edges(keys=True, data="part")
        if getattr(part, "constrains", False) and not part.is_rigid
    )
    joints = nx.MultiGraph(holds)
    free = joints.number_of_edges() - joints.number_of_nodes() + nx.number_connected_components(joints)
    found = topology(scene)
    assert len(found.loops) == free
    grouped = [joint for group in found.groups for joint in group]
    assert len(grouped) == len(set(grouped))
    for a, b, key in list(joints.edges(keys=True)):  # a joint whose ends stay tied without it is on a loop
        joints.remove_edge(a, b, key)
        if nx.has_path(joints, a, b):
            assert key in grouped
        joints.add_edge(a, b, key)


def test_scenes_without_joints_do_not_load_networkx():
    code = "import sys, fricmb as fm; fm.models.brake4dof('2').plan(); print('networkx' in sys.modules)"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.split() == ["False"]
