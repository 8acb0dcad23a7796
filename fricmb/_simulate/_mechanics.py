"""A scene as what an integrator runs and a solution asks for."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from fricmb._simulate._arguments import check_scene
from fricmb._simulate._driven import DrivenMotions, shifted
from fricmb._simulate._joined import JoinedRun
from fricmb._simulate._massless import with_masses
from fricmb._simulate._members import (
    Idle,
    Member,
    Rest,
    contact_names,
    has_same_names,
    idle_of,
    is_shifted,
    members_of,
    row_offset,
    row_scale,
)
from fricmb.errors import SceneError, shown, unknown_name
from fricmb.integrate import MotionSamples, Start, Trajectory
from fricmb.integrate.problem import LAW_CONSTANT, Codes, Floats, Ints
from fricmb.integrate.run.touches import is_continuous, own_run
from fricmb.plan import Plan, Selection, make_plan, truncated
from fricmb.scene import Element, Joint, MatrixElement, Scene, SpaceBody
from fricmb.scene._family import NUMBERS, of_same_parts
from fricmb.solution import Flags, Motion, Names, Origin, Vector, builder
from fricmb.system import System, build
from fricmb.values import has_entries, is_expression


@dataclass(frozen=True, kw_only=True)
class SceneMechanics:
    """A scene, what is run of it, and by how much the positions of driven bodies are shifted.

    Attributes
    ----------
    scene, placed : Scene
        As given, and with driven bodies where they are and as many modes as are run.
    plan : Plan
    observe : tuple of str or None
    shift : mapping of str to float
        What is added to a driven position over the scene's own, by name: with it the position is the declared one at
        the start of a run that does not start at t = 0, or goes on from that of another run.
    together : bool
        Whether all islands are run as one.
    """

    scene: Scene
    placed: Scene
    plan: Plan
    observe: tuple[str, ...] | None
    shift: Mapping[str, float]
    together: bool = False

    @cached_property
    def members(self) -> tuple[Member, ...]:
        """What is run on its own."""
        return members_of(self.placed, self.plan, self.names, self.together)

    @cached_property
    def rest(self) -> Rest:
        """What members rest by."""
        return Rest.of(self.members)

    @property
    def whole(self) -> Member | None:
        """The one member that is the whole; None where islands are run."""
        (first, *others) = self.members
        return None if others or first.island is not None else first

    @cached_property
    def system(self) -> System:
        """The arrays of all that is planned, islands together; built when it is asked for."""
        return build(self.placed, Selection(dofs=self.plan.dofs, parts=self.plan.parts))

    @cached_property
    def idle(self) -> Idle | None:
        """Contacts that act on nothing, where islands are run."""
        return None if self.whole is not None else idle_of(self.placed, self.plan, self.names)

    @cached_property
    def start(self) -> Start:
        """The declared start, at t = 0."""
        q, v = self.placed.initial_values(self.plan.dofs)
        return Start(t=0.0, q=q, v=v, z=np.zeros(int(self.names.z_start[-1])))

    def attach(self, trajectory: Trajectory) -> None:
        """Give an unpickled trajectory its problem again."""
        trajectory = own_run(trajectory)
        if isinstance(trajectory, JoinedRun):
            trajectory.attach_members(self.members, self.idle)
        else:
            trajectory.attach(self.members[0].system.problem)

    def laws(self, run: Iterable[int] | None = None) -> Codes:
        """Kind of every contact's law (n_c,) in the members that are run; LAW_CONSTANT for others."""
        kinds = np.full(len(self.names.contacts), LAW_CONSTANT, dtype=np.int8)
        for i in range(len(self.members)) if run is None else run:
            member = self.members[i]
            kinds[member.place.contacts] = member.system.problem.contacts.law
        return kinds

    def continuous(self, run: Iterable[int] | None = None) -> Flags:
        """Contacts (n_c,) whose friction does not fall where stick ends, in the members that are run."""
        found = np.zeros(len(self.names.contacts), dtype=np.bool_)
        for i in range(len(self.members)) if run is None else run:
            member = self.members[i]
            found[member.place.contacts] = is_continuous(member.system.problem.contacts)
        return found

    def has_law(self, kind: int, run: Iterable[int] | None = None) -> bool:
        """Whether a contact in the members that are run has a law of that kind."""
        numbers = range(len(self.members)) if run is None else run
        return any(bool((self.members[i].system.problem.contacts.law == kind).any()) for i in numbers)

    def smooth(self) -> Flags:
        """Whether each contact has a force law that never sticks (n_c,)."""
        kinds = {c.name: "" if c.law is None else c.law.kind for c in self.placed.frictional}
        return np.array([kinds[name] == "smooth" for name in self.names.contacts], dtype=np.bool_)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints of a mechanism, as events count them; those of two ends of one part are the same."""
        mechanism = None if self.whole is None else self.whole.system.problem.mechanism
        return () if mechanism is None else tuple(name.partition(".")[0] for name in mechanism.joints.names)

    def fastest(self) -> float:
        """Largest angular frequency of what was run; what rested was never built."""
        built = [member.system.problem.omega for member in self.members if "system" in vars(member)]
        return max((float(omega.max(initial=0.0)) for omega in built), default=0.0)

    def kinetic(self, samples: MotionSamples, moving: Ints | None = None) -> Floats:
        """Kinetic energy (n_t,)."""
        return self._sum(samples, moving, lambda system, part: system.kinetic(part))

    def potential(self, samples: MotionSamples, moving: Ints | None = None) -> Floats:
        """Stored energy (n_t,)."""
        return self._sum(samples, moving, lambda system, part: system.potential(part))

    def delivered(self, samples: MotionSamples) -> Floats | None:
        """Work (n_t,) of loads that are constant or linear in coordinates, but for a constant; None without such."""
        if self.whole is not None:
            return self.whole.system.delivered(samples) if self.whole.system.has_loads else None
        if not any(isinstance(part, Element) and part.is_load for part in self.placed.parts):
            return None
        total = np.zeros(samples.t.size)
        for member in self.members:
            if member.system.has_loads:
                total += member.system.delivered(member.place.part(samples))
        return total

    def rubbed(self, samples: MotionSamples) -> Floats | None:
        """Loss (n_c, n_t) of contacts by the centres of their cones, but for a constant; None where these are at 0."""
        if not self.names.offset:
            return None
        total = np.zeros((len(self.names.contacts), samples.t.size))
        for member in self.members:
            place = member.place
            total[place.contacts] += member.system.rubbed(place.part(samples))
        return total

    def leaps(self, t_start: float, t_end: float) -> Floats | None:
        """Times between two others at which driven positions jump, rising; None where none can."""
        if not any(is_expression(value) for body in self.placed.driven for value in body.position.values()):
            return None
        return np.unique(np.concatenate([m.system.leaps_between(t_start, t_end) for m in self.members]))

    def _sum(
        self, samples: MotionSamples, moving: Ints | None, energy: Callable[[System, MotionSamples], Floats]
    ) -> Floats:
        if self.whole is not None:
            return energy(self.whole.system, samples)
        total = np.zeros(samples.t.size)
        known = None if moving is None else set(moving.tolist())
        for member in self.members:
            # what rests holds no energy; its arrays need not be built
            if (known is None or member.first in known) and not member.keeps_still(samples):
                total += energy(member.system, member.place.part(samples))
        return total

    def freedom(self, samples: MotionSamples) -> int | None:
        """Degrees of freedom of a mechanism, constraints taken off; None for a scene without joints."""
        if not self.placed.is_mechanism or not samples.t.size:
            return None
        return sum(system.freedom(part) for system, part in self._parts(samples))

    def reaction(self, joint: str, samples: MotionSamples) -> Floats:
        """Reactions of a joint (rows, n_t); UnknownNameError for a name that is none."""
        if self.whole is not None:
            return self.whole.system.reaction(joint, samples)
        for member in self.members:
            if joint in member.selection.parts and isinstance(self.placed[joint], Joint):
                return member.system.reaction(joint, member.place.part(samples))
        raise unknown_name("joint", joint, [part.name for part in self.placed.parts if isinstance(part, Joint)])

    def reactions(self, samples: MotionSamples) -> dict[str, Floats]:
        """Reactions of all joints by name."""
        if not self.placed.is_mechanism:
            return {}
        return {name: found for system, part in self._parts(samples) for name, found in system.reactions(part).items()}

    def _parts(self, samples: MotionSamples) -> Iterator[tuple[System, MotionSamples]]:
        """Every member's arrays and its share of samples."""
        for member in self.members:
            yield member.system, samples if self.whole is not None else member.place.part(samples)

    def signals(self, t: Floats) -> tuple[Floats, Floats]:
        """Positions and velocities of the driven bodies (n_driven, n_t), in the order of ``names.signals``."""
        return self.driven.evaluate(t)

    @cached_property
    def driven(self) -> DrivenMotions:
        """Prescribed motions."""
        return DrivenMotions(self.placed)

    @cached_property
    def origin(self) -> Origin:
        """How to make this again in another process."""
        options = {"observe": self.observe, "shift": dict(self.shift), "together": self.together}
        return Origin(scene=self.scene, build=mechanics_of, options=options)

    @cached_property
    def names(self) -> Names:
        """Names of what the arrays hold; stiffness, damping and loads are in none of them."""
        parts = [part for part in self.placed.parts if not isinstance(part, Element | MatrixElement)]
        key = "names", self.plan.dofs, self.plan.parts
        return of_same_parts(self.placed, key, parts, self._names, but=NUMBERS, alike=has_same_names)

    def _names(self) -> Names:
        held = set(self.plan.parts)
        contacts = [contact for contact in self.placed.frictional if contact.name in held]
        labels = [contact_names(contact) for contact in contacts]
        return Names(
            dofs=self.plan.dofs,
            contacts=tuple(contact.name for contact in contacts),
            directions=tuple(directions for directions, _ in labels),
            states=tuple(states for _, states in labels),
            scale=tuple(row_scale(contact) for contact in contacts),
            offset=tuple(row_offset(contact) for contact in contacts) if any(map(is_shifted, contacts)) else (),
            motions=_points(self.placed, self.plan.dofs),
            vectors=_vectors(self.placed, {name: i for i, name in enumerate(self.plan.dofs)}),
            signals={name: i for i, name in enumerate(self.driven.names)},
        )

    def as_one(self) -> SceneMechanics:
        """The same with all islands run as one."""
        return mechanics_of(self.scene, observe=self.observe, shift=self.shift, together=True)


