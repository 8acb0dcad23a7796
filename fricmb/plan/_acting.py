"""Finding who acts on whom: lines between bodies in bulk, all other parts one by one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.equations import element_facts, element_groups
from fricmb.plan._links import Flags, Ints, Link, Links
from fricmb.plan._rest import can_start
from fricmb.scene import (
    Body,
    Contact,
    Driven,
    Element,
    Force,
    Gravity,
    Joint,
    MatrixElement,
    ModalBody,
    Part,
    RigidBody,
    Scene,
    SpaceBody,
)
from fricmb.scene._lines import MOVING, Rows, lines_of, parts_at
from fricmb.values import value_of


def links_of(scene: Scene) -> Links:
    """The links of a scene: lines in bulk, others one by one."""
    place = {name: i for i, name in enumerate(scene.dof_names)}
    lines = lines_of(scene)
    at, links = _single(scene, lines.others, place)
    tables = [_table(at, links), _element_table(scene, lines.elements), _contact_table(scene, lines.contacts)]
    kinds: dict[Any, int] = {}
    numbers = [[-1 if f is None else kinds.setdefault(f, len(kinds)) for f in table.facts] for table in tables]
    kind = np.concatenate(
        [np.array(number, dtype=np.int64)[table.which] for number, table in zip(numbers, tables, strict=True)]
    )
    where = np.concatenate([table.at for table in tables])
    order = np.argsort(where, kind="stable")
    rank = np.empty(order.size, dtype=np.int64)
    rank[order] = np.arange(order.size)
    shift = np.cumsum([0, *(table.at.size for table in tables)])
    owner = rank[np.concatenate([table.owner + by for table, by in zip(tables, shift, strict=False)])]
    entries = np.argsort(owner, kind="stable")
    start = np.concatenate([[0], np.cumsum(np.bincount(owner, minlength=order.size))]).astype(np.int64)
    parts = scene.parts

    def together(name: str) -> Any:
        return np.concatenate([getattr(table, name) for table in tables])[order]

    return Links(
        n=len(place), parts=[parts[i] for i in where[order].tolist()], at=where[order], start=start,
        dofs=np.concatenate([table.dofs for table in tables])[entries], acts=together("acts"),
        idle=together("idle"), starts=together("starts"), rubs=together("rubs"), kinds=tuple(kinds), kind=kind[order],
        turning=_turning(scene, place),
    )  # fmt: skip


def _turning(scene: Scene, place: dict[str, int]) -> Ints:
    """Pairs (2, k): the first degree of freedom of each body that turns with every other of its own."""
    bodies = [body for body in scene.bodies if isinstance(body, RigidBody | SpaceBody)]
    pairs = [(place[body.dof_names[0]], place[name]) for body in bodies for name in body.dof_names[1:]]
    return np.array(pairs, dtype=np.int64).reshape(-1, 2).T


@dataclass(frozen=True, kw_only=True)
class _Table:
    """Some of the links; ``which`` of ``facts`` each has, ``owner`` the link of each of ``dofs``."""

    at: Ints
    owner: Ints
    dofs: Ints
    acts: Ints
    idle: Flags
    starts: Flags
    rubs: Flags
    facts: Sequence[Any]
    which: Ints


def _table(at: list[int], links: list[Link]) -> _Table:
    sizes = [len(link.acts) + len(link.reads) for link in links]
    return _Table(
        at=np.array(at, dtype=np.int64),
        owner=np.repeat(np.arange(len(links)), sizes),
        dofs=np.array([dof for link in links for dof in (*link.acts, *link.reads)], dtype=np.int64),
        acts=np.array([len(link.acts) for link in links], dtype=np.int64),
        idle=np.array([link.idle for link in links], dtype=np.bool_),
        starts=np.array([link.starts for link in links], dtype=np.bool_),
        rubs=np.array([isinstance(link.part, Contact) for link in links], dtype=np.bool_),
        facts=[link.facts for link in links],
        which=np.arange(len(links)),
    )


def _ends(rows: Rows) -> tuple[Ints, Ints, Ints]:
    """Parts of rows, and degrees of freedom that these act on, rising in each: parts, owner, dofs."""
    at, part = np.unique(rows.at, return_inverse=True)
    owner = np.concatenate([part, part])
    dofs = np.concatenate([rows.a, rows.b])
    owner, dofs = owner[dofs >= 0], dofs[dofs >= 0]
    order = np.lexsort((dofs, owner))
    return at, owner[order], dofs[order]


def _element_table(scene: Scene, rows: Rows) -> _Table:
    at, owner, dofs = _ends(rows)
    facts: list[Any] = []
    which = np.zeros(at.size, dtype=np.int64)
    for group in element_groups(scene):
        which[group.index] = len(facts) + group.which
        facts += group.facts()
    idle = np.array([f.empty for f in facts], dtype=np.bool_)[which]
    starts = np.array([f.constant or f.nonlinear for f in facts], dtype=np.bool_)[which]
    none = np.zeros(at.size, dtype=np.bool_)
    acts = np.bincount(owner, minlength=at.size)
    return _Table(
        at=at, owner=owner, dofs=dofs, acts=acts, idle=idle, starts=starts & ~idle, rubs=none, facts=facts, which=which
    )


def _contact_table(scene: Scene, rows: Rows) -> _Table:
    at, owner, dofs = _ends(rows)
    idle = np.array([is_idle(part) for part in parts_at(scene, at)], dtype=np.bool_)  # type: ignore[arg-type]
    part = np.searchsorted(at, rows.at)
    moved = np.bincount(part, weights=(rows.a <= MOVING) | (rows.b <= MOVING), minlength=at.size) > 0
    acts = np.bincount(owner, minlength=at.size)
    return _Table(
        at=at, owner=owner, dofs=dofs, acts=acts, idle=idle, starts=moved & ~idle,
        rubs=np.ones(at.size, dtype=np.bool_), facts=[None], which=np.zeros(at.size, dtype=np.int64),
    )  # fmt: skip


def _single(scene: Scene, others: list[int], place: dict[str, int]) -> tuple[list[int], list[Link]]:
    """Links of parts looked at one by one; those that another scene of its family has as well are taken from there."""
    names, shared = scene._shared.get("links", ((), {}))
    if names != scene.dof_names:  # links hold places of degrees of freedom
        shared = {}
        scene._shared["links"] = scene.dof_names, shared
    at: list[int] = []
    links: list[Link] = []
    for i in others:
        part = scene.parts[i]
        if isinstance(part, Body | Driven):
            continue
        if isinstance(part, Gravity):
            weights = _weights(scene, part, place)
            links.extend(weights)
            at.extend([i] * len(weights))
            continue
        if not isinstance(part, Element | Contact | MatrixElement | Joint | SpaceBody) and not couples_modes(part):
            continue
        found = shared.get(part.name)
        if found is None or found.part is not part:
            found = _link(scene, part, place)
            if not part.uses():  # expressions name motions whose forms belong to other parts
                shared[part.name] = found
        links.append(found)
        at.append(i)
    return at, links


def couples_modes(part: Part) -> bool:
    """Whether a part is a modal body whose damping ties its modes together."""
    return isinstance(part, ModalBody) and part.damping is not None


def _link(scene: Scene, part: Part, place: dict[str, int]) -> Link:
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
        if isinstance(body, Body | RigidBody | SpaceBody):
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
    if isinstance(part, ModalBody | SpaceBody):
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
    if isinstance(part, Joint) and part.loaded_by:  # what presses it is run with it
        pressing: Any = scene[part.loaded_by]
        return own, {name for form in pressing.local_coordinates() for name in scene.expand(form).motions}
    read = {m for uses in part.uses().values() for name in uses.motions for m in scene.motion(name).motions}
    return own, read
