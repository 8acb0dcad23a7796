"""What is run on its own: an island's arrays, and their places in those of the whole scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fricmb.integrate import MotionSamples, Start
from fricmb.integrate.problem import Codes, Floats, Ints
from fricmb.plan import Island, Plan, Selection
from fricmb.scene import Contact, Joint, Part, Scene
from fricmb.scene._family import is_same_part
from fricmb.solution import Flags, Names
from fricmb.system import System, build
from fricmb.system._contacts import UNIT


@dataclass(frozen=True)
class Place:
    """Rows of a member's arrays in those of the whole: degrees of freedom, contacts, contact rows, law states."""

    dofs: Ints
    contacts: Ints
    rows: Ints
    states: Ints

    def part(self, samples: MotionSamples) -> MotionSamples:
        """The member's share of samples of the whole."""
        return MotionSamples(
            t=samples.t, q=samples.q[self.dofs], v=samples.v[self.dofs], z=samples.z[self.states],
            F=samples.F[self.rows], g=samples.g[self.rows], N=samples.N[self.contacts],
            mode=samples.mode[self.contacts],
        )  # fmt: skip

    def start(self, whole: Start) -> Start:
        """The member's share of a start."""
        mode: Codes | None = None if whole.mode is None else whole.mode[self.contacts]
        direction = None if whole.direction is None else whole.direction[self.rows]
        return Start(
            t=whole.t, q=whole.q[self.dofs], v=whole.v[self.dofs], z=whole.z[self.states], mode=mode,
            direction=direction,
        )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Member:
    """Something that is run on its own: an island, or a whole scene (``island`` None)."""

    scene: Scene
    selection: Selection
    names: Names
    island: Island | None = None

    @cached_property
    def place(self) -> Place:
        """Its places in the arrays of the whole; found when they are needed, which they are not of what rests."""
        return place_of(self.selection, self.names)

    @property
    def first(self) -> int:
        """Its first degree of freedom."""
        return self.names.dof_index[self.selection.dofs[0]]

    @cached_property
    def contacts(self) -> list[str]:
        """Its contacts."""
        return [name for name in self.selection.parts if name in self.names.contact_index]

    @cached_property
    def system(self) -> System:
        """Its arrays, built when it is run."""
        return build(self.scene, self.selection)

    def keeps_still(self, samples: MotionSamples) -> bool:
        """Whether it rests at all the samples' times."""
        place = self.place.dofs
        return self.island is not None and self.island.rests(samples.q[place], samples.v[place])

    def __str__(self) -> str:
        return "the scene" if self.island is None else str(self.island)


@dataclass(frozen=True)
class Rest:
    """What members rest by: whether each does without load, and has to start from 0; which one a dof belongs to."""

    inert: Flags
    held: Flags
    owner: Ints

    @classmethod
    def of(cls, members: Sequence[Member]) -> Rest:
        """From the islands of all members."""
        islands = [member.island for member in members]
        index = members[0].names.dof_index
        owner = np.zeros(len(members[0].names.dofs), dtype=np.int64)
        dofs = [index[name] for member in members for name in member.selection.dofs]
        owner[dofs] = np.repeat(np.arange(len(members)), [len(member.selection.dofs) for member in members])
        return cls(
            inert=np.array([island is not None and island.inert for island in islands], dtype=np.bool_),
            held=np.array([island is None or island.held for island in islands], dtype=np.bool_),
            owner=owner,
        )

    def members(self, start: Start) -> Flags:
        """Which members provably stay where they are from a start of the whole (n_members,)."""
        away = (start.v != 0.0) | (self.held[self.owner] & (start.q != 0.0))
        still: Flags = np.bincount(self.owner, weights=away, minlength=len(self.inert)) == 0
        return self.inert & still


def members_of(scene: Scene, plan: Plan, names: Names, together: bool) -> tuple[Member, ...]:
    """An island each; or, ``together`` or where there is nothing to tell apart, the whole as one."""
    if together or (len(plan.islands) == 1 and not plan.idle):
        whole = Selection(dofs=plan.dofs, parts=plan.parts)
        return (Member(scene=scene, selection=whole, names=names),)
    return tuple(Member(scene=scene, selection=i.selection, names=names, island=i) for i in plan.islands)


