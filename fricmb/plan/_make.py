"""Making a plan."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from fricmb.errors import unknown_name
from fricmb.integrate.model.band_ordering import is_narrow
from fricmb.plan._acting import links_of
from fricmb.plan._graph import coupling, narrow_order
from fricmb.plan._links import Flags, Links
from fricmb.plan._plan import Island, Plan
from fricmb.plan._redundant import redundant
from fricmb.plan._report import counts, empty, outside, remarks, resting, unloaded, vanishing
from fricmb.plan._rest import is_held
from fricmb.plan._same import common
from fricmb.plan._truncate import truncated
from fricmb.scene import Contact, Driven, Element, Joint, MatrixElement, Part, Scene, topology
from fricmb.scene._scene import BODIES
from fricmb.solution import owner_of
from fricmb.values._pause import no_collection


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
    return scene._once(key, lambda: _plan_of(scene, wanted, (*short.notes, *remarks(scene))))


#: Plans that scenes which differ in numbers alone keep together.
MANY = 16


def _plan_of(scene: Scene, wanted: Wanted | None, shortened: tuple[str, ...]) -> Plan:
    """The plan, taken from another scene where that has the same; ``shortened``: what is said of modes and laws."""
    plans: dict[Any, Plan] = common(scene).setdefault("plans", {})
    key = None if wanted is None else wanted.key, shortened
    found = plans.get(key)
    if found is None:
        with no_collection(len(scene.parts)):
            plan = _make(scene, wanted)
        cautions = (*shortened, *plan.cautions)
        found = replace(plan, notes=(*cautions, *plan.notes), cautions=cautions)
        for old in list(plans)[: len(plans) + 1 - MANY]:
            plans.pop(old, None)
        plans[key] = found
    return found


def _make(scene: Scene, wanted: Wanted | None) -> Plan:
    links = links_of(scene)
    kept = list(range(links.n)) if wanted is None else links.reaching(_sources(links, wanted))
    held = np.zeros(links.n, dtype=np.bool_)
    held[kept] = True
    inside = _inside(links, held, wanted)
    parts = _parts(scene, links, held, inside)
    dofs = scene.dof_names if len(kept) == links.n else tuple([scene.dof_names[i] for i in kept])
    islands = _islands(scene, links, kept, dofs)
    still = resting(scene, islands)
    idle = tuple([links.parts[i].name for i in np.flatnonzero(inside & links.idle & links.rubs).tolist()])
    order, bandwidth = narrow_order(coupling(links, inside, scene.dof_names), kept)
    joined = topology(scene, (part.name for part in parts))
    return Plan(
        scene=scene.name,
        dofs=dofs,
        parts=tuple([part.name for part in parts]),
        islands=islands,
        idle=idle,
        counts=counts(parts, links, inside, len(dofs), len(islands), len(still)),
        left_out=(*outside(scene, links, held, inside), *empty(links, inside)),
        resting=tuple(still),
        notes=(*unloaded(idle), *vanishing(links, inside)),
        cautions=tuple(redundant(scene, islands)),
        order=tuple([dofs[i] for i in order]),
        bandwidth=bandwidth,
        storage=_storage(len(dofs), bandwidth),
        tree=joined.tree,
        loops=joined.loops,
    )


def _targets(scene: Scene, names: tuple[str, ...]) -> Wanted:
    """What the observed names stand for."""
    place = {name: i for i, name in enumerate(scene.dof_names)}
    wanted = Wanted()
    for given in names:
        name = _owner(scene, given)
        if name in scene and isinstance(scene[name], Element | Contact | MatrixElement | Joint):
            wanted.parts.add(name)
        elif scene.has_motion(name):
            behind = (dof for motion in scene.motion(name).motions for dof in scene.dofs_behind(motion))
            wanted.dofs |= {place[dof] for dof in behind if dof in place}
        elif name in scene.points:
            point = scene.points[name]
            forms = [scene.motion(f"{name}.{letter}") for letter in point.letters]
            wanted.dofs |= {place[dof] for form in forms for dof in form.motions}
        elif name in scene.space_points:
            wanted.dofs |= {place[dof] for dof in scene.space_points[name].body.dof_names}
        elif name in scene.rigid_points:
            wanted.dofs |= {place[dof] for dof in scene.rigid_points[name].body.dof_names}
        elif name in scene:
            wanted.dofs |= {place[dof] for dof in getattr(scene[name], "dof_names", ())}
        else:
            raise unknown_name("name to observe", given, [*scene.motion_names, *(p.name for p in scene.parts)])
    return wanted


def _owner(scene: Scene, name: str) -> str:
    """What has to be run for a signal: "mass.x" for "mass.x.velocity", "sole" for "sole.force.x"."""
    return name if name in scene or scene.has_motion(name) else owner_of(name) or name


def _sources(links: Links, wanted: Wanted) -> set[int]:
    """Degrees of freedom that are asked for, those of parts included."""
    return wanted.dofs | links.touched(links.named(wanted.parts))


def _inside(links: Links, kept: Flags, wanted: Wanted | None) -> Flags:
    """Which links are built: those that act on what is kept; what is idle, where all that it touches is."""
    inside = links.named(() if wanted is None else wanted.parts)
    touching = np.bincount(links.owner, minlength=inside.size)
    here = np.bincount(links.owner, weights=kept[links.dofs], minlength=inside.size)
    inside |= links.idle & (touching > 0) & (here == touching)
    return inside | ((links.first >= 0) & kept[links.first])


def _parts(scene: Scene, links: Links, kept: Flags, inside: Flags) -> list[Part]:
    """Parts that are built, with bodies and all driven bodies."""
    acting = np.zeros(len(scene.parts), dtype=np.bool_)
    acting[links.at[inside]] = True
    found = []
    place = 0
    for part, acts in zip(scene.parts, acting.tolist(), strict=True):
        if isinstance(part, BODIES):
            count = len(part.dof_names)
            acts = acts or bool(kept[place : place + count].any())
            place += count
        if acts or isinstance(part, Driven):
            found.append(part)
    return found


def _islands(scene: Scene, links: Links, kept: Sequence[int], dofs: tuple[str, ...]) -> tuple[Island, ...]:
    owner = [body.name for body in scene.bodies for _ in body.dof_names]
    label = links.labels
    groups = links.groups(kept)
    island = np.full(links.n, -1, dtype=np.int64)  # of each label
    for number, group in enumerate(groups):
        island[label[group[0]]] = number
    mine = np.full(links.first.size, -1, dtype=np.int64)
    mine[links.first >= 0] = island[label[links.first[links.first >= 0]]]
    acting = np.argsort(mine, kind="stable")[np.count_nonzero(mine < 0) :]
    ends = np.searchsorted(mine[acting], np.arange(len(groups) + 1)).tolist()
    starts = np.bincount(mine[acting], weights=links.starts[acting], minlength=len(groups)).tolist()
    others = np.bincount(mine[acting], weights=~links.rubs[acting], minlength=len(groups)).tolist()
    names_of = [links.parts[i].name for i in acting.tolist()]
    found = []
    for number, group in enumerate(groups):
        places = group.tolist()
        names = dofs if len(groups) == 1 else tuple([scene.dof_names[i] for i in places])
        bodies = tuple(dict.fromkeys([owner[i] for i in places]))
        found.append(
            Island(
                dofs=names,
                parts=tuple(dict.fromkeys(names_of[ends[number] : ends[number + 1]])),
                bodies=bodies,
                inert=not starts[number] and not scene.is_mechanism,
                held=bool(others[number]) or is_held(scene, bodies),
            )
        )
    return tuple(found)


def _storage(n: int, bandwidth: int) -> str:
    if bandwidth == 0:
        return "diagonal"
    return "banded" if is_narrow(n, bandwidth) else "dense"
