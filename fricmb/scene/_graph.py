"""A scene as a graph: bodies and the ground are nodes, what acts between them edges."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

from fricmb.scene._bodies import Body
from fricmb.scene._contact import Contact
from fricmb.scene._element import Element
from fricmb.scene._joint import Joint
from fricmb.scene._matrix import MatrixElement
from fricmb.scene._part import GROUND, Part
from fricmb.scene._rigid import RigidBody
from fricmb.scene._space_body import SpaceBody
from fricmb.scene._turning import Gravity

if TYPE_CHECKING:
    import networkx

    from fricmb.scene._scene import Scene

#: What has weight.
_HEAVY = (Body, RigidBody, SpaceBody)


def scene_graph(scene: Scene) -> networkx.MultiGraph:
    """See :meth:`fricmb.Scene.graph`."""
    # imported here: it takes a tenth of a second, and few scenes need it
    import networkx

    ground = ground_of(scene)
    graph = networkx.MultiGraph(name=scene.name, ground=ground)
    graph.add_node(ground, kind="ground", part=GROUND)
    graph.add_nodes_from((body.name, {"kind": "body", "part": body}) for body in scene.bodies)
    graph.add_nodes_from((body.name, {"kind": "driven", "part": body}) for body in scene.driven)
    for part in scene.parts:
        kind = kind_of(part)
        for a, b, reads in _ties(scene, part, ground) if kind else ():
            graph.add_edge(a, b, key=part.name, kind=kind, part=part, reads=reads)
    return graph


def ground_of(scene: Scene) -> str:
    """The name of the ground's node: "ground", but for scenes with a part of this name."""
    name = GROUND.name
    while name in scene:
        name += "_"
    return name


def kind_of(part: Part) -> str | None:
    """What kind of edge a part is; None for one that is none."""
    if isinstance(part, Contact):
        return "contact"
    if isinstance(part, Joint):
        return "joint"
    return "element" if isinstance(part, Element | MatrixElement | Gravity) else None


def _ties(scene: Scene, part: Part, ground: str) -> Iterator[tuple[str, str, bool]]:
    """Pairs of nodes that a part ties, and whether it does no more than read the motion of the second."""
    if isinstance(part, Gravity):
        yield from ((body.name, ground, False) for body in scene.bodies if isinstance(body, _HEAVY))
        return
    if isinstance(part, MatrixElement):
        first, *others = dict.fromkeys(name.partition(".")[0] for name in part.dofs)
    else:
        first, *others = dict.fromkeys(ground if end.owner is GROUND else end.owner.name for end in part.ends())
    yield from ((first, other, False) for other in others or [ground])
    yield from ((first, other, True) for other in _read(part) if other not in (first, *others))


def _read(part: Part) -> Iterable[str]:
    """Bodies whose motions stand in the expressions of a part."""
    found: dict[str, Any] = {}
    for uses in part.uses().values():
        found |= dict.fromkeys(name.partition(".")[0] for name in uses.motions)
    return found
