"""From a scene with bodies that turn or joints to arrays: points become extended coordinates, joints constraints."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import numpy as np

from fricmb.equations import place_template
from fricmb.errors import SceneError
from fricmb.integrate.implicit.equations.consistent_start import assembled
from fricmb.integrate.mechanism import Entries, Mechanism, Places
from fricmb.integrate.problem import Floats, Linear, Problem, Signals, Start
from fricmb.plan import common
from fricmb.scene import (
    Body,
    Contact,
    Element,
    Gravity,
    Joint,
    MatrixElement,
    ModalBody,
    RigidBody,
    SpaceBody,
    impact_law,
    topology,
)
from fricmb.system import _motions
from fricmb.system._bends import bends_of
from fricmb.system._breakpoints import switches_of
from fricmb.system._contacts import ContactArrays
from fricmb.system._gravity import add_gravity
from fricmb.system._inputs import inputs_of
from fricmb.system._joints import JointArrays, Kept
from fricmb.system._leaps import leaps_of
from fricmb.system._mechanism_system import MechanismSystem
from fricmb.system._series import series_of
from fricmb.system._shares import add_share, is_equal_but_start, shares_of
from fricmb.system._structure import Structure
from fricmb.values import value_of

#: Bodies may be carried by this share of the geometry at the start.
_FAR = 0.5


def _found_once(scene: Any, key: Any, find: Callable[[], list[Any]]) -> list[Any]:
    """Names that do not depend on numbers, found once for scenes that differ in these alone."""
    known = common(scene)
    if key not in known:
        known[key] = find()
    found: list[Any] = known[key]
    return found


def build_mechanism(scene: Any, plan: Any) -> MechanismSystem:
    """The arrays of a scene with bodies that turn or joints."""
    dofs = scene.dof_names if plan is None else plan.dofs
    kept = None if plan is None else frozenset(plan.parts)
    parts = [part for part in scene.parts if kept is None or part.name in kept]
    n = len(dofs)
    points = _found_once(scene, ("used points", kept), lambda: _used_points(scene, parts))
    extended = (*dofs, *(f"{point}.{c}" for point in points for c in "xy"))
    index = {name: i for i, name in enumerate(extended)}
    signals = _motions.Signals()
    motions = _motions.Motions(scene, index, signals)
    structure = Structure(motions=motions)
    contacts = ContactArrays(motions=motions)
    joints = JointArrays(motions=motions, contacts=contacts)
    kept_shares = Kept(*(shares_of(scene, (which, extended)) for which in Kept._fields))
    for part in parts:
        if isinstance(part, Body) and not float(value_of(part.mass)) > 0.0:
            raise SceneError(f"{part.dof_names[0]}: the mass must be > 0, got 0")
        _add(part, structure, contacts, joints, kept_shares)
    for gravity in (part for part in parts if isinstance(part, Gravity)):
        add_gravity(gravity, parts, structure)
    n_y, n_u = len(extended), len(signals.held)
    elements, impacts = structure.elements(n_u), impact_law(scene.parts)
    mechanism = Mechanism(
        n=n,
        n_places=n_y - n,
        M=Entries.of(structure.triples("M")),
        K=Entries.of(structure.triples("K")),
        C=Entries.of(structure.triples("C")),
        B=Entries.of(structure.B),
        f=_vector(structure.f, n_y + n_u),
        places=_places(scene, points, index),
        joints=joints.build(n_y, n_u),
        slip=contacts.slip_table(n_y, n_u),
        least_mass=_least_mass(parts, index, n),
        poisson=impacts.law == "poisson",
        in_turn=impacts.several == "in_turn",
        jumps=impacts.painleve == "impact",
    )
    timed = [(s.template, s.parameters[:-1]) for s in signals.held] + contacts.timed + structure.timed
    known, searched = switches_of(timed)
    table = signals.table.build(n_y, n_u)
    problem = Problem(
        linear=_no_structure(n, n_u),
        signals=Signals(table=table, breakpoints=known, inputs=inputs_of(timed)),
        contacts=contacts.build(n_y, n_u, dense=False),
        elements=elements,
        bends=bends_of((*structure.bends, *contacts.bends), n_y, n_u),
        dof_names=tuple(dofs),
        contact_names=tuple(contacts.names),
        mechanism=mechanism,
    )
    q, v = scene.initial_values(dofs)
    _check_places(problem, scene, Start(t=0.0, q=q, v=v, z=np.zeros(problem.n_z)))
    problem = without_redundant(problem, scene, Start(t=0.0, q=q, v=v, z=np.zeros(problem.n_z)))
    return MechanismSystem(
        problem=problem,
        start=Start(t=0.0, q=q, v=v, z=np.zeros(problem.n_z)),
        contact_axes=tuple(contacts.labels),
        axis_scale=tuple(contacts.scale),
        state_names=tuple(contacts.states),
        stores=tuple(structure.stores),
        switches=searched,
        series=series_of(timed, scene),
        leaps=leaps_of(scene, signals.index),
    )


def _check_places(problem: Problem, scene: Any, start: Start) -> None:
    """Bodies stand where their joints are, but for a part of the geometry by which a rough start may be off.

    Raises
    ------
    SceneError
        Where a body would have to be carried farther than half of the largest distance of a point from its body.
    """
    points = [*scene.rigid_points.values(), *scene.space_points.values()]
    size = max((float(np.linalg.norm(point.offset)) for point in points), default=0.0)
    rows = [i for i, name in enumerate(problem.dof_names) if name.rpartition(".")[2] in ("x", "y", "z")]
    mechanism = problem.mechanism
    if not rows or size == 0.0 or mechanism is None or not mechanism.n_rows:
        return
    moved = np.abs(assembled(problem, start).q - start.q)[rows]
    if moved.max() > _FAR * size:
        name = problem.dof_names[rows[int(np.argmax(moved))]]
        raise SceneError(
            f"the mechanism is not assembled: {name} would have to move by {moved.max():.3g} to satisfy the joints, "
            f"which is beyond half of its size, {size:.3g}; expected position= of bodies near their places"
        )


def without_redundant(problem: Problem, scene: Any, start: Start) -> Problem:
    """The problem with constraints marked that follow from others; friction needs reactions that are determined."""
    from fricmb.integrate.implicit.equations.redundancy import redundancy

    mechanism = problem.mechanism
    names = () if mechanism is None else mechanism.joints.names
    groups = _found_once(scene, ("groups", names), lambda: _with_bodies(scene, topology(scene, names).groups))
    found = redundancy(problem, start, groups)
    if not found.rows.size or mechanism is None:
        return problem
    held = [name for name in found.joints if isinstance(scene[name], Joint)]
    pressing = {joint.loaded_by for joint in scene.joints}
    for name in held:
        if scene[name].friction is not None or name in pressing:
            others = ", ".join(repr(other) for other in held if other != name)
            raise SceneError(
                f"{type(scene[name]).__name__} {name!r}: its reaction, the normal force of its friction, is not"
                f" determined, because constraints of {others} and {name!r} are redundant"
            )
    dropped = mechanism.joints.dropped.copy()
    dropped[found.rows] = 1
    return replace(problem, mechanism=replace(mechanism, joints=replace(mechanism.joints, dropped=dropped)))


def _least_mass(parts: Iterable[Any], index: dict[str, int], n: int) -> Floats:
    """What coordinates count in changes at least (n,); nothing where every coordinate has its mass."""
    least = np.zeros(n)
    for body in parts:
        if isinstance(body, SpaceBody):
            for name, value in zip(body.dof_names, body.least_masses(), strict=True):
                least[index[name]] = value
    return least if least.any() else least[:0]


def _with_bodies(scene: Any, groups: Iterable[tuple[str, ...]]) -> list[tuple[str, ...]]:
    """Joints of loops with the inner constraints of the bodies that they tie, which bear the bodies' names."""
    found: list[tuple[str, ...]] = []
    for group in groups:
        owners = [end.owner for name in group for end in (scene[name].a, scene[name].b)]
        bodies = {owner.name for owner in owners if isinstance(owner, SpaceBody) and owner.inner() is not None}
        # loops that share a body are looked at together: its inner constraint is in both
        sharing = [other for other in found if not bodies.isdisjoint(other)]
        found = [other for other in found if other not in sharing]
        found.append(tuple(dict.fromkeys((*group, *(name for other in sharing for name in other), *sorted(bodies)))))
    return found


