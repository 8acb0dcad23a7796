"""Making a plan."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

from fricmb.errors import unknown_name
from fricmb.integrate._storage import is_narrow
from fricmb.plan._graph import coupling, narrow_order
from fricmb.plan._links import Link, Links, links_of
from fricmb.plan._plan import Island, Plan
from fricmb.plan._redundant import redundant
from fricmb.plan._report import counts, empty, outside, resting, unloaded, vanishing
from fricmb.plan._rest import is_held
from fricmb.plan._tree import topology
from fricmb.plan._truncate import truncated
from fricmb.scene import Body, Contact, Driven, Element, Joint, MatrixElement, ModalBody, Part, RigidBody, Scene


@dataclass
class Wanted:
    """What is asked for: degrees of freedom by their places, and parts by name."""

    dofs: set[int] = field(default_factory=set)
    parts: set[str] = field(default_factory=set)

    @property
    def key(self) -> tuple[frozenset[int], frozenset[str]]:
        """To know it again."""
        return frozenset(self.dofs), frozenset(self.parts)


def make_plan(scene: Scene, observe: Iterable[str] | None = None) -> Plan:
    """Plan a scene.

    Parameters
    ----------
    scene : Scene
    observe : iterable of str, optional
        Names of dofs, points, motions, contacts and other parts that are asked for.  What cannot influence them is left
        out.  Default: everything.

    Returns
    -------
    Plan

    Raises
    ------
    UnknownNameError
        If a name in ``observe`` does not exist.
    """
    short = truncated(scene)
    scene = short.scene
    wanted = None if observe is None else _targets(scene, tuple(observe))
    key = ("plan", None if wanted is None else wanted.key)
    found = scene._cache.get(key)
    if found is None:
        plan = _make(scene, wanted)
        cautions = (*short.notes, *plan.cautions)
        found = scene._cache[key] = replace(plan, notes=(*cautions, *plan.notes), cautions=cautions)
    return found


def _make(scene: Scene, wanted: Wanted | None) -> Plan:
    links = links_of(scene)
    kept = list(range(links.n)) if wanted is None else links.reaching(_sources(links, wanted))
    inside, parts = _inside(scene, links, set(kept), wanted)
    dofs = tuple(scene.dof_names[i] for i in kept)
    islands = _islands(scene, links, kept)
    still = resting(scene, islands)
    idle = tuple(link.part.name for link in inside if link.idle and isinstance(link.part, Contact))
    order, bandwidth = narrow_order(coupling(inside, scene.dof_names), kept)
    joined = topology(scene, (part.name for part in parts))
    return Plan(
        scene=scene.name,
        dofs=dofs,
        parts=tuple(part.name for part in parts),
        islands=islands,
        idle=idle,
        counts=counts(parts, inside, len(dofs), len(islands), len(still)),
        left_out=(*outside(scene, links, set(kept), inside), *empty(inside)),
        resting=tuple(still),
        notes=(*unloaded(idle), *vanishing(inside)),
        cautions=tuple(redundant(scene, islands)),
        order=tuple(dofs[i] for i in order),
        bandwidth=bandwidth,
        storage=_storage(len(dofs), bandwidth),
        tree=joined.tree,
        loops=joined.loops,
    )


def _targets(scene: Scene, names: tuple[str, ...]) -> Wanted:
    """What the observed names stand for."""
    place = {name: i for i, name in enumerate(scene.dof_names)}
    wanted = Wanted()
    for name in names:
        if name in scene and isinstance(scene[name], Element | Contact | MatrixElement | Joint):
            wanted.parts.add(name)
        elif scene.has_motion(name):
            behind = (dof for motion in scene.motion(name).motions for dof in scene.dofs_behind(motion))
            wanted.dofs |= {place[dof] for dof in behind if dof in place}
        elif name in scene.points:
            point = scene.points[name]
            forms = [scene.motion(f"{name}.{letter}") for letter in point.letters]
            wanted.dofs |= {place[dof] for form in forms for dof in form.motions}
        elif name in scene.rigid_points:
            wanted.dofs |= {place[dof] for dof in scene.rigid_points[name].body.dof_names}
        elif name in scene:
            wanted.dofs |= {place[dof] for dof in getattr(scene[name], "dof_names", ())}
        else:
            raise unknown_name("name to observe", name, [*scene.motion_names, *(p.name for p in scene.parts)])
    return wanted


def _sources(links: Links, wanted: Wanted) -> set[int]:
    """Degrees of freedom that are asked for, those of parts included."""
    return wanted.dofs | {
        dof for link in links.links if link.part.name in wanted.parts for dof in (*link.acts, *link.reads)
    }


def _inside(scene: Scene, links: Links, kept: set[int], wanted: Wanted | None) -> tuple[list[Link], list[Part]]:
    """Links that are built, and all parts with bodies and driven bodies."""
    named = set() if wanted is None else wanted.parts
    inside = []
    for link in links.links:
        touched = (*link.acts, *link.reads) if link.idle else link.acts
        if link.part.name in named or (touched and (kept.issuperset(touched) if link.idle else touched[0] in kept)):
            inside.append(link)
    acting = {link.part.name for link in inside}
    held = {scene.dof_names[i] for i in kept}
    parts = [
        part
        for part in scene.parts
        if isinstance(part, Driven)
        or part.name in acting
        or (isinstance(part, Body | ModalBody | RigidBody) and not held.isdisjoint(part.dof_names))
    ]
    return inside, parts


def _islands(scene: Scene, links: Links, kept: Sequence[int]) -> tuple[Island, ...]:
    owner = {name: body.name for body in scene.bodies for name in body.dof_names}
    place = {part.name: i for i, part in enumerate(scene.parts)}
    found = []
    for group in links.groups(kept):
        held = {id(link): link for dof in group for link in links.acting[dof]}
        inside = sorted(held.values(), key=lambda link: place[link.part.name])
        dofs = tuple(scene.dof_names[i] for i in group)
        bodies = tuple(dict.fromkeys(owner[name] for name in dofs))
        found.append(
            Island(
                dofs=dofs,
                parts=tuple(link.part.name for link in inside),
                bodies=bodies,
                inert=not any(link.starts for link in inside),
                held=is_held(scene, bodies, [link.part for link in inside]),
            )
        )
    return tuple(found)


def _storage(n: int, bandwidth: int) -> str:
    if bandwidth == 0:
        return "diagonal"
    return "banded" if is_narrow(n, bandwidth) else "dense"
