"""Trees and loops of a mechanism: how bodies hang on one another by joints, and which joints close loops.

The graph has the bodies and the ground as nodes and the joints as edges.  A spanning tree from the ground says on what
each body hangs; every further joint closes a loop.  Loops that share a joint form a *group*: constraints can depend on
one another within a group only, as long as a joint sees no more than the relative motion of its ends.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from fricmb.scene._graph import ground_of
from fricmb.scene._joint import Joint
from fricmb.scene._scene import Scene


@dataclass(frozen=True, kw_only=True)
class Branch:
    """A body on the tree: what it hangs on (None: it is free), by which joint, and that joint's own coordinates."""

    body: str
    on: str | None = None
    joint: str | None = None
    coordinates: tuple[str, ...] = ()

    def __str__(self) -> str:
        if self.joint is None:
            return f"{self.body}: free"
        moves = f", moves in {', '.join(self.coordinates)}" if self.coordinates else ""
        return f"{self.body} on {self.on} by {self.joint}{moves}"


@dataclass(frozen=True, kw_only=True)
class Loop:
    """A joint that closes a loop, and the joints of the tree along it."""

    joint: str
    along: tuple[str, ...]

    def __str__(self) -> str:
        if not self.along:
            return f"{self.joint}: ties a body to the ground beside the tree"
        return f"{self.joint} closes {', '.join(self.along)}"


@dataclass(frozen=True, kw_only=True)
class Topology:
    """Tree and loops.

    Attributes
    ----------
    tree : tuple of Branch
        From the ground outward.
    loops : tuple of Loop
    groups : tuple of tuple of str
        Joints whose constraints can depend on one another; a joint that is on no loop is in none.
    """

    tree: tuple[Branch, ...] = ()
    loops: tuple[Loop, ...] = ()
    groups: tuple[tuple[str, ...], ...] = ()


def topology(scene: Scene, names: Iterable[str] | None = None) -> Topology:
    """Tree and loops of the joints in a scene (of those with the given names)."""
    held = None if names is None else set(names)
    ties = [j for j in scene.joints if j.constrains and not j.is_rigid]
    joints = {j.name: j for j in ties if held is None or j.name in held}
    if not joints:
        return Topology()
    # imported here: it takes a tenth of a second, and scenes without joints do not need it
    import networkx as nx

    moving = [body.name for body in scene.bodies if body.dof_names]
    ground = ground_of(scene)
    ends = {name: _ends(joint, {*moving}, ground) for name, joint in joints.items()}
    graph = nx.MultiGraph()
    graph.add_nodes_from([ground, *moving])
    graph.add_edges_from((a, b, name) for name, (a, b) in ends.items())
    tree = nx.Graph()
    branches = []
    for root in graph:
        if root in tree:
            continue
        tree.add_node(root)
        if root != ground:
            branches.append(Branch(body=root))
        for on, body in nx.bfs_edges(graph, root):
            name = next(iter(graph[on][body]))
            tree.add_edge(on, body, joint=name)
            own = tuple(f"{name}.{label}" for label in joints[name].observed())
            branches.append(Branch(body=body, on=on, joint=name, coordinates=own))
    used = {branch.joint for branch in branches}
    loops = tuple(Loop(joint=name, along=_way(tree, *ends[name])) for name in joints if name not in used)
    return Topology(tree=tuple(branches), loops=loops, groups=_groups(joints, ends, ground))


def _ends(joint: Joint, moving: set[str], ground: str) -> tuple[str, str]:
    a, b = (end.owner.name if end.owner.name in moving else ground for end in (joint.a, joint.b))
    return a, b


def _way(tree: Any, a: str, b: str) -> tuple[str, ...]:
    """Joints of the tree between two bodies."""
    import networkx as nx

    way = nx.shortest_path(tree, a, b)
    return tuple(tree[here][there]["joint"] for here, there in pairwise(way))


def _groups(
    joints: Mapping[str, Joint], ends: Mapping[str, tuple[str, str]], ground: str
) -> tuple[tuple[str, ...], ...]:
    """Joints of loops that share a joint; a joint that sees more than relative motion counts as tied to the ground.

    With each joint as two nodes on a way from body to body, joints of one group are those of one biconnected
    component, on which every two lie on a loop.
    """
    import networkx as nx

    graph = nx.Graph()
    for name, (a, b) in ends.items():
        nx.add_path(graph, [("body", a), (name, 0), (name, 1), ("body", b)])
        if not joints[name].relative and ground not in (a, b):
            graph.add_edge((name, 0), ("body", ground))
    group: dict[str, int] = {}
    for number, part in enumerate(nx.biconnected_components(graph)):
        if len(part) > 2:
            group |= {name: number for name, place in part if place == 0}
    found: dict[int, list[str]] = {}
    for name in joints:
        if name in group:
            found.setdefault(group[name], []).append(name)
    return tuple(tuple(names) for names in found.values())