def _add(part: Any, structure: Structure, contacts: ContactArrays, joints: JointArrays, kept: Kept) -> None:
    if isinstance(part, Body | ModalBody | RigidBody | SpaceBody):
        add_share(kept.structure, part, structure, structure.add_body, is_equal_but_start)
    elif isinstance(part, MatrixElement):
        structure.add_matrix(part)
    elif isinstance(part, Element):
        add_share(kept.structure, part, structure, structure.add_element)
    elif isinstance(part, Contact):
        add_share(kept.contacts, part, contacts, contacts.add)
    elif isinstance(part, Joint):
        joints.add(part, kept)
    for within in part.parts_within():
        if isinstance(within, Joint):
            joints.add(within, kept, inner=True)
        else:
            structure.add_element(within)


def _used_points(scene: Any, parts: Iterable[Any]) -> list[str]:
    """Points of rigid bodies on which something depends."""
    known = scene.rigid_points
    used: set[str] = set()
    for part in parts:
        forms = []
        if isinstance(part, Element | Joint):
            forms = list(part.local_coordinates())
        elif isinstance(part, Contact):
            forms = [direction.form for direction in part.directions()]
            normal = part.normal_direction()
            forms += [] if normal is None else [normal.form]
        names = [name for form in forms for name in form.motions]
        names += [name for uses in part.uses().values() for name in uses.motions]
        used |= {name.rpartition(".")[0] for name in names}
    return [name for name in known if name in used]


def _places(scene: Any, points: list[str], index: dict[str, int]) -> Places:
    known = scene.rigid_points
    templates = [place_template(known[name].body) for name in points]
    offsets = [known[name].offset for name in points]
    dofs = [[index[d] for d in known[name].body.dof_names] for name in points]

    def starts(lengths: list[int]) -> Any:
        return np.concatenate(([0], np.cumsum(lengths))).astype(np.int64)

    return Places(
        address=np.array([t.address for t in templates], dtype=np.int64),
        p_start=starts([2] * len(points)),
        p=np.array([x for offset in offsets for x in offset], dtype=float),
        dof_start=starts([len(d) for d in dofs]),
        dof=np.array([i for d in dofs for i in d], dtype=np.int64),
        first=starts([int(t.facts["count"]) for t in templates]),
    )


def _vector(entries: list[tuple[int, float]], length: int) -> Floats:
    values = np.zeros(length)
    for i, value in entries:
        values[i] += value
    return values


def _no_structure(n: int, n_u: int) -> Linear:
    """What the problem keeps of a linear structure where a mechanism holds it: nothing."""
    return Linear(M=np.zeros((0, 0)), Kx=np.zeros((0, 0)), Cx=np.zeros((0, 0)), fx=np.zeros(0), B=np.zeros((n, n_u)))