def prepare(scene: Any, parameters: Any, observe: Any) -> SceneMechanics:
    """Check scene, values and names to observe, and build."""
    check_scene(scene)
    if parameters is not None and not isinstance(parameters, Mapping):
        raise SceneError(
            f"parameters: got {shown(parameters)}; expected a dict of names in scene.parameters and values"
        )
    if parameters:
        scene = scene.with_parameters(parameters)
    scene = with_masses(scene)
    if observe is not None and (isinstance(observe, str) or not has_entries(observe)):
        raise SceneError(f"observe: got {shown(observe)}; expected a list of names of dofs, points and contacts")
    names = None if observe is None else tuple(observe)
    if names is not None and not all(isinstance(name, str) for name in names):
        raise SceneError(f"observe: got {shown(observe)}; expected a list of names of dofs, points and contacts")
    if names == ():
        raise SceneError("observe: got no name; expected one or more of dofs, points and contacts, or None for all")
    return mechanics_of(scene, observe=names)


@builder("scene", Scene)
def mechanics_of(
    scene: Scene,
    *,
    observe: tuple[str, ...] | None = None,
    shift: Mapping[str, float] | None = None,
    together: bool = False,
) -> SceneMechanics:
    """Plan a scene, or take what is kept on it."""
    by = dict(shift or {})
    together = together or has_impacts(scene)
    key = ("mechanics", observe, tuple(sorted(by.items())), together)
    found = scene._cache.get(key)
    if not isinstance(found, SceneMechanics):
        placed = truncated(shifted(scene, by)).scene
        found = scene._cache[key] = SceneMechanics(
            scene=scene, placed=placed, plan=make_plan(placed, observe), observe=observe, shift=by, together=together,
        )  # fmt: skip
    return found


