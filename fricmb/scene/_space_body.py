"""What a body in space is to a scene.  The types themselves are in ``fricmb.space``, which is loaded when used."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar

from fricmb.errors import SceneError, unknown_name
from fricmb.scene._bodies import check_keys
from fricmb.scene._element import Element
from fricmb.scene._forms import LinearForm
from fricmb.scene._joint import Joint
from fricmb.scene._part import LETTERS, End, Part, PartEnd, PointEnd
from fricmb.values import is_list, value_of


def check_triple(owner: Part, argument: str, value: Any) -> tuple[Any, Any, Any]:
    """Three numbers: x, y and z."""
    if isinstance(value, Mapping):
        given = check_keys(owner, argument, value, LETTERS)
        x, y, z = (owner._number(f"{argument}[{c!r}]", given.get(c, 0.0)) for c in LETTERS)
        return x, y, z
    if is_list(value) and len(value) == 3:
        x, y, z = (owner._number(f"{argument}[{i}]", entry) for i, entry in enumerate(value))
        return x, y, z
    owner._refuse(argument, value, "three numbers, (x, y, z)")


#: Reads a number of a declaration: its path and its value.
Read = Callable[[str, Any], Any]


def plain(_: str, value: Any) -> float:
    """The number of a slot."""
    return float(value_of(value))


class SpaceBody(PartEnd):
    """Base of bodies in space: q' = v, a constant diagonal mass, and points that are linear in the coordinates.

    What ties the coordinates of one body together is a constraint like that of a joint, its *inner* one, which
    reactions and reports leave out.
    """

    #: Coordinates that turn, behind x, y and z: their names in ``dof_names``.
    turning: ClassVar[tuple[str, ...]] = ()
    #: Names of what the solution gives beside the degrees of freedom: ``sol["rod.rotation"]``, by its kind.
    seen: ClassVar[Mapping[str, str]] = {}

    mass: Any

    @property
    def dof_names(self) -> tuple[str, ...]:
        """``"name.x"``, ``"name.y"``, ``"name.z"`` of the centre of mass, then what turns."""
        return tuple(f"{self.name}.{c}" for c in (*LETTERS, *self.turning))

    def start_values(self, argument: str) -> dict[str, Any]:
        """Declared start of the degrees of freedom; ``argument``: "position" or "velocity"."""
        return {**getattr(self, argument), **dict(zip(self.turning, self.turned_start(argument), strict=True))}

    def turned_start(self, argument: str) -> tuple[float, ...]:
        """Start of the coordinates that turn, or of their rates."""
        raise NotImplementedError

    def masses(self, read: Read = plain) -> tuple[Any, ...]:
        """Diagonal of the mass matrix; ``read``: gives number or symbol of a slot."""
        raise NotImplementedError

    def turning_forms(self) -> tuple[LinearForm, ...]:
        """The coordinates that turn."""
        return tuple(LinearForm.of({f"{self.name}.{c}": 1.0}) for c in self.turning)

    def least_masses(self) -> tuple[float, ...]:
        """What coordinates count at least where changes are measured: above 0 where one may have no mass."""
        return (0.0,) * len(self.dof_names)

    def inner(self) -> Joint | None:
        """What keeps the coordinates those of a rigid body."""
        return None

    def gyroscopic(self) -> Element | None:
        """Forces of inertia beside mass times acceleration."""
        return None

    def parts_within(self) -> tuple[Joint | Element, ...]:
        """What is built with the body, and bears its name."""
        return tuple(part for part in (self.inner(), self.gyroscopic()) if part is not None)

    def place(self, offset: tuple[float, ...], letter: str) -> LinearForm:
        """Coordinate of a point fixed in the body."""
        raise NotImplementedError

    @property
    def offsets(self) -> Mapping[str, Any]:
        """Named points of the body, what they are declared by."""
        return {}

    def check_offset(self, argument: str, value: Any) -> tuple[Any, ...]:
        """Numbers that say where a point of the body is."""
        raise NotImplementedError

    @property
    def letters(self) -> tuple[str, ...]:
        """Letters of space."""
        return LETTERS

    @property
    def movable(self) -> bool:
        """True: forces move it."""
        return True

    def motion(self, letter: str) -> LinearForm:
        """The centre of mass along an axis."""
        return LinearForm.of({f"{self.name}.{letter}": 1.0})

    def _set_triples(self, *arguments: str) -> None:
        """Check vectors of the declaration, and keep them by letters."""
        for argument in arguments:
            triple = check_triple(self, argument, getattr(self, argument))
            self._set(argument, MappingProxyType(dict(zip(LETTERS, triple, strict=True))))

    def _check_points(self, argument: str) -> None:
        given = getattr(self, argument)
        if not isinstance(given, Mapping):
            self._refuse(argument, given, "a dict of names")
        for name in given:
            if not isinstance(name, str) or not name.isidentifier() or name in self._taken():
                self._refuse(argument, name, f"keyed by names that are identifiers, none of {self._taken()}")
        checked = {name: self.check_offset(f"{argument}[{name!r}]", value) for name, value in given.items()}
        self._set(argument, MappingProxyType(checked))

    def _taken(self) -> tuple[str, ...]:
        return (*LETTERS, *self.turning, *self.seen)

    def _point(self, name: str, offset: Any) -> SpacePoint:
        if offset is None:
            if not isinstance(name, str) or name not in self.offsets:
                raise unknown_name(f"point of {self._label()}", name, self.offsets)
            return SpacePoint(self, name)
        if name in self.offsets:
            raise SceneError(f"{self._label()}: {name!r} is among its points; leave the offset out")
        if not isinstance(name, str) or not name.isidentifier() or name in self._taken():
            self._refuse("point", name, f"named by an identifier, none of {self._taken()}")
        return SpacePoint(self, name, self.check_offset(f"point {name!r}", offset))


class InnerConstraint(Joint):
    """What ties the coordinates of one body together."""

    @property
    def relative(self) -> bool:
        """Of one body alone."""
        return True

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """What turns."""
        body: Any = self.a
        forms: tuple[LinearForm, ...] = body.turning_forms()
        return forms


def with_inner(parts: Iterable[Any]) -> list[Any]:
    """Parts, those with two ends by their ends, and behind each what is built with it."""
    return [
        one
        for part in parts
        for one in (*(part.sides() if isinstance(part, Joint) else (part,)), *part.parts_within())
    ]


@dataclass(frozen=True)
class SpacePoint(PointEnd):
    """A point fixed in a body in space; made by its ``point()`` or ``station()``.

    ``own``: where it is in the body, unless the body lists it.
    """

    body: SpaceBody
    point: str
    own: tuple[Any, ...] | None = None

    @property
    def offset(self) -> tuple[float, ...]:
        """What says where it is in the body."""
        held = self.own if self.own is not None else self.body.offsets[self.point]
        return tuple(float(value_of(x)) for x in held)

    @property
    def letters(self) -> tuple[str, ...]:
        """Letters of space."""
        return LETTERS

    def motion(self, letter: str) -> LinearForm:
        """Linear in the coordinates of the body."""
        return self.body.place(self.offset, letter)

    def moved_to(self, part: Part) -> End:
        """The point of the same name."""
        if part is self.body or not isinstance(part, SpaceBody):
            return self
        return SpacePoint(part, self.point, self.own)