def place_of(selection: Selection, names: Names) -> Place:
    """Where the arrays of a selection stand in the whole."""
    dofs = np.array([names.dof_index[name] for name in selection.dofs], dtype=np.int64)
    contacts = [names.contact_index[name] for name in selection.parts if name in names.contact_index]
    return Place(
        dofs=dofs,
        contacts=np.array(contacts, dtype=np.int64),
        rows=_ranges(contacts, names.row),
        states=_ranges(contacts, names.z_start),
    )


def _ranges(contacts: list[int], start: Ints) -> Ints:
    found = [np.arange(start[k], start[k + 1]) for k in contacts]
    return np.concatenate([np.zeros(0, dtype=np.int64), *found])


def contact_names(contact: Contact | Joint) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Labels of the directions and of the law's states of a contact or joint, as its arrays have them."""
    if isinstance(contact, Joint):
        named = contact.labels()
        return named, () if contact.friction is None else contact.friction.state_labels(named)
    letters = contact.labels()
    return letters, contact.law.state_labels(letters)


def row_scale(contact: Contact | Joint) -> tuple[float, ...]:
    """Factors of a contact's rows: those of a law that is not isotropic are stored scaled (see ``Names.scale``)."""
    if isinstance(contact, Joint):
        return UNIT[contact.slip_rows]
    if not contact.law.axis_scale():
        return UNIT[len(contact.labels())]
    return tuple(float(s) for s in contact.law.numeric().axis_scale())


def row_offset(contact: Contact | Joint) -> tuple[float, ...]:
    """Centre of a contact's cone along its rows, over the normal force (see ``Names.offset``)."""
    law = contact.law
    found = law.numeric().offsets() if law is not None and law.offsets() else ()
    return tuple(float(c) for c in found) or (0.0,) * len(contact.labels())


def is_shifted(contact: Contact | Joint) -> bool:
    """Whether the cone of a contact has its centre off 0."""
    return contact.law is not None and bool(contact.law.offsets())


def has_same_names(one: Part, other: Part, but: frozenset[str]) -> bool:
    """Whether names that a part brings are those of another: numbers of contacts and of bodies bring none."""
    if is_same_part(one, other, but):
        return True
    differs = one.differs_in(other)
    if differs is None or not isinstance(one, Contact | Joint) or not isinstance(other, Contact | Joint):
        return False
    named = frozenset(("law", "normal_force") if isinstance(one, Contact) else ("friction",))
    return (
        differs <= named and _rubs(one) and _rubs(other)
        and (contact_names(one), row_scale(one), row_offset(one))
        == (contact_names(other), row_scale(other), row_offset(other))
    )  # fmt: skip


def _rubs(part: Contact | Joint) -> bool:
    return isinstance(part, Contact) or part.friction is not None


@dataclass(frozen=True, kw_only=True)
class Idle:
    """Contacts without normal force: nothing but the relative velocity is to be known of them."""

    system: System
    place: Place

    def fill(self, samples: MotionSamples) -> None:
        """Relative velocities at the samples' times, for the motion they hold; no force, open."""
        from fricmb.integrate import OPEN

        problem, t = self.system.problem, samples.t
        contacts = problem.contacts
        rates: Floats = self.system.signals(t)[1]
        v = samples.v[self.place.dofs]
        samples.g[self.place.rows] = contacts.W.T @ v - contacts.w[:, None] - contacts.Wu @ rates
        samples.mode[self.place.contacts] = OPEN


def idle_of(scene: Scene, plan: Plan, names: Names) -> Idle | None:
    """The contacts of a plan that act on nothing, with the bodies they touch."""
    if not plan.idle:
        return None
    idle = set(plan.idle)
    bodies = {end.owner.name for name in plan.idle for end in scene[name].ends()}
    parts = tuple(part.name for part in scene.parts if part.name in idle or part.name in bodies)
    dofs = tuple(name for name in plan.dofs if name.partition(".")[0] in bodies)
    selection = Selection(dofs=dofs, parts=parts)
    return Idle(system=build(scene, selection), place=place_of(selection, names))