def has_impacts(scene: Scene) -> bool:
    """Whether something in it is rigid: then all of it is run as one."""
    return scene.is_mechanism and any(joint.is_rigid for joint in scene.joints)


def _points(scene: Scene, dofs: tuple[str, ...]) -> dict[str, Motion]:
    index = {name: i for i, name in enumerate(dofs)}
    found = {}
    for point in scene.points.values():
        for letter in point.letters:
            name = f"{point.end_name}.{letter}"
            terms = scene.motion(name).terms
            if all(dof in index for dof, _ in terms):
                places = np.array([index[dof] for dof, _ in terms], dtype=np.int64)
                found[name] = Motion(index=places, coefficient=np.array([c for _, c in terms], dtype=float))
    return found | _turning_points(scene, index) | _space_points(scene, index) | _joint_motions(scene, index)


def _space_points(scene: Scene, index: Mapping[str, int]) -> dict[str, Motion]:
    """Points of bodies in space."""
    found = {}
    for name, point in scene.space_points.items():
        for letter in point.letters:
            form = point.motion(letter)
            if all(dof in index for dof in form.motions):
                places = np.array([index[dof] for dof in form.motions], dtype=np.int64)
                coefficient = np.array([c for _, c in form.terms], dtype=float)
                found[f"{name}.{letter}"] = Motion(index=places, coefficient=coefficient)
    return found


