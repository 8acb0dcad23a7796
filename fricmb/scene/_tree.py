"""Trees and loops of a mechanism: how bodies hang on one another by joints, and which joints close loops.

The graph has the bodies and the ground as nodes and the joints as edges.  A spanning tree from the ground says on what
each body hangs; every further joint closes a loop.  Loops that share a joint form a *group*: constraints can depend on
one another within a group only, as long as a joint sees no more than the relative motion of its ends.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from fricmb.scene._joint import Joint
from fricmb.scene._scene import Scene

GROUND = "ground"


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


@dataclass(frozen=True)
class _Edge:
    a: str
    b: str
    joint: Joint


def topology(scene: Scene, names: Iterable[str] | None = None) -> Topology:
    """Tree and loops of the joints in a scene (of those with the given names)."""
    held = None if names is None else set(names)
    joints = [joint for joint in scene.joints if joint.constrains and (held is None or joint.name in held)]
    if not joints:
        return Topology()
    moving = {body.name for body in scene.bodies if body.dof_names}
    edges = [_Edge(*_ends(joint, moving), joint) for joint in joints]
    bodies = [body.name for body in scene.bodies if body.dof_names]
    order, parent = _span(bodies, edges)
    tree = tuple(_branch(name, parent[name]) for name in order)
    used = {edge.joint.name for edge in parent.values() if edge is not None}
    loops = tuple(
        Loop(joint=edge.joint.name, along=tuple(e.joint.name for e in _way(edge.a, edge.b, parent)))
        for edge in edges
        if edge.joint.name not in used
    )
    return Topology(tree=tree, loops=loops, groups=_groups(bodies, edges))


def _ends(joint: Joint, moving: set[str]) -> tuple[str, str]:
    a, b = (end.owner.name if end.owner.name in moving else GROUND for end in (joint.a, joint.b))
    return a, b


def _span(bodies: Sequence[str], edges: Sequence[_Edge]) -> tuple[list[str], dict[str, _Edge | None]]:
    """Bodies in the order of a breadth-first search, and the edge that each was reached by."""
    at: dict[str, list[_Edge]] = {GROUND: [], **{name: [] for name in bodies}}
    for edge in edges:
        at[edge.a].append(edge)
        at[edge.b].append(edge)
    parent: dict[str, _Edge | None] = {}
    order: list[str] = []
    for root in (GROUND, *bodies):
        if root in parent:
            continue
        if root != GROUND:
            parent[root] = None
            order.append(root)
        queue = deque([root])
        while queue:
            here = queue.popleft()
            for edge in at[here]:
                there = edge.b if edge.a == here else edge.a
                if there != GROUND and there not in parent and there != here:
                    parent[there] = edge
                    order.append(there)
                    queue.append(there)
    return order, parent


def _branch(name: str, edge: _Edge | None) -> Branch:
    if edge is None:
        return Branch(body=name)
    own = tuple(f"{edge.joint.name}.{label}" for label in edge.joint.observed())
    return Branch(body=name, on=edge.b if edge.a == name else edge.a, joint=edge.joint.name, coordinates=own)


def _way(a: str, b: str, parent: dict[str, _Edge | None]) -> list[_Edge]:
    """Edges of the tree between two bodies."""

    def up(name: str) -> list[tuple[str, _Edge]]:
        found = []
        while name != GROUND and (edge := parent[name]) is not None:
            found.append((name, edge))
            name = edge.b if edge.a == name else edge.a
        return found

    left, right = up(a), up(b)
    while left and right and left[-1][0] == right[-1][0]:
        left.pop()
        right.pop()
    return [edge for _, edge in (*left, *reversed(right))]


def _groups(bodies: Sequence[str], edges: Sequence[_Edge]) -> tuple[tuple[str, ...], ...]:
    """Joints of loops that share a joint; a joint that sees more than relative motion counts as tied to the ground."""
    seen: list[_Edge] = []
    for edge in edges:
        seen.append(edge)
        if not edge.joint.relative and GROUND not in (edge.a, edge.b):
            seen.append(_Edge(edge.a, GROUND, edge.joint))
    _, parent = _span(bodies, seen)
    lead = {edge.joint.name: edge.joint.name for edge in edges}

    def first(name: str) -> str:
        while lead[name] != name:
            lead[name] = lead[lead[name]]
            name = lead[name]
        return name

    on_loop: set[str] = set()
    in_tree = {id(edge) for edge in parent.values() if edge is not None}
    for edge in seen:
        if id(edge) in in_tree:
            continue
        for other in (edge, *_way(edge.a, edge.b, parent)):
            on_loop.add(other.joint.name)
            lead[first(other.joint.name)] = first(edge.joint.name)
    found: dict[str, list[str]] = {}
    for edge in edges:
        if edge.joint.name in on_loop:
            found.setdefault(first(edge.joint.name), []).append(edge.joint.name)
    return tuple(tuple(names) for names in found.values())
