"""Who acts on whom: the degrees of freedom that each part ties together, and those it only looks at."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from fricmb.plan._rest import can_start
from fricmb.scene import Body, Contact, Element, Force, Gravity, Joint, MatrixElement, ModalBody, Part, RigidBody, Scene
from fricmb.values import value_of


@dataclass(frozen=True, kw_only=True)
class Link:
    """What a part has to do with the degrees of freedom (by their places in the scene).

    Attributes
    ----------
    part : Part
    acts : tuple of int
        Degrees of freedom that feel it; it depends on them, too.
    reads : tuple of int
        Others it depends on: coordinates in an expression.
    facts : ElementFacts or None
        Of an element: which terms its numbers leave.
    idle : bool
        It acts on nothing: an element of which nothing is left, a contact without normal force.
    starts : bool
        It may set in motion what rests at the origin.
    """

    part: Part
    acts: tuple[int, ...]
    reads: tuple[int, ...]
    facts: Any = None
    idle: bool = False
    starts: bool = True


@dataclass(frozen=True)
class Links:
    """All parts of a scene that act, with what they act on."""

    links: tuple[Link, ...]
    n: int

    @cached_property
    def acting(self) -> list[list[Link]]:
        """Links that act on each degree of freedom."""
        found: list[list[Link]] = [[] for _ in range(self.n)]
        for link in self.links:
            for dof in () if link.idle else link.acts:
                found[dof].append(link)
        return found

    def reaching(self, targets: Iterable[int]) -> list[int]:
        """Degrees of freedom that can influence the given ones, and these: backwards along the links."""
        seen = set(targets)
        waiting = list(seen)
        used: set[int] = set()
        while waiting:
            for link in self.acting[waiting.pop()]:
                if id(link) in used:
                    continue
                used.add(id(link))
                new = {*link.acts, *link.reads} - seen
                seen |= new
                waiting.extend(new)
        return sorted(seen)

    def groups(self, dofs: Sequence[int]) -> list[list[int]]:
        """The given degrees of freedom in groups that parts tie together, in the order of the scene."""
        kept = set(dofs)
        pairs = [
            (held[0], other)
            for link in self.links
            if not link.idle and link.acts and link.acts[0] in kept
            for held in [(*link.acts, *link.reads)]
            for other in held[1:]
        ]
        rows, columns = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
        graph = coo_array((np.ones(len(pairs), dtype=np.int8), (rows, columns)), shape=(self.n, self.n))
        _, label = connected_components(graph, directed=False)
        found: dict[int, list[int]] = {}
        for dof in dofs:
            found.setdefault(int(label[dof]), []).append(dof)
        return list(found.values())


def links_of(scene: Scene) -> Links:
    """The links of a scene; those of parts that another scene of its family has as well are taken from there."""
    place = {name: i for i, name in enumerate(scene.dof_names)}
    names, shared = scene._shared.get("links", ((), {}))
    if names != scene.dof_names:  # links hold places of degrees of freedom
        shared = {}
        scene._shared["links"] = scene.dof_names, shared
    links = []
    for part in scene.parts:
        if isinstance(part, Gravity):
            links.extend(_weights(scene, part, place))
            continue
        if not isinstance(part, Element | Contact | MatrixElement | Joint) and not couples_modes(part):
            continue
        found = shared.get(part.name)
        if found is None or found.part is not part:
            found = _link(scene, part, place)
            if not part.uses():  # expressions name motions whose forms belong to other parts
                shared[part.name] = found
        links.append(found)
    return Links(tuple(links), len(place))


def couples_modes(part: Part) -> bool:
    """Whether a part is a modal body whose damping ties its modes together."""
    return isinstance(part, ModalBody) and part.damping is not None


def _link(scene: Scene, part: Part, place: dict[str, int]) -> Link:
    # what is left of an element for its numbers is known to the equations, one floor up
    from fricmb.equations import element_facts

    own, read = _motions(scene, part)
    acts = tuple(sorted({place[dof] for name in own for dof in scene.dofs_behind(name) if dof in place}))
    read_dofs = {place[dof] for name in read for dof in scene.dofs_behind(name) if dof in place}
    reads = tuple(sorted(read_dofs - set(acts)))
    facts = element_facts(part) if isinstance(part, Element) else None
    idle = facts.empty if facts is not None else isinstance(part, Contact) and is_idle(part)
    starts = not idle and can_start(scene, part, facts, (own | read).difference(place), bool(reads))
    return Link(part=part, acts=acts, reads=reads, facts=facts, idle=idle, starts=starts)


def _weights(scene: Scene, gravity: Gravity, place: dict[str, int]) -> list[Link]:
    """Gravity acts on every body alone, and ties none to another."""
    links = []
    for body in scene.bodies:
        if isinstance(body, Body | RigidBody):
            held = [f"{body.name}.{c}" for c, value in gravity.acceleration.items() if value_of(value) != 0.0]
            acts = tuple(place[name] for name in held if name in place)
            if acts:
                links.append(Link(part=gravity, acts=acts, reads=()))
    return links


def is_idle(contact: Contact) -> bool:
    """Whether a contact has no normal force, ever, and no state that would go on changing without."""
    constant = contact.normal_kind == "constant"
    return constant and float(value_of(contact.normal_force)) <= 0.0 and not contact.law.states


def _motions(scene: Scene, part: Part) -> tuple[set[str], set[str]]:
    """Names of dofs and prescribed motions that a part acts on, and that its expressions read."""
    if isinstance(part, MatrixElement):
        return set(part.dofs), set()
    if isinstance(part, ModalBody):
        return set(part.dof_names), set()
    if isinstance(part, Contact):
        normal = part.normal_direction()
        directions = (*part.directions(), *(() if normal is None else (normal,)))
        forms = [direction.form for direction in directions]
    elif isinstance(part, Element | Joint):
        forms = list(part.local_coordinates())
        if isinstance(part, Force):
            forms = forms[:1]  # it acts on the first; the others are what its value looks at
    own = {name for form in forms for name in scene.expand(form).motions}
    read = {m for uses in part.uses().values() for name in uses.motions for m in scene.motion(name).motions}
    return own, read