def _vectors(scene: Scene, index: Mapping[str, int]) -> dict[str, Vector]:
    """Orientation and angular velocity of bodies in space."""
    found: dict[str, Vector] = {}
    for body in scene.bodies:
        if isinstance(body, SpaceBody) and all(dof in index for dof in body.dof_names):
            places = np.array([index[dof] for dof in body.dof_names[3:]], dtype=np.int64)
            found |= {f"{body.name}.{name}": Vector(kind=kind, index=places) for name, kind in body.seen.items()}
    return found


def _turning_points(scene: Scene, index: Mapping[str, int]) -> dict[str, Motion]:
    """Points of rigid bodies."""
    found = {}
    for name, point in scene.rigid_points.items():
        if not all(dof in index for dof in point.body.dof_names):
            continue
        x, y, angle = (index[dof] for dof in point.body.dof_names)
        (u, v), one = point.offset, np.ones(1)
        found[f"{name}.x"] = Motion(index=np.array([x]), coefficient=one, angle=angle, arm=(u, -v))
        found[f"{name}.y"] = Motion(index=np.array([y]), coefficient=one, angle=angle, arm=(v, u))
    return found


def _joint_motions(scene: Scene, index: Mapping[str, int]) -> dict[str, Motion]:
    """Relative motions of joints."""
    found = {}
    for joint in scene.joints:
        for label, form in joint.observed().items():
            if all(dof in index for dof in form.motions):
                places = np.array([index[dof] for dof in form.motions], dtype=np.int64)
                coefficient = np.array([c for _, c in form.terms], dtype=float)
                found[f"{joint.name}.{label}"] = Motion(index=places, coefficient=coefficient, offset=form.constant)
    return found
